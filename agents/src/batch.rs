//! A batch of transitions on its way from the replay buffer to the networks.

use envs::Spec;

use crate::draw::Draw;
use crate::error::AgentError;

/// `n` transitions (s, a, r, s') with the goal they are judged by; every field is a flat matrix of `n` rows.
///
/// Filled from a replay buffer. Numbers are not normalised; whoever feeds them to a network does that.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// Number of transitions n.
    pub(crate) len: usize,
    /// Dimensions S, G, A.
    pub(crate) dims: Dims,
    /// Which transitions these are; scratch memory of the sampling.
    pub(crate) draws: Vec<Draw>,
    /// An achieved goal and a wanted one in double precision, shape `[2, G]`; scratch memory of the sampling.
    pub(crate) goal_pair: [Vec<f64>; 2],
    /// s, shape `[n, S]`.
    pub states: Vec<f32>,
    /// s', shape `[n, S]`.
    pub next_states: Vec<f32>,
    /// g, shape `[n, G]`.
    pub goals: Vec<f32>,
    /// a, shape `[n, A]`.
    pub actions: Vec<f32>,
    /// a' = π(s', g), shape `[n, A]`; zeros until [`crate::Critic::label_next_actions`] fills them.
    pub next_actions: Vec<f32>,
    /// r, shape `[n]`: 0 or −1.
    pub rewards: Vec<f32>,
}

/// The dimensions that a batch, a buffer and a network must agree on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dims {
    /// S.
    pub(crate) state: usize,
    /// G.
    pub(crate) goal: usize,
    /// A.
    pub(crate) action: usize,
}

impl Dims {
    /// The dimensions of a task.
    pub(crate) fn of(spec: &Spec) -> Self {
        Self { state: spec.state, goal: spec.goal, action: spec.action }
    }

    /// Numbers that an episode of `horizon` steps is made of in the replay buffer.
    pub(crate) fn episode_len(self, horizon: usize) -> usize {
        (horizon + 1) * (self.state + self.goal + self.action) + self.goal
    }

    /// S + G, what an actor sees.
    pub(crate) fn actor_inputs(self) -> usize {
        self.state + self.goal
    }

    /// S + G + A, what a critic sees.
    pub(crate) fn critic_inputs(self) -> usize {
        self.state + self.goal + self.action
    }

    /// Refuses anything of other dimensions.
    pub(crate) fn check(self, other: Self) -> Result<(), AgentError> {
        for (what, expected, got) in [
            ("a state", self.state, other.state),
            ("a goal", self.goal, other.goal),
            ("an action", self.action, other.action),
        ] {
            check_len(what, expected, got)?;
        }
        Ok(())
    }
}

/// Refuses a slice of another length than `expected`.
pub(crate) fn check_len(what: &'static str, expected: usize, got: usize) -> Result<(), AgentError> {
    if got == expected { Ok(()) } else { Err(AgentError::Shape { what, expected, got }) }
}

impl Batch {
    /// Room for `n` transitions of the task `spec`, all zeros.
    pub fn new(spec: &Spec, n: usize) -> Self {
        let dims = Dims::of(spec);
        Self {
            len: n,
            dims,
            draws: Vec::with_capacity(n),
            goal_pair: [vec![0.0; dims.goal], vec![0.0; dims.goal]],
            states: vec![0.0; n * dims.state],
            next_states: vec![0.0; n * dims.state],
            goals: vec![0.0; n * dims.goal],
            actions: vec![0.0; n * dims.action],
            next_actions: vec![0.0; n * dims.action],
            rewards: vec![0.0; n],
        }
    }

    /// Number of transitions n.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is room for no transition.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}
