//! Drawing a batch must not allocate: a run draws hundreds of thousands of them.

#[path = "support/mod.rs"]
mod support;

use agents::{Batch, Replay, Source, StudentConfig};
use envs::rng::{Purpose, stream};
use envs::testing::{CountingAllocator, allocations};
use support::{FETCH, Still, random_episode};

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

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
