//! `goalbench regress check`.

use std::path::PathBuf;

use reports::gate::compare::{self, compare};
use reports::gate::output::{self, Check};
use reports::gate::{Baseline, cells};

use super::options::{RunsArgs, SettingsArgs, name_options};
use super::{Exit, print};
use crate::Registry;
use crate::cli::complain;
use crate::cli::flags::{ProtocolFlags, name, parse_seeds};
use crate::config::layer::ConfigLayer;
use crate::error::HarnessError;
use crate::outputs;
use crate::paper;
use crate::protocol::Protocol;
use crate::protocol::plan::Plan;
use crate::regress;
use crate::sweep::ExitCode;

#[derive(clap::Args)]
#[command(
    after_help = "The baseline holds its protocol. Where PROTOCOL or --preset is given too, it must still be that one: a \
    protocol that was changed since it was recorded is refused.\n\nExit code 0: nothing fell. 1: something did, or a run failed. 2: wrong input, or a baseline of \
    another config or schema. 3: stopped by a signal."
)]
pub(super) struct Args {
    #[command(flatten)]
    protocol: ProtocolFlags,
    /// Baseline file, as written by `goalbench regress record`
    #[arg(long, value_name = "FILE")]
    baseline: PathBuf,
    /// Seeds instead of those that the baseline names; others than it recorded are compared by statistics
    /// alone
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<String>,
    /// Only these of the baseline's environments
    #[arg(long = "env", alias = "environment", value_name = "ID,...", value_delimiter = ',', value_parser = name)]
    environments: Vec<String>,
    /// Only these of the baseline's curricula
    #[arg(long = "curriculum", value_name = "ID,...", value_delimiter = ',', value_parser = name)]
    curricula: Vec<String>,
    /// What a changed setting does to learning, as in `student.precision="bf16"`: the runs are carried out
    /// with it, the baseline was recorded without
    #[arg(long = "set", value_name = "KEY=VALUE", conflicts_with = "exact")]
    settings_changed: Vec<String>,
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
    same_protocol(&baseline, args)?;
    let settings = args.settings.over(baseline.gate.settings)?;
    if let Some(folder) = &args.out {
        outputs::folder("--out", folder, &[args.baseline.as_path()])?;
    }
    args.runs.check_outputs(args.out.as_deref())?;
    let mut protocol = regress::protocol(&baseline, &args.baseline, registry)?;
    let mut notes = narrow(&mut protocol, registry, args)?;
    protocol.seeds = match &args.seeds {
        Some(text) => parse_seeds("--seeds", text)?,
        None => baseline.gate.seeds.clone(),
    };
    let recorded = Plan::new(&protocol, registry)?;
    let before = baseline.cells_of(&regress::expected(&recorded), &args.baseline)?;
    notes.extend(regress::foreign(&baseline));
    for assignment in &args.settings_changed {
        protocol.set(ConfigLayer::from_assignment("--set", assignment)?);
        notes.push(format!("the baseline was recorded without --set {assignment}"));
    }
    let plan = Plan::new(&protocol, registry)?;
    let expected = regress::expected(&plan);
    check_evaluations(&recorded, &plan)?;
    if !args.exact {
        // Told before anything is run.
        let tests = compare::samples(&before, &before, settings.window).len();
        compare::check_seeds(protocol.seeds.len(), baseline.seeds.len(), tests, settings.alpha)
            .map_err(name_options("--seeds"))?;
    }

    let Some(results) = args.runs.obtain(&plan)? else { return Ok(ExitCode::Stopped) };
    let found = cells::read(results.path(), &expected)?;
    let result = compare(&before, &found.cells, found.failures, settings);
    let catalogue = paper::catalogue(registry);
    let check = Check {
        result: &result,
        before: &before,
        now: &found.cells,
        exact: args.exact,
        notes,
        catalogue: &catalogue,
    };
    print(&if args.json { format!("{:#}\n", output::json(&check)) } else { output::text(&check) });
    if let Some(folder) = &args.out {
        for path in output::write(&check, folder)? {
            complain(&path.display().to_string());
        }
    }
    Ok(if check.passed() { ExitCode::Success } else { ExitCode::Failed })
}

/// # Errors
/// [`HarnessError::Argument`] if a protocol is given that the baseline was not recorded with.
fn same_protocol(baseline: &Baseline, args: &Args) -> Result<(), HarnessError> {
    let Some(written) = args.protocol.text()? else { return Ok(()) };
    if regress::provenance(written.flag, &written.text)?.protocol == baseline.protocol {
        return Ok(());
    }
    let reason = format!(
        "{} is not the protocol that {} was recorded with ({}); record the baseline again, or give that one",
        written.name,
        args.baseline.display(),
        baseline.source,
    );
    Err(HarnessError::Argument { option: "PROTOCOL", reason })
}

/// Checks that the runs of `plan` are evaluated as those that were `recorded`: other curves compare with
/// nothing.
fn check_evaluations(recorded: &Plan, plan: &Plan) -> Result<(), HarnessError> {
    let same = recorded.runs.iter().zip(&plan.runs).all(|(before, now)| {
        before.config.budget == now.config.budget && before.config.evaluation == now.config.evaluation
    });
    if same {
        return Ok(());
    }
    let reason = "settings of `budget` and `evaluation` stay the baseline's, so that curves can be compared; \
                  record a baseline with others";
    Err(HarnessError::Argument { option: "--set", reason: reason.to_owned() })
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
