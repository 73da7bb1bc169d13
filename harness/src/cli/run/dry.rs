//! `goalbench run --dry-run`: the plan as text, and what it would take.

use std::path::Path;
use std::time::Duration;

use agents::Device;
use reports::wording::{counted, counted_u64};

use super::phase::{conduct, decide, threads};
use super::{Args, Executor};
use crate::Registry;
use crate::cli::{Exit, complain, print};
use crate::error::HarnessError;
use crate::estimate::{Estimates, Pace};
use crate::pace::{self, human};
use crate::protocol::plan::{Plan, PlannedRun};
use crate::sweep::cohort::cohorts;
use crate::sweep::{Conduct, ExitCode, Job, Sweep, local};

/// How long speeds are measured on a device; what takes longer is estimated from the rest.
const PATIENCE: Duration = Duration::from_secs(45);

/// Prints the plan, then measures how fast each kind of run is here and prints what the open runs would take:
/// on the cores and, where one can be used, on the GPU, whichever the plan asks for.
pub(super) fn dry_run(registry: &Registry, args: &Args, plan: &Plan, sweep: &Sweep, results: &Path) -> Exit {
    let gpu = local::device::try_out();
    let needs_gpu = sweep.open().any(|job| job.config.student.device == Device::Cuda);
    if gpu.is_ok() || !needs_gpu || args.executor == Executor::Slurm {
        // So that it refuses what would be refused.
        decide(registry, args, sweep.open())?;
    }
    print(&describe(plan, sweep, results));
    if sweep.open().next().is_none() {
        return Ok(ExitCode::Success);
    }
    for device in [Device::Cpu, Device::Cuda] {
        match (device, &gpu) {
            (Device::Cuda, Err(HarnessError::Device { reason })) => {
                let needs =
                    "what they would take on a GPU can only be measured on one, and none can be used here";
                print(&format!("{needs}: {reason}\n"));
                continue;
            }
            (Device::Cuda, Err(_)) => return gpu.map(|()| ExitCode::Success),
            _ => {}
        }
        let open = sweep.jobs().iter().zip(&plan.runs).filter(|(job, _)| job.is_open());
        let (jobs, runs): (Vec<Job>, Vec<PlannedRun>) = open.map(|open| on(device, open)).unzip();
        let lanes = args.lanes.decide(registry, jobs.iter(), false, threads(args, jobs.len()))?;
        if let Some(note) = &lanes.note {
            complain(&format!("goalbench: {note}"));
        }
        let conduct = conduct(args, &lanes, jobs.len());
        let cohorts = cohorts(&jobs, conduct.lanes);
        let cohorts = cohorts.iter().map(|cohort| cohort.iter().map(|&index| runs[index].clone()).collect());
        price(device, &cohorts.collect::<Vec<_>>(), conduct)?;
    }
    Ok(ExitCode::Success)
}

/// The same run with its student on `device`.
fn on(device: Device, (job, run): (&Job, &PlannedRun)) -> (Job, PlannedRun) {
    let (mut job, mut run) = (job.clone(), run.clone());
    for config in [&mut job.config, &mut run.config] {
        config.student = config.student.clone().on(device);
    }
    (job, run)
}

/// Prints what `cohorts` would take on `device`, where they live already.
fn price(device: Device, cohorts: &[Vec<PlannedRun>], conduct: Conduct) -> Result<(), HarnessError> {
    let workers = conduct.workers.min(cohorts.len());
    let unit = if conduct.lanes > 1 { "cohort" } else { "run" };
    if conduct.lanes > 1 {
        let (all, most) = (counted(cohorts.len(), unit), counted(conduct.lanes, "run"));
        print(&format!("{all} of up to {most} in lockstep, {workers} at a time\n"));
    }
    let (kinds, patience) = (Estimates::kinds(cohorts), PATIENCE.as_secs());
    complain(&format!(
        "goalbench: measuring the speed of {} of {unit}, three cycles each, for at most {patience} s",
        counted(kinds, "kind")
    ));
    let pace = Pace { workers, threads: conduct.threads, patience: PATIENCE };
    let estimates = Estimates::measure(cohorts, pace)?;
    match estimates.measured() {
        0 => {
            complain("goalbench: none came through in that time, so there is no estimate");
            return Ok(());
        }
        measured if measured < kinds => complain(&format!(
            "goalbench: {measured} of {} came through in that time; the others count as fast as those most like them",
            counted(kinds, "kind")
        )),
        _ => {}
    }
    let priced = cohorts.iter().filter_map(|cohort| Some((cohort.len(), estimates.seconds(cohort)?)));
    let priced: Vec<(usize, f64)> = priced.collect();
    let longest = priced.iter().map(|&(_, seconds)| seconds).fold(0.0, f64::max);
    let total: f64 = priced.iter().map(|(_, seconds)| seconds).sum();
    // No schedule is shorter than its longest part.
    let wall = (total / workers as f64).max(longest);
    let time = |seconds: f64| human(pace::seconds(seconds));
    print(&match device {
        Device::Cpu => {
            let cores = priced.iter().map(|&(runs, seconds)| conduct.threads.min(runs) as f64 * seconds);
            let cores: f64 = cores.sum();
            format!(
                "at this machine's speed, from their beginning: {:.1} core-hours ({}), {} with {workers} side by side; \
                 longest {unit} {}\n",
                cores / 3600.0,
                time(cores),
                time(wall),
                time(longest),
            )
        }
        Device::Cuda => format!(
            "on this machine's GPU, from their beginning: {:.1} GPU-hours ({}); longest {unit} {}\n",
            total / 3600.0,
            time(total),
            time(longest)
        ),
    });
    Ok(())
}

/// The plan as text: a line per cell with its seeds and steps, then the sums.
fn describe(plan: &Plan, sweep: &Sweep, results: &Path) -> String {
    let mut cells: Vec<(String, Vec<String>, u64)> = Vec::new();
    for job in sweep.jobs() {
        let run = job.run();
        let name = format!("{}/{}/{}", run.environment, run.curriculum, run.variant);
        let seed = run.seed.to_string();
        match cells.iter_mut().find(|(known, ..)| *known == name) {
            Some((_, seeds, _)) => seeds.push(seed),
            None => cells.push((name, vec![seed], job.steps())),
        }
    }
    let mut text = format!("protocol {}, results in {}\n", plan.name, results.display());
    for (name, seeds, steps) in &cells {
        text += &format!("  {name:<56} {steps:>9} steps, seeds {}\n", seeds.join(","));
    }
    let steps = |jobs: &[&Job]| jobs.iter().map(|job| job.steps()).sum::<u64>();
    let (all, open): (Vec<&Job>, Vec<&Job>) = (sweep.jobs().iter().collect(), sweep.open().collect());
    text += &format!(
        "{}, {}; {} ({}) still to do\n",
        counted(all.len(), "run"),
        counted_u64(steps(&all), "training step"),
        counted(open.len(), "run"),
        counted_u64(steps(&open), "step")
    );
    text
}
