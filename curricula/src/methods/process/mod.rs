//! Process: a curriculum that is a program of its own, in Python or any other language.
//!
//! The program is started with every run and talks with goalbench in lines of JSON: it reads what happens
//! from its standard input and answers on its standard output. `harness/docs/python.md` has the messages;
//! `curricula/python/goalbench_curriculum.py` speaks them for programs in Python.
//!
//! # Choices
//! - Every message gets exactly one answer, so that whatever else a program prints is noticed at once.
//! - The program gets the key of the teacher's own stream. What goalbench draws on its behalf (fresh goals,
//!   states from replay) comes from another stream of that key.
//! - Its whole state is a text of its own, which goalbench keeps in checkpoints and does not look into.
//! - A program never outlives its run: see `conversation`.

mod answers;
mod command;
mod conversation;
mod error;
mod memory;
mod wire;

use std::cell::RefCell;
use std::sync::Arc;
use std::time::Duration;

use agents::Episode;
use envs::Goals;
use envs::rng::{Purpose, stream};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::error::CurriculumError;
use crate::method::Method;
use crate::snapshot;
use crate::state::TeacherState;
use conversation::Conversation;
pub use error::ProcessError;
use memory::Memory;
use wire::{Answer, Message, PROTOCOL};

/// The helper for curricula in Python, `goalbench_curriculum.py`: the other end of the conversation.
pub const PYTHON_HELPER: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/python/goalbench_curriculum.py"));

/// The most seconds that a program may be given for an answer: a day.
const LONGEST_TIMEOUT: f64 = 86_400.0;
/// The most characters of a title.
const LONGEST_TITLE: usize = 60;

/// Options of a curriculum that is a program.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct ProcessConfig {
    /// The program that teaches, with its arguments in the quotes that a shell would ask for: `python
    /// my_teacher.py`. It is started without a shell, in the folder that goalbench was started in. There is
    /// no default: a run of this curriculum needs one.
    ///
    /// Source: yours.
    pub command: String,
    /// Its name in figures and tables, at most 60 characters; empty for "Process".
    ///
    /// Source: yours.
    pub title: String,
    /// How long the program may take for an answer, and for its start. A run whose program takes longer
    /// fails.
    ///
    /// Unit: seconds. Range: above 0. Source: a choice.
    pub timeout: f64,
}

impl Default for ProcessConfig {
    fn default() -> Self {
        Self { command: String::new(), title: String::new(), timeout: 60.0 }
    }
}

/// A curriculum that is a program.
pub struct Process {
    words: Vec<String>,
    timeout: Duration,
    pool: Arc<Goals>,
    goal: usize,
    state: usize,
}

/// The program at work, and what goalbench remembers of it.
pub struct ProcessState {
    /// In a cell, because a program is asked for its state, too.
    conversation: RefCell<Conversation>,
    memory: Memory,
}

/// What is saved: the memory, and the program's own text.
type Saved = (Memory, String);

impl TeacherState for ProcessState {
    const VERSION: u32 = 1;

    fn write(&self) -> Result<Vec<u8>, CurriculumError> {
        let mut conversation = self.conversation.borrow_mut();
        let (message, deadline) = (Message::Save {}, conversation.deadline());
        match conversation.exchange(&message, deadline)? {
            Answer::Saved { state } => Ok(snapshot::plain_bytes(&(&self.memory, state))),
            other => Err(conversation.unexpected(&message, &other).into()),
        }
    }

    fn read(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        let (memory, text): Saved = snapshot::from_plain_bytes(bytes)?;
        let conversation = self.conversation.get_mut();
        let (message, deadline) = (Message::Load { state: &text }, conversation.deadline());
        let refused = |error: ProcessError| snapshot::refuse_because("its program did not take it", error);
        match conversation.exchange(&message, deadline).map_err(refused)? {
            Answer::Loaded {} => {}
            other => return Err(refused(conversation.unexpected(&message, &other))),
        }
        self.memory = memory;
        Ok(())
    }
}

impl Method for Process {
    type Config = ProcessConfig;
    type State = ProcessState;
    const ID: &'static str = "process";
    const TITLE: &'static str = "Process";
    const SOURCE: &'static str = "A program of your own, in Python or any language";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;
    const NEEDS: Option<&'static str> = Some("command");

    fn schema() -> Option<Schema> {
        Some(schema_of::<ProcessConfig>())
    }

