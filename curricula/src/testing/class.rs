//! A class in which a scripted student meets a teacher.

use std::sync::Arc;

use agents::{Auto, Episode, StudentConfig, Trajectory};
use envs::rng::{Purpose, Rng, stream, uniform};
use envs::{GoalEnv, Observation, draw_pool};

use super::{Script, ScriptedStudent, standing_still};
use crate::curriculum::{Curriculum, Lesson, Proposal, ProposedGoal, Setting};
use crate::error::CurriculumError;
use crate::registry::{CURRICULA, Entry};
use crate::rollouts::{RolloutRequest, Rollouts};

/// The student's settings, for teachers with networks of their own: all small, so that tests are fast.
fn small_student() -> StudentConfig {
    StudentConfig { width: 16, batch: Auto::Value(8), gamma: Auto::Value(0.5), ..StudentConfig::default() }
}

/// How likely an episode succeeds, in [0, 1], by its goal (`[G]`) and the student's gradient steps.
pub type Mastery = fn(&[f64], u64) -> f64;

/// A teacher, its scripted student, and everything a lesson needs.
///
/// All methods panic where a test could not go on.
///
/// ```
/// use curricula::testing::Class;
///
/// // A student that cannot tell goals apart: all of four goals are drawn alike.
/// let mut class = Class::new("teach", "", 4, |_goal, _steps| -10.0);
/// assert!(class.cycles(20).into_iter().all(|goal| goal < 4));
/// assert_eq!(class.weights(), [0.25; 4]);
/// ```
pub struct Class {
    /// The teacher.
    pub teacher: Box<dyn Curriculum>,
    /// Its student.
    pub student: ScriptedStudent,
    /// What the teacher was built from.
    pub setting: Setting,
    /// The task.
    pub env: Box<dyn GoalEnv>,
    /// How likely episodes succeed: never, unless a test says otherwise.
    pub mastery: Mastery,
    luck: Rng,
    starts: Rng,
    /// The start of the last episode.
    pub start: Observation,
    /// The teacher's stream.
    pub rng: Rng,
}

impl Class {
    /// The teacher `id` with `config` (TOML) over a pool of `goals`, on the point task.
    pub fn new(id: &str, config: &str, goals: usize, script: Script) -> Self {
        let entry = CURRICULA.iter().find(|entry| entry.id == id).expect("a registered teacher");
        Self::with(entry, config, goals, script).expect("a valid config")
    }

    /// The same for the row of any teacher.
    ///
    /// # Errors
    /// As [`Entry::build`].
    pub fn with(entry: &Entry, config: &str, goals: usize, script: Script) -> Result<Self, CurriculumError> {
        Self::on("Point", entry, config, goals, script)
    }

    /// The same on any environment.
    ///
    /// # Errors
    /// As [`Entry::build`].
    pub fn on(
        environment: &str,
        entry: &Entry,
        config: &str,
        goals: usize,
        script: Script,
    ) -> Result<Self, CurriculumError> {
        let mut env = envs::make(environment, &envs::EnvOptions::default()).expect("an environment");
        let pool = draw_pool(&mut *env, goals, &mut stream(0, Purpose::Pool)).expect("a pool");
        let student = small_student().resolve(env.spec()).expect("valid defaults");
        let setting = Setting { spec: env.spec().clone(), pool: Arc::new(pool), seed: 0, student };
        let teacher = entry.build(config.parse().expect("TOML"), &setting)?;
        let student = ScriptedStudent::new(env.spec().clone(), script);
        let (starts, rng) = (stream(0, Purpose::Environment), stream(0, Purpose::Teacher));
        let start = env.observation().clone();
        let luck = stream(0, Purpose::Exploration);
        let mastery: Mastery = |_, _| 0.0;
        Ok(Self { teacher, student, setting, mastery, luck, start, env, starts, rng })
    }

    /// An episode's beginning, before anything is proposed.
    pub fn reset(&mut self) {
        self.env.reset(&mut self.starts).expect("a start");
        self.start = self.env.observation().clone();
    }

