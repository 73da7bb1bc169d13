//! The whole report of a results folder.

mod analysis;
mod figures;
mod files;
mod tables;

use std::path::{Path, PathBuf};

use crate::environment::{EnvironmentInfo, MazeInfo};
use crate::error::ReportError;
use crate::render::page::{Page, READINGS};
use crate::render::table::{Table, markdown_escape};
use crate::stats::Resampling;
use crate::store::Store;
use crate::store::layout;
use crate::store::problem::Problem;
use analysis::{Analysis, Groups};
use tables::Tables;

/// What a report can be told.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Evaluations of a seed that its final score averages, and that steps to a success rate look back on.
    pub window: usize,
    /// How bootstrap intervals are made.
    pub resampling: Resampling,
    /// Dimensions for the table of environments; those that were not run are left out.
    pub environments: Vec<EnvironmentInfo>,
    /// Mazes to draw heat maps of; those that were not run are left out.
    pub mazes: Vec<MazeInfo>,
}

impl Default for Options {
    /// The last 5 evaluations; [`Resampling::default`]; nothing known of environments.
    fn default() -> Self {
        Self { window: 5, resampling: Resampling::default(), environments: Vec::new(), mazes: Vec::new() }
    }
}

impl Options {
    fn check(&self) -> Result<(), ReportError> {
        let wrong = |option, value: String, accepted| Err(ReportError::Option { option, value, accepted });
        let Resampling { resamples, confidence, .. } = self.resampling;
        if self.window == 0 {
            return wrong("window", "0".into(), "at least 1 evaluation");
        }
        if resamples == 0 {
            return wrong("resampling.resamples", "0".into(), "at least 1 resample");
        }
        if !(confidence > 0.0 && confidence < 1.0) {
            return wrong("resampling.confidence", confidence.to_string(), "a number in (0, 1)");
        }
        self.mazes.iter().try_for_each(MazeInfo::check)
    }
}

/// What a report consists of.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The files written, in order: the page, tables and data, figures, and the list of them all.
    pub files: Vec<PathBuf>,
    /// What is wrong with the results, for the caller to show.
    pub problems: Vec<Problem>,
    /// What the report lacks for being complete, in words.
    pub missing: Vec<String>,
    /// Runs and evaluations that the report rests on.
    pub runs: usize,
    /// Evaluations of all runs.
    pub evaluations: usize,
}

/// Writes figures and tables of all evaluations so far into `results/report/`. Each file is replaced atomically, files
/// of the report before that this one lacks are removed; the same results give the same bytes.
///
/// # Errors
/// What [`Store::read`] refuses; [`ReportError::NoRecords`] if there is nothing to draw; [`ReportError::Option`];
/// [`ReportError::Io`] if a file cannot be written.
pub fn write(results: &Path, options: &Options) -> Result<Written, ReportError> {
    options.check()?;
    let store = Store::read(results)?;
    if store.is_empty() {
        return Err(ReportError::NoRecords {
            path: results.to_owned(),
            runs: store.runs().len(),
            problems: store.problems().to_vec(),
        });
    }
    let groups = Groups::of(&store, options);
    let analysis = Analysis::of(results, &groups, options);
    // The problems of all files, for the report and for the caller.
    let mut problems = [store.problems(), &analysis.heat.problems].concat();
    problems.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
    let tables = Tables::of(&store, &groups, &analysis, options);
    let missing = tables::missing(&groups, &analysis, options);
    let figures = figures::figures(&groups, &analysis, options)?;
    let page = Page {
        store: &store,
        problems: &problems,
        pictures: &figures.pictures,
        environments: &groups.environments(),
        summary: &tables.summary,
        costs: &tables.costs,
        teaching: tables.teaching.as_ref(),
        runs: &tables.runs,
        aggregates: tables.aggregates.as_ref(),
        comparisons: tables.comparisons.as_ref(),
        ledger: &tables.ledger,
        readings: tables.readings.as_ref(),
        dimensions: tables.dimensions.as_ref(),
        deviations: &tables.deviations,
        missing: &missing,
    };
    let mut files = vec![
        ("index.html".into(), page.html().into_bytes()),
        ("summary.md".into(), markdown(&store, &tables, &missing, &problems).into_bytes()),
    ];
    files.extend(tables::files(&store, &groups, &analysis, &tables, options)?);
    files.extend(figures.files);

    let files = files::write_all(&layout::report_dir(results), files)?;
    Ok(Written { files, problems, missing, runs: store.runs().len(), evaluations: store.len() })
}

/// The report as Markdown: all tables, and what is missing or wrong.
fn markdown(store: &Store, tables: &Tables, missing: &[String], problems: &[Problem]) -> String {
    let (evaluations, runs) = (store.len(), store.runs().len());
    let summary = tables.summary.markdown();
    let mut text = format!(
        "# Results\n\n{evaluations} evaluations of {runs} runs.\n\n\
         ![Success rate over training](figures/grid.png)\n\n{summary}"
    );
    let mut section = |title: &str, table: Option<&Table>| {
        let table = table.map(|table| format!("\n## {title}\n\n{}", table.markdown()));
        text.push_str(&table.unwrap_or_default());
    };
    section("What training took", Some(&tables.costs));
    section("What teachers picked", tables.teaching.as_ref());
    section("Claims of the paper", Some(&tables.ledger));
    section(READINGS, tables.readings.as_ref());
    section("Across environments", tables.aggregates.as_ref());
    section("Comparisons", tables.comparisons.as_ref());
    section("Dimensions of the environments", tables.dimensions.as_ref());
    section("Deviations from the paper", Some(&tables.deviations));
    let mut list = |title: &str, items: Vec<String>| {
        if !items.is_empty() {
            text.push_str(&format!("\n## {title} ({})\n\n", items.len()));
            text.extend(items.iter().map(|item| format!("- {}\n", markdown_escape(item))));
        }
    };
    list("Missing", missing.to_vec());
    list("Problems", problems.iter().map(Problem::to_string).collect());
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_outside_their_range_are_named() {
        let options = Options { window: 0, ..Options::default() };
        let error = write(Path::new("does-not-matter"), &options).unwrap_err();
        assert_eq!(error.to_string(), "option window is 0; expected at least 1 evaluation");
    }
}
