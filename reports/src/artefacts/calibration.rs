//! Whether teachers' estimates of success hold, as measured.

use super::files::file_name;
use super::{Artefact, Drawing, Section, columns};
use crate::analysis::calibration::estimate::{Calibration, SeedBin};
use crate::analysis::calibration::progress::ScoreAndChange;
use crate::analysis::calibration::{BINS, Judged, of_teacher};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::render::table::cells::{UNDEFINED, decimal};
use crate::render::table::{Column, Sheet};
use crate::schema::RunKey;
use crate::stats;

pub(super) const SECTION: Section =
    Section::Named { id: "calibration", title: "Is what teachers believe true?" };

pub(super) const ROW: Artefact =
    Artefact::table("calibration", SECTION, "environment, curriculum, variant and teacher", sheet);

pub(super) const RELIABILITY: Artefact = Artefact::table(
    "reliability",
    Section::Nowhere,
    "environment, curriculum, variant, teacher, part of a run and bin of estimates",
    bins,
)
.with_parquet();

pub(super) const JUDGEMENTS: Artefact =
    Artefact::table("judgements", Section::Nowhere, "measure of the frontier and teacher", judgements)
        .with_parquet();

pub(super) const DIAGRAMS: Artefact = Artefact::figures("calibration", Section::Environments, draw);

fn rows(analysis: &Analysis<'_>) -> Vec<Calibration> {
    analysis.groups.all.iter().flat_map(|group| Calibration::of(group, analysis)).collect()
}

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let rows = rows(analysis);
    let mut columns = columns::of_teacher(
        "curriculum id of the teacher whose estimates are judged",
        true,
        |row: &Calibration| &row.teacher.key,
        |row| &row.teacher,
    );
    columns.extend([
        Column::count(
            "n_judged",
            "seeds with estimates at a measure after training had begun",
            |row: &Calibration| row.n_seeds as u64,
        )
        .shown("Seeds", |row| row.n_seeds.to_string()),
        Column::real(
            "estimate",
            "mean estimate of success, over goals and measures, then over seeds",
            |row: &Calibration| row.means.0,
        )
        .shown("Estimate", |row| decimal(row.means.0)),
        Column::real("success", "mean measured success, likewise", |row: &Calibration| row.means.1)
            .shown("Success", |row| decimal(row.means.1)),
    ]);
    columns.extend(columns::by_part(
        "calibration_error",
        ["Calibration error", "First third", "", "Last third"],
        "expected calibration error of the estimates, in ten bins of equal width, over the goals and measures of this part of \
         a run; mean over seeds",
        |row: &Calibration| row.error,
    ));
    columns.extend(columns::by_part(
        "correlation",
        ["Rank correlation", "First third of it", "", "Last third of it"],
        "Spearman's rank correlation of estimates and measured success over the goals of the pool, mean over the measures of \
         this part of a run, then over seeds; empty where all goals were alike",
        |row: &Calibration| row.correlation,
    ));
    Sheet::of(caption(), &rows, &columns)
}

fn caption() -> String {
    format!(
        "Whether teachers' estimates of success hold. Estimate: how likely a teacher took the student to succeed at a goal, \
         mean over the goals of the pool that it has an estimate of. ProCuRL's is its p; GOID's is how often the last \
         episodes towards a goal's region succeeded, with exploration noise; TEACH and SPaCE make none themselves, and \
         their confidence is read as ProCuRL reads it, as a share of the way from the lowest return there is to 0. Success: \
         what was measured in greedy episodes. Calibration error: estimates are put into {BINS} bins of equal width; the distance \
         between mean estimate and mean success of a bin, mean over bins by the number of goals in them; 0 for \
         estimates that hold. Rank correlation: Spearman's, of estimates and success; 1.00 where they put all goals in \
         one order, less where goals of equal success have different estimates. A return of -1 per step also tells \
         how long success takes, so estimates below 1 for mastered goals are to be expected. Means over measures, the \
         untrained student's left out, then over the seeds whose run has ended (where none has, over all) ± standard \
         deviation; of a run that failed the measures before count. {UNDEFINED} where all goals were alike."
    )
}

/// What a row of the bins is of: which part of a run, and which bin.
type BinRow<'a> = (&'a Calibration, usize, usize);