    fn check(config: &ProcessConfig) -> Result<(), CurriculumError> {
        let ProcessConfig { command, title, timeout } = config;
        let is_whole = command::words(command).is_some();
        CurriculumError::require(is_whole, "command", command::ACCEPTED, format!("{command:?}"))?;
        let is_title = title.chars().count() <= LONGEST_TITLE && !title.contains(char::is_control);
        let accepted = format!("a line of at most {LONGEST_TITLE} characters");
        CurriculumError::require(
            is_title && title.trim() == title,
            "title",
            &accepted,
            format!("{title:?}"),
        )?;
        let ok = *timeout > 0.0 && *timeout <= LONGEST_TIMEOUT;
        let accepted = format!("above 0 and at most {LONGEST_TIMEOUT} seconds");
        CurriculumError::require(ok, "timeout", &accepted, timeout)
    }

    fn version(config: &ProcessConfig) -> String {
        command::version(Self::VERSION, &config.command)
    }

    fn build(config: ProcessConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        let words = command::words(&config.command).unwrap_or_default();
        CurriculumError::require(!words.is_empty(), "command", command::ACCEPTED, "nothing")?;
        Ok(Self {
            words,
            timeout: Duration::from_secs_f64(config.timeout),
            pool: Arc::clone(&setting.pool),
            goal: setting.spec.goal,
            state: setting.spec.state,
        })
    }

    fn begin(&self, setting: &Setting) -> Result<ProcessState, CurriculumError> {
        let rng = stream(setting.seed, Purpose::Teacher);
        let mut conversation = Conversation::begin(&self.words, self.timeout)?;
        let hello = Message::Hello {
            protocol: PROTOCOL,
            spec: (&setting.spec).into(),
            pool: self.pool.iter().collect(),
            seed: setting.seed,
            stream: hex::encode(rng.get_seed()),
        };
        let deadline = conversation.deadline();
        let memory = match conversation.exchange(&hello, deadline)? {
            Answer::Ready { protocol: PROTOCOL, weights, statistics } => {
                Memory::begin(self.pool.len(), rng, weights, statistics)
                    .map_err(|reason| conversation.wrong(&hello, reason))?
            }
            Answer::Ready { protocol, .. } => {
                let reason = format!("speaks protocol {protocol}; this goalbench speaks {PROTOCOL}");
                return Err(conversation.wrong(&hello, reason).into());
            }
            other => return Err(conversation.unexpected(&hello, &other).into()),
        };
        Ok(ProcessState { conversation: RefCell::new(conversation), memory })
    }

    fn propose(
        &self,
        state: &mut ProcessState,
        lesson: &mut Lesson<'_>,
    ) -> Result<Proposal, CurriculumError> {
        let ProcessState { conversation, memory, .. } = state;
        let conversation = conversation.get_mut();
        // One deadline for a proposal and all that the program asks before it: nobody asks for ever.
        let deadline = conversation.deadline();
        let start = lesson.start.clone();
        let gradient_steps = lesson.student.gradient_steps();
        let propose = Message::Propose { gradient_steps, state: &start.state, achieved: &start.achieved };
        let mut answer = conversation.exchange(&propose, deadline)?;
        loop {
            answer = match answer {
                Answer::Goal { goal, score, rank, weights, statistics } => {
                    let taken = memory.take(weights, statistics);
                    let proposal = taken.and_then(|()| answers::proposal(&goal, score, rank, self));
                    let proposal = proposal.map_err(|reason| conversation.wrong(&propose, reason))?;
                    memory.propose(&proposal);
                    return Ok(proposal);
                }
                Answer::Ask(ask) => {
                    let told = answers::tell(&ask, self, memory, lesson)?;
                    let told = told.map_err(|reason| conversation.wrong(&propose, reason))?;
                    conversation.exchange(&told, deadline)?
                }
                other => return Err(conversation.unexpected(&propose, &other).into()),
            };
        }
    }

    fn observe(&self, state: &mut ProcessState, episode: &Episode) -> Result<(), CurriculumError> {
        let ProcessState { conversation, memory, .. } = state;
        let index = memory.observe(&self.pool, &episode.goal, episode.success);
        let message = Message::Episode {
            goal: &episode.goal,
            pool: index,
            success: episode.success,
            total_reward: episode.total_reward,
            achieved: episode.achieved.iter().last().unwrap_or_default(),
        };
        let conversation = conversation.get_mut();
        let deadline = conversation.deadline();
        match conversation.exchange(&message, deadline)? {
            Answer::Heard { weights, statistics } => {
                let taken = memory.take(weights, statistics);
                taken.map_err(|reason| conversation.wrong(&message, reason).into())
            }
            other => Err(conversation.unexpected(&message, &other).into()),
        }
    }

    fn summary<'a>(&'a self, state: &'a ProcessState) -> TeacherSummary<'a> {
        state.memory.summary()
    }

    fn check_state(&self, state: &ProcessState) -> Result<(), CurriculumError> {
        snapshot::require_goals(state.memory.goals(), self.pool.len())
    }
}
