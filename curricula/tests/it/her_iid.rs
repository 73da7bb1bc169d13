//! The baselines: the environment's own goals, fresh or from the pool.

use curricula::Proposal;
use curricula::testing::Class;

#[test]
fn her_iid_leaves_every_goal_to_the_environment() {
    let mut class = Class::new("her-iid", "", 4, |_, _| 0.0);
    let untouched = class.rng.clone();
    for _ in 0..10 {
        assert_eq!(class.propose().unwrap(), Proposal::native());
        class.learn();
    }
    assert_eq!(class.rng, untouched, "nothing is drawn");
    assert_eq!(class.teacher.summary().weights, None);
}

#[test]
fn her_iid_pool_draws_every_goal_of_the_pool_alike_whatever_the_student_thinks() {
    let mut class = Class::new("her-iid-pool", "", 5, |goal, steps| -(goal as f64) * steps as f64);
    let mut counts = [0u32; 5];
    class.cycles(5_000).into_iter().for_each(|goal| counts[goal] += 1);
    // Five standard deviations of a count, sqrt(5000 · 0.2 · 0.8) = 28.3.
    assert!(counts.iter().all(|&count| (f64::from(count) - 1_000.0).abs() < 142.0), "{counts:?}");
    assert_eq!(class.weights(), [0.2; 5]);
    assert!(class.student.asked.is_empty(), "the control looks at no network");
}