fn bins(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    const PARTS: [&str; 4] = ["all", "first", "second", "last"];
    fn bin<'a>(row: &BinRow<'a>) -> &'a SeedBin {
        &row.0.bins[row.1][row.2]
    }
    let judged = rows(analysis);
    let rows: Vec<BinRow<'_>> = judged
        .iter()
        .flat_map(|row| (0..4).flat_map(move |part| (0..BINS).map(move |bin| (row, part, bin))))
        .filter(|row| bin(row).bin.count > 0)
        .collect();
    let edge = |index: usize| index as f64 / BINS as f64;
    let columns = [
        Column::text(columns::ENVIRONMENT.0, columns::ENVIRONMENT.1, |row: &BinRow<'_>| {
            row.0.teacher.key.environment.clone()
        }),
        Column::text(columns::CURRICULUM.0, columns::CURRICULUM.1, |row: &BinRow<'_>| {
            row.0.teacher.key.curriculum.id.clone()
        }),
        Column::text(columns::VARIANT.0, columns::VARIANT.1, |row: &BinRow<'_>| {
            row.0.teacher.key.variant.clone()
        }),
        Column::text("teacher", "curriculum id of the teacher", |row: &BinRow<'_>| {
            row.0.teacher.method.id.clone()
        }),
        Column::text(
            "part",
            "`all` of a run, or its `first`, `second` or `last` third",
            |row: &BinRow<'_>| PARTS[row.1].to_owned(),
        ),
        Column::real("low", "lower end of the bin, which belongs to it", move |row: &BinRow<'_>| edge(row.2)),
        Column::real("high", "its upper end, which does not, but for 1", move |row: &BinRow<'_>| {
            edge(row.2 + 1)
        }),
        Column::count("goals", "estimates in it: one for each goal and measure", |row: &BinRow<'_>| {
            bin(row).bin.count
        }),
        Column::real("estimate", "their mean", |row: &BinRow<'_>| bin(row).bin.estimate()),
        Column::real("success", "mean measured success at the same goals", |row: &BinRow<'_>| {
            bin(row).bin.outcome()
        }),
        Column::count("n_judged", "seeds with an estimate in it", |row: &BinRow<'_>| bin(row).n_seeds as u64),
        Column::real(
            "success_std",
            "standard deviation over these seeds of the mean success; empty for fewer than two",
            |row: &BinRow<'_>| bin(row).std,
        ),
    ];
    Sheet::of(String::new(), &rows, &columns)
}

/// A teacher at a measure.
struct JudgedRow<'a> {
    run: &'a RunKey,
    teacher: String,
    judged: Judged,
    progress: Option<ScoreAndChange>,
}

fn judgements(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let mut rows = Vec::new();
    for run in analysis.store.runs() {
        let own = [run.key().curriculum.clone()];
        let watched = analysis.shadow.of_run(run);
        let ids = watched.map_or(&own[..], |watched| &watched.teachers[..]);
        for (place, id) in ids.iter().enumerate() {
            let judged = of_teacher(run, &analysis.frontier, &analysis.shadow, place);
            let progress = ScoreAndChange::of(&judged);
            for (judged, progress) in judged.into_iter().zip(progress) {
                if judged.estimates.is_some() || judged.scores.is_some() {
                    rows.push(JudgedRow { run: run.key(), teacher: id.clone(), judged, progress });
                }
            }
        }
    }
    let mut columns: Vec<Column<'_, JudgedRow<'_>>> = columns::run(|row: &JudgedRow<'_>| row.run).into();
    columns.extend([
        Column::count("step", "training steps taken in the environment", |row: &JudgedRow<'_>| {
            row.judged.step
        }),
        Column::count(
            "eval_index",
            "index of the evaluation beside which it was measured, 0 for the untrained student",
            |row: &JudgedRow<'_>| row.judged.eval_index,
        ),
        Column::text("teacher", "curriculum id of the teacher", |row: &JudgedRow<'_>| row.teacher.clone()),
        Column::real("estimate", "mean estimate of success; empty without any", |row: &JudgedRow<'_>| {
            row.judged.mean_estimate()
        }),
        Column::real("success", "mean measured success", |row: &JudgedRow<'_>| {
            stats::mean(&row.judged.success)
        }),
        Column::real(
            "calibration_error",
            "expected calibration error of the estimates, in ten bins of equal width",
            |row: &JudgedRow<'_>| stats::calibration_error(&row.judged.reliability()?),
        ),
        Column::real(
            "correlation",
            "Spearman's rank correlation of estimates and measured success; empty where all goals were alike",
            |row: &JudgedRow<'_>| row.judged.rank_correlation(),
        ),
        Column::real(
            "changed",
            "share of the goals whose success has changed since the measure before; empty for the first, and without scores",
            |row: &JudgedRow<'_>| row.progress?.changed,
        ),
        Column::real(
            "change_since",
            "Spearman's rank correlation of the teacher's scores with the absolute change of success since the measure \
             before; empty where scores or changes were alike for all goals",
            |row: &JudgedRow<'_>| row.progress?.since,
        ),
        Column::real("change_until", "the same with the change until the measure after", |row: &JudgedRow<'_>| {
            row.progress?.until
        }),
    ]);
    Sheet::of(String::new(), &rows, &columns)
}

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let mut drawings = Vec::new();
    for (index, id) in analysis.groups.environments().into_iter().enumerate() {
        let groups = analysis.groups.compared_groups();
        let here = groups.into_iter().filter(|group| group.key.environment == *id);
        let judged: Vec<Calibration> = here.flat_map(|group| Calibration::of(group, analysis)).collect();
        if !judged.is_empty() {
            drawings.push(Drawing {
                name: format!("calibration-{}", file_name(id, index)),
                title: format!("{id}: teachers' estimates of success, and what was measured"),
                environment: Some(id.to_string()),
                svg: figure::calibration(id, &judged)?,
            });
        }
    }
    Ok(drawings)
}
