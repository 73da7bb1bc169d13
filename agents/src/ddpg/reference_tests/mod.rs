//! The hand-written update against the same losses under automatic differentiation, in double precision.

mod automatic;
mod lanes;

use envs::rng::{Purpose, Rng, stream};
use envs::{Defaults, Spec};
use rand::Rng as _;
use tch::{Device, Kind, Tensor};

use automatic::{Mlp, Reference, Transitions};

use super::update::{Learner, Networks};
use crate::auto::Auto;
use crate::batch::{Batch, Dims};
use crate::config::StudentConfig;
use crate::device::far_away;
use crate::inputs::{Normalizers, rows_per_part};
use crate::losses::Discount;
use crate::networks::{Output, Parameters, Shape};
use crate::normalizer::{Normalizer, NormalizerConfig};
use crate::precision::{Arithmetic, Precision};

const SPEC: Spec = Spec {
    id: "Reference",
    family: "toy",
    state: 7,
    goal: 3,
    action: 4,
    horizon: 5,
    defaults: Defaults::TOY,
};
/// So low that random values are clipped from both sides.
const DISCOUNT: Discount = Discount { gamma: 0.5 };
const ACTION_L2: f64 = 0.7;
/// No whole number of cache lines: the parameters have gaps.
const WIDTH: usize = 20;

/// Of actor and critic.
fn shapes(layers: usize) -> [Shape; 2] {
    let dims = Dims::of(&SPEC);
    let shape = |inputs, outputs, output| Shape { inputs, layers, width: WIDTH, outputs, output };
    [shape(dims.actor_inputs(), dims.action, Output::Tanh), shape(dims.critic_inputs(), 1, Output::Linear)]
}

/// A learner, and networks that all differ and have no zero biases. The target networks' values are so large
/// that some Bellman targets are clipped.
fn learner(layers: usize, batch: usize, precision: Precision, rng: &mut Rng) -> (Learner, Networks) {
    let config = StudentConfig {
        batch: Auto::Value(batch),
        actor_lr: 1e-3,
        critic_lr: 2e-3,
        action_l2: ACTION_L2,
        ..StudentConfig::default()
    };
    let dims = Dims::of(&SPEC);
    let arithmetic = Arithmetic { device: Device::Cpu, precision };
    let learner = Learner::new(&config, DISCOUNT, dims, shapes(layers), 1, arithmetic).unwrap();
    (learner, networks(layers, arithmetic, rng))
}

/// Networks of one student as [`learner`] gives them.
fn networks(layers: usize, arithmetic: Arithmetic, rng: &mut Rng) -> Networks {
    let mut networks = Networks::new(Dims::of(&SPEC), shapes(layers), arithmetic, rng).unwrap();
    for trained in networks.both() {
        for (network, scale) in [(Parameters::Online, 1.0), (Parameters::Target, 1.5)] {
            let stack = trained.network(network);
            let mut numbers = stack.numbers().unwrap();
            for number in &mut numbers {
                *number = scale * (*number + rng.random_range(-0.3..0.3));
            }
            stack.set_numbers(&numbers).unwrap();
        }
    }
    networks
}

/// Normalisers that have seen numbers like those of [`batch`].
fn normalizers(rng: &mut Rng) -> Normalizers {
    let mut fed = |width: usize| {
        let mut normalizer = Normalizer::new(NormalizerConfig::default(), width);
        let rows: Vec<f32> = (0..50 * width).map(|_| rng.random_range(-1.0..3.0)).collect();
        normalizer.update(&rows);
        normalizer
    };
    Normalizers { state: fed(SPEC.state), goal: fed(SPEC.goal) }
}

fn batch(n: usize, rng: &mut Rng) -> Batch {
    let mut batch = Batch::new(&SPEC, n);
    for numbers in [&mut batch.states, &mut batch.next_states, &mut batch.goals] {
        numbers.fill_with(|| rng.random_range(-1.0..3.0));
    }
    batch.actions.fill_with(|| rng.random_range(-1.0..1.0));
    batch.rewards.fill_with(|| if rng.random_bool(0.5) { -1.0 } else { 0.0 });
    batch
}

fn numbers(tensor: &Tensor) -> Vec<f64> {
    Vec::try_from(tensor.flatten(0, -1)).unwrap()
}

