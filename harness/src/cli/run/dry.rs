//! `goalbench run --dry-run`: the plan as text, and what it would take.

use std::path::Path;
use std::time::Duration;

use reports::wording::{counted, counted_u64};

use crate::cli::{Exit, complain, print};
use crate::estimate::Estimates;
use crate::pace::{self, human};
use crate::protocol::plan::{Plan, PlannedRun};
use crate::sweep::cohort::cohorts;
use crate::sweep::{Conduct, ExitCode, Job, Sweep};

/// How long speeds are measured; what takes longer is estimated from the rest.
const PATIENCE: Duration = Duration::from_secs(45);

/// Prints the plan, then measures how fast each kind of run is here and prints what the open runs would take.
pub(super) fn dry_run(plan: &Plan, sweep: &Sweep, results: &Path, conduct: Conduct) -> Exit {
    let parallel = conduct.threads.saturating_mul(conduct.workers).min(sweep.open().count().max(1));
    print(&describe(plan, sweep, results));
    if conduct.lanes > 1 {
        let together = cohorts(sweep.jobs(), conduct.lanes);
        let open = together.iter().filter(|cohort| sweep.jobs()[cohort[0]].is_open()).count();
        print(&format!(
            "{} of up to {} in lockstep, {} at a time\n",
            counted(open, "cohort"),
            counted(conduct.lanes, "run"),
            conduct.workers.min(open.max(1))
        ));
    }
    let open = sweep.jobs().iter().zip(&plan.runs).filter(|(job, _)| job.is_open());
    let open: Vec<PlannedRun> = open.map(|(_, run)| run.clone()).collect();
    if open.is_empty() {
        return Ok(ExitCode::Success);
    }
    let (kinds, patience) = (Estimates::kinds(&open), PATIENCE.as_secs());
    complain(&format!(
        "goalbench: measuring the speed of {} of run, three cycles each, for at most {patience} s",
        counted(kinds, "kind")
    ));
    let estimates = Estimates::measure(&open, parallel, PATIENCE)?;
    match estimates.measured() {
        0 => {
            complain("goalbench: none came through in that time, so there is no estimate");
            return Ok(ExitCode::Success);
        }
        measured if measured < kinds => complain(&format!(
            "goalbench: {measured} of {} came through in that time; the others count as fast as those most like them",
            counted(kinds, "kind")
        )),
        _ => {}
    }
    let seconds: Vec<f64> = open.iter().filter_map(|run| estimates.seconds(run)).collect();
    let longest = seconds.iter().copied().fold(0.0, f64::max);
    let total: f64 = seconds.iter().sum();
    // No schedule is shorter than its longest run.
    let wall = (total / parallel as f64).max(longest);
    let time = |seconds: f64| human(pace::seconds(seconds));
    print(&format!(
        "at this machine's speed, from their beginning: {:.1} core-hours ({}), {} with {parallel} side by side; longest \
         run {}\n",
        total / 3600.0,
        time(total),
        time(wall),
        time(longest),
    ));
    Ok(ExitCode::Success)
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
