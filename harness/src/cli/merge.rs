//! `goalbench merge`.

use std::path::PathBuf;

use reports::wording::counted;

use super::{Exit, ExitCode, complain, print};
use crate::error::HarnessError;
use crate::merge::merge;
use crate::outputs;

#[derive(clap::Args)]
#[command(after_help = "\
Every run is checked before it is copied. Of several copies of a run the sound one that has come furthest is taken; \
damaged ones are named. Nothing is written where a run is damaged everywhere, or where copies conflict.")]
pub(super) struct Args {
    /// Results folders to bring together
    #[arg(required = true, num_args = 1..)]
    sources: Vec<PathBuf>,
    /// The new results folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(args: &Args) -> Exit {
    outputs::folder("--out", outputs::folder_of(&args.out), &[])?;
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
    for reason in merged.damaged {
        complain(&format!("goalbench: left out, another source has this run whole: {reason}"));
    }
    for stray in merged.strays {
        complain(&format!("goalbench: left out: {stray}"));
    }
    Ok(ExitCode::Success)
}
