//! Networks in training: online parameters, their gradient and optimiser, and the targets that follow.

use envs::rng::Rng;
use multiversion::multiversion;
use serde::{Deserialize, Serialize};
use tch::{TchError, Tensor};

use super::adam::Adam;
use super::block::copy;
use super::shape::Shape;
use super::slices::{read, same_memory, with_slices};
use super::stack::Stack;
use crate::device::in_reach;
use crate::error::AgentError;
use crate::precision::Arithmetic;

/// One of the two copies that every network is kept in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Parameters {
    /// The one that gradient steps change.
    Online,
    /// Its Polyak average.
    Target,
}

/// A stack with everything its training needs.
#[derive(Debug)]
pub(crate) struct Trained {
    online: Stack,
    target: Stack,
    gradient: Stack,
    adam: Adam,
}

/// Everything that [`Trained`] must remember.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SavedStack {
    online: Vec<f32>,
    target: Vec<f32>,
    adam_first: Vec<f32>,
    adam_second: Vec<f32>,
    adam_steps: u64,
}

impl Trained {
    /// Xavier-uniform networks drawn from `rng`, their targets equal to them.
    pub(crate) fn new(
        shape: Shape,
        members: usize,
        arithmetic: Arithmetic,
        rng: &mut Rng,
    ) -> Result<Self, TchError> {
        let networks = Self::zeros(shape, members, arithmetic)?;
        networks.online.copy_from(&Stack::xavier(shape, members, arithmetic, rng)?)?;
        networks.target.copy_from(&networks.online)?;
        Ok(networks)
    }

    /// Networks of zeros that have taken no step.
    pub(crate) fn zeros(shape: Shape, members: usize, arithmetic: Arithmetic) -> Result<Self, TchError> {
        let online = Stack::zeros(shape, members, arithmetic)?;
        let target = Stack::zeros(shape, members, arithmetic)?;
        let gradient = Stack::zeros(shape, members, Arithmetic::single(arithmetic.device))?;
        let adam = Adam::new(&online.flat)?;
        Ok(Self { online, target, gradient, adam })
    }

    /// The member with this index, which shares its memory with this stack. Steps are counted by both.
    pub(crate) fn member(&self, index: usize) -> Result<Self, TchError> {
        Ok(Self {
            online: self.online.member(index)?,
            target: self.target.member(index)?,
            gradient: self.gradient.member(index)?,
            adam: self.adam.member(index)?,
        })
    }

    /// Whether this is [`Trained::member`] `index` of `stack`.
    pub(crate) fn is_member(&self, stack: &Self, index: usize) -> bool {
        let Ok(row) = stack.online.flat.f_narrow(0, index as i64, 1) else { return false };
        same_memory(&row, &self.online.flat)
    }

    /// Overwrites all that is remembered with that of networks of the same shape.
    pub(crate) fn copy_from(&mut self, other: &Self) -> Result<(), TchError> {
        self.online.copy_from(&other.online)?;
        self.target.copy_from(&other.target)?;
        self.adam.copy_from(&other.adam)
    }

    /// Adam's steps so far, per member.
    pub(crate) fn steps(&self) -> &[u64] {
        &self.adam.steps
    }

    /// Counts the steps of `member` as if it had taken so many.
    pub(crate) fn set_steps(&mut self, member: usize, steps: u64) {
        self.adam.steps[member] = steps;
    }

    /// Prepares for `count` steps of size `lr`.
    pub(crate) fn plan(&mut self, lr: f64, count: usize) -> Result<(), TchError> {
        self.adam.plan(&self.online.flat, lr, count)
    }

    /// The networks asked for.
    pub(crate) fn network(&self, which: Parameters) -> &Stack {
        match which {
            Parameters::Online => &self.online,
            Parameters::Target => &self.target,
        }
    }

    /// Forgets the gradient, so that backward passes can add up a new one.
    pub(crate) fn zero_gradient(&mut self) -> Result<(), TchError> {
        let _ = self.gradient.flat.f_zero_()?;
        Ok(())
    }

    /// Online networks and the gradient that a backward pass adds to.
    pub(crate) fn for_backward(&mut self) -> (&Stack, &mut Stack) {
        (&self.online, &mut self.gradient)
    }

