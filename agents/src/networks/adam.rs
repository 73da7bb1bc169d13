//! The Adam optimiser on flat parameters.

use multiversion::multiversion;
use tch::{Kind, TchError, Tensor};

use super::block::copy;
use super::slices::with_slices;
use crate::device::in_reach;

/// Decay of the mean gradient (Adam's default, as in Baselines).
const BETA1: f64 = 0.9;
/// Decay of the mean squared gradient.
const BETA2: f64 = 0.999;
/// Keeps the division finite.
const EPSILON: f64 = 1e-8;

/// Adam's memory: one mean and one mean square per parameter, and the number of steps that each member has
/// taken.
#[derive(Debug)]
pub(super) struct Adam {
    pub(super) steps: Vec<u64>,
    pub(super) first: Tensor,
    pub(super) second: Tensor,
    /// [`Rates`] of coming steps, `[E, 1]` each, the last one first. Only devices whose memory is out of
    /// reach have any.
    planned: Vec<[Tensor; 2]>,
}

/// The step's constants: everything in Adam's rule that is the same for all parameters.
#[derive(Clone, Copy, Debug)]
struct Rates {
    /// lr / (1 − β₁ᵗ).
    step: f32,
    /// 1 / √(1 − β₂ᵗ).
    root: f32,
}

impl Rates {
    /// Of step `t`, from 1.
    fn new(lr: f64, t: u64) -> Self {
        let decay = |beta: f64| 1.0 - beta.powf(t as f64);
        Self { step: (lr / decay(BETA1)) as f32, root: (1.0 / decay(BETA2).sqrt()) as f32 }
    }
}

impl Adam {
    /// For a flat parameter tensor like `parameters`, `[E, P]`.
    pub(super) fn new(parameters: &Tensor) -> Result<Self, TchError> {
        let zeros = || Tensor::f_zeros(parameters.size(), (Kind::Float, parameters.device()));
        let steps = vec![0; parameters.size()[0] as usize];
        Ok(Self { steps, first: zeros()?, second: zeros()?, planned: Vec::new() })
    }

    /// The memory of one member, shared with this one; steps are counted by both.
    pub(super) fn member(&self, index: usize) -> Result<Self, TchError> {
        let row = |memory: &Tensor| memory.f_narrow(0, index as i64, 1);
        let (first, second) = (row(&self.first)?, row(&self.second)?);
        Ok(Self { steps: vec![self.steps[index]], first, second, planned: Vec::new() })
    }

    /// Overwrites all of it with that of parameters of the same size.
    pub(super) fn copy_from(&mut self, other: &Self) -> Result<(), TchError> {
        self.steps.clone_from(&other.steps);
        copy(&self.first, &other.first)?;
        copy(&self.second, &other.second)
    }

    /// Sends what `count` steps of size `lr` need to the device of `parameters`, so that none of them waits
    /// for numbers from the host.
    pub(super) fn plan(&mut self, parameters: &Tensor, lr: f64, count: usize) -> Result<(), TchError> {
        self.planned.clear();
        if in_reach(parameters.device()) {
            return Ok(());
        }
        let coming = |ahead: usize| self.steps.iter().map(move |t| Rates::new(lr, t + 1 + ahead as u64));
        let rates: Vec<Rates> = (0..count).flat_map(coming).collect();
        let send = |of: fn(&Rates) -> f32| {
            let numbers: Vec<f32> = rates.iter().map(of).collect();
            let size = [count as i64, self.steps.len() as i64, 1];
            Tensor::f_from_slice(&numbers)?.f_view(size)?.f_to_device(parameters.device())
        };
        let (steps, roots) = (send(|rates| rates.step)?, send(|rates| rates.root)?);
        let row = |step: usize| Ok([steps.f_select(0, step as i64)?, roots.f_select(0, step as i64)?]);
        self.planned = (0..count).rev().map(row).collect::<Result<_, TchError>>()?;
        Ok(())
    }

    /// One step of size `lr` down `gradient` (Kingma and Ba 2015, algorithm 1).
    pub(super) fn step(&mut self, parameters: &Tensor, gradient: &Tensor, lr: f64) -> Result<(), TchError> {
        if !in_reach(parameters.device()) {
            return self.step_elsewhere(parameters, gradient, lr);
        }
        self.steps.iter_mut().for_each(|steps| *steps += 1);
        let rates = self.steps.iter().map(|&t| Rates::new(lr, t));
        with_slices([parameters, &self.first, &self.second], [gradient], |[p, m, v], [g]| {
            let member = g.len() / self.steps.len();
            let written = p.chunks_exact_mut(member).zip(m.chunks_exact_mut(member));
            let members = written.zip(v.chunks_exact_mut(member)).zip(g.chunks_exact(member));
            for ((((p, m), v), g), rates) in members.zip(rates) {
                adam_all(p, m, v, g, rates);
            }
        });
        Ok(())
    }

