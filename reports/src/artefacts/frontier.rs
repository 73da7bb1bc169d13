//! What students could really do at every goal of their pools: whether teachers see the frontier, and maps of
//! it.

use super::files::file_name;
use super::{Artefact, Drawing, Repeated, Section, columns};
use crate::analysis::frontier::border::TOGETHER;
use crate::analysis::frontier::coverage::SOLVED;
use crate::analysis::frontier::map;
use crate::analysis::frontier::sight::{INTERMEDIATE, MeasureSight, SightMeans, SightSummary};
use crate::analysis::shadow::agreement::MeanStd;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::render::table::cells::{UNDEFINED, decimal, or_undefined, with_spread};
use crate::render::table::{Column, Sheet};
use crate::schema::{Frontier, RunKey};
use crate::stats;

pub(super) const SECTION: Section = Section::Named { id: "frontier", title: "The frontier" };

pub(super) const ROW: Artefact =
    Artefact::table("frontier", SECTION, "environment, curriculum and variant", sheet)
        .repeated(Repeated::Open);

pub(super) const MEASURES: Artefact =
    Artefact::table("measures", Section::Nowhere, "measure of the frontier", measures).with_parquet();

pub(super) const MAPS: Artefact = Artefact::figures("frontier", Section::Environments, draw);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let groups = analysis.groups.all.iter();
    let rows: Vec<SightSummary> = groups.flat_map(|group| SightSummary::of(group, analysis)).collect();
    let is_watched = rows.iter().any(SightSummary::is_shadow);
    let mut columns = vec![
        columns::environment(|row: &SightSummary| &row.key),
        columns::curriculum(|row| &row.key),
        columns::variant(|row| &row.key),
        columns::teacher(
            "curriculum id of the teacher whose weights and proposals are judged",
            is_watched,
            |row: &SightSummary| (&row.teacher, row.is_shadow()),
        ),
        Column::count(
            "n_measured",
            "seeds with a measure of the frontier after training had begun",
            |row: &SightSummary| row.n_seeds as u64,
        )
        .shown("Seeds", |row| row.n_seeds.to_string()),
    ];
    columns.extend(sight_columns(&ITSELF, |row| Some(&row.itself)));
    columns.extend(sight_columns(&BORDER, |row| row.border.as_ref()));
    Sheet::of(caption(is_watched), &rows, &columns)
}

/// How the columns about one kind of goals are called.
struct Names {
    share: (&'static str, &'static str, &'static str),
    proposed: (&'static str, &'static str),
    count: &'static str,
    /// Name, name of its standard deviation, title (none: not shown) and meaning.
    areas: [(&'static str, &'static str, &'static str, &'static str); 5],
}

const ITSELF: Names = Names {
    share: (
        "intermediate",
        "Goals of intermediate success",
        "share of the goals of the pool with intermediate success, mean over measures, then over seeds",
    ),
    proposed: ("proposed", ""),
    count: "n_auc",
    areas: [
        (
            "auc",
            "auc_std",
            "AUC of the weights",
            "area under the ROC curve of the teacher's weights for these goals, mean over measures, then over seeds; empty \
             where the teacher has no weights, or no measure has goals of both kinds",
        ),
        ("auc_1", "auc_1_std", "", "the same in the first third of a run"),
        ("auc_2", "auc_2_std", "", "in the second third"),
        ("auc_3", "auc_3_std", "", "in the last third"),
        (
            "auc_change",
            "auc_change_std",
            "",
            "that of the last third less that of the first, mean over the seeds that have both",
        ),
    ],
};

const BORDER: Names = Names {
    share: (
        "border",
        "Goals at the border",
        "share of the goals of the pool that lie at the border: with intermediate success of the goal and those next to it, \
         taken together; mean likewise; empty, as are the following, where nobody tells where goals lie",
    ),
    proposed: ("border_proposed", "Proposals at the border"),
    count: "n_border_auc",
    areas: [
        (
            "border_auc",
            "border_auc_std",
            "AUC at the border",
            "area under the ROC curve of the teacher's weights for the goals at the border, likewise",
        ),
        ("border_auc_1", "border_auc_1_std", "First third", "the same in the first third of a run"),
        ("border_auc_2", "border_auc_2_std", "", "in the second third"),
        ("border_auc_3", "border_auc_3_std", "Last third", "in the last third"),
        (
            "border_auc_change",
            "border_auc_change_std",
            "Change",
            "that of the last third less that of the first, mean over the seeds that have both",
        ),
    ],
};

/// The columns about one kind of goals.
fn sight_columns(
    names: &'static Names,
    of: fn(&SightSummary) -> Option<&SightMeans>,
) -> Vec<Column<'static, SightSummary>> {
    let (name, title, meaning) = names.share;
    let share = move |row: &SightSummary| of(row).map(|means| means.share);
    let proposed = move |row: &SightSummary| of(row)?.proposed;
    let mut columns = vec![
        Column::real(name, meaning, share).shown(title, move |row| or_undefined(share(row), decimal)),
        shown_if_titled(
            Column::real(
                names.proposed.0,
                "share of the goals that the teacher proposed since the evaluation before that are such goals, mean \
                 likewise; one from elsewhere counts as the nearest of the pool; empty where no shadow watched",
                proposed,
            ),
            names.proposed.1,
            move |row| or_undefined(proposed(row), decimal),
        ),
        Column::count(names.count, "seeds with the following AUC", move |row: &SightSummary| {
            of(row).map(|means| means.n_auc as u64)
        }),
    ];
    for (index, (name, std, title, meaning)) in names.areas.into_iter().enumerate() {
        let area = move |row: &SightSummary| -> MeanStd {
            of(row).map_or((None, None), |means| match index {
                0 => means.auc,
                third @ 1..=3 => means.auc_by_third[third - 1],
                _ => means.auc_change,
            })
        };
        let mean = Column::real(name, meaning, move |row: &SightSummary| area(row).0);
        columns.push(shown_if_titled(mean, title, move |row| with_spread(area(row).0, area(row).1)));
        columns.push(Column::real(
            std,
            "its standard deviation over seeds; empty for fewer than two",
            move |row: &SightSummary| area(row).1,
        ));
    }
    columns
}

