//! SFL: what it asks for, what it keeps, and how often it trains on that.

use curricula::testing::Class;
use curricula::{ProposedGoal, RolloutPolicy};

/// Goals on the left succeed every other time, those on the right never.
fn left_every_other_time(goal: &[f64], _steps: u64) -> f64 {
    if goal[0] < 0.0 { 0.5 } else { 0.0 }
}

#[test]
fn the_most_learnable_candidates_are_trained_on_every_other_time() {
    let mut class = Class::new("sfl", "candidates = 60\nkept = 10", 1, |_, _| -10.0);
    class.mastery = left_every_other_time;
    let before: Vec<_> = (0..20).map(|_| class.propose().unwrap()).collect();
    assert!(before.iter().all(|proposal| proposal.goal == ProposedGoal::Native), "nothing is measured yet");
    class.learn_alone();
    let request = class.request().expect("the first measurement follows the first cycle");
    assert_eq!((request.goals.len(), request.episodes), (60, 4));
    assert_eq!((request.policy, request.charge), (RolloutPolicy::Noisy, true));
    let left: Vec<Vec<f64>> =
        request.goals.iter().filter(|goal| goal[0] < 0.0).map(<[f64]>::to_vec).collect();
    assert!(left.len() > 10, "there are more than are kept");
    class.play(&request);
    let mut chosen = Vec::new();
    for _ in 0..2_000 {
        let proposal = class.propose().unwrap();
        if let ProposedGoal::Other(goal) = proposal.goal {
            assert_eq!(proposal.score, Some(0.25), "p = 1/2");
            chosen.push(goal);
        }
    }
    assert!((900..1100).contains(&chosen.len()), "1000 expected, {} came", chosen.len());
    for goal in &left[..10] {
        let times = chosen.iter().filter(|chosen| *chosen == goal).count();
        assert!((60..150).contains(&times), "100 expected of each of the first ten, {times} came");
    }
    assert!(chosen.iter().all(|goal| left[..10].contains(goal)), "ties go to those drawn first");
    assert_eq!(class.statistic("measurements"), 1.0);
    assert_eq!(class.statistic("set_learnability"), 0.25);
    let expected = 0.5 * left.len() as f64 / 60.0;
    assert!((class.statistic("candidate_success") - expected).abs() < 1e-12);
}

#[test]
fn it_measures_again_after_the_interval_and_forgets_the_old_set() {
    let config = "interval = 6\ncandidates = 20\nkept = 3\nshare = 1.0\ncharge = false";
    let mut class = Class::new("sfl", config, 1, |_, _| -10.0);
    class.mastery = |goal, steps| if (goal[0] < 0.0) == (steps < 2) { 0.5 } else { 1.0 };
    let mut asked = Vec::new();
    for cycle in 1..=10 {
        (0..2).for_each(|_| drop(class.propose().unwrap()));
        class.learn_alone();
        if let Some(request) = class.request() {
            assert!(!request.charge);
            asked.push(cycle);
            class.play(&request);
        }
    }
    assert_eq!(asked, [1, 4, 7, 10], "after every sixth episode");
    for _ in 0..20 {
        assert!(
            class.propose_goal()[0] >= 0.0,
            "since the first measurement learnable goals lie on the right"
        );
    }
}

#[test]
fn candidates_are_kept_even_if_nothing_can_be_learned() {
    let mut class = Class::new("sfl", "share = 1.0\nkept = 2", 1, |_, _| -10.0);
    class.propose().unwrap();
    class.learn();
    assert_eq!((class.propose().unwrap().score, class.statistic("set_learnability")), (Some(0.0), 0.0));
}
