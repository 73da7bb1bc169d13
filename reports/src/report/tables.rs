//! Which tables a report has, and what it lacks.

use std::path::PathBuf;

use super::Options;
use super::analysis::{Analysis, Groups};
use super::files::File;
use crate::analysis::ablation::AXES;
use crate::analysis::group::GroupKey;
use crate::analysis::missing;
use crate::environment::EnvironmentInfo;
use crate::error::ReportError;
use crate::render::table::{self, Table};
use crate::store::Store;
use crate::{dictionary, methods};

/// All tables to read; `None` where there is nothing to say.
pub(super) struct Tables {
    pub(super) summary: Table,
    pub(super) costs: Table,
    pub(super) teaching: Option<Table>,
    /// Single runs; for the page and the data alone: it is long.
    pub(super) runs: Table,
    pub(super) aggregates: Option<Table>,
    pub(super) comparisons: Option<Table>,
    pub(super) ledger: Table,
    pub(super) readings: Option<Table>,
    pub(super) dimensions: Option<Table>,
    pub(super) deviations: Table,
}

impl Tables {
    pub(super) fn of(store: &Store, groups: &Groups<'_>, analysis: &Analysis<'_>, options: &Options) -> Self {
        let Options { window, resampling, .. } = *options;
        let across = &analysis.across;
        let aggregates =
            || table::aggregate_table(&across.aggregates, &across.environments, &across.left_out, resampling);
        let comparisons = || table::comparison_table(&analysis.comparisons, resampling);
        let dimensions = dimensions(groups, options);
        Self {
            summary: table::summary_table(&analysis.rows, window, resampling),
            costs: table::cost_table(&analysis.rows),
            teaching: (!analysis.teaching.is_empty()).then(|| table::teaching_table(&analysis.teaching)),
            runs: table::run_table(store.runs(), window, resampling.confidence),
            aggregates: (!across.aggregates.is_empty()).then(aggregates),
            comparisons: (!analysis.comparisons.is_empty()).then(comparisons),
            ledger: table::ledger_table(&analysis.ledger, window, resampling),
            readings: (!analysis.readings.families.is_empty())
                .then(|| table::readings_table(&analysis.readings, window, resampling)),
            deviations: table::deviation_table(),
            dimensions: (!dimensions.is_empty()).then(|| table::environment_table(&dimensions)),
        }
    }

    /// Those that are files of their own, with the names of these.
    fn named(&self) -> impl Iterator<Item = (&'static str, &Table)> {
        let all = [
            ("summary", Some(&self.summary)),
            ("costs", Some(&self.costs)),
            ("teaching", self.teaching.as_ref()),
            ("aggregates", self.aggregates.as_ref()),
            ("comparisons", self.comparisons.as_ref()),
            ("ledger", Some(&self.ledger)),
            ("readings", self.readings.as_ref()),
            ("environments", self.dimensions.as_ref()),
            ("deviations", Some(&self.deviations)),
        ];
        all.into_iter().filter_map(|(name, table)| Some((name, table?)))
    }
}

/// What is known of the environments that were run.
fn dimensions<'a>(groups: &Groups<'_>, options: &'a Options) -> Vec<&'a EnvironmentInfo> {
    let run = groups.environments();
    options.environments.iter().filter(|info| run.contains(&info.id.as_str())).collect()
}

