//! `goalbench regress record`.

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use reports::gate::baseline::Gate;
use reports::gate::compare::{Settings, check_seeds, samples};
use reports::gate::{Baseline, cells};

use super::options::{RunsArgs, SettingsArgs};
use super::{Exit, STOPPED, print};
use crate::Registry;
use crate::cli::complain;
use crate::config::seeds;
use crate::error::HarnessError;
use crate::protocol::plan::Plan;
use crate::protocol::{Protocol, presets};
use crate::regress;

/// Seeds that a check runs unless told otherwise: the first of the protocol's.
const CHECK_SEEDS: usize = 5;

#[derive(clap::Args)]
#[command(
    after_help = "More seeds in the baseline make checks surer without making them longer: a check runs a few of them."
)]
pub(super) struct Args {
    /// Protocol file (TOML)
    #[arg(long, value_name = "FILE", required_unless_present = "preset", conflicts_with = "preset")]
    protocol: Option<PathBuf>,
    /// Built-in protocol; `goalbench list presets` names them
    #[arg(long, value_name = "NAME")]
    preset: Option<String>,
    /// Baseline file to write (JSON)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Seeds instead of the protocol's: a range such as 0..12 (0 to 11), a list such as 0,3
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<String>,
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
    let (source, name, text) = protocol_text(args)?;
    let mut protocol = Protocol::parse(&name, &text, registry)?;
    if let Some(text) = &args.seeds {
        protocol.seeds = parse_seeds("--seeds", text)?;
    }
    let check = match &args.check_seeds {
        Some(text) => parse_seeds("--check-seeds", text)?,
        None => protocol.seeds.iter().copied().take(CHECK_SEEDS).collect(),
    };
    let plan = Plan::new(&protocol, registry)?;
    let Some(results) = args.runs.obtain(&plan)? else { return Ok(ExitCode::from(STOPPED)) };
    let found = cells::read(results.path(), &regress::expected(&plan))?;
    if let Some(failure) = found.failures.first() {
        let reason = format!("{}; a baseline needs runs that come to their end", failure.reason);
        return Err(HarnessError::Run { run: failure.run.clone(), reason });
    }
    let tests = samples(&found.cells, &found.cells, settings.window).len();
    if let Err(error) = check_seeds(check.len(), protocol.seeds.len(), tests, settings.alpha) {
        complain(&format!("goalbench: only checks with --exact will take this baseline: {error}"));
    }
    let count = found.cells.len();
    let provenance = regress::provenance(source, &text)?;
    let baseline = Baseline::new(provenance, Gate { seeds: check, settings }, found.cells);
    fs::write(&args.out, baseline.text()).map_err(HarnessError::io(&args.out, "write this baseline"))?;
    print(&format!(
        "{count} cells of {} seeds recorded in {}; next: goalbench regress check --baseline {1}\n",
        baseline.seeds.len(),
        args.out.display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// The options that name the protocol, what errors call it, and its TOML.
fn protocol_text(args: &Args) -> Result<(String, String, String), HarnessError> {
    match (&args.protocol, &args.preset) {
        (Some(path), _) => {
            let text = fs::read_to_string(path).map_err(HarnessError::io(path, "read this protocol"))?;
            let name = path.display().to_string();
            Ok((format!("--protocol {name}"), name, text))
        }
        (None, name) => {
            let preset = presets::find(name.as_deref().unwrap_or_default())?;
            Ok((
                format!("--preset {}", preset.name),
                format!("preset {}", preset.name),
                preset.text.to_owned(),
            ))
        }
    }
}

/// Seeds as an option gives them.
pub(super) fn parse_seeds(option: &'static str, text: &str) -> Result<Vec<u64>, HarnessError> {
    seeds::parse(text).map_err(|reason| HarnessError::Argument { option, reason })
}
