//! How far an ensemble's values lie apart, and the curriculum that follows: hand-worked values and degenerate
//! cases.

use curricula::CurriculumError;
use curricula::methods::vds::Disagreement;
use curricula::testing::LOWEST;
use envs::Rows;
use proptest::prelude::*;

const ALL: [Disagreement; 4] = [Disagreement::Std, Disagreement::Var, Disagreement::Tanh, Disagreement::Exp];

/// One row of values for each member, a column for each goal.
fn rows<const GOALS: usize>(members: &[[f64; GOALS]]) -> Rows {
    let mut rows = Rows::new(GOALS);
    members.iter().for_each(|member| rows.push(member));
    rows
}

/// The curriculum of `kind` over three goals on which two members' values are these.
fn curriculum(kind: Disagreement, members: [[f64; 3]; 2]) -> Vec<f64> {
    kind.curriculum(&kind.over(&rows(&members)), LOWEST).expect("finite values").probabilities().to_vec()
}

#[test]
fn hand_worked_disagreement() {
    // Mean -3, deviations 2, 0, -2: variance 8/3.
    let of = |kind: Disagreement| kind.of([-1.0, -3.0, -5.0]);
    let variance = 8.0f64 / 3.0;
    assert_eq!(of(Disagreement::Var), variance);
    assert_eq!(of(Disagreement::Std), variance.sqrt());
    assert!((of(Disagreement::Tanh) - 0.990_390_5).abs() < 1e-7);
    assert!((of(Disagreement::Exp) - 5.119_174_3).abs() < 1e-7);
}

#[test]
fn agreement_weighs_nothing_except_under_exp() {
    let of = |kind: Disagreement| kind.of([-7.0; 3]);
    for kind in [Disagreement::Std, Disagreement::Var, Disagreement::Tanh] {
        assert_eq!(of(kind), 0.0);
    }
    assert_eq!(of(Disagreement::Exp), 1.0);
}

#[test]
fn disagreement_is_taken_across_members_for_each_goal() {
    // Two members, three goals; they differ on the middle one: deviations 2 and -2.
    let values = rows(&[[-4.0, -1.0, -9.0], [-4.0, -5.0, -9.0]]);
    assert_eq!(Disagreement::Std.over(&values), [0.0, 2.0, 0.0]);
}

#[test]
fn where_all_members_agree_on_every_goal_the_draw_is_uniform() {
    for kind in ALL {
        assert_eq!(curriculum(kind, [[-50.0, -3.0, 0.0]; 2]), [1.0 / 3.0; 3], "{kind:?}");
    }
}

#[test]
fn where_members_differ_by_rounding_alone_the_draw_is_uniform() {
    // Neighbours in single precision near -50 are 2^-18 apart: standard deviation 1.9e-6 on the first goal.
    let neighbour = -50.0 + 2f64.powi(-18);
    for kind in ALL {
        let drawn = curriculum(kind, [[-50.0; 3], [neighbour, -50.0, -50.0]]);
        // Under exp it is a weight of 1.0000019 beside two of 1.
        let within = if kind == Disagreement::Exp { 1e-6 } else { 0.0 };
        assert!(drawn.iter().all(|p| (p - 1.0 / 3.0).abs() <= within), "{kind:?}: {drawn:?}");
    }
}

#[test]
fn a_difference_beyond_rounding_decides() {
    let members = [[-50.0; 3], [-49.999, -50.0, -50.0]];
    for kind in [Disagreement::Std, Disagreement::Var, Disagreement::Tanh] {
        assert_eq!(curriculum(kind, members), [1.0, 0.0, 0.0], "{kind:?}");
    }
    // Standard deviation 0.0005: exp(0.0005) to 1 to 1.
    let weight = 0.0005f64.exp();
    let drawn = curriculum(Disagreement::Exp, members);
    assert!((drawn[0] - weight / (weight + 2.0)).abs() < 1e-12, "{drawn:?}");
}

#[test]
fn rounding_is_that_of_the_longest_horizon() {
    // A mean disagreement of 5e-6 is more than rounding near -100 gives, and less than it gives near -1000.
    let of = |lowest| Disagreement::Std.curriculum(&[1e-5, 0.0], lowest).unwrap().probabilities().to_vec();
    assert_eq!(of(-100.0), [1.0, 0.0]);
    assert_eq!(of(-1000.0), [0.5, 0.5]);
}

#[test]
fn what_is_not_finite_is_refused() {
    assert!(ALL.iter().all(|kind| kind.of([-1.0, f64::NAN]).is_nan()));
    // Values 2000 apart have a standard deviation of 1000, and e^1000 is too large a number.
    let overflow = Disagreement::Exp.of([-2000.0, 0.0]);
    for weight in [f64::NAN, overflow] {
        let error = Disagreement::Exp.curriculum(&[1.0, weight], LOWEST).unwrap_err();
        let named = matches!(error, CurriculumError::NotFinite { what: "disagreement", index: 1, .. });
        assert!(named, "{error}");
    }
}

proptest! {
    #[test]
    fn the_order_of_members_and_of_goals_does_not_matter(
        values in prop::collection::vec(prop::array::uniform3(-50.0..0.0f64), 4),
    ) {
        // Four members, three goals, forwards and backwards.
        let backwards: Vec<[f64; 3]> = values.iter().rev().map(|&[a, b, c]| [c, b, a]).collect();
        for kind in ALL {
            let (one, other) = (kind.over(&rows(&values)), kind.over(&rows(&backwards)));
            for (x, y) in one.iter().zip(other.iter().rev()) {
                prop_assert!((x - y).abs() <= 1e-9 * x.abs().max(1.0), "{kind:?}: {x} {y}");
            }
        }
    }
}
