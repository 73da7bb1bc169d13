//! The matrix products of a gradient step and nothing else: the floor under its cost.

use std::time::Instant;

use envs::Spec;
use tch::{Cuda, Device, Tensor};

use crate::batch::Dims;
use crate::config::StudentConfig;
use crate::error::AgentError;
use crate::precision::{Arithmetic, Precision};

/// The products of a DDPG update on preallocated memory, 28 with two hidden layers, 38 with three.
///
/// No implementation of the update can do without them, so a gradient step's time is best given as a multiple
/// of theirs, measured on the same machine at the same time. Each product is computed the way the update
/// computes it, thin ones by columns and wide ones in the student's precision, with one difference: it covers
/// the whole batch at once, where the update on a CPU goes through the batch in parts.
#[derive(Debug)]
pub struct Products {
    arithmetic: Arithmetic,
    batch: usize,
    products: Vec<[Tensor; 3]>,
    memory: Vec<(Role, Tensor)>,
}

/// What a matrix is in its product (left, right or result: 0 to 2), its size and precision.
type Role = (usize, [usize; 2], Precision);

impl Products {
    /// The products of one gradient step of the student that `config` describes, for the task `spec`.
    ///
    /// # Errors
    /// [`AgentError::Config`], [`AgentError::Device`].
    pub fn new(config: &StudentConfig, spec: &Spec) -> Result<Self, AgentError> {
        let config = config.clone().resolve(spec)?;
        let arithmetic = Arithmetic::of(&config)?;
        let dims = Dims::of(spec);
        let widths = |inputs, outputs| -> Vec<usize> {
            let hidden = std::iter::repeat_n(config.width, config.layers(spec));
            std::iter::once(inputs).chain(hidden).chain([outputs]).collect()
        };
        let actor = widths(dims.actor_inputs(), dims.action);
        let critic = widths(dims.critic_inputs(), 1);
        let mut step = Self { arithmetic, batch: config.batch(), products: Vec::new(), memory: Vec::new() };
        // Target actor, target critic, critic, actor, critic of the policy's action.
        for network in [&actor, &critic, &critic, &actor, &critic] {
            step.forward(network)?;
        }
        step.backward(&critic, true)?;
        step.backward(&actor, true)?;
        step.backward(&critic, false)?;
        // Into the action's columns of the critic's input.
        step.push(Precision::F32, [dims.action, config.width, step.batch], false, true)?;
        Ok(step)
    }

    fn forward(&mut self, widths: &[usize]) -> Result<(), AgentError> {
        let last = widths.len() - 2;
        for (layer, pair) in widths.windows(2).enumerate() {
            if layer < last {
                self.push(self.arithmetic.precision, [self.batch, pair[0], pair[1]], false, false)?;
            } else {
                self.push(Precision::F32, [pair[1], pair[0], self.batch], false, true)?;
            }
        }
        Ok(())
    }

    fn backward(&mut self, widths: &[usize], weights: bool) -> Result<(), AgentError> {
        let last = widths.len() - 2;
        for (layer, pair) in widths.windows(2).enumerate().rev() {
            let by_columns = layer == last;
            let precision = if by_columns { Precision::F32 } else { self.arithmetic.precision };
            if weights && by_columns {
                self.push(precision, [pair[1], self.batch, pair[0]], false, false)?;
            } else if weights {
                self.push(precision, [pair[0], self.batch, pair[1]], true, false)?;
            }
            if layer > 0 {
                self.push(precision, [self.batch, pair[1], pair[0]], by_columns, !by_columns)?;
            }
        }
        Ok(())
    }

    /// left `[rows, inner]` · right `[inner, columns]`; a transposed factor is stored the other way round.
    fn push(
        &mut self,
        precision: Precision,
        [rows, inner, columns]: [usize; 3],
        left_transposed: bool,
        right_transposed: bool,
    ) -> Result<(), AgentError> {
        let left = self.matrix((0, [rows, inner], precision), left_transposed)?;
        let right = self.matrix((1, [inner, columns], precision), right_transposed)?;
        let out = self.matrix((2, [rows, columns], precision), false)?;
        self.products.push([out, left, right]);
        Ok(())
    }

    /// The matrix of this role. All products share it, as the buffers of an update are reused.
    fn matrix(&mut self, role: Role, transposed: bool) -> Result<Tensor, AgentError> {
        let (part, [rows, columns], precision) = role;
        let size = if transposed { [columns, rows] } else { [rows, columns] };
        let role = (part, size, precision);
        let stored = match self.memory.iter().find(|(known, _)| *known == role) {
            Some((_, tensor)) => tensor.shallow_clone(),
            None => {
                let options = Arithmetic { precision, ..self.arithmetic }.options();
                let fresh = Tensor::f_full(size.map(|n| n as i64), 0.5, options)?;
                self.memory.push((role, fresh.shallow_clone()));
                fresh
            }
        };
        Ok(if transposed { stored.f_tr()? } else { stored })
    }

    /// The number of products.
    pub fn count(&self) -> usize {
        self.products.len()
    }

    /// Multiply-add pairs in all of them, two operations each, in units of 10⁹ operations.
    pub fn gflop(&self) -> f64 {
        let operations = |[out, left, _]: &[Tensor; 3]| 2 * out.numel() as i64 * left.size()[1];
        self.products.iter().map(operations).sum::<i64>() as f64 / 1e9
    }

