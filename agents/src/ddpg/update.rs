//! One gradient step of DDPG.

use envs::rng::Rng;
use tch::TchError;

use crate::batch::{Batch, Dims};
use crate::config::StudentConfig;
use crate::diagnosis::DryStep;
use crate::error::AgentError;
use crate::inputs::{Normalizers, TransitionInputs, rows_per_part};
use crate::losses::{Discount, Loss, mean_part, penalty_part, value_part};
use crate::networks::{Block, Parameters, Passes, Shape, Trained, copy};
use crate::precision::Arithmetic;
use crate::value::ValueLearner;

/// What students have learned: actor and critic of each, in stacks of as many members as there are students.
#[derive(Debug)]
pub(super) struct Networks {
    pub(super) actor: Trained,
    pub(super) critic: Trained,
    /// The online critic's first-layer weights of the action, `[E, A, width]`.
    action_weights: Block,
}

impl Networks {
    /// Those of one student, drawn from `rng`.
    pub(super) fn new(
        dims: Dims,
        [actor, critic]: [Shape; 2],
        arithmetic: Arithmetic,
        rng: &mut Rng,
    ) -> Result<Self, TchError> {
        let actor = Trained::new(actor, 1, arithmetic, rng)?;
        Self::of(actor, Trained::new(critic, 1, arithmetic, rng)?, dims)
    }

    /// Room for those of `members` students: all zeros.
    pub(super) fn zeros(
        dims: Dims,
        shapes: [Shape; 2],
        members: usize,
        arithmetic: Arithmetic,
    ) -> Result<Self, TchError> {
        let [actor, critic] = shapes.map(|shape| Trained::zeros(shape, members, arithmetic));
        Self::of(actor?, critic?, dims)
    }

    fn of(actor: Trained, critic: Trained, dims: Dims) -> Result<Self, TchError> {
        let online = critic.network(Parameters::Online);
        let action_weights = online.input_weights(dims.actor_inputs(), dims.action)?;
        Ok(Self { actor, critic, action_weights })
    }

    /// The networks of student `index`, which share their memory with these. Steps are counted by both.
    pub(super) fn member(&self, index: usize, dims: Dims) -> Result<Self, TchError> {
        Self::of(self.actor.member(index)?, self.critic.member(index)?, dims)
    }

    /// Both, for what is done to each alike.
    pub(super) fn both(&mut self) -> [&mut Trained; 2] {
        [&mut self.actor, &mut self.critic]
    }

    /// Gradient steps that student `index` has taken.
    pub(super) fn steps(&self, index: usize) -> u64 {
        self.actor.steps()[index]
    }

    /// target ← α·target + (1 − α)·online for actors and critics, with the weight `polyak` for α.
    pub(super) fn follow(&mut self, polyak: f64) -> Result<(), TchError> {
        self.both().into_iter().try_for_each(|networks| networks.follow(polyak))
    }
}

/// All that a gradient step needs besides the networks: buffers, and the losses' constants.
#[derive(Debug)]
pub(super) struct Learner {
    critic: ValueLearner,
    actor_passes: Passes,
    pub(super) inputs: TransitionInputs,
    rates: Rates,
}

#[derive(Clone, Copy, Debug)]
struct Rates {
    actor: f64,
    critic: f64,
    action_l2: f64,
}

impl Learner {
    /// For `members` students with networks of the shapes of `[actor, critic]`.
    pub(super) fn new(
        config: &StudentConfig,
        discount: Discount,
        dims: Dims,
        [actor, critic]: [Shape; 2],
        members: usize,
        arithmetic: Arithmetic,
    ) -> Result<Self, TchError> {
        let n = config.batch();
        Ok(Self {
            critic: ValueLearner::new(critic, members, n, discount, arithmetic)?,
            actor_passes: Passes::new(actor, members, rows_per_part(n, arithmetic), arithmetic)?,
            inputs: TransitionInputs::new(dims, members, n, arithmetic)?,
            rates: Rates { actor: config.actor_lr, critic: config.critic_lr, action_l2: config.action_l2 },
        })
    }

