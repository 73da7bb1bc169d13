//! What a step costs beside the physics it consists of.
//!
//! `cargo bench --package envs` first prints, for one environment of each kind, the cost of a step and of the
//! 20 `mj_step` calls in it, on the same states of one episode, and their ratio; then criterion's `step` and
//! `reset`. The ratio takes the fastest of many repetitions of each step, so that other processes do not
//! disturb it.

#![expect(clippy::print_stdout, reason = "a benchmark prints what it measured")]

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group};
use envs::rng::{Purpose, stream};
use envs::{EnvOptions, GoalEnv, SimulationStart, Start, make};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use rand::Rng as _;

/// The largest ratio that the project allows.
const LIMIT: f64 = 1.10;
/// Repetitions of the episode.
const REPETITIONS: usize = 25;
/// `mj_step` calls in a step.
const SUBSTEPS: usize = 20;

/// One environment of each kind, and its model.
const SIMULATED: [(&str, &str); 7] = [
    ("FetchReach", "fetch/reach.xml"),
    ("FetchPush", "fetch/push.xml"),
    ("FetchPickAndPlace", "fetch/pick_and_place.xml"),
    ("HandReach", "hand/reach.xml"),
    ("HandManipulateBlock", "hand/manipulate_block.xml"),
    ("HandManipulatePen", "hand/manipulate_pen.xml"),
    ("HandManipulateEgg", "hand/manipulate_egg.xml"),
];

fn build(id: &str) -> Box<dyn GoalEnv> {
    make(id, &EnvOptions::default()).expect("the environment can be built")
}

fn actions(env: &dyn GoalEnv) -> Vec<Vec<f64>> {
    let mut rng = stream(0, Purpose::Exploration);
    let mut action = || (0..env.spec().action).map(|_| rng.random_range(-1.0..1.0)).collect();
    (0..env.spec().horizon).map(|_| action()).collect()
}

fn capture(env: &mut dyn GoalEnv) -> SimulationStart {
    match env.playback().map(|env| env.capture()) {
        Some(Start::Simulation(state)) => state,
        _ => unreachable!("a simulated environment"),
    }
}

/// The model as the environments use it.
fn load(file: &str) -> MjModel {
    let path = Path::new(env!("GOALBENCH_NATIVE")).join("assets").join(file);
    let mut model = MjModel::from_xml(path).expect("the model can be loaded");
    model.opt_mut().disableflags |= 1 << 17;
    for weld in model.eq_data_mut() {
        weld[..7].copy_from_slice(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }
    model
}

/// The time of the physics alone from `start`.
fn time_physics(data: &mut MjData<&MjModel>, start: &SimulationStart) -> Duration {
    data.reset();
    data.qpos_mut().copy_from_slice(&start.qpos);
    data.qvel_mut().copy_from_slice(&start.qvel);
    data.ctrl_mut().copy_from_slice(&start.ctrl);
    data.mocap_pos_mut().copy_from_slice(&start.mocap_pos);
    data.mocap_quat_mut().copy_from_slice(&start.mocap_quat);
    data.forward();
    let began = Instant::now();
    for _ in 0..SUBSTEPS {
        data.step();
    }
    began.elapsed()
}

/// The mean times of a step and of its physics over an episode, each step's the fastest of all repetitions.
/// The two are timed in turns.
fn time(id: &str, file: &str) -> [Duration; 2] {
    let mut env = build(id);
    let model = load(file);
    let mut data = model.make_data();
    let actions = actions(env.as_ref());
    let mut fastest = vec![[Duration::MAX; 2]; actions.len()];
    for _ in 0..REPETITIONS {
        env.reset(&mut stream(0, Purpose::Environment)).expect("a stable start");
        for (action, [fastest_step, fastest_physics]) in actions.iter().zip(&mut fastest) {
            let before = capture(env.as_mut());
            let began = Instant::now();
            env.step(action).expect("a stable step");
            *fastest_step = began.elapsed().min(*fastest_step);
            // Position and velocity from before, the controls that the action set.
            let start = SimulationStart { qpos: before.qpos, qvel: before.qvel, ..capture(env.as_mut()) };
            *fastest_physics = time_physics(&mut data, &start).min(*fastest_physics);
        }
    }
    let steps = u32::try_from(fastest.len()).expect("episodes are short");
    [0, 1].map(|which| fastest.iter().map(|pair| pair[which]).sum::<Duration>() / steps)
}

/// Prints the table; whether every ratio is within the limit.
fn print_ratios() -> bool {
    println!("{:<20} {:>10} {:>12} {:>8}", "environment", "step, µs", "physics, µs", "ratio");
    let mut within = true;
    for (id, file) in SIMULATED {
        let [step, physics] = time(id, file).map(|time| time.as_secs_f64() * 1e6);
        println!("{id:<20} {step:>10.1} {physics:>12.1} {:>8.3}", step / physics);
        within &= step / physics <= LIMIT;
    }
    within
}

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    for id in ["Point", "MazeA", "FetchReach", "HandManipulateBlock"] {
        let mut env = build(id);
        let actions = actions(env.as_ref());
        env.reset(&mut stream(0, Purpose::Environment)).expect("a stable start");
        let mut next = actions.iter().cycle();
        group.bench_function(id, |bencher| {
            bencher.iter(|| env.step(black_box(next.next().expect("a cycle has no end"))));
        });
    }
}

fn reset(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("reset");
    for id in ["MazeA", "FetchReach", "FetchPush", "HandReach", "HandManipulateBlock"] {
        let (mut env, mut rng) = (build(id), stream(0, Purpose::Environment));
        group.bench_function(id, |bencher| bencher.iter(|| env.reset(&mut rng)));
    }
}

criterion_group!(
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(2));
    targets = step, reset
);

fn main() {
    let within = print_ratios();
    benches();
    Criterion::default().configure_from_args().final_summary();
    assert!(within, "a step costs more than {LIMIT} times its physics");
}
