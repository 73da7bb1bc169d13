//! `goalbench regress record`.

use std::fs;
use std::path::{Path, PathBuf};

use reports::gate::baseline::Gate;
use reports::gate::compare::{Settings, check_seeds, samples};
use reports::gate::{Baseline, cells};
use reports::wording::counted;

use super::options::{RunsArgs, SettingsArgs};
use super::{Exit, print};
use crate::Registry;
use crate::cli::flags::{ProtocolFlags, SeedsFlag, parse_seeds};
use crate::cli::{complain, warn_of_idle};
use crate::console::word;
use crate::error::{HarnessError, chain};
use crate::outputs;
use crate::protocol::Protocol;
use crate::protocol::plan::Plan;
use crate::regress;
use crate::sweep::ExitCode;

/// Seeds that a check runs unless told otherwise: the first of the protocol's.
const CHECK_SEEDS: usize = 5;

#[derive(clap::Args)]
#[command(
    after_help = "More seeds in the baseline make checks surer without making them longer: a check runs a few of them."
)]
pub(super) struct Args {
    #[command(flatten)]
    protocol: ProtocolFlags,
    /// Baseline file to write (JSON); one of this name is replaced
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    seeds: SeedsFlag,
    /// Seeds that a check runs [default: the first five]
    #[arg(long, value_name = "SEEDS")]
    check_seeds: Option<String>,
    #[command(flatten)]
    runs: RunsArgs,
    #[command(flatten)]
    settings: SettingsArgs,
}

pub(super) fn record(registry: &Registry, args: &Args) -> Exit {
    let settings = args.settings.over(Settings::default())?;
    outputs::file("--out", &args.out, &args.protocol.inputs())?;
    args.runs.check_outputs(Some(&args.out))?;
    let written = args.protocol.text()?.ok_or_else(|| HarnessError::Argument {
        option: "regress record",
        reason: "give a protocol file or --preset NAME".to_owned(),
    })?;
    let mut protocol = Protocol::parse(&written.name, &written.text, registry)?;
    protocol.refuse_search()?;
    protocol.seeds = args.seeds.or(protocol.seeds)?;
    let check = match &args.check_seeds {
        Some(text) => parse_seeds("--check-seeds", text)?,
        None => protocol.seeds.iter().copied().take(CHECK_SEEDS).collect(),
    };
    let plan = Plan::new(&protocol, registry)?;
    warn_of_idle(&protocol, &plan);
    let Some(results) = args.runs.obtain(&plan)? else { return Ok(ExitCode::Stopped) };
    let found = cells::read(results.path(), &regress::expected(&plan))?;
    if let Some(failure) = found.failures.first() {
        let reason = format!("{}; a baseline needs runs that come to their end", failure.reason);
        let mut keys = plan.runs.iter().map(|run| &run.key);
        let run = keys.find(|key| key.to_string() == failure.run).expect("only runs of the plan are read");
        return Err(HarnessError::Run { run: run.clone(), reason });
    }
    let tests = samples(&found.cells, &found.cells, settings.window).len();
    if let Err(error) = check_seeds(check.len(), protocol.seeds.len(), tests, settings.alpha) {
        complain(&format!("goalbench: only checks with --exact will take this baseline: {}", chain(&error)));
    }
    let count = found.cells.len();
    let provenance = regress::provenance(written.flag, &written.text)?;
    let baseline = Baseline::new(provenance, Gate { seeds: check, settings }, found.cells);
    write(&args.out, &baseline)?;
    print(&format!(
        "{} of {} recorded in {}; next: goalbench regress check --baseline {2}\n",
        counted(count, "cell"),
        counted(baseline.seeds.len(), "seed"),
        word(&args.out)
    ));
    Ok(ExitCode::Success)
}

/// Writes the baseline, whole or not at all, into a folder that is made if need be.
fn write(path: &Path, baseline: &Baseline) -> Result<(), HarnessError> {
    let folder = outputs::folder_of(path);
    fs::create_dir_all(folder)
        .and_then(|()| guard::fresh::write_through(path, baseline.text().as_bytes()))
        .map_err(HarnessError::io(path, "write this baseline"))
}
