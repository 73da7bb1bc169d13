//! A step must not allocate: runs take millions of them.

#[path = "../../ci/allocations.rs"]
mod allocations;

use envs::rng::{Purpose, stream};
use envs::{EnvOptions, environments};

#[test]
fn stepping_rewarding_and_sampling_goals_do_not_allocate() {
    for row in environments() {
        let mut env = row.make(&EnvOptions::default()).unwrap();
        let mut rng = stream(0, Purpose::Environment);
        env.reset(&mut rng).unwrap();
        let action = vec![0.5; row.spec.action];
        let mut goal = vec![0.0; row.spec.goal];
        let count = allocations::count(|| {
            for _ in 0..row.spec.horizon {
                env.step(&action).unwrap();
                env.sample_goal(&mut rng, &mut goal);
                env.set_goal(&goal).unwrap();
                std::hint::black_box(env.reward(&env.observation().achieved, env.goal()));
            }
        });
        assert_eq!(count, 0, "{}", row.spec.id);
    }
}
