//! GOID: it goes to goals that succeed sometimes.

use curricula::testing::Class;

/// The middle of the square succeeds every other time, the rest never or always.
fn middle(goal: &[f64], _steps: u64) -> f64 {
    match goal[0] {
        x if x < -0.3 => 0.0,
        x if x > 0.3 => 1.0,
        _ => 0.5,
    }
}

/// The probability of goals whose first component is within `bound`.
fn within(class: &Class, bound: f64) -> f64 {
    let pairs = class.weights().into_iter().zip(class.setting.pool.iter().map(|goal| goal[0]));
    pairs.filter(|(_, x)| x.abs() <= bound).map(|(weight, _)| weight).sum()
}

#[test]
fn goals_that_succeed_sometimes_are_trained_on_most() {
    let mut class = Class::new("goid", "goals_per_region = 1", 60, |_, _| -10.0);
    class.mastery = middle;
    class.propose_index();
    let share = class.setting.pool.iter().filter(|goal| goal[0].abs() <= 0.3).count() as f64 / 60.0;
    assert!((within(&class, 0.3) - share).abs() < 1e-9, "all alike before anything is known");
    class.cycles(1500);
    // 0.9 of all episodes now and earlier, and a share of those afresh.
    assert!(within(&class, 0.3) > 0.85, "{} of {share}", within(&class, 0.3));
    assert!((class.statistic("intermediate_goals") / 60.0 - share).abs() < 0.1);
}

#[test]
fn goals_that_were_intermediate_are_kept_and_others_are_tried_afresh() {
    let config = "goals_per_region = 1\nwindow = 4\nearlier = 0.5\nfresh = 0.5";
    let mut class = Class::new("goid", config, 8, |_, _| -10.0);
    // The first half of a run: every other time; then always.
    class.mastery = |_, steps| if steps < 200 { 0.5 } else { 1.0 };
    class.cycles(200);
    assert_eq!(class.statistic("earlier_goals"), 8.0);
    class.cycles(400);
    assert_eq!(class.statistic("intermediate_goals"), 0.0, "all are mastered");
    assert_eq!(class.statistic("earlier_goals"), 8.0, "and all have been intermediate");
    let weights = class.weights();
    assert!(weights.iter().all(|weight| (weight - 0.125).abs() < 1e-12), "{weights:?}");
}

#[test]
fn neighbours_share_what_is_known() {
    let config = "goals_per_region = 20\nwindow = 10\nearlier = 0.0\nfresh = 1.0";
    let mut class = Class::new("goid", config, 40, |_, _| -10.0);
    class.mastery = |_, _| 0.5;
    // Two regions of 20 goals, each tried ten times: most goals have not been tried at all.
    class.cycles(20);
    assert_eq!([class.statistic("intermediate_goals"), class.statistic("earlier_goals")], [40.0, 40.0]);
    let scores: Vec<_> = (0..10).map(|_| class.propose().unwrap().score).collect();
    assert!(scores.iter().all(Option::is_some), "every goal has the rate of its region: {scores:?}");
}
