//! `goalbench regress check`.

use std::path::PathBuf;

use super::options::{RunsArgs, SettingsArgs};
use super::{Exit, print};
use crate::Registry;
use crate::cli::complain;
use crate::cli::flags::parse_seeds;
use crate::error::HarnessError;
use crate::protocol::Protocol;
use crate::protocol::plan::Plan;
use crate::regress::compare::{self, compare};
use crate::regress::output::{self, Check};
use crate::regress::{Baseline, cells};
use crate::run::manifest::{self, COMMIT};
use crate::sweep::ExitCode;

#[derive(clap::Args)]
#[command(
    after_help = "Exit code 0: nothing fell. 1: something did, or a run broke down. 2: wrong input, or a baseline of \
    another config or schema. 3: stopped by a signal."
)]
pub(super) struct Args {
    /// Baseline file, as written by `goalbench regress record`
    #[arg(long, value_name = "FILE")]
    baseline: PathBuf,
    /// Seeds instead of those that the baseline names; others than it recorded are compared by statistics
    /// alone
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<String>,
    /// Only these of the baseline's environments
    #[arg(long = "env", alias = "environment", value_name = "ID,...", value_delimiter = ',')]
    environments: Vec<String>,
    /// Only these of the baseline's curricula
    #[arg(long = "curriculum", value_name = "ID,...", value_delimiter = ',')]
    curricula: Vec<String>,
    /// Fail where any run differs from the baseline's in any byte (for the machine that recorded it)
    #[arg(long)]
    exact: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Folder for regression.json, junit.xml, summary.md and the figure (SVG, PNG)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    runs: RunsArgs,
    #[command(flatten)]
    settings: SettingsArgs,
}

pub(super) fn check(registry: &Registry, args: &Args) -> Exit {
    let baseline = Baseline::read(&args.baseline)?;
    let settings = args.settings.over(baseline.gate.settings)?;
    let mut protocol = baseline.protocol(&args.baseline, registry)?;
    let mut notes = narrow(&mut protocol, registry, args)?;
    protocol.seeds = match &args.seeds {
        Some(text) => parse_seeds("--seeds", text)?,
        None => baseline.gate.seeds.clone(),
    };
    let plan = Plan::new(&protocol, registry)?;
    let before = baseline.cells_of(&plan, &args.baseline)?;
    notes.extend(foreign(&baseline));
    if !args.exact {
        // Told before anything is run.
        let tests = compare::samples(&before, &before, settings.window).len();
        compare::check_seeds(protocol.seeds.len(), baseline.seeds.len(), tests, settings.alpha)?;
    }

    let Some(results) = args.runs.obtain(&plan)? else { return Ok(ExitCode::Stopped) };
    let found = cells::read(results.path(), &plan)?;
    let comparison = compare(&before, &found.cells, found.failures, settings);
    let check =
        Check { comparison: &comparison, before: &before, now: &found.cells, exact: args.exact, notes };
    print(&if args.json { format!("{:#}\n", output::json(&check)) } else { output::text(&check) });
    if let Some(folder) = &args.out {
        for path in output::write(&check, folder)? {
            complain(&path.display().to_string());
        }
    }
    Ok(if check.passed() { ExitCode::Success } else { ExitCode::Failed })
}

/// Narrows `protocol` to what the options name, and says what is left out.
fn narrow(protocol: &mut Protocol, registry: &Registry, args: &Args) -> Result<Vec<String>, HarnessError> {
    let mut notes = Vec::new();
    if !args.environments.is_empty() {
        let chosen = registry.expand_environments(&args.environments, "--env: ")?;
        notes.extend(keep(&mut protocol.environments, &chosen, "--env")?);
    }
    if !args.curricula.is_empty() {
        let chosen = registry.expand_curricula(&args.curricula, "--curriculum: ")?;
        notes.extend(keep(&mut protocol.curricula, &chosen, "--curriculum")?);
    }
    Ok(notes)
}

/// Keeps those of `list` that are `chosen`, and names the others.
fn keep(
    list: &mut Vec<String>,
    chosen: &[String],
    option: &'static str,
) -> Result<Option<String>, HarnessError> {
    if let Some(foreign) = chosen.iter().find(|id| !list.contains(id)) {
        let reason = format!("the baseline has no {foreign}; it has {}", list.join(", "));
        return Err(HarnessError::Argument { option, reason });
    }
    let (kept, left): (Vec<String>, Vec<String>) = list.drain(..).partition(|id| chosen.contains(id));
    *list = kept;
    Ok((!left.is_empty()).then(|| format!("left out by {option}: {}", left.join(", "))))
}

/// How this machine differs from the one that recorded, in a line each: with any of them curves need not be
/// identical.
fn foreign(baseline: &Baseline) -> Vec<String> {
    let now = manifest::versions();
    let version = |(name, there): (&String, &String)| {
        let here = now.get(name).map_or("none", String::as_str);
        (here != there).then(|| format!("{name} is {here} here, the baseline was recorded with {there}"))
    };
    let compared = baseline.versions.iter().filter(|(name, _)| name.as_str() != COMMIT);
    let mut notes: Vec<String> = compared.filter_map(version).collect();
    let cpu = crate::regress::baseline::cpu();
    if cpu != baseline.cpu {
        notes.push(format!(
            "the processor is {cpu} here, {} in the baseline: rounding may differ",
            baseline.cpu
        ));
    }
    notes
}
