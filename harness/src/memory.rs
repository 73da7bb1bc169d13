//! How much memory a run may come to hold, from the shapes in its config: told before it starts.

use std::fs;

use agents::{Replay, StudentConfig};
use envs::Spec;

use crate::config::RunConfig;

/// What a process holds before it trains: program, libraries, physics, environments. Measured: 150 to 250 MB
/// (`harness/docs/performance.md`).
const PROCESS: u64 = 200_000_000;
/// What a process holds of a GPU besides its lanes: its context and libtorch's kernels, and for every thread
/// that computes there a cuBLAS handle with its workspace. Measured on an H100 with CUDA 13: 35 lanes of
/// MazeA with 16 threads held 3.6 GB, and in two halves with twice as many threads 5.2 GB, of which the lanes
/// have 1.0 GB by their shapes.
const GPU_PROCESS: u64 = 1_000_000_000;
const GPU_THREAD: u64 = 100_000_000;
/// Copies of a network's weights: trained, target, gradients, and Adam's two averages.
const COPIES: u64 = 5;

/// About how many bytes a run on the task `spec` holds at its end, which is when it holds most.
pub fn of_run(config: &RunConfig, spec: &Spec) -> u64 {
    let needs = [PROCESS, replay(config, spec), networks(&config.student, spec), values(config, spec)];
    needs.into_iter().fold(0, u64::saturating_add)
}

/// The replay buffer, as full as the budget makes it.
fn replay(config: &RunConfig, spec: &Spec) -> u64 {
    let horizon = spec.horizon as u64;
    let transitions =
        (config.student.replay_capacity as u64).min(config.budget.steps.saturating_add(horizon));
    let transitions = usize::try_from(transitions).unwrap_or(usize::MAX);
    Replay::new(spec, transitions).map_or(0, |replay| replay.capacity_bytes())
}

/// The student's actor and critic.
fn networks(student: &StudentConfig, spec: &Spec) -> u64 {
    let width = student.width as u64;
    let inputs = (spec.state + spec.goal + spec.action) as u64;
    let between = width.saturating_mul(width).saturating_mul(student.layers(spec).saturating_sub(1) as u64);
    let weights = width.saturating_mul(inputs).saturating_add(between);
    weights.saturating_mul(2 * COPIES * size_of::<f32>() as u64)
}

/// About how many bytes a lane on the task `spec` takes of a GPU's memory: networks, and the buffers that
/// they are trained and asked with, of its teacher's ensemble as well. Worked out from the shapes alone.
pub fn on_gpu(config: &RunConfig, spec: &Spec) -> u64 {
    let student = &config.student;
    // Every hidden layer's activations and two gradients, and the two networks' inputs.
    let columns = (student.width as u64)
        .saturating_mul(student.layers(spec) as u64 + 2)
        .saturating_add(2 * (spec.state + spec.goal + spec.action) as u64);
    let buffers = |rows: u64| rows.saturating_mul(columns).saturating_mul(size_of::<f32>() as u64);
    // Actor and critic: for its own steps, in the stack of its cohort, and for questions.
    let rows = 2 * (2 * student.batch() as u64 + agents::ROWS_ASKED_AFAR as u64);
    let number = |name: &str| {
        let numbers = config.curriculum.values().filter_map(|own| own.get(name)?.as_integer());
        numbers.max().and_then(|number| u64::try_from(number).ok())
    };
    let members = number("members").unwrap_or(0);
    let batch = number("batch").unwrap_or(student.batch() as u64);
    let ensemble = (networks(student, spec) / 2).saturating_add(buffers(batch + 1024));
    [networks(student, spec).saturating_mul(2), buffers(rows), members.saturating_mul(ensemble)]
        .into_iter()
        .fold(0, u64::saturating_add)
}

/// About how many bytes of a GPU's memory a process takes beside its lanes, if so many threads compute there.
pub fn on_gpu_besides(threads: usize) -> u64 {
    GPU_PROCESS.saturating_add(GPU_THREAD.saturating_mul(threads as u64))
}

