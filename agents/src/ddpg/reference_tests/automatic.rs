//! The same networks, losses and steps by automatic differentiation, in double precision.

use tch::{Kind, Tensor};

use super::{ACTION_L2, DISCOUNT, SPEC, shapes};
use crate::batch::Batch;
use crate::ddpg::update::Networks;
use crate::inputs::Normalizers;
use crate::networks::{Output, Parameters, Shape, Stack, Trained};

/// A network in f64.
pub(super) struct Mlp {
    pub(super) output: Output,
    /// Weight `[inputs, outputs]` and bias `[outputs]` of every layer in turn.
    pub(super) parameters: Vec<Tensor>,
}

impl Mlp {
    /// A copy of a stack of one network, whose matrices and vectors each start at a multiple of 16 numbers.
    pub(super) fn of(stack: &Stack, shape: Shape) -> Self {
        let numbers: Vec<f64> = stack.numbers().unwrap().into_iter().map(f64::from).collect();
        let mut start = 0;
        let mut take = |size: &[usize]| {
            let part = &numbers[start..][..size.iter().product()];
            start = (start + part.len()).next_multiple_of(16);
            let size: Vec<i64> = size.iter().map(|&n| n as i64).collect();
            Tensor::from_slice(part).view(&size[..])
        };
        let mut parameters = Vec::new();
        for layer in 0..=shape.layers {
            let inputs = if layer == 0 { shape.inputs } else { shape.width };
            let weight = if layer == shape.layers {
                take(&[shape.outputs, inputs]).tr()
            } else {
                take(&[inputs, shape.width])
            };
            let outputs = weight.size()[1] as usize;
            parameters.extend([weight, take(&[outputs])]);
        }
        assert_eq!(start, numbers.len(), "all parameters read");
        Self { output: shape.output, parameters }
    }

    /// `[n, inputs]` to `[n, outputs]`.
    pub(super) fn forward(&self, input: &Tensor) -> Tensor {
        let last = self.parameters.len() / 2 - 1;
        let mut x = input.shallow_clone();
        for (layer, pair) in self.parameters.chunks_exact(2).enumerate() {
            x = x.matmul(&pair[0]) + &pair[1];
            if layer < last {
                x = x.relu();
            }
        }
        match self.output {
            Output::Linear => x,
            Output::Tanh => x.tanh(),
        }
    }

    /// The gradient of `loss(self)` with respect to every parameter.
    pub(super) fn gradient(&self, loss: impl Fn(&Self) -> Tensor) -> Vec<Tensor> {
        let parameters = self.parameters.iter().map(|p| p.detach().copy().set_requires_grad(true)).collect();
        let tracked = Self { output: self.output, parameters };
        Tensor::run_backward(&[loss(&tracked)], &tracked.parameters, false, false)
    }
}

/// An online network with its target and Adam's memory (Kingma and Ba 2015, algorithm 1).
pub(super) struct Reference {
    pub(super) online: Mlp,
    pub(super) target: Mlp,
    pub(super) first: Vec<Tensor>,
    pub(super) second: Vec<Tensor>,
    pub(super) steps: i32,
}

impl Reference {
    pub(super) fn of(trained: &Trained, shape: Shape) -> Self {
        let [online, target] =
            [Parameters::Online, Parameters::Target].map(|which| Mlp::of(trained.network(which), shape));
        let zeros = || online.parameters.iter().map(Tensor::zeros_like).collect();
        Self { first: zeros(), second: zeros(), steps: 0, online, target }
    }

    /// Actor and critic of one student.
    pub(super) fn both(networks: &Networks, layers: usize) -> [Self; 2] {
        let [actor, critic] = shapes(layers);
        [Self::of(&networks.actor, actor), Self::of(&networks.critic, critic)]
    }

    pub(super) fn adam(&mut self, gradient: &[Tensor], lr: f64) {
        self.steps += 1;
        for (i, g) in gradient.iter().enumerate() {
            self.first[i] = &self.first[i] * 0.9 + g * 0.1;
            self.second[i] = &self.second[i] * 0.999 + g.square() * 0.001;
            let mean = &self.first[i] / (1.0 - 0.9f64.powi(self.steps));
            let square = &self.second[i] / (1.0 - 0.999f64.powi(self.steps));
            self.online.parameters[i] = &self.online.parameters[i] - mean * lr / (square.sqrt() + 1e-8);
        }
    }

    pub(super) fn follow(&mut self, polyak: f64) {
        for (target, online) in self.target.parameters.iter_mut().zip(&self.online.parameters) {
            *target = &*target * polyak + online * (1.0 - polyak);
        }
    }
}

/// A batch as the networks see it, in f64.
pub(super) struct Transitions {
    /// (s, g), `[n, S + G]`.
    pub(super) observed: Tensor,
    /// (s', g), `[n, S + G]`.
    pub(super) next_observed: Tensor,
    /// `[n, A]`.
    pub(super) actions: Tensor,
    /// `[n, 1]`.
    pub(super) rewards: Tensor,
}

impl Transitions {
    pub(super) fn of(batch: &Batch, normalizers: &Normalizers) -> Self {
        let matrix = |numbers: &[f32]| {
            Tensor::from_slice(numbers).to_kind(Kind::Double).view([batch.len() as i64, -1])
        };
        let observed = |states: &[f32]| {
            let mut rows = vec![0.0; batch.len() * (SPEC.state + SPEC.goal)];
            let pairs = states.chunks_exact(SPEC.state).zip(batch.goals.chunks_exact(SPEC.goal));
            for (row, (state, goal)) in rows.chunks_exact_mut(SPEC.state + SPEC.goal).zip(pairs) {
                normalizers.write(state, goal, row);
            }
            matrix(&rows)
        };
        Self {
            observed: observed(&batch.states),
            next_observed: observed(&batch.next_states),
            actions: matrix(&batch.actions),
            rewards: matrix(&batch.rewards),
        }
    }

    /// y = clip(r + γ·Q'(s', g, π'(s', g)), −1/(1 − γ), 0), `[n, 1]`.
    pub(super) fn targets(&self, actor: &Mlp, critic: &Mlp) -> Tensor {
        let actions = actor.forward(&self.next_observed);
        let values = critic.forward(&Tensor::cat(&[&self.next_observed, &actions], 1));
        (&self.rewards + values * DISCOUNT.gamma).clamp(-1.0 / (1.0 - DISCOUNT.gamma), 0.0)
    }

    /// mean (Q(s, g, a) − y)².
    pub(super) fn critic_loss(&self, critic: &Mlp, targets: &Tensor) -> Tensor {
        let values = critic.forward(&Tensor::cat(&[&self.observed, &self.actions], 1));
        (values - targets).square().mean(Kind::Double)
    }

    /// −mean Q(s, g, π(s, g)) + λ·mean π².
    pub(super) fn actor_loss(&self, actor: &Mlp, critic: &Mlp) -> Tensor {
        let actions = actor.forward(&self.observed);
        let values = critic.forward(&Tensor::cat(&[&self.observed, &actions], 1));
        actions.square().mean(Kind::Double) * ACTION_L2 - values.mean(Kind::Double)
    }

    /// The gradients of both losses, the actor's first.
    pub(super) fn gradients(&self, actor: &Reference, critic: &Reference) -> [Vec<Tensor>; 2] {
        let targets = self.targets(&actor.target, &critic.target);
        [
            actor.online.gradient(|online| self.actor_loss(online, &critic.online)),
            critic.online.gradient(|online| self.critic_loss(online, &targets)),
        ]
    }
}
