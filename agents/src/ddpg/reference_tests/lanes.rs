//! Several students in one stack against automatic differentiation, each for itself.

use envs::rng::{Purpose, stream};
use tch::Tensor;

use super::automatic::{Mlp, Reference, Transitions};
use super::*;
use crate::batch::Batch;
use crate::device::under_test;
use crate::losses::Loss;

/// Transitions per student and step.
const N: usize = 24;
/// Members of the stack that are nobody's.
const IDLE: usize = 2;

/// The products, sums and steps that a GPU does for all students at once: on the CPU, unless there is one.
#[test]
fn students_in_one_stack_each_take_the_steps_of_automatic_differentiation() {
    for (lanes, precision, most) in [
        (1, Precision::F32, SINGLE_ERROR),
        (3, Precision::F32, SINGLE_ERROR),
        (35, Precision::F32, SINGLE_ERROR),
        (3, Precision::Bf16, ROUNDED_ERROR),
    ] {
        far_away(|| check(lanes, precision, most));
    }
}

/// A student of the stack: what it is by automatic differentiation, and what it learns from.
struct Student {
    networks: [Reference; 2],
    normalizers: Normalizers,
    batch: Batch,
}

/// Gradients, losses and parameters of `lanes` students through three steps, with targets that follow.
fn check(lanes: usize, precision: Precision, most: f64) {
    crate::prepare_thread();
    let rng = &mut stream(5, Purpose::Weights);
    let arithmetic = Arithmetic { device: under_test().open().unwrap(), precision };
    let (dims, members) = (Dims::of(&SPEC), lanes + IDLE);
    let config = StudentConfig {
        batch: Auto::Value(N),
        actor_lr: 1e-3,
        critic_lr: 2e-3,
        action_l2: ACTION_L2,
        ..StudentConfig::default()
    };
    let mut learner = Learner::new(&config, DISCOUNT, dims, shapes(2), members, arithmetic).unwrap();
    let mut stack = Networks::zeros(dims, shapes(2), members, arithmetic).unwrap();
    let mut students: Vec<Student> = (0..lanes)
        .map(|lane| {
            let mut member = stack.member(lane, dims).unwrap();
            let mut apart = networks(2, arithmetic, rng);
            for (to, from) in member.both().into_iter().zip(apart.both()) {
                to.copy_from(from).unwrap();
            }
            let networks = Reference::both(&apart, 2);
            Student { networks, normalizers: normalizers(rng), batch: batch(N, rng) }
        })
        .collect();
    for step in 0..3 {
        students.iter_mut().for_each(|student| student.batch = batch(N, rng));
        learner
            .inputs
            .fill_each(step, &mut students, |s, rows| rows.write(&s.batch, &s.normalizers))
            .unwrap();
        let losses = Loss::read(&learner.update(&mut stack).unwrap()).unwrap();
        for (lane, student) in students.iter_mut().enumerate() {
            let found = [losses[0][lane], losses[1][lane]];
            student.check_step(&mut stack.member(lane, dims).unwrap(), found, most);
        }
        stack.follow(0.9).unwrap();
        students.iter_mut().flat_map(|student| &mut student.networks).for_each(|net| net.follow(0.9));
    }
    for (lane, student) in students.iter().enumerate() {
        let got = Reference::both(&stack.member(lane, dims).unwrap(), 2);
        for (got, expected) in got.iter().zip(&student.networks) {
            for (got, expected) in [(&got.online, &expected.online), (&got.target, &expected.target)] {
                let error = relative_distance(&got.parameters, &expected.parameters);
                assert!(error < most.min(0.01), "{lanes} lanes, lane {lane}: {error}");
            }
        }
    }
    // Who is missing changes nothing and becomes nothing.
    for idle in lanes..members {
        for trained in stack.member(idle, dims).unwrap().both() {
            assert!(
                trained.network(Parameters::Online).numbers().unwrap().iter().all(|&number| number == 0.0)
            );
        }
    }
}

impl Student {
    /// Takes the step that the student's `member` of the stack has taken, and compares its gradients and its
    /// losses of critic and actor.
    fn check_step(&mut self, member: &mut Networks, losses: [f64; 2], most: f64) {
        let transitions = Transitions::of(&self.batch, &self.normalizers);
        let [actor, critic] = &mut self.networks;
        let targets = transitions.targets(&actor.target, &critic.target);
        let expected = [
            transitions.critic_loss(&critic.online, &targets),
            transitions.actor_loss(&actor.online, &critic.online),
        ];
        for (loss, expected) in losses.iter().zip(expected.map(|loss| loss.double_value(&[]))) {
            assert!((loss - expected).abs() < most * expected.abs().max(1.0), "{loss}, not {expected}");
        }
        let gradients: [Vec<Tensor>; 2] = transitions.gradients(actor, critic);
        for ((trained, shape), gradient) in member.both().into_iter().zip(shapes(2)).zip(&gradients) {
            let got = Mlp::of(trained.for_backward().1, shape).parameters;
            let error = relative_distance(&got, gradient);
            assert!(error < most, "{:?}: {error}", shape.output);
        }
        actor.adam(&gradients[0], 1e-3);
        critic.adam(&gradients[1], 2e-3);
    }
}
