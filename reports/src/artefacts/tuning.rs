//! What a search over settings was worth, and how much settings matter.

use super::files::file_name;
use super::{Artefact, Drawing, Section, columns, style};
use crate::analysis::tuning::{DEFAULT, FreshScores, TunedPlace};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::render::table::cells::{
    BOOTSTRAP_COVERAGE, UNDEFINED, decimal, or_undefined, p_value, thousands, with_interval, with_spread,
};
use crate::render::table::{Column, Sheet};
use crate::schema::{TrialPlace, TrialScore, Tuning};
use crate::store::layout;
use crate::wording::counted;

const SECTION: Section = Section::Named { id: "tuning", title: "Tuned against default settings" };

pub(super) const FIGURES: Artefact = Artefact::figures("trials", SECTION, draw);

pub(super) const ROW: Artefact =
    Artefact::table("tuning", SECTION, "environment and curriculum of a search", sheet).with_parquet();

pub(super) const SENSITIVITY: Artefact =
    Artefact::table("sensitivity", SECTION, "environment and curriculum with ranges", sensitivity);

pub(super) const TRIALS: Artefact =
    Artefact::table("trials", Section::Nowhere, "environment and settings that a search tried", trials)
        .with_parquet();

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let places = with_ranges(analysis);
    let Some(tuning) = &analysis.tuning.tuning else { return Ok(Vec::new()) };
    let style = style(analysis);
    let here = |a: &TunedPlace<'_>, b: &TunedPlace<'_>| a.key.environment == b.key.environment;
    let drawing = |(index, rows): (usize, &[TunedPlace<'_>])| {
        let environment = &rows[0].key.environment;
        Ok(Drawing {
            name: format!("trials-{}", file_name(environment, index)),
            title: format!("{environment}: what settings make of each method, on the seeds of the search"),
            environment: None,
            svg: figure::trials(rows, tuning, &style)?,
        })
    };
    places.chunk_by(here).enumerate().map(drawing).collect()
}

fn with_ranges<'a>(analysis: &'a Analysis<'_>) -> Vec<TunedPlace<'a>> {
    let mut places = analysis.tuning.places(analysis.groups, analysis.options);
    places.retain(|place| !place.tried.tried.is_empty());
    places
}

fn fresh(scores: Option<FreshScores>) -> String {
    with_spread(scores.map(|of| of.mean), scores.and_then(|of| of.std))
}

fn is_kept(row: &TunedPlace<'_>) -> bool {
    row.tried.chosen == DEFAULT
}

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let places = analysis.tuning.places(analysis.groups, analysis.options);
    let Some(tuning) = &analysis.tuning.tuning else {
        return Sheet::of(String::new(), &places, &columns(""));
    };
    Sheet::of(caption(tuning, analysis), &places, &columns(tuning.measure.as_str()))
}

fn columns<'a>(measure: &'a str) -> Vec<Column<'a, TunedPlace<'a>>> {
    let mut columns = vec![
        columns::environment(|row: &TunedPlace<'_>| &row.key),
        columns::curriculum(|row| &row.key),
        Column::text("measure", "`area` or `final`: what the search went by", |_: &TunedPlace<'_>| {
            measure.to_owned()
        }),
        Column::count(
            "n_default",
            "finished runs with the default settings on fresh seeds",
            |row: &TunedPlace<'_>| row.default.map(|of| of.n as u64),
        ),
        Column::real(
            "default_mean",
            "mean over fresh seeds of the measure with the default settings",
            |row: &TunedPlace<'_>| row.default.map(|of| of.mean),
        )
        .shown("Default", |row| fresh(row.default)),
        Column::real("default_std", "its standard deviation over seeds, ddof = 1", |row: &TunedPlace<'_>| {
            row.default.and_then(|of| of.std)
        }),
        Column::count(
            "n_tuned",
            "the same with the chosen settings; empty where the default ones were chosen",
            |row: &TunedPlace<'_>| row.tuned.map(|of| of.n as u64),
        ),
        Column::real(
            "tuned_mean",
            "mean over fresh seeds of the measure with the chosen settings",
            |row: &TunedPlace<'_>| row.tuned.map(|of| of.mean),
        )
        .shown("Tuned", |row| match row.tried.best() {
            Some(_) if is_kept(row) => "the same".to_owned(),
            _ => fresh(row.tuned),
        }),
        Column::real("tuned_std", "its standard deviation over seeds", |row: &TunedPlace<'_>| {
            row.tuned.and_then(|of| of.std)
        }),
    ];
    columns.extend(differences());
    columns.extend(choices());
    columns
}

