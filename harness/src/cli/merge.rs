//! `goalbench merge`.

use std::path::PathBuf;

use reports::wording::counted;

use super::{Exit, ExitCode, print};
use crate::error::HarnessError;
use crate::merge::merge;

#[derive(clap::Args)]
pub(super) struct Args {
    /// Results folders to bring together
    #[arg(required = true, num_args = 1..)]
    sources: Vec<PathBuf>,
    /// The new results folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(args: &Args) -> Exit {
    let merged = merge(&args.sources, &args.out).map_err(|error| match error {
        HarnessError::Exists { .. } => HarnessError::flag("--out")(error),
        error => error,
    })?;
    print(&format!(
        "{} in {} ({} of them found more than once)\n",
        counted(merged.runs, "run"),
        args.out.display(),
        merged.shared
    ));
    Ok(ExitCode::Success)
}
