//! ProCuRL prefers goals of medium difficulty.

use curricula::Proposal;
use curricula::testing::{Class, LOWEST};

use crate::support::{close, entry};

/// p = 0, 0.1, 0.5 and 1 between the lowest value and 0.
fn graded(goal: usize, _steps: u64) -> f64 {
    LOWEST * (1.0 - [0.0, 0.1, 0.5, 1.0][goal])
}

#[test]
fn the_softmax_has_the_stated_ratio() {
    let mut class = Class::new("procurl", "", 4, graded);
    class.propose_index();
    let weights = class.weights();
    // p(1-p) = 0, 0.09, 0.25, 0: ratio exp(20 · (0.25 - 0.09)) = exp(3.2).
    assert!((weights[2] / weights[1] - 3.2f64.exp()).abs() < 1e-9);
    assert!((weights[1] / weights[0] - 1.8f64.exp()).abs() < 1e-9);
    assert!(close(&[weights[0]], &[weights[3]]));
}

#[test]
fn beta_zero_is_a_uniform_draw() {
    let mut class = Class::new("procurl", "beta = 0", 4, graded);
    class.propose_index();
    assert_eq!(class.weights(), [0.25; 4]);
}

#[test]
fn argmax_takes_the_goal_reached_every_other_time() {
    let mut class = Class::new("procurl", "selection = \"argmax\"", 4, graded);
    assert!(class.cycles(10).iter().all(|&goal| goal == 2));
}

#[test]
fn adaptive_bounds_are_those_of_the_pool() {
    // Values -50, -45, -40: far from success by the fixed bounds, but the middle one is halfway in the pool.
    let mut class = Class::new("procurl", "bounds = \"adaptive\"", 3, |goal, _| -50.0 + 5.0 * goal as f64);
    class.propose_index();
    // p = 0, 1/2, 1: exp(20/4) = e^5 for the middle one.
    let total = 2.0 + 5f64.exp();
    assert!(close(&class.weights(), &[1.0 / total, 5f64.exp() / total, 1.0 / total]));
}

#[test]
fn adaptive_bounds_do_not_stretch_rounding() {
    let weights_of = |script| {
        let mut class = Class::new("procurl", "bounds = \"adaptive\"", 3, script);
        class.propose_index();
        class.weights()
    };
    assert!(close(&weights_of(|_, _| -7.0), &[1.0 / 3.0; 3]));
    // Neighbouring numbers of single precision near -50, 2^-18 = 3.8e-6 apart.
    let neighbours = |goal, _| -50.0 + goal as f64 * 2f64.powi(-18);
    assert!(close(&weights_of(neighbours), &[1.0 / 3.0; 3]));
    // Ten thousandths are more than that: the middle goal is halfway, as above.
    let apart = weights_of(|goal, _| -50.0 + goal as f64 * 1e-3);
    assert!((apart[1] / apart[0] - 5f64.exp()).abs() < 1e-6, "{apart:?}");
}

#[test]
fn scores_are_renewed_when_the_networks_change() {
    let mut class = Class::new("procurl", "selection = \"argmax\"", 2, |goal, steps| {
        // The goals swap at every gradient step.
        if (goal as u64 + steps).is_multiple_of(2) { -25.0 } else { -49.0 }
    });
    assert_eq!(class.cycles(4), [0, 1, 0, 1]);
    assert_eq!(class.statistic("evaluations"), 4.0);
}

/// A task is a start with its goal: the second episode of a cycle has another start, and so other scores.
#[test]
fn scores_are_those_of_the_start_at_hand() {
    let mut class = Class::on("FetchPush", entry("procurl"), "", 2, |_, _| -25.0).unwrap();
    class.student.by_state = 1.0;
    for _ in 0..2 {
        for _ in 0..2 {
            class.propose().unwrap();
            let p = [1.0 - (-25.0 + class.start.state.iter().sum::<f64>()) / LOWEST, 0.5];
            let [a, b] = p.map(|p| (20.0 * p * (1.0 - p)).exp());
            assert!(close(&class.weights(), &[a / (a + b), b / (a + b)]), "{:?}", class.weights());
        }
        class.learn();
    }
    assert_eq!(class.student.asked.len(), 4);
}

#[test]
fn a_choice_is_told_with_its_score() {
    let mut class = Class::new("procurl", "selection = \"argmax\"", 4, graded);
    assert_eq!(class.propose().unwrap(), Proposal::pool(2).scored(0.25));
}

/// Values beyond the bounds count as the bounds.
#[test]
fn values_that_no_return_can_have_are_clipped_here() {
    let mut class = Class::new("procurl", "", 3, |goal, _| [-70.0, 10.0, -25.0][goal]);
    class.propose_index();
    let total = 2.0 + 5f64.exp();
    assert!(close(&class.weights(), &[1.0 / total, 1.0 / total, 5f64.exp() / total]));
}