    /// One episode: the teacher's proposal, after which student and teacher hear of an episode of standing
    /// still. Chance and [`Class::mastery`] say whether it counts as a success.
    ///
    /// # Errors
    /// What the teacher says.
    pub fn propose(&mut self) -> Result<Proposal, CurriculumError> {
        self.reset();
        let Self { teacher, student, setting, mastery, luck, start, env, rng, .. } = self;
        let proposal = teacher.propose(&mut Lesson { student, start, goals: &mut **env, rng })?;
        let mut episode = standing_still(&**env);
        match &proposal.goal {
            ProposedGoal::Native => {}
            ProposedGoal::Pool(index) => episode.goal = setting.pool.row(*index).to_vec(),
            ProposedGoal::Other(goal) => episode.goal.clone_from(goal),
        }
        let likely = mastery(&episode.goal, student.steps);
        episode.success = uniform(luck, 0.0, 1.0) < likely;
        teacher.observe(&episode)?;
        let Episode { states, achieved, actions, goal, .. } = episode;
        student.remembered.push(Trajectory { states, achieved, actions, goal });
        Ok(proposal)
    }

    /// One episode's proposal, which must be from the pool.
    pub fn propose_index(&mut self) -> usize {
        match self.propose().expect("a proposal").goal {
            ProposedGoal::Pool(index) => index,
            other => panic!("{other:?} is not from the pool"),
        }
    }

    /// One episode's goal, whoever drew it.
    pub fn propose_goal(&mut self) -> Vec<f64> {
        match self.propose().expect("a proposal").goal {
            ProposedGoal::Native => self.env.goal().to_vec(),
            ProposedGoal::Pool(index) => self.setting.pool.row(index).to_vec(),
            ProposedGoal::Other(goal) => goal,
        }
    }

    /// The end of a cycle: student and teacher learn, and the teacher hears of the probe rollouts that it
    /// asks for, if any.
    pub fn learn(&mut self) {
        self.learn_alone();
        if let Some(request) = self.request() {
            self.play(&request);
        }
    }

    /// The student's and the teacher's learning.
    pub fn learn_alone(&mut self) {
        self.student.steps += 1;
        self.student.has_replay = true;
        let Self { teacher, student, env, rng, .. } = self;
        teacher.learn(student, &**env, rng).expect("learns");
    }

    /// What the teacher asks for after it has learned.
    pub fn request(&mut self) -> Option<RolloutRequest> {
        let Self { teacher, env, rng, .. } = self;
        teacher.request_rollouts(&mut **env, rng).expect("a request, or none")
    }

    /// The teacher hears that p·E of the E episodes of each goal have succeeded, rounded, with p from
    /// [`Class::mastery`].
    pub fn play(&mut self, request: &RolloutRequest) {
        let RolloutRequest { ref goals, episodes, .. } = *request;
        let steps = self.student.steps;
        let succeed = |goal: &[f64]| ((self.mastery)(goal, steps) * episodes as f64).round() as usize;
        let successes = goals.iter().map(succeed).collect();
        let rollouts = Rollouts { goals: goals.clone(), episodes, successes };
        self.teacher.hear_rollouts(&rollouts).expect("rollouts that were asked for");
    }

    /// `n` cycles of one episode each: the indices proposed.
    pub fn cycles(&mut self, n: usize) -> Vec<usize> {
        let cycle = |_| {
            let index = self.propose_index();
            self.learn();
            index
        };
        (0..n).map(cycle).collect()
    }

    /// The teacher's weights, shape `[N]`.
    pub fn weights(&self) -> Vec<f64> {
        self.teacher.summary().weights.expect("a teacher with weights").to_vec()
    }

    /// The teacher's number of this name.
    pub fn statistic(&self, name: &str) -> f64 {
        let numbers = self.teacher.summary().statistics;
        numbers
            .into_iter()
            .find(|(known, _)| *known == name)
            .unwrap_or_else(|| panic!("no number `{name}`"))
            .1
    }
}
