//! Single runs: how far each got, how it ended, what it reached and what it took.

use polars::prelude::DataFrame;

use super::cells::{decimal, or_undefined, thousands, with_interval};
use super::{Table, column};
use crate::analysis::scores;
use crate::error::ReportError;
use crate::methods;
use crate::schema::{Outcome, Timing};
use crate::stats;
use crate::store::Run;

/// One row per run, in order: how far it got, how it ended, what it reached over its last `window` evaluations with
/// Wilson's interval of coverage `confidence`, what it cost and with what it was made.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the data.
pub fn run_frame(runs: &[Run], window: usize, confidence: f64) -> Result<DataFrame, ReportError> {
    let last = |run: &Run| run.records.last().map(|record| (record.step, record.gradient_steps));
    let hours = |run: &Run, seconds: fn(&Timing) -> Option<f64>| Some(seconds(run.timings.last()?)? / 3600.0);
    let counts = |run: &Run| Some(scores::final_counts(&run.records, window)).filter(|counts| counts.1 > 0);
    let versions = |run: &Run| {
        let versions: Vec<String> =
            run.manifest.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
        versions.join(", ")
    };
    let columns = vec![
        column("environment", runs, |run| run.key().environment.as_str()),
        column("curriculum", runs, |run| run.key().curriculum.as_str()),
        column("variant", runs, |run| run.key().variant.as_str()),
        column("seed", runs, |run| run.key().seed),
        column("status", runs, status),
        column("evaluations", runs, |run| run.records.len() as u64),
        column("step", runs, |run| last(run).map(|(step, _)| step)),
        column("gradient_steps", runs, |run| last(run).map(|(_, gradient_steps)| gradient_steps)),
        column("final_success", runs, |run| scores::final_score(&run.records, window)),
        column("final_successes", runs, |run| counts(run).map(|(successes, _)| successes)),
        column("final_episodes", runs, |run| counts(run).map(|(_, episodes)| episodes)),
        column("final_ci_low", runs, |run| interval(run, window, confidence).map(|ci| ci.0)),
        column("final_ci_high", runs, |run| interval(run, window, confidence).map(|ci| ci.1)),
        column("wall_hours", runs, |run| hours(run, |timing| Some(timing.wall_s))),
        column("evaluation_hours", runs, |run| hours(run, |timing| Some(timing.evaluation_s))),
        column("teacher_hours", runs, |run| hours(run, |timing| timing.teacher_s)),
        column("learning_hours", runs, |run| hours(run, |timing| timing.learning_s)),
        column("config_hash", runs, |run| run.manifest.hash.as_str()),
        column("versions", runs, versions),
    ];
    Ok(DataFrame::new(runs.len(), columns)?)
}

const HEADER: [&str; 8] =
    ["Environment", "Curriculum", "Variant", "Status", "Seed", "Steps", "Final success", "Hours"];

/// The runs as a table to read.
pub fn run_table(runs: &[Run], window: usize, confidence: f64) -> Table {
    let cells = |run: &Run| {
        let key = run.key();
        let score = scores::final_score(&run.records, window);
        [
            key.environment.clone(),
            methods::title(&key.curriculum).to_owned(),
            key.variant.clone(),
            status(run).to_owned(),
            key.seed.to_string(),
            or_undefined(run.records.last(), |record| thousands(record.step)),
            or_undefined(score, |score| with_interval(score, interval(run, window, confidence))),
            or_undefined(run.timings.last(), |timing| decimal(timing.wall_s / 3600.0)),
        ]
    };
    let caption = format!(
        "Final success: success rate averaged over the last {window} evaluations of the run, with Wilson's {} % \
         interval for the successes among all of their episodes. It covers the noise of evaluating this one run, not \
         what another seed would give. Steps: at the last evaluation. Hours: wall-clock time up to it.",
        confidence * 100.0,
    );
    Table::new(caption, 4, HEADER, runs.iter().map(cells))
}

fn status(run: &Run) -> &'static str {
    match run.outcome {
        Some(Outcome::Finished { .. }) => "finished",
        Some(Outcome::Failed { .. }) => "failed",
        None => "unfinished",
    }
}

fn interval(run: &Run, window: usize, confidence: f64) -> Option<(f64, f64)> {
    let (successes, episodes) = scores::final_counts(&run.records, window);
    stats::wilson_interval(successes, episodes, confidence)
}
