//! What a student experiences, and what it remembers of that.

use envs::Rows;

/// One finished episode, horizon H.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// States, shape `[H + 1, S]`.
    pub states: Rows,
    /// Achieved goals, shape `[H + 1, G]`.
    pub achieved: Rows,
    /// Actions, shape `[H, A]`.
    pub actions: Rows,
    /// The goal asked for, shape `[G]`.
    pub goal: Vec<f64>,
    /// Sum of the rewards of its steps, towards that goal.
    pub total_reward: f64,
    /// Success at the last step.
    pub success: bool,
}

/// An episode as the replay buffer remembers it, in single precision; horizon H.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// States, shape `[H + 1, S]`.
    pub states: Rows,
    /// Achieved goals, shape `[H + 1, G]`.
    pub achieved: Rows,
    /// Actions, shape `[H, A]`.
    pub actions: Rows,
    /// The goal asked for, shape `[G]`.
    pub goal: Vec<f64>,
}
