//! What students could really do at every goal of their pools: whether teachers see the frontier, and maps of
//! it.

use super::files::file_name;
use super::{Artefact, Drawing, Repeated, Section, columns};
use crate::analysis::frontier::border::TOGETHER;
use crate::analysis::frontier::coverage::SOLVED;
use crate::analysis::frontier::map;
use crate::analysis::frontier::sight::{AreaMeans, INTERMEDIATE, MeasureSight, SightMeans, SightSummary};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::render::table::cells::{UNDEFINED, decimal, or_undefined};
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
    let is_watched = rows.iter().any(|row| row.teacher.is_shadow());
    let mut columns = columns::of_teacher(
        "curriculum id of the teacher whose scores, weights and proposals are judged",
        is_watched,
        |row: &SightSummary| &row.teacher.key,
        |row| &row.teacher,
    );
    columns.push(
        Column::count(
            "n_measured",
            "seeds with a measure of the frontier after training had begun",
            |row: &SightSummary| row.n_seeds as u64,
        )
        .shown("Seeds", |row| row.n_seeds.to_string()),
    );
    columns.extend(sight_columns(&ITSELF, |row| Some(&row.itself)));
    columns.extend(sight_columns(&BORDER, |row| row.border.as_ref()));
    Sheet::of(caption(is_watched), &rows, &columns)
}

/// How the columns about one kind of goals are called.
struct Names {
    /// Before the names of all but the first.
    prefix: &'static str,
    /// Name, title and meaning.
    share: (&'static str, &'static str, &'static str),
    /// Title (none: not shown).
    proposed: &'static str,
    weights: AreaNames,
    scores: AreaNames,
}

/// How the columns about an area are called.
struct AreaNames {
    /// Titles (none: not shown): over all of a run, over each third, and of the change.
    titles: [&'static str; 5],
    meaning: &'static str,
}

const ITSELF: Names = Names {
    prefix: "",
    share: (
        "intermediate",
        "Goals of intermediate success",
        "share of the goals of the pool with intermediate success, mean over measures, then over seeds",
    ),
    proposed: "",
    weights: AreaNames {
        titles: ["AUC of the weights", "", "", "", ""],
        meaning: "area under the ROC curve of the teacher's weights for these goals, mean over measures, then over \
                  seeds; empty where the teacher has no weights, or no measure has goals of both kinds",
    },
    scores: AreaNames {
        titles: ["AUC of the scores", "", "", "", ""],
        meaning: "the same of the teacher's scores, over the goals that have one; empty where it scores none",
    },
};

const BORDER: Names = Names {
    prefix: "border_",
    share: (
        "border",
        "Goals at the border",
        "share of the goals of the pool that lie at the border: with intermediate success of the goal and those next to it, \
         taken together; mean likewise; empty, as are the following, where nobody tells where goals lie",
    ),
    proposed: "Proposals at the border",
    weights: AreaNames {
        titles: ["AUC of weights at the border", "First third", "", "Last third", "Change"],
        meaning: "area under the ROC curve of the teacher's weights for the goals at the border, likewise",
    },
    scores: AreaNames {
        titles: ["AUC of scores at the border", "First third of it", "", "Last third of it", "Change of it"],
        meaning: "the same of the teacher's scores, over the goals that have one, likewise",
    },
};

/// The columns about one kind of goals.
fn sight_columns(
    names: &'static Names,
    of: fn(&SightSummary) -> Option<&SightMeans>,
) -> Vec<Column<'static, SightSummary>> {
    let (name, title, meaning) = names.share;
    let share = move |row: &SightSummary| of(row).map(|means| means.share);
    let proposed = move |row: &SightSummary| of(row)?.proposed;
    let proposals = Column::real(
        format!("{}proposed", names.prefix),
        "share of the goals that the teacher proposed since the evaluation before that are such goals, mean \
         likewise; one from elsewhere counts as the nearest of the pool; empty where no shadow watched",
        proposed,
    );
    let mut columns = vec![
        Column::real(name, meaning, share).shown(title, move |row| or_undefined(share(row), decimal)),
        columns::titled(proposals, names.proposed, move |row| or_undefined(proposed(row), decimal)),
    ];
    let (weights, scores) = (format!("{}roc_auc", names.prefix), format!("{}score_roc_auc", names.prefix));
    columns.extend(area_columns(&weights, &names.weights, move |row| Some(of(row)?.weights)));
    columns.extend(area_columns(&scores, &names.scores, move |row| Some(of(row)?.scores)));
    columns
}

/// The columns about an area.
fn area_columns(
    name: &str,
    AreaNames { titles: [all, first, second, last, change], meaning }: &AreaNames,
    of: impl Fn(&SightSummary) -> Option<AreaMeans> + Copy + 'static,
) -> Vec<Column<'static, SightSummary>> {
    let count = move |row: &SightSummary| of(row).map(|means| means.parts.n_seeds as u64);
    let mut columns = vec![Column::count(format!("n_{name}"), "seeds with the following AUC", count)];
    columns.extend(columns::by_part(name, [all, first, second, last], meaning, move |row| {
        of(row).map(|means| means.parts).unwrap_or_default()
    }));
    columns.extend(columns::mean_std(
        format!("{name}_change"),
        change,
        "that of the last third less that of the first, mean over the seeds that have both",
        move |row| of(row).map(|means| means.change).unwrap_or_default(),
    ));
    columns
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
         mastered or out of reach. AUC of the scores: the same of what the teacher scores goals by, over those that it has \
         scored; weights follow from scores in each method's own way, and may follow from other things besides. Where every \
         episode has the same start, a greedy student reaches a goal always or never, and no goal has intermediate \
         success by itself. Goals at the border: share of the goals that have it together with those next to them in \
         the pool, {TOGETHER} goals in all, by Euclidean distance, be there a wall in between or not; AUC of weights \
         and of scores for these, over all measures, over those of the first and of the last third of a run's budget, and \
         the difference of the two where a run has both. Means over measures, the untrained student's left out, then over \
         the seeds whose run has ended (where none has, over all) ± standard deviation; of a run that failed the measures \
         before count. {UNDEFINED} for teachers that do not weigh the pool, or score no goals, and where no measure has \
         goals of both kinds. Few episodes per goal make goals look intermediate, or not, by chance, which pulls the \
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
            "roc_auc",
            "area under the ROC curve of the teacher's weights for the goals of intermediate success; empty where the \
             teacher has no weights, or all goals are of one kind",
            |row: &Row<'_>| MeasureSight::of(row.1).weights,
        ),
        Column::real(
            "score_roc_auc",
            "the same of the teacher's scores, over the goals that have one; empty likewise",
            |row: &Row<'_>| MeasureSight::of(row.1).scores,
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
