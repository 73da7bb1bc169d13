//! Asking the student for its confidence in the goals of the pool.

use agents::{AgentError, Network};
use envs::{Goals, Rows};
use serde::{Deserialize, Serialize};

use crate::curriculum::Lesson;
use crate::distribution::require_finite;
use crate::error::CurriculumError;

/// From which states confidence is measured: the paper's "s ~ D" leaves it open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StateSource {
    /// The start state of the coming episode.
    #[default]
    Initial,
    /// States drawn uniformly from the replay buffer. The price is a pass over the pool for every one of them.
    Replay,
}

/// How confidence is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeConfig {
    /// Which networks answer.
    pub network: Network,
    /// From which states.
    pub states: StateSource,
    /// How many states, with [`StateSource::Replay`].
    pub replay_states: usize,
}

/// The largest accepted number of replay states: every one costs a forward pass over the whole pool.
const MOST_REPLAY_STATES: usize = 1024;

impl ProbeConfig {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`CurriculumError::Config`] for `replay_states` outside 1 to 1024.
    pub fn check(&self) -> Result<(), CurriculumError> {
        let accepted = format!("in 1..={MOST_REPLAY_STATES}");
        let ok = (1..=MOST_REPLAY_STATES).contains(&self.replay_states);
        CurriculumError::require(ok, "replay_states", &accepted, self.replay_states)
    }
}

/// What comes of asking.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// The confidence in every goal, shape `[N]`, within [−1/(1−γ), 0].
    Confidence(Vec<f64>),
    /// Nothing was evaluated: the networks have not changed since the last evaluation.
    Unchanged,
    /// Nothing was evaluated: replay states are asked for, and there are none yet.
    NoStates,
}

/// Measures policy confidence C(g) (TEACH, Eq. 7) over a list of goals, and at most once per state of the
/// networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Gradient steps behind the networks at the last evaluation.
    asked_at: Option<u64>,
    evaluations: u64,
    /// Mean, smallest and largest confidence at the last evaluation.
    summary: Option<[f64; 3]>,
}

impl Probe {
    /// A probe that has not asked yet.
    pub fn new() -> Self {
        Self { asked_at: None, evaluations: 0, summary: None }
    }

    /// The student's confidence in every goal of `pool`, if there is something to be learned by asking.
    ///
    /// # Errors
    /// [`CurriculumError::NotFinite`] or [`CurriculumError::Student`] if the answer is not one finite value per goal.
    pub fn ask(
        &mut self,
        config: &ProbeConfig,
        pool: &Goals,
        lesson: &mut Lesson<'_>,
    ) -> Result<Answer, CurriculumError> {
        let now = lesson.student.gradient_steps();
        if self.asked_at == Some(now) {
            return Ok(Answer::Unchanged);
        }
        let states = match config.states {
            StateSource::Initial => single(&lesson.start.state),
            StateSource::Replay => lesson.student.replay_states(config.replay_states, lesson.rng),
        };
        if states.is_empty() {
            return Ok(Answer::NoStates);
        }
        let values = lesson.student.confidence(pool, &states, config.network)?;
        if values.len() != pool.len() {
            return Err(
                AgentError::Shape { what: "confidence", expected: pool.len(), got: values.len() }.into()
            );
        }
        require_finite(&values, "confidence")?;
        self.asked_at = Some(now);
        self.evaluations += 1;
        self.summary = Some(summarise(&values));
        Ok(Answer::Confidence(values))
    }

    /// Evaluations so far, and the mean, smallest and largest confidence at the last one (NaN before the first).
    pub fn statistics(&self) -> [(&'static str, f64); 4] {
        let [mean, min, max] = self.summary.unwrap_or([f64::NAN; 3]);
        [
            ("evaluations", self.evaluations as f64),
            ("confidence_mean", mean),
            ("confidence_min", min),
            ("confidence_max", max),
        ]
    }
}

impl Default for Probe {
    fn default() -> Self {
        Self::new()
    }
}

/// One state as a matrix of one row.
fn single(state: &[f64]) -> Rows {
    let mut states = Rows::with_capacity(state.len(), 1);
    states.push(state);
    states
}

/// Mean, smallest and largest of `values`, of which there is at least one.
fn summarise(values: &[f64]) -> [f64; 3] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let min = values.iter().copied().fold(f64::INFINITY, f64::min);
    let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [mean, min, max]
}