/// The values that a teacher with a window keeps of every goal of the pool.
fn values(config: &RunConfig, spec: &Spec) -> u64 {
    let windows = config.curriculum.values().filter_map(|own| own.get("window")?.as_integer());
    let window = windows.max().and_then(|window| u64::try_from(window).ok()).unwrap_or(0);
    let cycle = (config.student.episodes_per_cycle() * spec.horizon).max(1) as u64;
    let kept = window.min(config.budget.steps.div_ceil(cycle));
    kept.saturating_mul(config.pool.size as u64).saturating_mul(size_of::<f64>() as u64)
}

/// Bytes that this machine could give now; `None` where the system does not tell.
pub fn available() -> Option<u64> {
    let info = fs::read_to_string("/proc/meminfo").ok()?;
    let line = info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// What is to be said before runs of these sizes are carried out, `parallel` of them side by side, on a
/// machine that can give `available` bytes; `None` if they fit.
pub fn warning(mut sizes: Vec<u64>, parallel: usize, available: u64) -> Option<String> {
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    let together = sizes.iter().take(parallel).fold(0, |sum: u64, size| sum.saturating_add(*size));
    let gigabytes = |bytes: u64| format!("{:.1} GB", bytes as f64 / 1e9);
    (together > available).then(|| {
        format!(
            "{} side by side may come to hold {} of memory, the largest of them {}, and this machine has {} to give; fewer \
             --jobs or a smaller student.replay_capacity need less",
            parallel.min(sizes.len()),
            gigabytes(together),
            gigabytes(sizes[0]),
            gigabytes(available)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_does_not_fit_is_told() {
        assert_eq!(warning(vec![1_000, 2_000, 3_000], 2, 5_000), None);
        let text =
            warning(vec![1_000_000_000, 3_000_000_000, 2_000_000_000], 2, 4_999_999_999).expect("too large");
        for part in ["2 side by side", "5.0 GB of memory", "the largest of them 3.0 GB", "5.0 GB to give"] {
            assert!(text.contains(part), "{text}");
        }
        assert_eq!(warning(Vec::new(), 2, 0), None);
        assert!(available().is_some_and(|bytes| bytes > 0));
    }

    /// A student of 2 × 256 on FetchPush by hand: 2 copies of its 5 × 2 × (256 · 32 + 256²) numbers, and 2 ·
    /// (2 · 1024 + 1024) rows of 4 · 256 + 64. VDS adds three critics with 2048 rows each.
    #[test]
    fn a_lane_on_a_gpu_by_hand() {
        let registry = crate::Registry::builtin();
        let size = |curriculum: &str| {
            let mut protocol = crate::protocol::Protocol::from_options();
            protocol.environments = vec!["FetchPush".to_owned()];
            protocol.curricula = vec![curriculum.to_owned()];
            let plan = crate::protocol::plan::Plan::new(&protocol, &registry).expect("a valid plan");
            on_gpu(&plan.runs[0].config, &registry.environment("FetchPush").expect("built in").spec)
        };
        let networks = 2 * 4 * 5 * 2 * (256 * 32 + 256 * 256);
        let plain = networks + 4 * (4096 + 2 * 8192) * (4 * 256 + 64);
        assert_eq!(size("teach"), plain);
        assert_eq!(size("vds"), plain + 3 * (networks / 4 + 4 * 2048 * (4 * 256 + 64)));
    }

    #[test]
    fn every_part_grows_with_its_fields() {
        let registry = crate::Registry::builtin();
        let size = |set: &str| {
            let mut protocol = crate::protocol::Protocol::from_options();
            protocol.environments = vec!["Point".to_owned()];
            protocol.curricula = vec!["teach".to_owned()];
            for assignment in set.split_whitespace() {
                let layer = crate::config::layer::ConfigLayer::from_assignment("--set", assignment);
                protocol.set(layer.expect("an assignment"));
            }
            let plan = crate::protocol::plan::Plan::new(&protocol, &registry).expect("a valid plan");
            of_run(&plan.runs[0].config, &registry.environment("Point").expect("built in").spec)
        };
        let plain = size("budget.steps=1000");
        assert!(plain < 250_000_000, "{plain}");
        assert!(size("budget.steps=1000000000 student.replay_capacity=1000000000") > 1_000_000_000);
        assert!(size("student.width=8192") > plain + 2_000_000_000);
        assert!(
            size(
                "budget.steps=10000000 pool.size=1000000 curriculum.teach.window=10000 curriculum.teach.renewal=10000"
            ) > 10_000_000_000
        );
    }
}
