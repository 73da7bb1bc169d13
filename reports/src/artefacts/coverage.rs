//! Of the goals of the pool: what was ever solved, what was forgotten, how the hardest fare.

use super::frontier::SECTION;
use super::{Artefact, Repeated, columns};
use crate::analysis::frontier::coverage::{Coverage, CoverageSummary, FORGOTTEN, SOLVED};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{UNDEFINED, decimal, or_undefined};
use crate::render::table::{Column, Sheet};

pub(super) const ROW: Artefact =
    Artefact::table("coverage", SECTION, "environment, curriculum and variant", sheet)
        .repeated(Repeated::Open);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let groups = analysis.groups.all.iter();
    let rows: Vec<CoverageSummary> =
        groups.filter_map(|group| CoverageSummary::of(group, &analysis.frontier)).collect();
    Sheet::of(caption(), &rows, &columns())
}

fn columns() -> [Column<'static, CoverageSummary>; 9] {
    [
        columns::environment(|row| &row.key),
        columns::curriculum(|row| &row.key),
        columns::variant(|row| &row.key),
        Column::count(
            "n_measured",
            "seeds with a measure of the frontier, or that failed before it",
            |row: &CoverageSummary| row.n_seeds as u64,
        )
        .shown("Seeds", |row| row.n_seeds.to_string()),
        share("success", "success at the goals of the pool in the last measure".into(), "Success", |mean| {
            Some(mean.success)
        }),
        share(
            "solved",
            format!("share of the goals that had a success of at least {SOLVED} in some measure"),
            "Ever solved",
            |mean| Some(mean.solved),
        ),
        share(
            "forgotten",
            format!(
                "share of these with a success below {FORGOTTEN} in the last measure; empty where none was solved"
            ),
            "Forgotten",
            |mean| mean.forgotten,
        ),
        share(
            "cvar_10",
            "success in the last measure over the worst 10 % of the goals".into(),
            "Worst 10 %",
            |mean| Some(mean.worst_tenth),
        ),
        share("cvar_25", "the same over the worst 25 %".into(), "Worst 25 %", |mean| {
            Some(mean.worst_quarter)
        }),
    ]
}

/// A mean over seeds.
fn share(
    name: &'static str,
    meaning: String,
    title: &'static str,
    of: fn(&Coverage) -> Option<f64>,
) -> Column<'static, CoverageSummary> {
    Column::real(name, format!("{meaning}; mean over seeds"), move |row: &CoverageSummary| of(&row.mean))
        .shown(title, move |row| or_undefined(of(&row.mean), decimal))
}

fn caption() -> String {
    format!(
        "How much of the pool students cover, by the measures of the frontier: means over the seeds whose run has ended (where \
         none has, over all). A run that failed counts 0 from its failure on, unless failures are left out: it has success at \
         no goal, and has forgotten what it had solved. Success: at all goals in the last measure. Ever solved: share of the goals with a success of at least {SOLVED} in some measure. Forgotten: \
         share of these whose success lies below {FORGOTTEN} in the last measure; {UNDEFINED} where none was solved. Worst \
         10 % and 25 %: success in the last measure over the goals at which it is lowest (conditional value at \
         risk); with few episodes per goal chance makes it look lower than it is."
    )
}
