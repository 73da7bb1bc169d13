//! `goalbench evaluate`.

mod find;
mod output;

use std::path::PathBuf;
use std::time::Duration;

use envs::rng::{Purpose, stream};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use reports::schema::RunKey;
use reports::store::cells::{CellMember, OddOne, odd_ones};
use reports::wording::counted;
use serde_json::Value;

use super::flags::{JobsFlag, QuietFlag, whole};
use super::{Exit, ExitCode, complain, print};
use crate::Registry;
use crate::console;
use crate::error::{HarnessError, chain};
use crate::run::evaluate::{LOCKSTEP, Tally, tally};
use crate::run::policy::Policy;
use find::{Chosen, Subject, find};

#[derive(clap::Args)]
#[command(after_help = "\
Each run's greedy policy as of its last checkpoint plays the same episodes: their starts and goals depend on \
environment, --seed and number alone, and no training run's own evaluations meet them. Nothing is written, and runs may \
be in progress.

Means are over seeds of one config: a run whose config differs from that of its cell is in none. Runs of a results \
folder that have no policy yet or are damaged are left out and named. Exit code 1 if a run is damaged or differs, \
none could be evaluated, or one given by itself failed.")]
pub(super) struct Args {
    /// Folders of runs (RESULTS/runs/.../seed-N), or results folders for all of their runs
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,
    /// Episodes of each run
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole::<u64>(1..=1_000_000))]
    episodes: u64,
    /// Seed of starts and goals
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole::<u64>(..))]
    seed: u64,
    #[command(flatten)]
    jobs: JobsFlag,
    #[command(flatten)]
    quiet: QuietFlag,
    /// Print a JSON object per run and line
    #[arg(long)]
    json: bool,
}

/// What was measured of a run.
struct Measured {
    folder: PathBuf,
    /// The results folder that the run belongs to.
    results: PathBuf,
    run: RunKey,
    /// The run's complete config.
    config: Value,
    /// Training steps behind the policy.
    step: u64,
    /// Training steps of the whole run.
    steps: u64,
    /// Whether its cell has another config.
    is_odd: bool,
    tally: Tally,
}

pub(super) fn evaluate(registry: &Registry, args: &Args) -> Exit {
    let Chosen { subjects, mut left_out, strays, hides_runs } = find(registry, &args.paths)?;
    let outcomes = measure_all(registry, &subjects, args)?;
    let (mut measured, mut broken) = (Vec::new(), false);
    for (subject, outcome) in subjects.iter().zip(outcomes) {
        match outcome {
            Ok(one) => measured.push(one),
            Err(error) => {
                broken |= subject.named;
                left_out.push(error);
            }
        }
    }
    let odd = odd_ones_of(&mut measured);
    if args.json {
        print(&output::as_json(&measured, args.seed));
    } else if !measured.is_empty() {
        print(&output::as_text(&measured));
    }
    for reason in &odd {
        complain(&format!("goalbench: in no mean: {reason}"));
    }
    let is_damaged = hides_runs || left_out.iter().any(HarnessError::is_damage);
    for stray in strays {
        complain(&format!("goalbench: left out: {stray}"));
    }
    for error in left_out {
        complain(&format!("goalbench: left out: {}", chain(&error)));
    }
    if measured.is_empty() {
        complain("goalbench: no run was evaluated");
    }
    Ok(if measured.is_empty() || broken || is_damaged || !odd.is_empty() {
        ExitCode::Failed
    } else {
        ExitCode::Success
    })
}

/// Marks the runs that are not configured as their cell is, and says in a line each how they differ.
fn odd_ones_of(measured: &mut [Measured]) -> Vec<String> {
    let mut reasons = Vec::new();
    for section in measured.chunk_by_mut(|a, b| a.results == b.results) {
        let members =
            section.iter().map(|one| CellMember { run: &one.run, config: &one.config, has_begun: true });
        for OddOne { run, other, pointer } in odd_ones(members) {
            reasons.push(format!("{run}: config differs from that of {other} at `{pointer}`"));
            section.iter_mut().filter(|one| one.run == run).for_each(|one| one.is_odd = true);
        }
    }
    reasons
}

/// Evaluates all, some of them at a time; the answers are in the order of `subjects`.
fn measure_all(
    registry: &Registry,
    subjects: &[Subject],
    args: &Args,
) -> Result<Vec<Result<Measured, HarnessError>>, HarnessError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.jobs.for_runs(subjects.len()))
        .build()
        .map_err(HarnessError::system("start a thread per run"))?;
    let bar = if args.quiet.quiet { ProgressBar::hidden() } else { progress(subjects.len(), args.episodes) };
    let measured = pool.install(|| {
        // Runs take seconds to minutes, and those of one environment, which take equally long, follow one
        // another.
        let each = subjects.par_iter().with_max_len(1);
        each.map(|subject| measure(registry, subject, args, &bar)).collect()
    });
    bar.finish_and_clear();
    Ok(measured)
}

/// Builds what one run needs on the thread that plays its episodes, and plays them.
fn measure(
    registry: &Registry,
    subject: &Subject,
    args: &Args,
    bar: &ProgressBar,
) -> Result<Measured, HarnessError> {
    let policy = Policy::read(registry, &subject.folder)?;
    let instances = LOCKSTEP.min(args.episodes);
    let mut envs =
        (0..instances).map(|_| policy.environment(registry)).collect::<Result<Vec<_>, HarnessError>>()?;
    let mut student = policy.student(envs[0].spec())?;
    let mut rng = stream(args.seed, Purpose::FinalEvaluation);
    let mut played = |episodes| bar.inc(episodes);
    let tally = tally(&mut envs, student.as_mut(), None, args.episodes, &mut rng, &mut played)
        .map_err(HarnessError::unusable(subject.folder.display(), "evaluate this run"))?;
    Ok(Measured {
        folder: subject.folder.clone(),
        results: subject.results.clone(),
        run: policy.run().clone(),
        config: policy.manifest().config.clone(),
        step: policy.step(),
        steps: policy.steps(),
        is_odd: false,
        tally,
    })
}

/// A bar on standard error, if that is a terminal that can show one.
fn progress(runs: usize, episodes: u64) -> ProgressBar {
    const TEMPLATE: &str = "{prefix} {wide_bar} {pos}/{len} episodes, {eta} left";
    if console::columns().is_none() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(TEMPLATE).expect("the template is a constant");
    let bar = ProgressBar::new(runs as u64 * episodes).with_style(style.progress_chars("=> "));
    bar.set_prefix(counted(runs, "run"));
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}
