//! What the student costs besides the matrix products that no implementation can avoid, on one thread, at
//! batch 1024:
//!
//! - `update/L x256/to its products`: a gradient step on a batch as a multiple of its bare products, measured
//!   in turn so that both meet the same machine (at most 1.15 is wanted);
//! - `precision/L x256/bf16 to f32`: a gradient step with products in bf16 as a multiple of one in singles
//!   (at most 0.35 is wanted where the processor has AMX, 0.62 where it has AVX512-BF16; elsewhere it is
//!   slower);
//! - `lanes/8 to 8 alone`: a cycle of eight students in lockstep as a multiple of the cycles of eight
//!   students alone, in turn, on one thread (at most 1.05 is wanted);
//! - `replay/sampling to an update`: the share of a full replay buffer's sampling in a gradient step (at most
//!   0.05);
//! - `act/one observation` (at most 20 µs) and `confidence/1000 goals`: times.

#[path = "../../tests/support/mod.rs"]
mod support;

mod ratio;

use std::hint::black_box;
use std::time::Duration;

use agents::{
    Agent, Auto, Batch, CohortLane, Mode, Network, Precision, Products, Replay, Source, StudentConfig,
    make_cohort,
};
use cpu_time::ThreadTime;
use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use envs::Observation;
use envs::rng::{Purpose, stream};
use ratio::Ratio;
use support::{FETCH, Still, random_episode, random_rows};

/// Transitions per gradient step.
const BATCH: usize = 1024;

/// Episodes that the student has seen.
const EPISODES: usize = 500;

/// A buffer that holds `episodes` episodes.
fn replay(episodes: usize) -> Replay {
    let mut rng = stream(0, Purpose::Replay);
    let mut replay = Replay::new(&FETCH, 1_000_000).expect("room");
    for _ in 0..episodes {
        replay.push(&random_episode(&FETCH, &mut rng)).expect("an episode of this task");
    }
    replay
}

/// A student with some experience.
fn student(config: &StudentConfig) -> Box<dyn Agent> {
    let mut student = agents::make(config, &FETCH, 0).expect("a student");
    let (env, mut rng) = (Still::new(FETCH), stream(0, Purpose::Replay));
    for _ in 0..EPISODES {
        let episode = random_episode(&FETCH, &mut rng);
        student.observe(&episode, &env, &mut rng).expect("an episode of this task");
    }
    student
}

/// Processor time that `work` takes. It never waits, so processor time and wall-clock time differ only if
/// other processes use the machine.
fn timed(work: impl FnOnce()) -> Duration {
    let start = ThreadTime::now();
    work();
    start.elapsed()
}

/// A short cycle of the student against the products of as many updates, in turn. The cycle includes its
/// Polyak update; the time for drawing its batches, measured on a buffer of the same episodes, is subtracted.
///
/// A real cycle takes ten times as many gradient steps. Short ones alternate so often that a change in the
/// machine's speed slows both sides alike.
fn update(criterion: &mut Criterion<Ratio>) {
    agents::prepare_thread();
    for layers in [2, 3] {
        let mut group = criterion.benchmark_group(format!("update/{layers}x256"));
        group.sampling_mode(SamplingMode::Flat).sample_size(20).measurement_time(Duration::from_secs(30));
        let config =
            StudentConfig { layers: Auto::Value(layers), updates_per_cycle: 4, ..StudentConfig::default() };
        let products = Products::new(&config, &FETCH).expect("memory");
        let mut student = student(&config);
        let (env, mut rng) = (Still::new(FETCH), stream(0, Purpose::Replay));
        let replay = replay(EPISODES);
        let mut batch = Batch::new(&FETCH, BATCH);
        group.bench_function("to its products", |bencher| {
            bencher.iter_custom(|times| {
                let ratio = |_| {
                    let bare = timed(|| {
                        (0..config.updates_per_cycle).for_each(|_| products.run().expect("products"))
                    });
                    let whole = timed(|| student.learn(&env, &mut rng).expect("finite"));
                    let drawing = timed(|| {
                        for _ in 0..config.updates_per_cycle {
                            replay
                                .sample(Source::All, config.hindsight(), &env, &mut rng, &mut batch)
                                .expect("transitions");
                        }
                    });
                    (whole - drawing).as_secs_f64() / bare.as_secs_f64()
                };
                (0..times).map(ratio).sum()
            });
        });
    }
}

