//! Drawing a batch must not allocate: a run draws hundreds of thousands of them.

#[path = "support/mod.rs"]
mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use agents::{Batch, Replay, Source, StudentConfig};
use envs::rng::{Purpose, stream};
use support::{FETCH, Still, random_episode};

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
fn sampling_with_hindsight_does_not_allocate() {
    assert_eq!(allocations(|| drop(std::hint::black_box(Box::new(1)))), 1, "the count counts");
    let (env, mut rng) = (Still::new(FETCH), stream(0, Purpose::Replay));
    let mut replay = Replay::new(&FETCH, 1000).unwrap();
    for _ in 0..30 {
        replay.push(&random_episode(&FETCH, &mut rng)).unwrap();
    }
    let hindsight = StudentConfig::default().hindsight();
    let mut batch = Batch::new(&FETCH, 1024);
    for source in [Source::All, Source::Newest] {
        let count = allocations(|| replay.sample(source, hindsight, &env, &mut rng, &mut batch).unwrap());
        assert_eq!(count, 0, "{source:?}");
    }
}