    /// Prepares `networks` for `count` updates.
    pub(super) fn plan(&self, networks: &mut Networks, count: usize) -> Result<(), TchError> {
        networks.actor.plan(self.rates.actor, count)?;
        networks.critic.plan(self.rates.critic, count)
    }

    /// One Adam step of actors and critics on the transitions in [`Learner::inputs`], both gradients taken
    /// before either step. Returns the losses of critics and actors before the step.
    pub(super) fn update(&mut self, networks: &mut Networks) -> Result<[Loss; 2], TchError> {
        forget(networks)?;
        let mut losses: Option<[Loss; 2]> = None;
        for part in 0..self.inputs.parts.len() {
            let critic = self.add_critic_gradient(networks, part)?;
            let actor = self.add_actor_gradient(networks, part)?;
            losses = Some(match losses {
                None => [critic, actor],
                Some([critics, actors]) => [critics.plus(critic)?, actors.plus(actor)?],
            });
        }
        networks.critic.step(self.rates.critic)?;
        networks.actor.step(self.rates.actor)?;
        Ok(losses.expect("a batch has at least one part"))
    }

    /// What [`Learner::update`] would find on `batch`, for one student. The gradients stay in place and no
    /// step follows: the next update forgets them.
    pub(super) fn dry_step(
        &mut self,
        networks: &mut Networks,
        batch: &Batch,
        normalizers: &Normalizers,
    ) -> Result<DryStep, AgentError> {
        self.inputs.fill(batch, normalizers)?;
        forget(networks)?;
        let mut found = DryStep::default();
        for part in 0..self.inputs.parts.len() {
            found.critic_loss += self.add_critic_gradient(networks, part)?.total()?;
            // What the critic said last was of the actions taken.
            found.mean_q += mean_part(&self.critic.passes.output().plain, self.inputs.n)?.total()?;
            found.actor_loss += self.add_actor_gradient(networks, part)?.total()?;
        }
        found.critic_gradient_norm = networks.critic.gradient_norm()?;
        found.actor_gradient_norm = networks.actor.gradient_norm()?;
        Ok(found)
    }

    /// Adds ∂(mean (Q(s, g, a) − y)²)/∂θ_Q over `part`, with a' = π'(s', g) in y. Returns these
    /// rows' part of the losses.
    fn add_critic_gradient(&mut self, networks: &mut Networks, part: usize) -> Result<Loss, TchError> {
        let Self { critic, actor_passes, inputs, .. } = self;
        let part = &inputs.parts[part];
        actor_passes.forward(networks.actor.network(Parameters::Target), &part.next.observed)?;
        copy(&part.next.actions.plain.whole, &actor_passes.output().plain.whole)?;
        critic.add_gradient(&mut networks.critic, part, inputs.n)
    }

    /// Adds ∂(−mean Q(s, g, π(s, g)) + λ·mean π²)/∂θ_π over `part`, by the chain rule through the critic's
    /// action input. Returns these rows' part of the losses.
    fn add_actor_gradient(&mut self, networks: &mut Networks, part: usize) -> Result<Loss, TchError> {
        let Self { critic, actor_passes, inputs, rates, .. } = self;
        let (part, n) = (&inputs.parts[part], inputs.n);
        actor_passes.forward(networks.actor.network(Parameters::Online), &part.current.observed)?;
        // The critic has learned from the actions that lay here; now it judges the policy's.
        copy(&part.current.actions.plain.whole, &actor_passes.output().plain.whole)?;
        let judge = networks.critic.network(Parameters::Online);
        critic.passes.forward(judge, &part.current.all)?;
        let value = value_part(&critic.passes.output().plain, n, &critic.passes.output_gradient().plain)?;
        let slope = actor_passes.output_gradient();
        critic.passes.backward_input(judge, &networks.action_weights, slope)?;
        let actions = &actor_passes.output().transposed;
        let penalty = penalty_part(actions, rates.action_l2, n, &slope.transposed)?;
        let (online, gradient) = networks.actor.for_backward();
        actor_passes.backward_parameters(online, &part.current.observed, gradient)?;
        value.plus(penalty)
    }
}

/// Forgets the gradients of the batch before.
fn forget(networks: &mut Networks) -> Result<(), TchError> {
    networks.both().into_iter().try_for_each(Trained::zero_gradient)
}
