//! Single runs: how far each got, how it ended, what it reached and what it took.

use super::{Artefact, Repeated, Section, columns};
use crate::analysis::cost::last_timing;
use crate::analysis::options::ReportOptions;
use crate::analysis::scores;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{duration, or_undefined, thousands, with_interval};
use crate::render::table::{Column, Sheet};
use crate::schema::{Outcome, Timing};
use crate::stats;
use crate::store::Run;
use crate::wording::counted;

pub(super) const ROW: Artefact = Artefact::table("runs", Section::Nowhere, "run", sheet)
    .repeated(Repeated::Folded("Single runs"))
    .with_parquet();

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let mut columns = progress(analysis);
    columns.extend(success(analysis.options));
    columns.extend(speed(analysis.options));
    columns.extend(costs());
    Sheet::of(caption(analysis.options), analysis.store.runs(), &columns)
}

/// Which run it is, and how far it got.
fn progress<'a>(analysis: &'a Analysis<'_>) -> Vec<Column<'a, Run>> {
    let environment = |run: &Run| run.key().environment.clone();
    let variant = |run: &Run| run.key().variant.clone();
    let title = |run: &Run| analysis.catalogue().method_of(&run.manifest).title.clone();
    let [of_environment, of_curriculum, of_variant, of_seed] = columns::run(Run::key);
    vec![
        of_environment.named("Environment", environment),
        of_curriculum.named("Curriculum", title),
        of_variant.named("Variant", variant),
        of_seed,
        Column::text("status", "`finished`, `failed` or `unfinished`", |run: &Run| status(run).to_owned())
            .named("Status", |run| status(run).to_owned()),
        Column::only_shown("Seed", |run: &Run| run.key().seed.to_string()),
        Column::count("evaluations", "evaluations that could be used", |run: &Run| run.records.len() as u64),
        Column::count("step", "training steps at the last of them; empty without one", |run: &Run| {
            run.records.last().map(|record| record.step)
        })
        .shown("Steps", |run| or_undefined(run.records.last(), |record| thousands(record.step))),
        Column::count("gradient_steps", "gradient steps of the student at the last of them", |run: &Run| {
            run.records.last().map(|record| record.gradient_steps)
        }),
    ]
}

/// What it reached over its last evaluations.
fn success(options: &ReportOptions) -> [Column<'_, Run>; 5] {
    let window = options.window;
    let score = move |run: &Run| scores::final_score(&run.records, window);
    let counts =
        move |run: &Run| Some(scores::final_counts(&run.records, window)).filter(|counts| counts.1 > 0);
    let interval = move |run: &Run| {
        let (successes, episodes) = scores::final_counts(&run.records, window);
        stats::wilson_interval(successes, episodes, options.resampling.confidence)
    };
    [
        Column::real("final_success", "success rate averaged over the last evaluations", score)
            .shown("Final success", move |run| {
                or_undefined(score(run), |score| with_interval(score, interval(run)))
            }),
        Column::count("final_successes", "successes in these evaluations", move |run: &Run| {
            counts(run).map(|(successes, _)| successes)
        }),
        Column::count("final_episodes", "episodes in these evaluations", move |run: &Run| {
            counts(run).map(|(_, episodes)| episodes)
        }),
        Column::real(
            "final_ci_low",
            "lower end of Wilson's interval of final_successes / final_episodes: noise of evaluating this run, not of seeds",
            move |run: &Run| interval(run).map(|ci| ci.0),
        ),
        Column::real("final_ci_high", "its upper end", move |run: &Run| interval(run).map(|ci| ci.1)),
    ]
}

/// How fast it learned, for statistics of one's own. A failed run's numbers end where it did.
fn speed(options: &ReportOptions) -> [Column<'_, Run>; 3] {
    let window = options.window;
    let steps_to = move |threshold| move |run: &Run| scores::steps_to(&run.records, threshold, window);
    [
        Column::real(
            "auc",
            "area under the success rate over the steps that were evaluated, divided by these steps; that of a failed run ends \
             where it did (the summary goes on with 0)",
            |run: &Run| scores::area_under_curve(&run.records),
        ),
        Column::count(
            "steps_to_50",
            "step of the first evaluation with a success of 0.5 that is kept in the mean over the window of final_success; \
             empty where censored",
            steps_to(0.5),
        ),
        Column::count("steps_to_80", "the same for 0.8", steps_to(0.8)),
    ]
}

/// What it took, and what it was made with.
fn costs() -> [Column<'static, Run>; 6] {
    let hours = |run: &Run, seconds: fn(&Timing) -> Option<f64>| Some(seconds(last_timing(run)?)? / 3600.0);
    let wall = move |run: &Run| hours(run, |timing| Some(timing.wall_s));
    let versions = |run: &Run| {
        let versions = run.manifest.versions.iter().map(|(name, version)| format!("{name} {version}"));
        versions.collect::<Vec<_>>().join(", ")
    };
    [
        Column::real(
            "wall_hours",
            "hours of wall-clock time up to the last evaluation; empty without timings",
            wall,
        )
        .shown("Time", move |run| or_undefined(wall(run), duration)),
        Column::real("evaluation_hours", "hours of it spent in evaluations", move |run: &Run| {
            hours(run, |timing| Some(timing.evaluation_s))
        }),
        Column::real(
            "teacher_hours",
            "hours of it spent in the teacher: proposing goals, observing episodes, learning; empty where timings do not \
             tell",
            move |run: &Run| hours(run, |timing| timing.teacher_s),
        ),
        Column::real(
            "learning_hours",
            "hours of it spent in the student's gradient steps; likewise",
            move |run: &Run| hours(run, |timing| timing.learning_s),
        ),
        Column::text("config_hash", "hash of the complete config", |run: &Run| run.manifest.hash.clone()),
        Column::text("versions", "versions of goalbench and its native libraries", versions),
    ]
}

fn status(run: &Run) -> &'static str {
    match run.outcome {
        Some(Outcome::Finished { .. }) => "finished",
        Some(Outcome::Failed { .. }) => "failed",
        None => "unfinished",
    }
}

fn caption(options: &ReportOptions) -> String {
    format!(
        "Final success: success rate averaged over the last {} of the run, with Wilson's {} % interval for \
         the successes among all of their episodes. It covers the noise of evaluating this one run, not what another \
         seed would give. That of the untrained student is never among them. Steps: at the last evaluation. Time: by the clock on the wall up to it.",
        counted(options.window, "evaluation"),
        columns::percent(options.resampling.confidence),
    )
}
