//! How a student's learning stands, for whoever records it.

/// What [`Agent::diagnose`](crate::Agent::diagnose) finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diagnosis {
    /// Episodes in the replay buffer.
    pub replay_episodes: u64,
    /// Transitions in the replay buffer.
    pub replay_transitions: u64,
    /// What a gradient step would find; `None` before the first episode.
    pub dry_step: Option<DryStep>,
}

/// What a gradient step would find on one batch, if it were taken. Numbers that diverge are not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DryStep {
    /// The critic's loss, mean (Q(s, g, a) − y)².
    pub critic_loss: f64,
    /// The actor's loss, −mean Q(s, g, π(s, g)) + λ·mean π².
    pub actor_loss: f64,
    /// Mean of Q(s, g, a) over the batch, by the online critic.
    pub mean_q: f64,
    /// Euclidean norm of the critic's gradient.
    pub critic_gradient_norm: f64,
    /// Euclidean norm of the actor's gradient.
    pub actor_gradient_norm: f64,
}