/// The largest difference between matrices, each relative to the reference's largest number.
fn largest_relative_error(got: &[Tensor], expected: &[Tensor]) -> f64 {
    assert_eq!(got.len(), expected.len());
    let error = |(got, expected): (&Tensor, &Tensor)| {
        let size = expected.abs().max().double_value(&[]);
        assert!(size > 0.0, "a gradient without a number says nothing");
        (got - expected).abs().max().double_value(&[]) / size
    };
    got.iter().zip(expected).map(error).fold(0.0, f64::max)
}

/// ‖got − expected‖ / ‖expected‖ over all matrices together.
fn relative_distance(got: &[Tensor], expected: &[Tensor]) -> f64 {
    let squares = |tensor: &Tensor| tensor.square().sum(Kind::Double).double_value(&[]);
    let error: f64 = got.iter().zip(expected).map(|(got, expected)| squares(&(got - expected))).sum();
    (error / expected.iter().map(squares).sum::<f64>()).sqrt()
}

/// The kernels that a GPU would run take the same steps.
#[test]
fn gradients_on_another_device_are_those_of_automatic_differentiation() {
    far_away(|| {
        assert_eq!(rows_per_part(1024, Arithmetic::single(Device::Cpu)), 1024);
        let cases = [(2, 1), (2, 7), (2, 256), (2, 1024), (3, 1), (3, 7)];
        check_gradients(&cases, Precision::F32, SINGLE_ERROR);
        check_gradients(&cases, Precision::Bf16, ROUNDED_ERROR);
    });
}

#[test]
fn gradients_are_those_of_automatic_differentiation() {
    // 7 are one part of an odd size, 1024 come in several.
    assert!(rows_per_part(1024, Arithmetic::single(Device::Cpu)) < 1024);
    let two_and_three = [(2, 1), (2, 7), (2, 256), (2, 1024), (3, 1), (3, 7), (3, 256), (3, 1024)];
    let others = [(1, 7), (4, 7), (8, 7)];
    let cases = [&two_and_three[..], &others].concat();
    check_gradients(&cases, Precision::F32, SINGLE_ERROR);
    check_gradients(&cases, Precision::Bf16, ROUNDED_ERROR);
}

/// The largest error of a gradient in single precision, relative to its matrix' largest number. Some 5e-7
/// are seen.
const SINGLE_ERROR: f64 = 1e-5;

/// The distance of a network's gradient from the exact one, as a share of its length, where wide products are
/// rounded to 8 bits:
/// mostly some 0.7 %; more where a few transitions' terms cancel.
const ROUNDED_ERROR: f64 = 0.15;

/// Compares in every case, which is a number of hidden layers and a number of transitions.
fn check_gradients(cases: &[(usize, usize)], precision: Precision, most: f64) {
    crate::prepare_thread();
    let mut rng = stream(0, Purpose::Weights);
    for &(layers, n) in cases {
        let (mut learner, mut networks) = learner(layers, n, precision, &mut rng);
        let normalizers = normalizers(&mut rng);
        let batch = batch(n, &mut rng);
        let [actor, critic] = Reference::both(&networks, layers);
        let transitions = Transitions::of(&batch, &normalizers);
        if n >= 256 {
            let targets = numbers(&transitions.targets(&actor.target, &critic.target));
            let lowest = DISCOUNT.lowest_value();
            assert!(targets.contains(&0.0) && targets.contains(&lowest), "both bounds clip");
            assert!(targets.iter().any(|y| lowest < *y && *y < 0.0), "neither clips all");
        }
        let expected = transitions.gradients(&actor, &critic);

        let references = (&transitions, [&actor, &critic]);
        check_dry_step((&mut learner, &mut networks), (&batch, &normalizers), references, &expected, most);
        // The update leaves its gradients in place.
        learner.inputs.fill(&batch, &normalizers).unwrap();
        learner.update(&mut networks).unwrap();
        for ((trained, shape), expected) in networks.both().into_iter().zip(shapes(layers)).zip(expected) {
            let gradient = Mlp::of(trained.for_backward().1, shape).parameters;
            let error = match precision {
                Precision::F32 => largest_relative_error(&gradient, &expected),
                Precision::Bf16 => relative_distance(&gradient, &expected),
            };
            assert!(
                error < most,
                "{precision:?}, {:?}, {layers} layers, {n} transitions: {error}",
                shape.output
            );
        }
    }
}

