//! SPaCE's set grows exactly when its rule says so.

use curricula::{CurriculumError, Distribution, PoolState, snapshot};

use crate::support::Class;

/// All goals move together, by more than a tenth at steps 1 to 3 and by less from there on.
fn levelling_off(_goal: usize, steps: u64) -> f64 {
    [-40.0, -30.0, -20.0, -10.0, -9.5, -9.2, -9.0][(steps as usize).min(6)]
}

fn sizes(config: &str, goals: usize, updates: usize) -> Vec<f64> {
    let mut class = Class::new("space", config, goals, levelling_off);
    let mut update = || {
        class.cycles(1);
        class.statistic("set_size")
    };
    (0..updates).map(|_| update()).collect()
}

#[test]
fn the_set_grows_when_progress_stagnates_and_only_then() {
    // Relative changes: 1/4, 1/3, 1/2, then 1/20, 3/95, 2/92, 0.
    assert_eq!(sizes("", 10, 8), [1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    // With eta 0.3 the first change stagnates too.
    assert_eq!(sizes("eta = 0.3", 10, 5), [1.0, 2.0, 2.0, 2.0, 3.0]);
    // With eta 0 only an exact standstill does.
    assert_eq!(sizes("eta = 0.0", 10, 8), [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0]);
    assert_eq!(sizes("kappa = 4", 20, 7), [1.0, 1.0, 1.0, 1.0, 5.0, 9.0, 13.0]);
}

#[test]
fn the_set_never_leaves_the_pool() {
    assert_eq!(sizes("kappa = 2", 3, 8), [1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0]);
    assert_eq!(sizes("kappa = 9223372036854775807", 3, 8)[7], 3.0);
    assert_eq!(sizes("", 1, 8), [1.0; 8]);
}

/// Goal i improves by 0.3 i per step, from the bottom.
fn fanning(goal: usize, steps: u64) -> f64 {
    -50.0 + 0.3 * (goal as u64 * steps) as f64
}

#[test]
fn the_set_holds_the_goals_that_rank_first() {
    // From -50 the mean of the set moves by at most 1.5, that is 3 %, so the set grows by one at every update but the first.
    let mut class = Class::new("space", "", 4, fanning);
    class.cycles(3);
    assert_eq!(class.weights(), [0.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0], "most improved first");
    let mut class = Class::new("space", "order = \"absolute\"", 4, fanning);
    class.cycles(3);
    assert_eq!(class.weights(), [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0], "lowest value first");
}

#[test]
fn the_first_update_ranks_as_if_all_values_had_been_zero_and_does_not_grow() {
    let first = |config: &str| {
        let mut class = Class::new("space", config, 4, |goal, _| -[40.0, 50.0, 10.0, 30.0][goal]);
        (class.propose_index(), class.weights())
    };
    // Improvements -40, -50, -10, -30, which relative to 0 would all be the same.
    assert_eq!(first(""), (2, vec![0.0, 0.0, 1.0, 0.0]));
    assert_eq!(first("order = \"relative\""), (2, vec![0.0, 0.0, 1.0, 0.0]));
    assert_eq!(first("order = \"absolute\""), (1, vec![0.0, 1.0, 0.0, 0.0]));

    // A mean of 0 does not differ from 0, but there is no last mean that it could stagnate at.
    let mut class = Class::new("space", "", 4, |_, _| 0.0);
    class.cycles(1);
    assert_eq!(class.statistic("set_size"), 1.0);
    class.cycles(1);
    assert_eq!(class.statistic("set_size"), 2.0);
}

#[test]
fn the_relative_order_prefers_the_larger_share_of_the_last_value() {
    // From -40 to -30 is a quarter, from -8 to -4 a half.
    let script = |goal: usize, steps: u64| [[-40.0, -30.0], [-8.0, -4.0]][goal][steps.min(1) as usize];
    let chosen = |order: &str| Class::new("space", &format!("order = \"{order}\""), 2, script).cycles(2)[1];
    assert_eq!(chosen("relative"), 1);
    assert_eq!(chosen("signed"), 0);
}

#[test]
fn the_new_set_is_trained_on_at_once() {
    // From the first update to the second goal 7 improves; all others decline by 15 %, too much to stagnate.
    let script =
        |goal: usize, steps: u64| [-20.0 - 3.0 * steps as f64, -50.0 + steps as f64][usize::from(goal == 7)];
    assert_eq!(Class::new("space", "", 9, script).cycles(2)[1], 7);
}

#[test]
fn goals_of_the_set_take_turns() {
    let mut class = Class::new("space", "kappa = 2", 4, fanning);
    assert_eq!(class.cycles(1), [0], "all stand at -50: the first goal of the pool");
    // At the second update the set becomes 3, 2, 1. It is the second turn.
    let turns: Vec<usize> = (0..6).map(|_| class.propose_index()).collect();
    assert_eq!(turns, [2, 1, 3, 2, 1, 3]);
    assert_eq!(class.weights(), [0.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0]);
}

#[test]
fn stagnation_is_that_of_the_set_not_of_the_pool() {
    // The lowest goal stands still, the others improve by more than a tenth.
    let script = |goal, steps: u64| if goal == 0 { -50.0 } else { -40.0 * 0.5f64.powi(steps as i32) };
    let mut class = Class::new("space", "order = \"absolute\"", 3, script);
    class.cycles(2);
    assert_eq!(class.statistic("set_size"), 2.0);
}

#[test]
fn a_mean_is_compared_with_the_mean_of_the_set_before() {
    // Nothing moves, but the set moves on from goal 0 at -10 to goal 1 at -40, which is no stagnation.
    let mut class =
        Class::new("space", "order = \"absolute\"", 2, |goal, _| if goal == 0 { -10.0 } else { -40.0 });
    class.cycles(2);
    assert_eq!(class.statistic("set_size"), 1.0);
    assert_eq!(class.statistic("set_confidence"), -40.0);
    class.cycles(1);
    assert_eq!(class.statistic("set_size"), 2.0);
}

#[test]
fn a_state_whose_set_or_values_do_not_fit_the_pool_is_refused() {
    let load = |set: Vec<usize>, last: Option<(Vec<f64>, f64)>| {
        let common = PoolState::new(Distribution::uniform(3));
        let bytes = snapshot::save("space", 2, &(common, set, 5usize, last));
        Class::new("space", "", 3, levelling_off).teacher.load(&bytes)
    };
    assert!(load(vec![2, 0], Some((vec![-1.0; 3], -1.0))).is_ok());
    for (set, last) in [
        (vec![], None),
        (vec![0, 3], None),
        (vec![0], Some((vec![-1.0; 2], -1.0))),
        (vec![0], Some((vec![-1.0, f64::NAN, -1.0], -1.0))),
    ] {
        let result = load(set.clone(), last.clone());
        assert!(matches!(result, Err(CurriculumError::State { .. })), "{set:?}, {last:?}: {result:?}");
    }
}
