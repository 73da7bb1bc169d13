//! PLR: which goals it has seen, and which it replays.

use curricula::testing::Class;

use crate::support::close;

/// A class in which the critic errs by the first component of a goal.
fn class(config: &str, goals: usize) -> Class {
    let mut class = Class::new("plr", config, goals, |_, _| -10.0);
    class.student.surprise = |goal, _| goal[0];
    class
}

#[test]
fn the_goal_whose_last_episode_surprised_most_is_replayed_most() {
    let mut class = class("staleness = 0.0\nschedule = \"fixed\"\nreplay = 0.5\nbeta = 1.0", 6);
    class.cycles(200);
    assert_eq!(class.statistic("seen_goals"), 6.0, "half of the episodes went to unseen goals");
    class.propose_index();
    let sizes: Vec<f64> = class.setting.pool.iter().map(|goal| goal[0].abs()).collect();
    let total: f64 = (1..=6).map(|rank| 1.0 / f64::from(rank)).sum();
    let rank = |size: &f64| sizes.iter().filter(|other| *other >= size).count() as f64;
    let expected: Vec<f64> = sizes.iter().map(|size| 1.0 / rank(size) / total).collect();
    assert!(close(&class.weights(), &expected), "{:?} for {expected:?}", class.weights());
    let mean = sizes.iter().sum::<f64>() / 6.0;
    assert!((class.statistic("td_error_mean") - mean).abs() < 1e-12);
}

#[test]
fn a_goal_whose_episode_has_not_been_learned_from_has_no_score() {
    let mut class = class("schedule = \"fixed\"\nreplay = 1.0", 4);
    for _ in 0..3 {
        assert_eq!(class.propose().unwrap().score, None);
    }
    assert_eq!(class.weights(), [0.25; 4], "all are unseen until the student learns");
    class.learn();
    let seen = class.statistic("seen_goals");
    let proposal = class.propose().unwrap();
    assert!((1.0..=3.0).contains(&seen) && proposal.score.is_some(), "{seen}: {proposal:?}");
}

/// Two episodes towards one goal in a cycle: the later one's errors count.
#[test]
fn the_newest_episode_counts() {
    let mut class = class("", 1);
    class.student.surprise = |goal, _| goal[0];
    (0..2).for_each(|_| drop(class.propose().unwrap()));
    class.student.remembered[0].goal = vec![8.0, 0.0];
    class.student.remembered[1].goal = vec![-3.0, 0.0];
    class.learn();
    assert_eq!(class.propose().unwrap().score, Some(3.0));
}

#[test]
fn the_share_of_replays_grows_with_the_share_of_the_pool_that_is_seen() {
    let mut class = class("", 100);
    for _ in 0..40 {
        class.propose().unwrap();
        class.learn();
    }
    let seen = class.statistic("seen_goals");
    class.propose().unwrap();
    let unseen = (1.0 - seen / 100.0) / (100.0 - seen);
    let weights = class.weights();
    let of_unseen = weights.iter().filter(|&&weight| (weight - unseen).abs() < 1e-12).count() as f64;
    assert!(seen > 10.0 && of_unseen >= 100.0 - seen, "{of_unseen} of {}", 100.0 - seen);
}

#[test]
fn stale_goals_come_back() {
    let mut class = class("staleness = 1.0\nschedule = \"fixed\"\nreplay = 0.5", 3);
    class.cycles(60);
    assert_eq!(class.statistic("seen_goals"), 3.0);
    let last = class.cycles(2);
    class.propose().unwrap();
    // The last goal is not stale at all; the one before has waited for one episode if it is another.
    assert_eq!(class.weights()[last[1]], 0.0);
}

#[test]
fn a_positive_score_counts_values_that_are_too_low() {
    let score = |config: &str| {
        let mut class = class(config, 1);
        class.student.surprise = |_, _| 0.5;
        class.cycles(1);
        class.propose().unwrap().score
    };
    assert_eq!(score("score = \"absolute\""), Some(0.5));
    assert_eq!(score("score = \"positive\""), Some(0.25), "every other error is below 0");
}