/// What a step would find is what automatic differentiation finds. The update that follows is checked after
/// it.
fn check_dry_step(
    (learner, networks): (&mut Learner, &mut Networks),
    (batch, normalizers): (&Batch, &Normalizers),
    (transitions, [actor, critic]): (&Transitions, [&Reference; 2]),
    gradients: &[Vec<Tensor>; 2],
    most: f64,
) {
    let found = learner.dry_step(networks, batch, normalizers).unwrap();
    let targets = transitions.targets(&actor.target, &critic.target);
    let taken = Tensor::cat(&[&transitions.observed, &transitions.actions], 1);
    let number = |tensor: Tensor| tensor.double_value(&[]);
    let norm = |gradient: &[Tensor]| {
        gradient.iter().map(|g| number(g.square().sum(Kind::Double))).sum::<f64>().sqrt()
    };
    for (name, found, expected) in [
        ("critic's loss", found.critic_loss, number(transitions.critic_loss(&critic.online, &targets))),
        ("actor's loss", found.actor_loss, number(transitions.actor_loss(&actor.online, &critic.online))),
        ("mean Q", found.mean_q, number(critic.online.forward(&taken).mean(Kind::Double))),
        ("actor's gradient", found.actor_gradient_norm, norm(&gradients[0])),
        ("critic's gradient", found.critic_gradient_norm, norm(&gradients[1])),
    ] {
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error < most, "{name}: {found}, not {expected}");
    }
}

/// ‖got − expected‖ / ‖expected − start‖ over all parameters: the error as a share of the way travelled.
fn drift(got: &Mlp, expected: &Mlp, start: &Mlp) -> f64 {
    let distance = |a: &Mlp, b: &Mlp| {
        let squares = a.parameters.iter().zip(&b.parameters);
        squares.map(|(a, b)| (a - b).square().sum(Kind::Double).double_value(&[])).sum::<f64>().sqrt()
    };
    distance(got, expected) / distance(expected, start)
}

#[test]
fn two_hundred_updates_follow_automatic_differentiation_with_adam() {
    check_updates(0.95, 40, Precision::F32, 1e-3);
}

#[test]
fn targets_that_follow_every_update_do_so_beside_automatic_differentiation() {
    check_updates(0.99, 1, Precision::F32, 1e-3);
}

#[test]
fn two_hundred_updates_on_another_device_follow_automatic_differentiation_with_adam() {
    far_away(|| check_updates(0.95, 40, Precision::F32, 1e-3));
}

#[test]
fn two_hundred_rounded_updates_stay_near_those_in_double_precision() {
    check_updates(0.95, 40, Precision::Bf16, 0.1);
    far_away(|| check_updates(0.95, 40, Precision::Bf16, 0.1));
}

/// Compares with targets that follow with weight `polyak`, once every `every` updates.
fn check_updates(polyak: f64, every: usize, precision: Precision, most: f64) {
    crate::prepare_thread();
    let mut rng = stream(1, Purpose::Weights);
    let (mut learner, mut networks) = learner(2, 64, precision, &mut rng);
    let normalizers = normalizers(&mut rng);
    let start = Reference::both(&networks, 2);
    let [mut actor, mut critic] = Reference::both(&networks, 2);
    for _ in 0..200 / every {
        for _ in 0..every {
            let batch = batch(64, &mut rng);
            let [actor_gradient, critic_gradient] =
                Transitions::of(&batch, &normalizers).gradients(&actor, &critic);
            actor.adam(&actor_gradient, 1e-3);
            critic.adam(&critic_gradient, 2e-3);
            learner.inputs.fill(&batch, &normalizers).unwrap();
            learner.update(&mut networks).unwrap();
        }
        actor.follow(polyak);
        critic.follow(polyak);
        networks.follow(polyak).unwrap();
    }
    assert_eq!(networks.steps(0), 200);
    let got = Reference::both(&networks, 2);
    for ((got, expected), start) in got.iter().zip([&actor, &critic]).zip(&start) {
        for (name, got, expected, start) in [
            ("online", &got.online, &expected.online, &start.online),
            ("target", &got.target, &expected.target, &start.target),
        ] {
            let drift = drift(got, expected, start);
            // Single precision leaves up to 2e-5; Adam carries the difference of small gradients on.
            assert!(drift < most, "{precision:?}, {name}: {drift}");
        }
    }
}