    /// Euclidean norm of the gradient, ‖∂L/∂θ‖₂, of all members together.
    pub(crate) fn gradient_norm(&self) -> Result<f64, TchError> {
        let squares = |numbers: &[f32]| numbers.iter().map(|&g| f64::from(g).powi(2)).sum::<f64>();
        Ok(read(&self.gradient.flat, squares)?.sqrt())
    }

    /// One Adam step of size `lr` down the gradient.
    pub(crate) fn step(&mut self, lr: f64) -> Result<(), TchError> {
        self.adam.step(&self.online.flat, &self.gradient.flat, lr)?;
        self.online.round()
    }

    /// target ← α·target + (1 − α)·online with α = `polyak` (TEACH, Eq. 12).
    pub(crate) fn follow(&mut self, polyak: f64) -> Result<(), TchError> {
        follow(&self.target.flat, &self.online.flat, polyak)?;
        self.target.round()
    }

    /// Whether every parameter is finite, member by member. A target that follows finite networks is finite
    /// too.
    pub(crate) fn are_finite(&self) -> Result<Vec<bool>, TchError> {
        self.online.are_finite()
    }

    /// Everything it must remember.
    pub(crate) fn save(&self) -> Result<SavedStack, TchError> {
        let numbers = |tensor: &Tensor| Vec::try_from(tensor.f_view(-1)?);
        Ok(SavedStack {
            online: self.online.numbers()?,
            target: self.target.numbers()?,
            adam_first: numbers(&self.adam.first)?,
            adam_second: numbers(&self.adam.second)?,
            // All members of what is saved have taken the same.
            adam_steps: self.adam.steps[0],
        })
    }

    /// Takes back what [`Trained::save`] gave.
    pub(crate) fn load(&mut self, saved: &SavedStack) -> Result<(), AgentError> {
        for (tensor, numbers) in [
            (&self.online.flat, &saved.online),
            (&self.target.flat, &saved.target),
            (&self.adam.first, &saved.adam_first),
            (&self.adam.second, &saved.adam_second),
        ] {
            if numbers.len() != tensor.numel() {
                let (got, expected) = (numbers.len(), tensor.numel());
                let reason = format!("networks of {got} parameters where {expected} are expected");
                return Err(AgentError::misfit(reason));
            }
            copy(tensor, &Tensor::f_from_slice(numbers)?.f_view_as(tensor)?)?;
        }
        self.adam.steps.fill(saved.adam_steps);
        self.online.round()?;
        self.target.round()?;
        Ok(())
    }
}

/// See [`Trained::follow`].
fn follow(target: &Tensor, online: &Tensor, polyak: f64) -> Result<(), TchError> {
    if in_reach(target.device()) {
        let (keep, take) = (polyak as f32, (1.0 - polyak) as f32);
        with_slices([target], [online], |[target], [online]| follow_all(target, online, keep, take));
        return Ok(());
    }
    follow_elsewhere(target, online, polyak)
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn follow_all(target: &mut [f32], online: &[f32], keep: f32, take: f32) {
    for (target, online) in target.iter_mut().zip(online) {
        *target = keep * *target + take * online;
    }
}

/// The same with libtorch's kernels, for devices whose memory is out of reach.
fn follow_elsewhere(target: &Tensor, online: &Tensor, polyak: f64) -> Result<(), TchError> {
    let _ = target.f_mul_scalar_out(target, polyak)?;
    let _ = target.f_add_out(target, &online.f_mul_scalar(1.0 - polyak)?)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use tch::Tensor;

    use super::{follow, follow_elsewhere};

    #[test]
    fn polyak_average_by_hand() {
        // 0.95*2 + 0.05*4 = 2.1
        for average in [follow, follow_elsewhere] {
            let target = Tensor::from_slice(&[2.0f32, 1.0]);
            average(&target, &Tensor::from_slice(&[4.0f32, 1.0]), 0.95).unwrap();
            assert!((target.double_value(&[0]) - 2.1).abs() < 1e-6);
            assert!((target.double_value(&[1]) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn extremes_copy_and_freeze() {
        let target = Tensor::from_slice(&[2.0f32]);
        follow(&target, &Tensor::from_slice(&[4.0f32]), 1.0).unwrap();
        assert_eq!(target.double_value(&[0]), 2.0);
        follow(&target, &Tensor::from_slice(&[4.0f32]), 0.0).unwrap();
        assert_eq!(target.double_value(&[0]), 4.0);
    }
}