/// Chosen less default settings.
fn differences<'a>() -> Vec<Column<'a, TunedPlace<'a>>> {
    vec![
        Column::count("n_pairs", "fresh seeds that both have", |row: &TunedPlace<'_>| {
            row.difference.map(|of| of.pairs as u64)
        })
        .shown("Pairs", |row| or_undefined(row.difference, |of| of.pairs.to_string())),
        Column::real("difference", "mean over these pairs, chosen less default", |row: &TunedPlace<'_>| {
            row.difference.map(|of| of.mean)
        })
        .shown("Difference", |row| or_undefined(row.difference, |of| with_interval(of.mean, of.interval))),
        Column::real(
            "difference_ci_low",
            "lower end of its paired bootstrap interval",
            |row: &TunedPlace<'_>| row.difference.and_then(|of| of.interval).map(|ci| ci.0),
        ),
        Column::real("difference_ci_high", "its upper end", |row: &TunedPlace<'_>| {
            row.difference.and_then(|of| of.interval).map(|ci| ci.1)
        }),
        Column::real(
            "sign_flip_p",
            "two-sided p-value of the sign-flip test of these pairs, uncorrected",
            |row: &TunedPlace<'_>| row.difference.and_then(|of| of.sign_flip).map(|test| test.p),
        )
        .shown("p (sign flips)", |row| {
            or_undefined(row.difference.and_then(|of| of.sign_flip), |test| p_value(test.p))
        }),
    ]
}

/// What was chosen, of what, and what that took.
fn choices<'a>() -> Vec<Column<'a, TunedPlace<'a>>> {
    vec![
        Column::text("chosen", "variant of the chosen trial, `default` where no trial was better", |row: &TunedPlace<'_>| {
            row.tried.chosen.clone()
        })
        .named("Chosen settings", |row| match row.tried.best() {
            None => "no ranges: nothing was searched".to_owned(),
            Some(best) if is_kept(row) => format!("{}: no trial was better", best.said()),
            Some(best) => best.said(),
        }),
        Column::text("settings", "the chosen settings; empty where they are the default ones", |row: &TunedPlace<'_>| {
            row.tried.best().filter(|_| !is_kept(row)).map(TrialScore::said)
        }),
        Column::text("ranges", "what settings were drawn from; empty where nothing was searched", |row: &TunedPlace<'_>| {
            Some(row.tried.ranges.join("; ")).filter(|said| !said.is_empty())
        }),
        Column::count("trials", "draws of settings", |row: &TunedPlace<'_>| row.tried.drawn().len() as u64)
            .shown("Trials", |row| row.tried.drawn().len().to_string()),
        Column::count(
            "steps",
            "steps that the search took in this environment: those of the trials and of the default settings on the same seeds",
            TunedPlace::steps,
        )
        .shown("Steps of the search", |row| thousands(row.steps())),
    ]
}

fn caption(tuning: &Tuning, analysis: &Analysis<'_>) -> String {
    let trials = counted(usize::try_from(tuning.trials).unwrap_or(usize::MAX), "trial");
    format!(
        "Every method with ranges got {trials} of random settings, on the seeds {} that nothing else here rests on. Of these and the \
         default settings those with the highest mean {}, over environments and seeds, are the chosen ones (`{}/choice.json`). Default and \
         tuned: {} of both on fresh seeds, mean ± standard deviation over finished runs of the same evaluations; failed ones count 0 from \
         their failure on. Difference: tuned minus default, mean over the seeds that both have, with its {} % paired bootstrap interval: \
         {BOOTSTRAP_COVERAGE}. p (sign flips): test of these pairs, uncorrected. Where the default settings were chosen, the same runs \
         would stand on both sides. Steps: of trials and default settings on the seeds of the search, probe rollouts included; the same number of trials \
         need not be the same number of steps for curricula with uncharged rollouts.",
        seeds(tuning),
        tuning.measure.in_words(),
        layout::TUNING,
        tuning.measure.in_words(),
        columns::percent(analysis.options.resampling.confidence),
    )
}

/// `100, 101, 102`.
fn seeds(tuning: &Tuning) -> String {
    tuning.seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")
}

