//! What the harness and the teachers may ask of a student.

use std::any::Any;
use std::path::Path;
use std::time::Duration;

use envs::rng::Rng;
use envs::{Observation, Reward, Rows, Spec};

use crate::actor::PolicyWeights;
use crate::batch::Batch;
use crate::diagnosis::Diagnosis;
use crate::episode::{Episode, Trajectory};
use crate::error::AgentError;
use crate::networks::Parameters;

/// Which copy of the networks answers: the trained ones or their slowly following targets.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    schemars::JsonSchema,
    serde::Serialize,
    serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Network {
    /// The networks that gradient steps change: Q(s, g, π(s, g)).
    #[default]
    Online,
    /// Their Polyak averages: Q'(s, g, π'(s, g)).
    Target,
    /// The averaged critic judges the actions of the trained policy: Q'(s, g, π(s, g)), the smooth value
    /// function of TEACH, section 5.4 and Eq. 12.
    TargetCritic,
}

impl Network {
    /// Whose actions are judged.
    pub(crate) fn actor(self) -> Parameters {
        match self {
            Self::Online | Self::TargetCritic => Parameters::Online,
            Self::Target => Parameters::Target,
        }
    }

    /// Who judges them.
    pub(crate) fn critic(self) -> Parameters {
        match self {
            Self::Online => Parameters::Online,
            Self::Target | Self::TargetCritic => Parameters::Target,
        }
    }
}

/// The read-only side of a student: what a teacher may look at.
///
/// Methods take `&mut self` because they use the student's scratch buffers; none changes what it has learned.
pub trait Critic {
    /// Dimensions of the task.
    fn spec(&self) -> &Spec;

    /// Gradient steps taken so far. As long as this number stays the same, so do the networks; only their
    /// input normalisers still move, with every episode that feeds them.
    fn gradient_steps(&self) -> u64;

    /// The lowest return there is, -1/(1-gamma); the highest is 0. A critic's own values can lie outside.
    fn lowest_value(&self) -> f64;

    /// Policy confidence in every one of `goals` (`[n, G]`), shape `[n]`: the mean of Q(s, g, pi(s, g)) over
    /// `states` (`[m, S]`; TEACH, Eq. 7). Values are not clipped: an untrained critic may answer above 0 or
    /// below [`Critic::lowest_value`].
    ///
    /// # Errors
    /// [`AgentError::NotFinite`] if a value is NaN.
    fn confidence(&mut self, goals: &Rows, states: &Rows, network: Network) -> Result<Vec<f64>, AgentError>;

    /// The greedy action for every pair of a state (`[n, S]`) and a goal (`[n, G]`): shape `[n, A]`.
    ///
    /// # Errors
    /// [`AgentError::NotFinite`] if an action is NaN.
    fn policy(&mut self, states: &Rows, goals: &Rows, network: Network) -> Result<Rows, AgentError>;

    /// `m` states drawn uniformly, with replacement, from the replay buffer: shape `[m, S]`; no row if the
    /// buffer is empty.
    fn replay_states(&mut self, m: usize, rng: &mut Rng) -> Rows;

    /// `m` goals that were achieved after some transition, drawn uniformly, with replacement, from the replay
    /// buffer: shape `[m, G]`; no row if the buffer is empty.
    fn replay_achieved(&mut self, m: usize, rng: &mut Rng) -> Rows;

    /// Episodes in the replay buffer.
    fn replay_episodes(&self) -> usize;

    /// The episode that came into the replay buffer as the last but `age`: 0 is the newest,
    /// [`Critic::replay_episodes`] − 1 the oldest. `None` beyond that.
    fn replay_trajectory(&self, age: usize) -> Option<Trajectory>;

    /// The temporal-difference error of every transition of `trajectory` towards its own goal, shape `[H]`:
    /// y − Q(s, g, a), with the target y that the student's critic learns towards. `reward` is the task's.
    ///
    /// # Errors
    /// [`AgentError::NotFinite`] if a value is NaN, [`AgentError::Shape`] if `trajectory` is of another task.
    fn td_errors(&mut self, trajectory: &Trajectory, reward: &dyn Reward) -> Result<Vec<f64>, AgentError>;

    /// Fills `batch` with transitions drawn uniformly from the replay buffer, each with the goal that was
    /// asked for in its episode (no relabelling). A teacher that learns from the student's experience needs
    /// no buffer of its own.
    ///
    /// # Errors
    /// [`AgentError::EmptyReplay`] before the first episode, [`AgentError::Shape`] if `batch` is of another
    /// task.
    fn replay_batch(&self, reward: &dyn Reward, rng: &mut Rng, batch: &mut Batch) -> Result<(), AgentError>;

