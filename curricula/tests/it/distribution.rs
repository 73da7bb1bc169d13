//! Distributions over goals: hand-worked values, properties, degenerate cases.

use curricula::{CurriculumError, Distribution};
use envs::rng::{Purpose, stream};
use proptest::prelude::*;

use crate::support::close;

fn proportional(weights: &[f64]) -> Distribution {
    Distribution::proportional(weights, 0.0, "weight").expect("finite weights")
}

#[test]
fn hand_worked_values() {
    assert_eq!(proportional(&[1.0, 3.0, 0.0]).probabilities(), [0.25, 0.75, 0.0]);
    // exp(ln 3 · 1) = 3 against exp(0) = 1.
    let softmax = Distribution::softmax(&[0.0, 1.0], 3f64.ln(), "score").unwrap();
    assert!(close(softmax.probabilities(), &[0.25, 0.75]));
    let argmax = Distribution::argmax(&[1.0, 5.0, 5.0, 0.0], "score").unwrap();
    assert_eq!(argmax.probabilities(), [0.0, 0.5, 0.5, 0.0]);
    assert_eq!(Distribution::uniform_over(&[2, 0], 4).probabilities(), [0.5, 0.0, 0.5, 0.0]);
}

#[test]
fn hand_worked_entropy() {
    // ln 4 - (3/4) ln 3 for one and three quarters.
    let skewed = proportional(&[1.0, 3.0]);
    assert!((skewed.entropy() - (4f64.ln() - 0.75 * 3f64.ln())).abs() < 1e-15);
    // 4 / 3^(3/4).
    assert!((skewed.effective_goals() - 4.0 / 3f64.powf(0.75)).abs() < 1e-14);
    assert!((Distribution::uniform(8).effective_goals() - 8.0).abs() < 1e-12);
    assert!(proportional(&[0.0, 2.0]).entropy().to_bits() == 0, "nothing to guess, and no minus sign");
}

#[test]
fn weights_without_content_give_a_uniform_draw() {
    let above = |negligible: f64, weights: [f64; 2]| {
        Distribution::proportional(&weights, negligible, "weight").unwrap().probabilities().to_vec()
    };
    // It is the mean weight that counts: here 2.
    assert_eq!(above(2.0, [1.0, 3.0]), [0.5, 0.5]);
    assert_eq!(above(1.999, [1.0, 3.0]), [0.25, 0.75]);
    assert_eq!(above(0.0, [0.0, 0.0]), [0.5, 0.5]);
    // However small, where everything counts.
    assert_eq!(above(0.0, [1e-300, 3e-300]), [0.25, 0.75]);
}

#[test]
fn huge_weights_do_not_overflow() {
    assert_eq!(proportional(&[f64::MAX, f64::MAX]).probabilities(), [0.5, 0.5]);
    let softmax = Distribution::softmax(&[1e300, 0.0], 1.0, "score").unwrap();
    assert_eq!(softmax.probabilities(), [1.0, 0.0]);
}

#[test]
fn one_goal_gets_everything() {
    for distribution in [proportional(&[0.0]), proportional(&[7.0]), Distribution::uniform(1)] {
        assert_eq!(distribution.probabilities(), [1.0]);
        assert_eq!(distribution.draw(&mut stream(0, Purpose::Teacher)), 0);
    }
}

#[test]
fn what_is_not_finite_is_refused_by_name() {
    for bad in [f64::NAN, f64::INFINITY] {
        let weights = [1.0, bad, f64::NAN];
        let refusals = [
            Distribution::proportional(&weights, 0.0, "weight"),
            Distribution::softmax(&weights, 1.0, "weight"),
            Distribution::argmax(&weights, "weight"),
        ];
        for refusal in refusals {
            let error = refusal.unwrap_err();
            assert!(matches!(error, CurriculumError::NotFinite { what: "weight", index: 1, .. }), "{error}");
        }
    }
}

#[test]
fn draws_follow_the_probabilities() {
    let distribution = proportional(&[0.0, 1.0, 2.0, 0.0, 7.0, 0.0]);
    let mut rng = stream(1, Purpose::Teacher);
    let mut counts = [0u32; 6];
    for _ in 0..10_000 {
        counts[distribution.draw(&mut rng)] += 1;
    }
    for (count, p) in counts.into_iter().zip(distribution.probabilities()) {
        // Five standard deviations of the binomial count; exactly none where p is 0.
        let (mean, deviation) = (10_000.0 * p, (10_000.0 * p * (1.0 - p)).sqrt());
        assert!((f64::from(count) - mean).abs() <= 5.0 * deviation, "{count} draws at probability {p}");
    }
}

#[test]
fn saved_bytes_that_are_no_distribution_are_refused() {
    let read = |p: &[f64]| postcard::from_bytes::<Distribution>(&postcard::to_stdvec(p).unwrap());
    assert_eq!(read(&[0.25, 0.75]).unwrap(), proportional(&[1.0, 3.0]));
    for bad in [&[][..], &[0.5, 0.6], &[1.5, -0.5], &[f64::NAN, 1.0]] {
        assert!(read(bad).is_err(), "{bad:?}");
    }
}

/// One of the ways to make a distribution from scores in [0, 50].
fn make(kind: usize, scores: &[f64]) -> Distribution {
    match kind {
        0 => Distribution::proportional(scores, 0.0, "score"),
        1 => Distribution::softmax(scores, 2.0, "score"),
        _ => Distribution::argmax(scores, "score"),
    }
    .expect("finite scores")
}

proptest! {
    #[test]
    fn probabilities_sum_to_one(kind in 0..3usize, scores in prop::collection::vec(0.0..50.0f64, 1..50)) {
        let distribution = make(kind, &scores);
        prop_assert!((distribution.probabilities().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        prop_assert!(distribution.probabilities().iter().all(|&p| p >= 0.0));
        let (entropy, most) = (distribution.entropy(), (scores.len() as f64).ln());
        prop_assert!((-1e-12..=most + 1e-12).contains(&entropy));
    }

    #[test]
    fn permuting_goals_permutes_probabilities(
        kind in 0..3usize,
        (scores, order) in prop::collection::vec(0.0..50.0f64, 1..50).prop_flat_map(|scores| {
            let order: Vec<usize> = (0..scores.len()).collect();
            (Just(scores), Just(order).prop_shuffle())
        }),
    ) {
        let permuted: Vec<f64> = order.iter().map(|&i| scores[i]).collect();
        let original = make(kind, &scores);
        let expected: Vec<f64> = order.iter().map(|&i| original.probabilities()[i]).collect();
        prop_assert!(close(make(kind, &permuted).probabilities(), &expected));
    }

    #[test]
    fn a_goal_of_probability_zero_is_never_drawn(
        mut weights in prop::collection::vec(prop_oneof![Just(0.0), 0.1..10.0f64], 1..20),
        seed: u64,
    ) {
        weights.push(1.0);
        let drawn = proportional(&weights).draw(&mut stream(seed, Purpose::Teacher));
        prop_assert!(weights[drawn] > 0.0);
    }
}