/// Every table as LaTeX, its numbers as CSV, and the tidy data with its dictionary.
pub(super) fn files(
    store: &Store,
    groups: &Groups<'_>,
    analysis: &Analysis<'_>,
    tables: &Tables,
    options: &Options,
) -> Result<Vec<File>, ReportError> {
    let latex = |(name, table): (&str, &Table)| {
        (PathBuf::from(format!("tables/{name}.tex")), table.latex().into_bytes())
    };
    let Options { window, resampling, .. } = *options;
    let mut files: Vec<File> = tables.named().map(latex).collect();
    let across = &analysis.across;
    let frames = [
        ("summary.csv", table::summary_frame(&analysis.rows)?),
        ("costs.csv", table::cost_frame(&analysis.rows)?),
        ("teaching.csv", table::teaching_frame(&analysis.teaching)?),
        ("aggregates.csv", table::aggregate_frame(&across.aggregates, across.environments.len())?),
        ("comparisons.csv", table::comparison_frame(&analysis.comparisons)?),
        ("ledger.csv", table::ledger_frame(&analysis.ledger)?),
        ("readings.csv", table::readings_frame(&analysis.readings)?),
        ("environments.csv", table::environment_frame(&dimensions(groups, options))?),
    ];
    for (name, frame) in frames {
        files.push((name.into(), table::csv(frame)?));
    }
    for (name, frame) in [
        ("records", store.frame()?),
        ("runs", table::run_frame(store.runs(), window, resampling.confidence)?),
    ] {
        files.push((format!("{name}.parquet").into(), table::parquet(frame.clone())?));
        files.push((format!("{name}.csv").into(), table::csv(frame)?));
    }
    files.push(("DATA.md".into(), dictionary::markdown(options).into_bytes()));
    Ok(files)
}

/// What the report lacks, in words.
pub(super) fn missing(groups: &Groups<'_>, analysis: &Analysis<'_>, options: &Options) -> Vec<String> {
    let mut lacking = missing::runs(&groups.all, &groups.compared_groups());
    lacking.extend(missing::runs(&groups.all, &groups.variant_groups()));
    lacking.extend(missing::of_the_paper(&groups.all));
    if analysis.across.environments.is_empty() {
        lacking.push("sums over environments: no two methods share two environments".to_owned());
    }
    for key in &analysis.across.left_out {
        let name = format!("{}{}", methods::title(&key.curriculum), key.detail());
        lacking.push(format!("sums over environments leave out {name}, which lacks too many of them"));
    }
    match groups.left_out() {
        0 => {}
        k => lacking.push(format!(
            "comparisons, ledger and sums over environments rest on finished runs of the same evaluations; left \
             out of all runs of methods: {k}"
        )),
    }
    for (axis, ablations) in AXES.iter().zip(&analysis.ablations) {
        if ablations.is_empty() {
            let field = axis.pointer.trim_start_matches('/').replace('/', ".");
            lacking.push(format!("Figure {} of the paper: no variants differ in {field} alone", axis.figure));
        }
    }
    for id in groups.environments() {
        if options.environments.iter().all(|info| info.id != id) {
            lacking.push(format!("{id}: dimensions not known to this report"));
        }
    }
    for maze in &options.mazes {
        let drawn = |key: &GroupKey| {
            analysis.heat.mazes.iter().flat_map(|heat| &heat.maps).any(|map| map.key == *key)
        };
        for group in groups.compared_groups() {
            let key = &group.key;
            if key.environment == maze.id && !drawn(key) {
                let name = format!("{}{}", methods::title(&key.curriculum), key.detail());
                lacking
                    .push(format!("{}: {name}: no record of what the teacher did, so no heat map", maze.id));
            }
        }
    }
    lacking.extend(missing::any_success(&groups.all));
    lacking.extend(missing::picks(&groups.all));
    let silent = analysis.rows.iter().filter(|row| {
        row.cost.wall_hours.is_some()
            && (row.cost.teacher_hours.is_none() || row.cost.learning_hours.is_none())
    });
    let silent = silent.count();
    if silent > 0 {
        let all = analysis.rows.len();
        lacking.push(format!(
            "the teacher's and the student's share of time: timings of {silent} of {all} methods do not tell"
        ));
    }
    if groups.curves.iter().any(|curve| curve.points.iter().any(|point| point.hours.is_none())) {
        lacking.push("timings of some evaluations: figures over wall-clock time leave them out".to_owned());
    }
    lacking
}