/// A short cycle of a student in bf16 against one of a student in f32, in turn, without the time for drawing
/// batches.
fn precision(criterion: &mut Criterion<Ratio>) {
    agents::prepare_thread();
    for layers in [2, 3] {
        let mut group = criterion.benchmark_group(format!("precision/{layers}x256"));
        group.sampling_mode(SamplingMode::Flat).sample_size(20).measurement_time(Duration::from_secs(30));
        let config = |precision| StudentConfig {
            layers: Auto::Value(layers),
            updates_per_cycle: 4,
            precision,
            ..StudentConfig::default()
        };
        let mut students = [Precision::Bf16, Precision::F32].map(|precision| student(&config(precision)));
        let (env, mut rng) = (Still::new(FETCH), stream(0, Purpose::Replay));
        group.bench_function("bf16 to f32", |bencher| {
            bencher.iter_custom(|times| {
                let mut learning = |student: &mut Box<dyn Agent>| {
                    let drawn = student.sampling_time().unwrap_or_default();
                    let whole = timed(|| student.learn(&env, &mut rng).expect("finite"));
                    whole.saturating_sub(student.sampling_time().unwrap_or_default() - drawn).as_secs_f64()
                };
                let [rounded, single] = &mut students;
                (0..times).map(|_| learning(rounded) / learning(single)).sum()
            });
        });
    }
}

/// A short cycle of eight students in lockstep against those of eight others, one after the other.
fn lanes(criterion: &mut Criterion<Ratio>) {
    const LANES: usize = 8;
    // A thread of its own, so that neither side has another to spread to.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let config = StudentConfig { updates_per_cycle: 4, ..StudentConfig::default() };
    let students = || -> Vec<_> {
        agents::prepare_thread();
        (0..LANES).map(|_| (student(&config), stream(0, Purpose::Replay))).collect()
    };
    let (mut alone, mut together) = (students(), students());
    let mut cohort = make_cohort(&config, LANES).expect("a known agent");
    let env = Still::new(FETCH);
    let mut group = criterion.benchmark_group("lanes");
    group.sampling_mode(SamplingMode::Flat).sample_size(20).measurement_time(Duration::from_secs(60));
    group.bench_function("8 to 8 alone", |bencher| {
        bencher.iter_custom(|times| {
            let mut ratio = || {
                agents::prepare_thread();
                let apart = timed(|| {
                    for (student, rng) in &mut alone {
                        student.learn(&env, rng).expect("finite");
                    }
                });
                let beside = timed(|| {
                    let mut lanes: Vec<CohortLane<'_>> = together
                        .iter_mut()
                        .map(|(student, rng)| CohortLane { student: student.as_mut(), reward: &env, rng })
                        .collect();
                    assert!(cohort.learn(&mut lanes).iter().all(Result::is_ok), "finite");
                });
                beside.as_secs_f64() / apart.as_secs_f64()
            };
            pool.install(|| (0..times).map(|_| ratio()).sum())
        });
    });
}

/// Drawing a batch from a full buffer against learning from it.
fn sampling(criterion: &mut Criterion<Ratio>) {
    agents::prepare_thread();
    let (env, mut rng) = (Still::new(FETCH), stream(0, Purpose::Replay));
    let replay = replay(20_000);
    let mut batch = Batch::new(&FETCH, BATCH);
    let config = StudentConfig { updates_per_cycle: 1, ..StudentConfig::default() };
    let mut student = student(&config);
    let mut group = criterion.benchmark_group("replay");
    group.sampling_mode(SamplingMode::Flat).sample_size(20);
    group.bench_function("sampling to an update", |bencher| {
        bencher.iter_custom(|times| {
            let ratio = |_| {
                let sample = timed(|| {
                    replay
                        .sample(Source::All, config.hindsight(), &env, &mut rng, &mut batch)
                        .expect("transitions");
                });
                let update = timed(|| student.learn(&env, &mut rng).expect("finite"));
                sample.as_secs_f64() / update.as_secs_f64()
            };
            (0..times).map(ratio).sum()
        });
    });
}

fn questions(criterion: &mut Criterion) {
    agents::prepare_thread();
    let mut student = student(&StudentConfig::default());
    let mut rng = stream(0, Purpose::Pool);
    let observation = Observation { state: vec![0.1; FETCH.state], achieved: vec![0.1; FETCH.goal] };
    let (goal, mut action) = (vec![0.2; FETCH.goal], vec![0.0; FETCH.action]);
    criterion.bench_function("act/one observation", |bencher| {
        bencher.iter(|| student.act(black_box(&observation), &goal, Mode::Greedy, &mut action));
    });
    let goals = random_rows(1000, FETCH.goal, &mut rng);
    let states = random_rows(1, FETCH.state, &mut rng);
    criterion.bench_function("confidence/1000 goals", |bencher| {
        bencher.iter(|| student.confidence(&goals, &states, Network::Online));
    });
}

criterion_group! {
    name = ratios;
    config = Criterion::default().with_measurement(Ratio);
    targets = update, precision, lanes, sampling
}
criterion_group!(times, questions);
criterion_main!(ratios, times);
