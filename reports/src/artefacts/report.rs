//! The whole report of a results folder.

use std::path::{Path, PathBuf};

use super::files::{self, File};
use super::heading::Heading;
use super::made::{Made, make, shown};
use super::{ARTEFACTS, Artefact, Content, Section, page};
use crate::analysis::comparison::{ALPHA, TARGET_POWER};
use crate::analysis::complete;
use crate::analysis::groups::Groups;
use crate::analysis::guests::{self, Guest};
use crate::analysis::missing;
use crate::analysis::options::ReportOptions;
use crate::analysis::subset::Subset;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{self, markdown_escape};
use crate::store::Store;
use crate::store::layout;
use crate::store::problem::StoreProblem;
use crate::store::protocols;
use crate::wording::counted;

/// What a report consists of.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The files written, in order: the page, tables and data, figures, and the list of them all.
    pub files: Vec<PathBuf>,
    /// What is wrong with the results, for the caller to show.
    pub problems: Vec<StoreProblem>,
    /// What the report lacks for being complete, in words.
    pub missing: Vec<String>,
    /// Runs that the report rests on.
    pub runs: usize,
    /// Evaluations of all runs.
    pub evaluations: usize,
}

/// Writes figures and tables of all evaluations so far into `results/report/`. Each file is replaced
/// atomically, files of the report before that this one lacks are removed; the same results give the same
/// bytes.
///
/// # Errors
/// What [`Store::read`] refuses; [`ReportError::NotInResults`]; [`ReportError::NoRecords`] if there is
/// nothing to draw;
/// [`ReportError::Option`];
/// [`ReportError::InTheWay`] if something that no report wrote has the name of a file;
/// [`ReportError::Io`] if a file cannot be written.
pub fn write(results: &Path, options: &ReportOptions) -> Result<Written, ReportError> {
    write_beside(results, Vec::new(), options)
}

/// [`write()`], with results of others drawn beside these and marked by their names. They decide no verdict
/// on a claim, and their runs are paired with others of the same seed only where they were made alike.
///
/// # Errors
/// As [`write()`]; [`ReportError::Guest`].
pub fn write_beside(
    results: &Path,
    guests: Vec<Guest>,
    options: &ReportOptions,
) -> Result<Written, ReportError> {
    options.check()?;
    let mut store = Store::read(results)?;
    let subset = Subset::cut(&mut store, options)?;
    let mut catalogue = options.catalogue.clone();
    let beside = guests::welcome(&mut store, &mut catalogue, guests, &options.curricula)?;
    let options = &ReportOptions { catalogue, ..options.clone() };
    let (protocols, unreadable) = protocols::protocols(results);
    if store.is_empty() {
        return Err(ReportError::NoRecords {
            path: results.to_owned(),
            runs: store.runs().len(),
            problems: store.problems().to_vec(),
        });
    }
    let completed = complete::failed_as_zero(&store, options.failures);
    let groups = Groups::of(&store, &completed, options);
    let analysis = Analysis::of(results, (&store, &protocols), &groups, options);
    let heading = Heading::of(options, &protocols, subset.as_ref(), &beside);
    // The problems of all files, for the report and for the caller.
    let problems = store.problems().iter().chain(analysis.problems()).chain(&unreadable);
    let mut problems: Vec<StoreProblem> = problems.cloned().collect();
    problems.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
    let missing = missing::all(&analysis);
    let made: Result<Vec<Made>, ReportError> = ARTEFACTS.iter().map(|row| make(row, &analysis)).collect();
    let made = made?;

    let mut files: Vec<File> = vec![
        ("index.html".into(), page::html(&analysis, &heading, &made, &missing, &problems).into_bytes()),
        ("summary.md".into(), markdown(&analysis, &heading, &made, &missing, &problems).into_bytes()),
    ];
    for (artefact, sheet) in shown(&made) {
        files.push((format!("tables/{}.tex", artefact.id).into(), sheet.table.latex().into_bytes()));
    }
    for made in &made {
        files.extend(data(made)?);
    }
    files.push(("DATA.md".into(), dictionary(options, &made).into_bytes()));
    files.extend(made.into_iter().flat_map(|made| made.figures));

    let files = files::write_all(&layout::report_dir(results), files)?;
    Ok(Written { files, problems, missing, runs: store.runs().len(), evaluations: store.len() })
}

