//! Learning of action values: temporal-difference steps for a stack of critics.

use tch::TchError;

use crate::inputs::{Part, rows_per_part};
use crate::losses::{Discount, Loss, critic_part, write_targets};
use crate::networks::{Block, Parameters, Passes, Shape, Trained};
use crate::precision::Arithmetic;

/// What E critics, each with a target network, need to learn, besides themselves.
#[derive(Debug)]
pub(crate) struct ValueLearner {
    pub(crate) passes: Passes,
    /// y, `[E, rows of a part, 1]`.
    targets: Block,
    discount: Discount,
}

impl ValueLearner {
    /// For critics of `shape` that learn from `n` transitions each per step.
    pub(crate) fn new(
        shape: Shape,
        members: usize,
        n: usize,
        discount: Discount,
        arithmetic: Arithmetic,
    ) -> Result<Self, TchError> {
        let rows = rows_per_part(n, arithmetic);
        Ok(Self {
            passes: Passes::new(shape, members, rows, arithmetic)?,
            targets: Block::zeros(members, rows, 1, Arithmetic::single(arithmetic.device))?,
            discount,
        })
    }

    /// Adds the gradient of the loss of every critic of `networks` on `part` of n transitions, whose next
    /// actions are in place. Returns the part's share of the losses.
    pub(crate) fn add_gradient(
        &mut self,
        networks: &mut Trained,
        part: &Part,
        n: usize,
    ) -> Result<Loss, TchError> {
        let Self { passes, targets, discount } = self;
        passes.forward(networks.network(Parameters::Target), &part.next.all)?;
        write_targets(&part.rewards.plain, &passes.output().plain, *discount, &targets.plain)?;
        passes.forward(networks.network(Parameters::Online), &part.current.all)?;
        let slope = &passes.output_gradient().plain;
        let loss = critic_part(&passes.output().plain, &targets.plain, n, slope)?;
        let (online, gradient) = networks.for_backward();
        passes.backward_parameters(online, &part.current.all, gradient)?;
        Ok(loss)
    }
}
