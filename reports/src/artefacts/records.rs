//! All evaluations, as tidy data.

use std::collections::BTreeSet;

use serde_json::Value;

use super::{Artefact, Section, columns};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{Column, Sheet};
use crate::schema::Record;

pub(super) const ROW: Artefact =
    Artefact::table("records", Section::Nowhere, "evaluation", sheet).with_parquet();

/// A row per evaluation, by run and step: the fields of [`Record`] in their order, then `teacher.NAME` for
/// every number that any teacher recorded, by name.
fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let records: Vec<&Record> = analysis.store.runs().iter().flat_map(|run| &run.records).collect();
    let mut columns = fields();
    let names: BTreeSet<&String> = records.iter().flat_map(|record| record.teacher.keys()).collect();
    for name in names {
        let number = move |record: &&Record| record.teacher.get(name).and_then(Value::as_f64);
        columns.push(Column::real(format!("teacher.{name}"), "", number));
    }
    Sheet::of(String::new(), &records, &columns)
}

fn fields<'a>() -> Vec<Column<'a, &'a Record>> {
    vec![
        Column::text(columns::ENVIRONMENT.0, columns::ENVIRONMENT.1, |row: &&Record| row.environment.clone()),
        Column::text(columns::CURRICULUM.0, columns::CURRICULUM.1, |row: &&Record| row.curriculum.clone()),
        Column::text(columns::VARIANT.0, columns::VARIANT.1, |row: &&Record| row.variant.clone()),
        Column::count(columns::SEED.0, columns::SEED.1, |row: &&Record| row.seed),
        Column::count(
            "step",
            "steps of the budget that were taken: training steps and charged probe rollouts; evaluation steps are not counted",
            |row: &&Record| row.step,
        ),
        Column::count(
            "eval_index",
            "index of the evaluation; 0 is the untrained student",
            |row: &&Record| row.eval_index,
        ),
        Column::count("episodes", "episodes in this evaluation", |row: &&Record| row.episodes),
        Column::real("success_rate", "share of them that ended in success, in [0, 1]", |row: &&Record| {
            row.success_rate
        }),
        Column::real(
            "any_success_rate",
            "share of them that were successful after at least one of their actions; empty where the run is older than the \
             field",
            |row: &&Record| row.any_success_rate,
        ),
        Column::real(
            "mean_return",
            "mean over episodes of the sum of rewards, in [-H, 0]",
            |row: &&Record| row.mean_return,
        ),
        Column::count("gradient_steps", "gradient steps taken by the student", |row: &&Record| {
            row.gradient_steps
        }),
        Column::count(
            "probe_steps",
            "steps taken in probe rollouts that the teacher asked for",
            |row: &&Record| row.probe_steps,
        ),
        Column::count(
            "uncharged_steps",
            "those of them that are not charged to the budget, and so are not in step",
            |row: &&Record| row.uncharged_steps,
        ),
        Column::several("teacher.NAME", "number that the teacher recorded; empty where it is not defined"),
    ]
}
