//! One gradient step of DDPG.

use envs::rng::Rng;
use tch::TchError;

use crate::batch::{Batch, Dims};
use crate::config::StudentConfig;
use crate::diagnosis::DryStep;
use crate::error::AgentError;
use crate::inputs::{Normalizers, TransitionInputs, rows_per_part};
use crate::losses::{Discount, mean_part, penalty_part, value_part};
use crate::networks::{Block, Parameters, Passes, Shape, Trained, copy};
use crate::precision::Arithmetic;
use crate::value::ValueLearner;

/// Actor and critic under training.
#[derive(Debug)]
pub(super) struct Learner {
    pub(super) actor: Trained,
    pub(super) critic: ValueLearner,
    /// Gradient steps taken.
    pub(super) steps: u64,
    actor_passes: Passes,
    inputs: TransitionInputs,
    /// The online critic's first-layer weights of the action, `[1, A, width]`.
    action_weights: Block,
    rates: Rates,
}

#[derive(Clone, Copy, Debug)]
struct Rates {
    actor: f64,
    critic: f64,
    action_l2: f64,
}

impl Learner {
    /// New networks of the shapes of `[actor, critic]`, drawn from `rng`.
    pub(super) fn new(
        config: &StudentConfig,
        discount: Discount,
        dims: Dims,
        [actor, critic]: [Shape; 2],
        arithmetic: Arithmetic,
        rng: &mut Rng,
    ) -> Result<Self, TchError> {
        let n = config.batch();
        let actor_networks = Trained::new(actor, 1, arithmetic, rng)?;
        let critic = ValueLearner::new(critic, 1, n, discount, arithmetic, rng)?;
        let online = critic.networks.network(Parameters::Online);
        Ok(Self {
            action_weights: online.input_weights(dims.actor_inputs(), dims.action)?,
            actor: actor_networks,
            critic,
            steps: 0,
            actor_passes: Passes::new(actor, 1, rows_per_part(n, arithmetic), arithmetic)?,
            inputs: TransitionInputs::new(dims, 1, n, arithmetic)?,
            rates: Rates { actor: config.actor_lr, critic: config.critic_lr, action_l2: config.action_l2 },
        })
    }

    /// One Adam step of actor and critic on `batch`, both gradients taken before either step.
    ///
    /// # Errors
    /// [`AgentError::Diverged`] if a loss is not finite.
    pub(super) fn update(&mut self, batch: &Batch, normalizers: &Normalizers) -> Result<(), AgentError> {
        self.begin(batch, normalizers)?;
        let (mut critic_loss, mut actor_loss) = (0.0, 0.0);
        for part in 0..self.inputs.parts.len() {
            critic_loss += self.add_critic_gradient(part)?;
            actor_loss += self.add_actor_gradient(part)?;
        }
        self.critic.networks.step(self.rates.critic)?;
        self.actor.step(self.rates.actor)?;
        self.steps += 1;
        for (what, loss) in [("critic's loss", critic_loss), ("actor's loss", actor_loss)] {
            if !loss.is_finite() {
                return Err(AgentError::Diverged { what, gradient_steps: self.steps });
            }
        }
        Ok(())
    }

    /// What [`Learner::update`] would find on `batch`. The gradients stay in place and no step follows: the
    /// next update forgets them.
    pub(super) fn dry_step(
        &mut self,
        batch: &Batch,
        normalizers: &Normalizers,
    ) -> Result<DryStep, AgentError> {
        self.begin(batch, normalizers)?;
        let mut found = DryStep::default();
        for part in 0..self.inputs.parts.len() {
            found.critic_loss += self.add_critic_gradient(part)?;
            // What the critic said last was of the actions taken.
            found.mean_q += mean_part(&self.critic.passes.output().plain, self.inputs.n)?;
            found.actor_loss += self.add_actor_gradient(part)?;
        }
        found.critic_gradient_norm = self.critic.networks.gradient_norm()?;
        found.actor_gradient_norm = self.actor.gradient_norm()?;
        Ok(found)
    }

    /// Takes in a batch and forgets the gradients of the one before.
    fn begin(&mut self, batch: &Batch, normalizers: &Normalizers) -> Result<(), AgentError> {
        self.inputs.fill(batch, normalizers)?;
        self.actor.zero_gradient()?;
        self.critic.networks.zero_gradient()?;
        Ok(())
    }

    /// Adds ∂(mean (Q(s, g, a) − y)²)/∂θ_Q over `part`, with a' = π'(s', g) in y. Returns these
    /// rows' part of the loss.
    fn add_critic_gradient(&mut self, part: usize) -> Result<f64, TchError> {
        let Self { actor, critic, actor_passes, inputs, .. } = self;
        let part = &inputs.parts[part];
        actor_passes.forward(actor.network(Parameters::Target), &part.next.observed)?;
        copy(&part.next.actions.plain.whole, &actor_passes.output().plain.whole)?;
        critic.add_gradient(part, inputs.n)
    }

    /// Adds ∂(−mean Q(s, g, π(s, g)) + λ·mean π²)/∂θ_π over `part`, by the chain rule through the critic's
    /// action input. Returns these rows' part of the loss.
    fn add_actor_gradient(&mut self, part: usize) -> Result<f64, TchError> {
        let Self { actor, critic, actor_passes, inputs, action_weights, rates, .. } = self;
        let (part, n) = (&inputs.parts[part], inputs.n);
        actor_passes.forward(actor.network(Parameters::Online), &part.current.observed)?;
        // The critic has learned from the actions that lay here; now it judges the policy's.
        copy(&part.current.actions.plain.whole, &actor_passes.output().plain.whole)?;
        let judge = critic.networks.network(Parameters::Online);
        critic.passes.forward(judge, &part.current.all)?;
        let mut loss = value_part(&critic.passes.output().plain, n, &critic.passes.output_gradient().plain)?;
        let slope = actor_passes.output_gradient();
        critic.passes.backward_input(judge, action_weights, slope)?;
        loss += penalty_part(&actor_passes.output().transposed, rates.action_l2, n, &slope.transposed)?;
        let (online, gradient) = actor.for_backward();
        actor_passes.backward_parameters(online, &part.current.observed, gradient)?;
        Ok(loss)
    }

    /// target ← α·target + (1 − α)·online for actor and critic, with the weight `polyak` for α.
    pub(super) fn follow(&mut self, polyak: f64) -> Result<(), TchError> {
        self.actor.follow(polyak)?;
        self.critic.networks.follow(polyak)?;
        Ok(())
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// [`AgentError::Diverged`] if one is not finite.
    pub(super) fn check(&self) -> Result<(), AgentError> {
        for (what, networks) in [("actor", &self.actor), ("critic", &self.critic.networks)] {
            if !networks.is_finite()? {
                return Err(AgentError::Diverged { what, gradient_steps: self.steps });
            }
        }
        Ok(())
    }
}