/// `column`, shown below `title` if there is one.
fn shown_if_titled(
    column: Column<'static, SightSummary>,
    title: &'static str,
    text: impl Fn(&SightSummary) -> String + 'static,
) -> Column<'static, SightSummary> {
    if title.is_empty() { column } else { column.shown(title, text) }
}

fn caption(is_watched: bool) -> String {
    let watched = if is_watched {
        " Several teachers saw each student: the one that acted, and those that only watched. Proposals at the border: share \
         of the goals that a teacher proposed since the evaluation before, played or not, that lie at the border in the \
         measure; a goal that is not of the pool counts as the nearest that is. A teacher that draws evenly comes near \
         the share of such goals."
    } else {
        ""
    };
    format!(
        "Whether teachers see the frontier. At some evaluations the student's success at every goal of the pool was measured in \
         episodes that neither budget nor teacher hears of. Goals of intermediate success: share of the goals whose \
         measured success p has p(1 - p) above {INTERMEDIATE}. AUC of the weights: the probability that the teacher gave \
         such a goal more weight than another one at that moment, ties one half; 0.50 for a teacher that does not tell \
         them apart, 1.00 where all of them weigh more than all others, below 0.50 where it prefers goals that are \
         mastered or out of reach. Where every episode has the same start, a greedy student reaches a goal always or never, \
         and no goal has intermediate success by itself. Goals at the border: share of the goals that have it together with \
         those next to them in the pool, {TOGETHER} goals in all, by Euclidean distance, be there a wall in between or not; \
         AUC of the weights for these, over all measures, over those of the first and of the last third of a run, and the \
         difference of the two where a run has both. Means over measures, the untrained student's left out, then over \
         seeds ± standard deviation; {UNDEFINED} for teachers that do not weigh the pool, and where no measure has goals of \
         both kinds. Few episodes per goal make goals look intermediate, or not, by chance, which pulls the \
         AUC towards 0.50.{watched}"
    )
}

type Row<'a> = (&'a RunKey, &'a Frontier);

fn measures(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let runs = analysis.frontier.measures.iter();
    let rows: Vec<Row<'_>> =
        runs.flat_map(|(run, measures)| measures.iter().map(move |measure| (run, measure))).collect();
    let mean = |rates: Vec<f64>| stats::mean(&rates);
    let solved =
        |rates: Vec<f64>| stats::mean(&rates.iter().map(|&p| f64::from(p >= SOLVED)).collect::<Vec<_>>());
    let mut columns: Vec<Column<'_, Row<'_>>> = columns::run(|row: &Row<'_>| row.0).into();
    columns.extend([
        Column::count("step", "training steps taken in the environment", |row: &Row<'_>| row.1.step),
        Column::count(
            "eval_index",
            "index of the evaluation beside which it was measured, 0 for the untrained student",
            |row: &Row<'_>| row.1.eval_index,
        ),
        Column::count("goals", "goals of the pool", |row: &Row<'_>| row.1.successes.len() as u64),
        Column::count("episodes", "greedy episodes towards each of them", |row: &Row<'_>| row.1.episodes),
        Column::real("success", "share of all these episodes that ended in success", move |row: &Row<'_>| {
            mean(row.1.rates())
        }),
        Column::real(
            "intermediate",
            format!("share of the goals whose success p has p(1 - p) above {INTERMEDIATE}"),
            |row: &Row<'_>| MeasureSight::of(row.1).share,
        ),
        Column::real(
            "solved",
            format!("share of the goals with a success of at least {SOLVED}"),
            move |row: &Row<'_>| solved(row.1.rates()),
        ),
        Column::real(
            "auc",
            "area under the ROC curve of the teacher's weights for the goals of intermediate success; empty where the \
             teacher has no weights, or all goals are of one kind",
            |row: &Row<'_>| MeasureSight::of(row.1).auc,
        ),
    ]);
    Sheet::of(String::new(), &rows, &columns)
}

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let maps = map::maps(analysis);
    let mut drawings = Vec::new();
    for (index, frontier) in maps.iter().enumerate() {
        let id = &frontier.maze.id;
        drawings.push(Drawing {
            name: format!("frontier-{}", file_name(id, index)),
            title: format!("{id}: measured success at the goals of the pool, and the teacher's weights"),
            environment: Some(id.clone()),
            svg: figure::frontier(frontier)?,
        });
    }
    Ok(drawings)
}