    /// The same step with libtorch's kernels, for devices whose memory is out of reach.
    fn step_elsewhere(&mut self, parameters: &Tensor, gradient: &Tensor, lr: f64) -> Result<(), TchError> {
        if self.planned.is_empty() {
            self.plan(parameters, lr, 1)?;
        }
        self.steps.iter_mut().for_each(|steps| *steps += 1);
        let [step, root] = self.planned.pop().expect("just planned");
        let _ = self.first.f_lerp_(gradient, 1.0 - BETA1)?;
        let _ = self.second.f_lerp_(&gradient.f_square()?, 1.0 - BETA2)?;
        let size = self.second.f_sqrt()?.f_mul(&root)?.f_add_scalar(EPSILON)?;
        let way = self.first.f_div(&size)?.f_mul(&step)?;
        let _ = parameters.f_sub_out(parameters, &way)?;
        Ok(())
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn adam_all(p: &mut [f32], m: &mut [f32], v: &mut [f32], g: &[f32], rates: Rates) {
    for (((p, m), v), g) in p.iter_mut().zip(m).zip(v).zip(g) {
        adam(p, m, v, *g, rates);
    }
}

/// Adam's rule for one parameter: m ← β₁m + (1 − β₁)g, v ← β₂v + (1 − β₂)g²,
/// p ← p − lr·m̂/(√v̂ + ε) with m̂ = m/(1 − β₁ᵗ), v̂ = v/(1 − β₂ᵗ) (Kingma and Ba 2015, algorithm 1).
#[inline(always)]
fn adam(p: &mut f32, m: &mut f32, v: &mut f32, g: f32, rates: Rates) {
    *m += (1.0 - BETA1) as f32 * (g - *m);
    *v += (1.0 - BETA2) as f32 * (g * g - *v);
    *p -= rates.step * *m / (v.sqrt() * rates.root + EPSILON as f32);
}

#[cfg(test)]
mod tests {
    use tch::Tensor;

    use super::{Adam, Rates, adam};
    use crate::device::far_away;

    #[test]
    fn second_step_by_hand() {
        // t = 2 from m = 0.1, v = 0.004 with g = 3: m = 0.09 + 0.3 = 0.39, v = 0.003996 + 0.009 = 0.012996,
        // m^ = 0.39/0.19, v^ = 0.012996/0.001999, step = lr * m^/sqrt(v^) = 0.01 * 2.0526316/2.5497548.
        let (mut p, mut m, mut v) = (1.0, 0.1, 0.004);
        adam(&mut p, &mut m, &mut v, 3.0, Rates::new(0.01, 2));
        assert!((m - 0.39).abs() < 1e-6 && (v - 0.012996).abs() < 1e-7, "{m} {v}");
        assert!((p - (1.0 - 0.0080503)).abs() < 1e-6, "{p}");
    }

    #[test]
    fn other_devices_take_the_same_steps() {
        let parameters = || Tensor::from_slice(&[0.5f32, -1.0, 2.0, 1.0, 1.0, -1.0]).view([2, 3]);
        let [looped, elsewhere] = [parameters(), parameters()];
        let [mut a, mut b] = [&looped, &elsewhere].map(|parameters| Adam::new(parameters).unwrap());
        // Members that have come from different places.
        [&mut a, &mut b].into_iter().for_each(|adam| adam.steps[1] = 7);
        far_away(|| b.plan(&elsewhere, 0.1, 2)).unwrap();
        let gradients = [[1.0f32, -0.5, 0.0, 0.3, 0.2, 0.1], [0.2, 3.0, -1e-3, 1.0, -1.0, 0.0]];
        // The third step is one more than was planned.
        for gradient in [gradients[0], gradients[1], gradients[0]] {
            let gradient = Tensor::from_slice(&gradient).view([2, 3]);
            a.step(&looped, &gradient, 0.1).unwrap();
            far_away(|| b.step(&elsewhere, &gradient, 0.1)).unwrap();
        }
        assert_eq!((&a.steps, &b.steps), (&vec![3, 10], &vec![3, 10]));
        assert!((looped - elsewhere).abs().max().double_value(&[]) < 1e-6);
    }

    #[test]
    fn a_member_shares_the_memory_of_its_stack_and_steps_as_it_does() {
        let parameters = || Tensor::from_slice(&[0.5f32, -1.0, 2.0, 1.0]).view([2, 2]);
        let gradient = Tensor::from_slice(&[1.0f32, 2.0, 3.0, 4.0]).view([2, 2]);
        let (whole, apart) = (parameters(), parameters());
        let [mut stack, other] = [&whole, &apart].map(|parameters| Adam::new(parameters).unwrap());
        stack.step(&whole, &gradient, 0.1).unwrap();
        for index in 0..2 {
            let row = |tensor: &Tensor| tensor.narrow(0, index, 1);
            let mut member = other.member(index as usize).unwrap();
            member.step(&row(&apart), &row(&gradient), 0.1).unwrap();
        }
        assert_eq!(whole, apart);
        assert_eq!((&stack.first, &stack.second), (&other.first, &other.second));
    }

    #[test]
    fn first_step_is_one_step_size_against_the_gradient() {
        let parameters = Tensor::from_slice(&[1.0f32, 1.0, 1.0]).view([1, 3]);
        let mut optimiser = Adam::new(&parameters).unwrap();
        let gradient = Tensor::from_slice(&[5.0f32, -0.01, 0.0]).view([1, 3]);
        optimiser.step(&parameters, &gradient, 0.1).unwrap();
        let moved = Vec::<f32>::try_from(parameters.view(-1)).unwrap();
        assert!((moved[0] - 0.9).abs() < 1e-5 && (moved[1] - 1.1).abs() < 1e-5, "{moved:?}");
        assert_eq!(moved[2], 1.0);
    }
}
