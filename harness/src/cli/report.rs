//! `goalbench report`.

use std::path::PathBuf;

use reports::ReportOptions;

use super::{Exit, ExitCode, complain, print};
use crate::{Registry, paper};

#[derive(clap::Args)]
pub(super) struct Args {
    /// Results folder, as written by `goalbench run`
    results: PathBuf,
}

pub(super) fn report(registry: &Registry, args: &Args) -> Exit {
    let options = ReportOptions { catalogue: paper::catalogue(registry), ..ReportOptions::default() };
    let written = reports::write(&args.results, &options)?;
    for path in &written.files {
        print(&format!("{}\n", path.display()));
    }
    for missing in &written.missing {
        complain(&format!("missing: {missing}"));
    }
    for problem in &written.problems {
        complain(&format!("goalbench: {problem}"));
    }
    Ok(if written.problems.is_empty() { ExitCode::Success } else { ExitCode::Failed })
}
