//! Probe rollouts: episodes that a teacher asks for to see what the student can do, and that train nobody.

use envs::Goals;
use serde::{Deserialize, Serialize};

/// A request for probe rollouts. The harness plays them between cycles, on an instance of the environment of
/// their own and from a stream of their own; the student learns nothing from them, and the training
/// environment knows nothing of them.
///
/// ```
/// use curricula::{RolloutPolicy, RolloutRequest};
/// use envs::Goals;
///
/// let mut goals = Goals::new(2);
/// goals.push(&[0.0, 0.5]);
/// goals.push(&[0.5, 0.0]);
/// let request = RolloutRequest { goals, episodes: 4, policy: RolloutPolicy::Noisy, charge: true };
/// assert_eq!(request.all_episodes(), 8);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RolloutRequest {
    /// The goals to try, shape `[n, G]`.
    pub goals: Goals,
    /// E, episodes per goal.
    pub episodes: usize,
    /// How the student acts in them.
    pub policy: RolloutPolicy,
    /// Whether their steps are charged to the run's budget.
    pub charge: bool,
}

impl RolloutRequest {
    /// n · E, the episodes of all goals together.
    pub fn all_episodes(&self) -> usize {
        self.goals.len() * self.episodes
    }
}

/// How the student acts in probe rollouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RolloutPolicy {
    /// The policy's own actions.
    Greedy,
    /// With the exploration noise of training.
    Noisy,
}

/// What probe rollouts came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Rollouts {
    /// The goals of the request, shape `[n, G]`.
    pub goals: Goals,
    /// E, episodes per goal.
    pub episodes: usize,
    /// For each goal, how many of its episodes were successful at their last step, shape `[n]`.
    pub successes: Vec<usize>,
}

impl Rollouts {
    /// The share of successful episodes of each goal, shape `[n]`.
    pub fn success_rates(&self) -> Vec<f64> {
        self.successes.iter().map(|&successes| successes as f64 / self.episodes as f64).collect()
    }
}
