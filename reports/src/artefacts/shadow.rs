//! Teachers that watched while another one acted: how far they agree, and what each of them did.

use super::files::file_name;
use super::{Artefact, Drawing, Section, columns};
use crate::analysis::shadow::agreement::{AgreementSummary, MeanStd};
use crate::analysis::shadow::{ShadowLine, TOP, WatchedRun};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure::{self, AgreementMatrix};
use crate::render::table::cells::{UNDEFINED, with_spread};
use crate::render::table::{Column, Sheet};
use crate::schema::RunKey;

const SECTION: Section = Section::Named { id: "shadows", title: "What other teachers would have done" };

pub(super) const AGREEMENT: Artefact =
    Artefact::table("agreement", SECTION, "environment, curriculum, variant and pair of teachers", agreement);

pub(super) const MATRICES: Artefact = Artefact::figures("agreement", Section::Environments, draw);

pub(super) const LINES: Artefact =
    Artefact::table("shadows", Section::Nowhere, "evaluation and shadow", lines).with_parquet();

/// Names of the columns of the thirds.
const CORRELATION: [(&str, &str); 3] = [
    ("correlation_1", "correlation_1_std"),
    ("correlation_2", "correlation_2_std"),
    ("correlation_3", "correlation_3_std"),
];
const OVERLAP: [(&str, &str); 3] =
    [("overlap_1", "overlap_1_std"), ("overlap_2", "overlap_2_std"), ("overlap_3", "overlap_3_std")];
const CORRELATION_TITLES: [&str; 3] = ["Correlation, first third", "second third", "last third"];
const OVERLAP_TITLES: [&str; 3] = ["Overlap, first third", "second third of it", "last third of it"];

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
        Column::count("n_watched", "seeds in which both weighed the pool", |row: &AgreementSummary| {
            row.n_seeds as u64
        })
        .shown("Seeds", |row| row.n_seeds.to_string()),
    ];
    let correlation = |row: &AgreementSummary, third: usize| row.correlation[third];
    columns.extend(by_third(
        "Spearman's rank correlation of their weights over the pool, mean over the evaluations of this third of a run, then \
         over seeds; empty where one of them made no difference between goals",
        (CORRELATION, CORRELATION_TITLES),
        correlation,
    ));
    let overlap = |row: &AgreementSummary, third: usize| row.overlap[third];
    columns.extend(by_third(
        "share of the tenth of the pool that one of them weighs most which the other one weighs most, too; likewise",
        (OVERLAP, OVERLAP_TITLES),
        overlap,
    ));
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

/// Mean and standard deviation of each third.
fn by_third(
    meaning: &'static str,
    (names, titles): ([(&'static str, &'static str); 3], [&'static str; 3]),
    of: fn(&AgreementSummary, usize) -> MeanStd,
) -> Vec<Column<'static, AgreementSummary>> {
    let third = |(third, ((name, std), title)): (usize, ((&'static str, &'static str), &'static str))| {
        let mean = Column::real(name, meaning, move |row: &AgreementSummary| of(row, third).0);
        let mean = mean.shown(title, move |row| {
            let (mean, std) = of(row, third);
            with_spread(mean, std)
        });
        let std = Column::real(
            std,
            "its standard deviation over seeds; empty for fewer than two",
            move |row: &AgreementSummary| of(row, third).1,
        );
        [mean, std]
    };
    names.into_iter().zip(titles).enumerate().flat_map(third).collect()
}

fn caption() -> String {
    format!(
        "How far teachers agree that saw the same student at the same moments: the one that acted, and those that only \
         watched. Correlation: Spearman's rank correlation of their weights over the goals of the pool at an evaluation, \
         1.00 where they put all goals in the same order, 0.00 where one order says nothing of the other, below that where \
         one prefers what the other avoids. Overlap: share of the {:.0} % of the goals that one weighs most which the \
         other one weighs most, too; {TOP:.2} by chance, as for teachers that make no difference between goals. Means over \
         the evaluations of each third of a run, the untrained student's left out, then over seeds ± standard deviation; \
         {UNDEFINED} where one of the two made no difference between goals. Pairs are left out in which one weighs no goals, \
         or all alike throughout. Weights are not all alike in kind: those of a teacher that takes turns are shares of \
         turns, and many goals may have a weight of 0.",
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
            "Spearman's rank correlation of its weights over the pool with those of the teacher that acted; empty where \
             one of them has none, or makes no difference between goals",
            |row: &Row<'_>| row.2.correlation,
        ),
        Column::real(
            "overlap",
            "share of the tenth of the pool that it weighs most which the teacher that acted weighs most, too; empty \
             where one of them has no weights",
            |row: &Row<'_>| row.2.overlap,
        ),
        Column::text("silent", "`yes` if it had failed before, `no` otherwise", |row: &Row<'_>| {
            String::from(if row.2.silent { "yes" } else { "no" })
        }),
    ]);
    Sheet::of(String::new(), &rows, &columns)
}
