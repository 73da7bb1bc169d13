//! A step must not allocate: runs take millions of them.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use envs::rng::{Purpose, stream};
use envs::{EnvOptions, environments};

/// Counts this thread's allocations.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

#[expect(unsafe_code, reason = "a global allocator is an unsafe trait; this one only counts and passes on")]
// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) };
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

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
