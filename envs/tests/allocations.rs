//! A step must not allocate: runs take millions of them.

use envs::rng::{Purpose, stream};
use envs::testing::{CountingAllocator, allocations};
use envs::{EnvOptions, environments};

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

#[test]
fn stepping_rewarding_and_sampling_goals_do_not_allocate() {
    assert_eq!(allocations(|| drop(std::hint::black_box(Box::new(1)))), 1, "the count counts");
    for row in environments() {
        let mut env = row.make(&EnvOptions::default()).unwrap();
        let mut rng = stream(0, Purpose::Environment);
        env.reset(&mut rng).unwrap();
        let action = vec![0.5; row.spec.action];
        let mut goal = vec![0.0; row.spec.goal];
        let count = allocations(|| {
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
