//! `goalbench export`.

use std::path::PathBuf;

use super::{Exit, ExitCode, print};
use crate::Registry;
use crate::error::HarnessError;
use crate::export::ExportedPolicy;
use crate::outputs;
use crate::run::folder::{outcome, read_manifest};
use crate::run::policy::Policy;

#[derive(clap::Args)]
#[command(after_help = "\
DIR/policy.safetensors holds weights, biases and the scaling of inputs, DIR/policy.json says what they are: layers, \
observation layout, action range, environment, seed, config hash, versions. The policy is that of the run's last \
checkpoint; the run is only read, and may be in progress.")]
pub(super) struct Args {
    /// Folder of a run (RESULTS/runs/.../seed-N)
    run: PathBuf,
    /// New folder to write the policy into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn export(registry: &Registry, args: &Args) -> Exit {
    let policy = Policy::read(registry, &args.run)?;
    outcome(&args.run, &read_manifest(&args.run)?.0)?;
    outputs::outside_runs("--out", &args.out, &args.run)?;
    outputs::folder("--out", outputs::folder_of(&args.out), &[])?;
    let written = ExportedPolicy::of(registry, &policy)?.write(&args.out).map_err(|error| match error {
        HarnessError::Exists { .. } => HarnessError::flag("--out")(error),
        error => error,
    })?;
    for path in written {
        print(&format!("{}\n", path.display()));
    }
    Ok(ExitCode::Success)
}