fn sensitivity(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let end = |row: &TunedPlace<'_>, index: usize| row.spread().map(|spread| spread[index]);
    let columns = [
        columns::environment(|row: &TunedPlace<'_>| &row.key),
        columns::curriculum(|row| &row.key),
        Column::count("trials", "draws of settings", |row: &TunedPlace<'_>| row.drawn().len() as u64)
            .shown("Trials", |row| row.drawn().len().to_string()),
        Column::real(
            "default",
            "score of the default settings on the seeds of the search",
            |row: &TunedPlace<'_>| row.on_search_seeds().map(|place| place.score),
        )
        .shown("Default", |row| or_undefined(row.on_search_seeds(), |place| decimal(place.score))),
        Column::real("worst", "lowest score of a trial", move |row: &TunedPlace<'_>| end(row, 0))
            .shown("Worst", move |row| or_undefined(end(row, 0), decimal)),
        Column::real("median", "median of the scores of trials", move |row: &TunedPlace<'_>| end(row, 1))
            .shown("Median", move |row| or_undefined(end(row, 1), decimal)),
        Column::real("best", "highest score of a trial", move |row: &TunedPlace<'_>| end(row, 2))
            .shown("Best", move |row| or_undefined(end(row, 2), decimal)),
        Column::real(
            "share_better",
            "share of trials with a higher score than the default settings",
            TunedPlace::share_better,
        )
        .shown("Better than default", |row| or_undefined(row.share_better(), decimal)),
        Column::count("distinct", "different settings among the trials", |row: &TunedPlace<'_>| {
            distinct(row)
        })
        .shown("Different settings", |row| distinct(row).to_string()),
        Column::count("failed", "runs of trials that failed", |row: &TunedPlace<'_>| failed(row))
            .shown("Failed runs", |row| failed(row).to_string()),
    ];
    let measure = analysis.tuning.tuning.as_ref().map_or(UNDEFINED, |tuning| tuning.measure.in_words());
    let caption = format!(
        "How much the settings matter: the {measure} of every trial on the seeds of the search, means over seeds. The best of many \
         trials is best by luck too: what it is worth stands in the table above, on fresh seeds. Better than default: the share of \
         trials with a higher score than the default settings. Different settings: draws from a few values can meet."
    );
    Sheet::of(caption, &with_ranges(analysis), &columns)
}

fn distinct(row: &TunedPlace<'_>) -> u64 {
    let drawn = row.tried.drawn();
    let is_new = |(index, trial): &(usize, &TrialScore)| {
        drawn[..*index].iter().all(|other| other.settings != trial.settings)
    };
    drawn.iter().enumerate().filter(is_new).count() as u64
}

fn failed(row: &TunedPlace<'_>) -> u64 {
    let here = |trial: &TrialScore| trial.place(&row.key.environment).map(|place| place.failed);
    row.tried.drawn().iter().filter_map(here).sum()
}

/// A trial in one environment.
struct Tried<'a> {
    place: &'a TunedPlace<'a>,
    trial: &'a TrialScore,
    found: &'a TrialPlace,
}

fn trials(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let places = with_ranges(analysis);
    let rows: Vec<Tried<'_>> = places
        .iter()
        .flat_map(|place| {
            let here = |trial| Some((trial, TrialScore::place(trial, &place.key.environment)?));
            let tried = place.tried.tried.iter().filter_map(here);
            tried.map(move |(trial, found)| Tried { place, trial, found })
        })
        .collect();
    let columns = [
        columns::environment(|row: &Tried<'_>| &row.place.key),
        columns::curriculum(|row| &row.place.key),
        Column::text(
            "trial",
            "variant of its runs; `default` for the default settings",
            |row: &Tried<'_>| row.trial.variant.clone(),
        ),
        Column::text("settings", "the drawn settings", |row: &Tried<'_>| {
            Some(row.trial.said()).filter(|_| !row.trial.settings.is_empty())
        }),
        Column::real("score", "mean over the seeds of the search of its measure", |row: &Tried<'_>| {
            row.found.score
        }),
        Column::real(
            "score_overall",
            "the same over all environments: what is chosen by",
            |row: &Tried<'_>| row.trial.score,
        ),
        Column::count("n_seeds", "runs", |row: &Tried<'_>| row.found.by_seed.len() as u64),
        Column::count(
            "n_failed",
            "those that failed, and count 0 from their failure on",
            |row: &Tried<'_>| row.found.failed,
        ),
        Column::count("steps", "steps that they took, probe rollouts included", |row: &Tried<'_>| {
            row.found.steps
        }),
        Column::text("chosen", "`yes` for the chosen settings", |row: &Tried<'_>| {
            (row.trial.variant == row.place.tried.chosen).then(|| "yes".to_owned())
        }),
    ];
    Sheet::of(String::new(), &rows, &columns)
}
