//! Teachers that watched while another one acted: how far they agree, and what each of them did.

use super::files::file_name;
use super::{Artefact, Drawing, Section, columns};
use crate::analysis::shadow::agreement::AgreementSummary;
use crate::analysis::shadow::{ShadowLine, TOP, WatchedRun};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure::{self, AgreementMatrix};
use crate::render::table::cells::UNDEFINED;
use crate::render::table::{Column, Sheet};
use crate::schema::RunKey;

const SECTION: Section = Section::Named { id: "shadows", title: "What other teachers would have done" };

pub(super) const AGREEMENT: Artefact =
    Artefact::table("agreement", SECTION, "environment, curriculum, variant and pair of teachers", agreement);

pub(super) const MATRICES: Artefact = Artefact::figures("agreement", Section::Environments, draw);

pub(super) const LINES: Artefact =
    Artefact::table("shadows", Section::Nowhere, "evaluation and shadow", lines).with_parquet();

/// Titles of the columns of the thirds.
const CORRELATION: [&str; 3] = ["Correlation, first third", "second third", "last third"];
const OVERLAP: [&str; 3] = ["Overlap, first third", "second third of it", "last third of it"];

fn agreement(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let groups = analysis.groups.all.iter();
    let rows: Vec<AgreementSummary> = groups
        .flat_map(|group| AgreementSummary::of(group, &analysis.shadow, analysis.catalogue()))
        .collect();
    let teacher = |place: usize, name: &'static str, title: &'static str, meaning: &'static str| {
        Column::text(name, meaning, move |row: &AgreementSummary| row.teachers[place].id.clone())
            .named(title, move |row| row.teachers[place].title.clone())
    };
    let mut columns = vec![
        columns::environment(|row: &AgreementSummary| &row.key),
        columns::curriculum(|row| &row.key),
        columns::variant(|row| &row.key),
        teacher(
            0,
            "teacher",
            "Teacher",
            "curriculum id of one of two teachers: `curriculum`, which acted, or a shadow",
        ),
        teacher(1, "other", "Other teacher", "curriculum id of the other one, a shadow"),
        Column::count("n_watched", "seeds in which both ordered the pool", |row: &AgreementSummary| {
            row.n_seeds as u64
        })
        .shown("Seeds", |row| row.n_seeds.to_string()),
    ];
    for (third, title) in CORRELATION.into_iter().enumerate() {
        let meaning = "Spearman's rank correlation of their orders of the pool, mean over the evaluations of this third of a run, \
                       then over seeds; empty where one of them made no difference between goals";
        let of = move |row: &AgreementSummary| row.correlation[third];
        columns.extend(columns::mean_std(format!("correlation_{}", third + 1), title, meaning, of));
    }
    for (third, title) in OVERLAP.into_iter().enumerate() {
        let meaning = "share of the tenth of the pool that one of them wants most which the other one wants most, too; likewise";
        let of = move |row: &AgreementSummary| row.overlap[third];
        columns.extend(columns::mean_std(format!("overlap_{}", third + 1), title, meaning, of));
    }
    Sheet::of(caption(), &rows, &columns)
}

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let mut drawings = Vec::new();
    for (index, id) in analysis.groups.environments().into_iter().enumerate() {
        let groups =
            analysis.groups.compared_groups().into_iter().filter(|group| group.key.environment == *id);
        let rows: Vec<(String, Vec<AgreementSummary>)> = groups
            .map(|group| {
                let pairs = AgreementSummary::of(group, &analysis.shadow, analysis.catalogue());
                (group.key.name(), pairs)
            })
            .filter(|(_, pairs)| !pairs.is_empty())
            .collect();
        let matrices: Vec<AgreementMatrix<'_>> = rows
            .iter()
            .map(|(name, pairs)| AgreementMatrix { name: name.clone(), pairs: pairs.iter().collect() })
            .collect();
        if !matrices.is_empty() {
            drawings.push(Drawing {
                name: format!("agreement-{}", file_name(id, index)),
                title: format!("{id}: how alike teachers order the goals of the pool"),
                environment: Some(id.to_string()),
                svg: figure::agreement(id, &matrices)?,
            });
        }
    }
    Ok(drawings)
}

fn caption() -> String {
    format!(
        "How far teachers agree that saw the same student at the same moments: the one that acted, and those that only \
         watched. A teacher orders the goals of the pool by its scores where the student was measured and the teacher had \
         scored all of them, and by its weights elsewhere. Correlation: Spearman's rank correlation of two such orders \
         at an evaluation, 1.00 where they are the same, 0.00 where one says nothing of the other, below that where one \
         teacher prefers what the other avoids. Overlap: share of the {:.0} % of the goals that one wants most which the \
         other one wants most, too; {TOP:.2} by chance, as for teachers that make no difference between goals. Means over \
         the evaluations of each third of a run's budget, the untrained student's left out, then over the seeds whose run has \
         ended (where none has, over all) ± standard deviation; {UNDEFINED} where one of the two made no difference between \
         goals. Pairs are left out in which one orders no goals, or wants all alike throughout. Weights are not all alike in \
         kind: those of a teacher that takes turns are shares of turns, and many goals may have a weight of 0.",
        TOP * 100.0
    )
}

type Row<'a> = (&'a RunKey, &'a WatchedRun, &'a ShadowLine);

fn lines(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let runs = analysis.shadow.runs.iter();
    let rows: Vec<Row<'_>> =
        runs.flat_map(|(run, watched)| watched.notes.iter().map(move |line| (run, watched, line))).collect();
    let mut columns: Vec<Column<'_, Row<'_>>> = columns::run(|row: &Row<'_>| row.0).into();
    columns.extend([
        Column::count("step", "training steps taken in the environment", |row: &Row<'_>| row.2.step),
        Column::count(
            "eval_index",
            "index of the evaluation, 0 for the untrained student",
            |row: &Row<'_>| row.2.eval_index,
        ),
        Column::text("teacher", "curriculum id of the shadow", |row: &Row<'_>| {
            row.1.teachers[row.2.teacher].clone()
        }),
        Column::count("proposals", "goals that it proposed since the evaluation before", |row: &Row<'_>| {
            row.2.proposals.0
        }),
        Column::count("elsewhere", "those of them that were not of the pool", |row: &Row<'_>| {
            row.2.proposals.1
        }),
        Column::count(
            "goals",
            "distinct goals of the pool among them; one from elsewhere counts as the nearest",
            |row: &Row<'_>| row.2.goals,
        ),
        Column::real(
            "correlation",
            "Spearman's rank correlation of its order of the pool, by scores or by weights, with that of the teacher that \
             acted; empty where one of them has none, or makes no difference between goals",
            |row: &Row<'_>| row.2.correlation,
        ),
        Column::real(
            "overlap",
            "share of the tenth of the pool that it wants most which the teacher that acted wants most, too; empty \
             where one of them has no order",
            |row: &Row<'_>| row.2.overlap,
        ),
        Column::text("silent", "`yes` if it had failed before, `no` otherwise", |row: &Row<'_>| {
            String::from(if row.2.silent { "yes" } else { "no" })
        }),
    ]);
    Sheet::of(String::new(), &rows, &columns)
}
