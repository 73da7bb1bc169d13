//! `goalbench unpack`.

use std::path::PathBuf;

use reports::wording::counted;

use super::{Exit, ExitCode, print};
use crate::archive::{Unpacked, unpack_to};
use crate::error::HarnessError;
use crate::outputs;

#[derive(clap::Args)]
#[command(after_help = "\
Every file is checked against the archive's checksums, and the runs as those of any results folder, before the new \
folder appears. `goalbench report` draws it.")]
pub(super) struct Args {
    /// Archive, as written by `goalbench pack`
    archive: PathBuf,
    /// New results folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(args: &Args) -> Exit {
    outputs::folder("--out", outputs::folder_of(&args.out), &[])?;
    let Unpacked { store, sha256 } = unpack_to(&args.archive, &args.out).map_err(|error| match error {
        HarnessError::Exists { .. } => HarnessError::flag("--out")(error),
        error => error,
    })?;
    print(&format!("{}: {}\nSHA-256 {sha256}\n", args.out.display(), counted(store.runs().len(), "run")));
    Ok(ExitCode::Success)
}
