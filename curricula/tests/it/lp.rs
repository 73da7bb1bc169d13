//! LP: it goes where success changes.

use curricula::testing::Class;

use crate::support::close;

/// Of a square: the left half never succeeds, the right half has begun to after 40 cycles.
fn right_from_40_on(goal: &[f64], steps: u64) -> f64 {
    f64::from(u8::from(goal[0] > 0.0 && steps >= 40))
}

#[test]
fn regions_whose_success_changes_are_trained_on() {
    let mut class = Class::new("lp", "regions = 2\nwindow = 30\nepsilon = 0.4", 40, |_, _| -10.0);
    class.mastery = |goal, steps| right_from_40_on(&[goal[0].max(goal[1])], steps);
    class.cycles(39);
    assert!(close(&class.weights(), &[1.0 / 40.0; 40]), "nothing changes yet: all alike");
    assert_eq!((class.statistic("progress_mean"), class.statistic("progress_max")), (0.0, 0.0));
    class.cycles(20);
    assert!(class.statistic("progress_max") > 0.2);
    // Long after, both halves of the window are alike again.
    class.cycles(400);
    assert!(class.statistic("progress_max") < 0.35, "{}", class.statistic("progress_max"));
}

#[test]
fn a_region_where_success_rises_has_more_than_its_share() {
    let mut class = Class::new("lp", "regions = 2\nwindow = 200\nepsilon = 0.4", 200, |_, _| -10.0);
    class.mastery = right_from_40_on;
    class.cycles(100);
    let weights = class.weights();
    let right: f64 = weights
        .iter()
        .zip(class.setting.pool.iter())
        .filter(|(_, goal)| goal[0] > 0.0)
        .map(|(weight, _)| weight)
        .sum();
    // Two regions, the left without progress: 0.4/2 + 0.6, if the pool is cut at 0.
    assert!((0.6..=0.85).contains(&right), "{right}");
}

#[test]
fn forgetting_counts_as_progress() {
    let mut class = Class::new("lp", "regions = 1\nwindow = 10", 5, |_, _| -10.0);
    class.mastery = |_, steps| f64::from(u8::from(steps < 10));
    class.cycles(20);
    assert_eq!(class.statistic("progress_max"), 1.0, "ten successes, then ten failures");
    assert_eq!(class.propose().unwrap().score, Some(1.0));
}
