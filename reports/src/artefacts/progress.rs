//! Whether teachers' scores follow the student's progress, as measured.

use super::calibration::SECTION;
use super::{Artefact, columns};
use crate::analysis::calibration::progress::ProgressSummary;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{UNDEFINED, decimal, or_undefined};
use crate::render::table::{Column, Sheet};

pub(super) const ROW: Artefact =
    Artefact::table("progress", SECTION, "environment, curriculum, variant and teacher", sheet);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let groups = analysis.groups.all.iter();
    let rows: Vec<ProgressSummary> = groups.flat_map(|group| ProgressSummary::of(group, analysis)).collect();
    let mut columns = columns::of_teacher(
        "curriculum id of the teacher whose scores are judged",
        true,
        |row: &ProgressSummary| &row.teacher.key,
        |row| &row.teacher,
    );
    columns.extend([
        Column::count(
            "n_scored",
            "seeds with scores at a measure after training had begun",
            |row: &ProgressSummary| row.n_seeds as u64,
        )
        .shown("Seeds", |row| row.n_seeds.to_string()),
        Column::real(
            "changed",
            "share of the goals of the pool whose measured success changed from a measure to the next, mean over \
             measures, then over seeds",
            |row: &ProgressSummary| row.changed,
        )
        .shown("Goals that changed", |row| or_undefined(row.changed, decimal)),
    ]);
    columns.extend(columns::by_part(
        "since",
        ["Change since", "First third", "Second third", "Last third"],
        "Spearman's rank correlation of the teacher's scores with the absolute change of measured success since the measure \
         before, mean over measures, then over seeds; empty where scores or changes were alike for all goals",
        |row: &ProgressSummary| row.since,
    ));
    columns.extend(columns::by_part(
        "until",
        ["Change until", "", "", ""],
        "the same with the change until the measure after",
        |row: &ProgressSummary| row.until,
    ));
    Sheet::of(caption(), &rows, &columns)
}

fn caption() -> String {
    format!(
        "Whether teachers' scores follow the student's progress. Scores: TEACH's variance of confidence over its window, \
         ProCuRL's p(1 - p), SPaCE's improvement of confidence at its last update, LP's change of success in a goal's region, \
         GOID's p(1 - p) of the success there, PLR's temporal-difference error at the goal's last episode; correlations are \
         over the goals that have a score. \
         Goals that changed: share of the goals whose measured success changed from a measure to the next, up or down. \
         Change since: Spearman's rank correlation over the pool of the scores at a measure with the absolute change of \
         success since the measure before, 1.00 where the goals that changed most have the highest scores, 0.00 \
         where scores say nothing of it. Change until: the same with the change until the measure after, which a score \
         would have to foresee. Many goals do not change at all, and share a rank, which keeps correlations below 1. \
         Means over measures, then over the seeds whose run has ended (where none has, over all) ± standard deviation; of a \
         run that failed the measures before count. {UNDEFINED} where scores or changes were alike for \
         all goals."
    )
}