    /// Computes all products, and waits until a GPU has finished them.
    ///
    /// # Errors
    /// [`AgentError::Torch`] if libtorch refuses.
    pub fn run(&self) -> Result<(), AgentError> {
        for [out, left, right] in &self.products {
            let _ = left.f_mm_out(out, right)?;
        }
        if let Device::Cuda(index) = self.arithmetic.device {
            Cuda::synchronize(index as i64);
        }
        Ok(())
    }
}

/// How fast this machine computes the products of a gradient step in every [`Precision`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProductRates {
    /// 10⁹ operations per second, in the order of [`Precision::ALL`].
    pub gflop_per_second: [f64; 2],
}

impl ProductRates {
    /// Runs the products of a gradient step some times in each precision, in turns; what other processes take
    /// from the machine slows the best of them least.
    ///
    /// # Errors
    /// As [`Products::new`] and [`Products::run`].
    pub fn measure(config: &StudentConfig, spec: &Spec) -> Result<Self, AgentError> {
        const ROUNDS: usize = 5;
        let products = |precision| Products::new(&StudentConfig { precision, ..config.clone() }, spec);
        let both = [products(Precision::ALL[0])?, products(Precision::ALL[1])?];
        let mut best = [f64::INFINITY; 2];
        // The first round sets up memory and is not counted.
        for round in 0..=ROUNDS {
            for (products, best) in both.iter().zip(&mut best) {
                let begun = Instant::now();
                products.run()?;
                if round > 0 {
                    *best = best.min(begun.elapsed().as_secs_f64());
                }
            }
        }
        Ok(Self { gflop_per_second: best.map(|seconds| both[0].gflop() / seconds) })
    }

    /// How many times as fast `precision` is as singles.
    pub fn gain(&self, precision: Precision) -> f64 {
        let [single, rounded] = self.gflop_per_second;
        match precision {
            Precision::F32 => 1.0,
            Precision::Bf16 => rounded / single,
        }
    }
}

#[cfg(test)]
mod tests {
    use envs::rng::{Purpose, stream};
    use envs::{EnvOptions, Rows};

    use super::{Precision, Products};
    use crate::auto::Auto;
    use crate::config::StudentConfig;
    use crate::episode::Episode;
    use crate::networks::done;

    /// With a batch small enough to be one part.
    #[test]
    fn they_are_those_that_a_gradient_step_does() {
        crate::prepare_thread();
        let env = envs::make("Point", &EnvOptions::default()).unwrap();
        let (spec, mut rng) = (env.spec(), stream(0, Purpose::Replay));
        let rows = |width: usize, count: usize| {
            let mut rows = Rows::new(width);
            (0..count).for_each(|_| rows.push(&vec![0.5; width]));
            rows
        };
        for (layers, precision) in (1..=4).flat_map(|layers| Precision::ALL.map(|p| (layers, p))) {
            let config = StudentConfig {
                layers: Auto::Value(layers),
                precision,
                width: 32,
                batch: Auto::Value(256),
                updates_per_cycle: 1,
                ..StudentConfig::default()
            };
            let mut student = crate::make(&config, spec, 0).unwrap();
            let episode = Episode {
                states: rows(spec.state, spec.horizon + 1),
                achieved: rows(spec.goal, spec.horizon + 1),
                actions: rows(spec.action, spec.horizon),
                goal: vec![0.0; spec.goal],
                total_reward: 0.0,
                success: false,
            };
            student.observe(&episode, env.as_ref(), &mut rng).unwrap();
            done::take();
            student.learn(env.as_ref(), &mut rng).unwrap();
            let products = Products::new(&config, spec).unwrap();
            let mut listed: Vec<_> =
                products.products.iter().map(|[_, left, right]| done::product(left, right)).collect();
            listed.sort_unstable();
            assert_eq!(listed, done::take(), "{layers} layers, {precision:?}");
        }
    }

    #[test]
    fn the_gain_is_a_quotient_of_rates() {
        let rates = super::ProductRates { gflop_per_second: [100.0, 250.0] };
        assert_eq!(Precision::ALL.map(|precision| rates.gain(precision)), [1.0, 2.5]);
    }

    /// Per row of the batch and hidden width w: the forward passes and backward passes of an actor 28 → w → w
    /// → 4 and a critic 32 → w → w → 1, a product being 2·rows·inner·columns operations.
    #[test]
    fn a_step_of_two_layers_is_28_products_and_of_three_38() {
        let spec = &envs::find("FetchPush").unwrap().spec;
        let products = |layers| {
            let config = StudentConfig { layers: Auto::Value(layers), ..StudentConfig::default() };
            Products::new(&config, spec).unwrap()
        };
        let (two, three) = (products(2), products(3));
        assert_eq!((two.count(), three.count()), (28, 38));
        let (actor, critic) = (28 * 256 + 256 * 256 + 256 * 4, 32 * 256 + 256 * 256 + 256);
        let (actor_back, critic_back) = (256 * 256 + 256 * 4, 256 * 256 + 256);
        let forward = 2 * actor + 3 * critic;
        let backward = (actor + actor_back) + (critic + critic_back) + critic_back + 256 * 4;
        let expected = 2.0 * 1024.0 * f64::from(forward + backward) / 1e9;
        assert!((two.gflop() - expected).abs() < 1e-9, "{} against {expected}", two.gflop());
        two.run().unwrap();
    }
}