    /// Fills the next actions of `batch` with the greedy ones, pi(s', g).
    ///
    /// # Errors
    /// [`AgentError::NotFinite`] if an action is NaN, [`AgentError::Shape`] if `batch` is of another task.
    fn label_next_actions(&mut self, batch: &mut Batch, network: Network) -> Result<(), AgentError>;
}

/// How an action is chosen.
pub enum Mode<'a> {
    /// The policy's own action.
    Greedy,
    /// The policy's action with exploration noise from this stream; a random one in a warm-up.
    Explore(&'a mut Rng),
}

/// A student: acts, remembers, learns.
pub trait Agent: Critic + Send + Any {
    /// Writes an action for `observation` and `goal` (`[G]`) into `action` (`[A]`).
    ///
    /// # Errors
    /// [`AgentError::NotFinite`] if the policy gives NaN, [`AgentError::Shape`] if a slice does not fit the
    /// task.
    fn act(
        &mut self,
        observation: &Observation,
        goal: &[f64],
        mode: Mode<'_>,
        action: &mut [f64],
    ) -> Result<(), AgentError>;

    /// Tells the student that an episode with exploration begins (correlated noise starts anew).
    fn begin_episode(&mut self) {}

    /// Takes in a finished training episode. `reward` is the task's, for relabelling.
    ///
    /// # Errors
    /// [`AgentError::Shape`] if the episode does not fit the task.
    fn observe(&mut self, episode: &Episode, reward: &dyn Reward, rng: &mut Rng) -> Result<(), AgentError>;

    /// Episodes between two calls of [`Agent::learn`].
    fn episodes_per_cycle(&self) -> usize;

    /// One cycle's learning: its gradient steps and the Polyak updates. `reward` is the task's, for
    /// relabelling. A student that is still warming up takes no gradient step.
    ///
    /// # Errors
    /// [`AgentError::Diverged`] if a loss or parameter is not finite, [`AgentError::EmptyReplay`] before the
    /// first episode, unless it is warming up.
    fn learn(&mut self, reward: &dyn Reward, rng: &mut Rng) -> Result<(), AgentError>;

    /// Time that [`Agent::learn`] has spent on drawing batches so far; `None` if the student does not measure
    /// it.
    fn sampling_time(&self) -> Option<Duration> {
        None
    }

    /// How learning stands: losses and gradients of a batch that `rng` draws as a gradient step would,
    /// without the step. Nothing that the student has learned changes, and its own learning goes on as if it
    /// had not been asked. `reward` is the task's, for relabelling.
    ///
    /// # Errors
    /// [`AgentError::Torch`] if libtorch refuses.
    fn diagnose(&mut self, reward: &dyn Reward, rng: &mut Rng) -> Result<Diagnosis, AgentError>;

    /// The greedy policy as plain numbers: what a program without this crate needs to act as it does.
    ///
    /// # Errors
    /// [`AgentError::Torch`] if the parameters cannot be read.
    fn weights(&self) -> Result<PolicyWeights, AgentError>;

    /// Appends the episodes that came in since the last save to the log in folder `replay` (created if
    /// missing) and returns everything else the student is: networks, optimisers, normalisers, counters.
    /// Random streams are not included: they belong to the caller.
    ///
    /// A save never overwrites episodes that an earlier state refers to, and removes old ones only one save
    /// after they were last needed. A caller that writes the returned bytes atomically after this call can
    /// therefore be killed at any moment: the bytes that it wrote last still load.
    ///
    /// # Errors
    /// [`AgentError::Log`] if the log cannot be written.
    fn save(&mut self, replay: &Path) -> Result<Vec<u8>, AgentError>;

    /// Becomes the student that [`Agent::save`] wrote: training on from here gives the same bytes as never
    /// having stopped. Episodes that the log holds beyond `state` are cut off.
    ///
    /// # Errors
    /// [`AgentError::State`] if `state` is damaged or of another student, [`AgentError::Log`] if the log is.
    /// The student is unusable after an error.
    fn load(&mut self, state: &[u8], replay: &Path) -> Result<(), AgentError>;

    /// Takes over networks and normalisers of the student that [`Agent::save`] wrote, but not its experience:
    /// greedy actions and answers are those of that student. This student's own replay buffer stays as it is,
    /// and so does its number of episodes, which decides whether it warms up and how strong its exploration
    /// noise is.
    ///
    /// # Errors
    /// [`AgentError::State`] if `state` is damaged or of another student, which leaves this one unusable.
    fn load_policy(&mut self, state: &[u8]) -> Result<(), AgentError>;
}
