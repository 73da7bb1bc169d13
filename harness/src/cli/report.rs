//! `goalbench report`.

use std::path::{Path, PathBuf};

use reports::analysis::options::{Bands, FEWEST_PAIRS, Failures, MARGIN};
use reports::stats::Resampling;
use reports::store::layout;
use reports::store::problem::StoreProblem;
use reports::wording::counted;
use reports::{Guest, ReportOptions};

use super::flags::{QuietFlag, between, name, one_of, whole};
use super::{Exit, ExitCode, complain, print};
use crate::archive::{Unpacked, name_of, unpack};
use crate::error::HarnessError;
use crate::status::{Activity, RunStatus, status};
use crate::{Registry, outputs, paper};

#[derive(clap::Args)]
pub(super) struct Args {
    /// Results folder, as written by `goalbench run`
    results: PathBuf,
    /// Number of evaluations at the end of a run that its final success is averaged over
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole::<u16>(1..))]
    window: u16,
    /// Coverage of intervals; verdicts are false with at most the remaining probability
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = between(0.5))]
    confidence: f64,
    /// Largest difference in success rate that still counts as none
    #[arg(long, value_name = "RATE", default_value_t = MARGIN, value_parser = between(0.0))]
    margin: f64,
    /// Fewest pairs of runs with the same seed, in all environments together, for a verdict
    #[arg(long, value_name = "N", default_value_t = FEWEST_PAIRS as u16, value_parser = whole::<u16>(1..))]
    fewest_pairs: u16,
    /// Runs that failed: success 0 from then on, or left out and counted
    #[arg(long, value_name = "HOW", default_value = Failures::default().as_str(), value_parser = one_of(Failures::ALL, Failures::as_str))]
    failures: Failures,
    /// Judge claims also where both sides train different students
    #[arg(long)]
    mixed_students: bool,
    /// Draw the student's losses, values and gradients, and the numbers that teachers record
    #[arg(long)]
    diagnostics: bool,
    /// Only these environments of the results, by id, separated by commas
    #[arg(long, value_name = "ID,...", value_delimiter = ',', value_parser = name)]
    environments: Vec<String>,
    /// Only these curricula of the results, by id, separated by commas
    #[arg(long, value_name = "ID,...", value_delimiter = ',', value_parser = name)]
    curricula: Vec<String>,
    /// Archive of `goalbench pack` to draw beside these results, marked by its name [repeatable]
    #[arg(long = "with", value_name = "NAME.tar.zst")]
    with: Vec<PathBuf>,
    /// What stands above the report [default: the names of the protocols]
    #[arg(long, value_name = "TEXT", value_parser = title)]
    title: Option<String>,
    #[command(flatten)]
    quiet: QuietFlag,
    /// Bands of learning curves: spread of seeds (std), standard error (sem) or t interval (ci) of the mean
    #[arg(long, value_name = "WHAT", default_value = Bands::default().as_str(), value_parser = one_of(Bands::ALL, Bands::as_str))]
    bands: Bands,
    /// Fit the axes of rates to the data instead of 0 to 1; such axes are marked
    #[arg(long)]
    zoom: bool,
}

/// A title that can be read.
pub(super) fn title(text: &str) -> Result<String, &'static str> {
    let is_readable = !text.trim().is_empty() && !text.chars().any(char::is_control);
    is_readable.then(|| text.trim().to_owned()).ok_or("a line of text is accepted")
}

impl Args {
    fn options(&self, registry: &Registry) -> ReportOptions {
        ReportOptions {
            window: self.window.into(),
            resampling: Resampling { confidence: self.confidence, ..Resampling::default() },
            margin: self.margin,
            fewest_pairs: self.fewest_pairs.into(),
            failures: self.failures,
            mixed_students: self.mixed_students,
            diagnostics: self.diagnostics,
            environments: self.environments.clone(),
            curricula: self.curricula.clone(),
            title: self.title.clone(),
            zoom: self.zoom,
            bands: self.bands,
            catalogue: paper::catalogue(registry),
        }
    }
}

/// The results in the archive at `path`, which its file's name marks.
fn guest(path: &Path) -> Result<Guest, HarnessError> {
    let wrong = |reason: String| HarnessError::Argument { option: "--with", reason };
    let name = name_of(path).map_err(wrong)?;
    let file = path.file_name().unwrap_or_default().display();
    let Unpacked { store, sha256 } = unpack(path).map_err(HarnessError::flag("--with"))?;
    let source = format!("{} in {file} (SHA-256 {sha256})", counted(store.runs().len(), "run"));
    Ok(Guest { name: name.to_owned(), source, store })
}

/// Damaged runs that `problems` do not name: of a run that may go on, records must fit its checkpoint, which
/// reports do not read.
fn damaged_besides(results: &Path, problems: &[StoreProblem]) -> Result<Vec<RunStatus>, HarnessError> {
    let is_named = |run: &RunStatus| {
        let folder = layout::run_dir(Path::new(""), &run.run);
        problems.iter().any(|problem| problem.path.starts_with(&folder))
    };
    let mut runs = status(results)?.runs;
    runs.retain(|run| run.activity == Activity::Damaged && !is_named(run));
    Ok(runs)
}

pub(super) fn report(registry: &Registry, args: &Args) -> Exit {
    let folder = reports::store::layout::report_dir(&args.results);
    if args.results.is_dir() {
        outputs::folder("report", &folder, &[])?;
    }
    let guests = args.with.iter().map(|path| guest(path)).collect::<Result<Vec<_>, _>>()?;
    let written = reports::write_beside(&args.results, guests, &args.options(registry))?;
    if !args.quiet.quiet {
        written.files.iter().for_each(|path| print(&format!("{}\n", path.display())));
        written.missing.iter().for_each(|missing| complain(&format!("missing: {missing}")));
    }
    for problem in &written.problems {
        complain(&format!("goalbench: {problem}"));
    }
    let damaged = damaged_besides(&args.results, &written.problems)?;
    for run in &damaged {
        complain(&format!("goalbench: {}: {}", run.run, run.reason.as_deref().unwrap_or("damaged")));
    }
    Ok(if written.problems.is_empty() && damaged.is_empty() { ExitCode::Success } else { ExitCode::Failed })
}