/// The numbers of a table as CSV, and as Parquet where there is such a file.
pub(super) fn data(made: &Made) -> Result<Vec<File>, ReportError> {
    let Some(sheet) = made.sheet.as_ref().filter(|sheet| !sheet.dictionary.is_empty()) else {
        return Ok(Vec::new());
    };
    let Artefact { id, content, .. } = made.artefact;
    let csv = (format!("{id}.csv").into(), table::csv(sheet.data.clone())?);
    Ok(match content {
        Content::Table { parquet: true, .. } => {
            vec![(format!("{id}.parquet").into(), table::parquet(sheet.data.clone())?), csv]
        }
        _ => vec![csv],
    })
}

/// The report as Markdown: all tables, and what is missing or wrong.
fn markdown(
    analysis: &Analysis<'_>,
    heading: &Heading,
    made: &[Made],
    missing: &[String],
    problems: &[StoreProblem],
) -> String {
    let (evaluations, runs) = (analysis.store.len(), analysis.store.runs().len());
    let mut text = format!("# {}\n\n", markdown_escape(&heading.title));
    text.extend(heading.lines.iter().map(|line| format!("{}\n\n", markdown_escape(line))));
    let (evaluations, runs) = (counted(evaluations, "evaluation"), counted(runs, "run"));
    text += &format!("{evaluations} of {runs}.\n\n![Success rate over training](figures/grid.png)\n");
    let mut last = super::RESULTS;
    for (artefact, sheet) in shown(made) {
        if let Section::Named { title, .. } = artefact.section
            && artefact.section != last
        {
            text.push_str(&format!("\n## {title}\n"));
        }
        last = artefact.section;
        text.push_str(&format!("\n{}", sheet.table.markdown()));
    }
    let mut list = |title: &str, items: Vec<String>| {
        if !items.is_empty() {
            text.push_str(&format!("\n## {title} ({})\n\n", items.len()));
            text.extend(items.iter().map(|item| format!("- {}\n", markdown_escape(item))));
        }
    };
    list("Missing", missing.to_vec());
    list("Problems", problems.iter().map(StoreProblem::to_string).collect());
    text
}

/// What every column of the table's files of data means.
fn entry(made: &Made) -> Option<String> {
    let Content::Table { parquet, .. } = made.artefact.content else { return None };
    let id = made.artefact.id;
    let names = if parquet { format!("{id}.csv, {id}.parquet") } else { format!("{id}.csv") };
    columns_of(made, &names)
}

/// What every column of a table means, below the names of its files.
pub(super) fn columns_of(made: &Made, names: &str) -> Option<String> {
    let Content::Table { row, .. } = made.artefact.content else { return None };
    let sheet = made.sheet.as_ref().filter(|sheet| !sheet.dictionary.is_empty())?;
    Some(format!("\n## {names}: one row per {row}\n\n{}", sheet.dictionary_markdown()))
}

/// The data dictionary: what every column of every file of data means.
fn dictionary(options: &ReportOptions, made: &[Made]) -> String {
    format!(
        "# Data dictionary\n\nThe numbers behind the report, unrounded. CSV and Parquet of one name hold the same; an \
         empty field of a CSV is null in Parquet. Final success: over the last {} of a run. Intervals: {} \
         %, bootstrap with {} resamples where not said otherwise. Detectable differences: at level {ALPHA} over the number of \
         tests, with a power of {TARGET_POWER}.\n{}",
        counted(options.window, "evaluation"),
        options.resampling.confidence * 100.0,
        options.resampling.resamples,
        made.iter().filter_map(entry).collect::<String>(),
    )
}
