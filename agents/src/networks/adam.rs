//! The Adam optimiser on flat parameters.

use multiversion::multiversion;
use tch::{Kind, TchError, Tensor};

use super::slices::with_slices;
use crate::device::in_reach;

/// Decay of the mean gradient (Adam's default, as in Baselines).
const BETA1: f64 = 0.9;
/// Decay of the mean squared gradient.
const BETA2: f64 = 0.999;
/// Keeps the division finite.
const EPSILON: f64 = 1e-8;

/// Adam's memory: one mean and one mean square per parameter, and the number of steps taken.
#[derive(Debug)]
pub(super) struct Adam {
    pub(super) steps: u64,
    pub(super) first: Tensor,
    pub(super) second: Tensor,
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
    /// For a flat parameter tensor like `parameters`.
    pub(super) fn new(parameters: &Tensor) -> Result<Self, TchError> {
        let zeros = || Tensor::f_zeros(parameters.size(), (Kind::Float, parameters.device()));
        Ok(Self { steps: 0, first: zeros()?, second: zeros()? })
    }

    /// One step of size `lr` down `gradient` (Kingma and Ba 2015, algorithm 1).
    pub(super) fn step(&mut self, parameters: &Tensor, gradient: &Tensor, lr: f64) -> Result<(), TchError> {
        self.steps += 1;
        let rates = Rates::new(lr, self.steps);
        if in_reach(parameters.device()) {
            with_slices([parameters, &self.first, &self.second], [gradient], |[p, m, v], [g]| {
                adam_all(p, m, v, g, rates);
            });
            return Ok(());
        }
        self.step_elsewhere(parameters, gradient, rates)
    }

    /// The same step with libtorch's kernels, for devices whose memory is out of reach.
    fn step_elsewhere(
        &mut self,
        parameters: &Tensor,
        gradient: &Tensor,
        rates: Rates,
    ) -> Result<(), TchError> {
        let _ = self.first.f_lerp_(gradient, 1.0 - BETA1)?;
        let _ = self.second.f_lerp_(&gradient.f_square()?, 1.0 - BETA2)?;
        let size = (self.second.f_sqrt()? * f64::from(rates.root)).f_add_scalar(EPSILON)?;
        let step = self.first.f_div(&size)?.f_mul_scalar(-f64::from(rates.step))?;
        let _ = parameters.f_add_out(parameters, &step)?;
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
        let start = [0.5f32, -1.0, 2.0];
        let [looped, elsewhere] = [Tensor::from_slice(&start), Tensor::from_slice(&start)];
        let [mut a, mut b] = [&looped, &elsewhere].map(|parameters| Adam::new(parameters).unwrap());
        for gradient in [[1.0f32, -0.5, 0.0], [0.2, 3.0, -1e-3]] {
            let gradient = Tensor::from_slice(&gradient);
            a.step(&looped, &gradient, 0.1).unwrap();
            b.step_elsewhere(&elsewhere, &gradient, Rates::new(0.1, a.steps)).unwrap();
        }
        assert!((looped - elsewhere).abs().max().double_value(&[]) < 1e-6);
    }

    #[test]
    fn first_step_is_one_step_size_against_the_gradient() {
        let parameters = Tensor::from_slice(&[1.0f32, 1.0, 1.0]);
        let mut optimiser = Adam::new(&parameters).unwrap();
        optimiser.step(&parameters, &Tensor::from_slice(&[5.0f32, -0.01, 0.0]), 0.1).unwrap();
        let moved = Vec::<f32>::try_from(&parameters).unwrap();
        assert!((moved[0] - 0.9).abs() < 1e-5 && (moved[1] - 1.1).abs() < 1e-5, "{moved:?}");
        assert_eq!(moved[2], 1.0);
    }
}
