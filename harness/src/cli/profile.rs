//! `goalbench profile`.

use super::flags::{name, whole};
use super::{Exit, print, warn_of_idle};
use crate::Registry;
use crate::config::layer::ConfigLayer;
use crate::error::HarnessError;
use crate::profile::{beside, lockstep, profile};
use crate::protocol::Protocol;
use crate::protocol::plan::{Plan, PlannedRun};
use crate::sweep::ExitCode;

#[derive(clap::Args)]
#[command(
    after_help = "The matrix products of the updates are run alone after every cycle, in the same process, and told \
    apart from the rest of the updates by subtraction. Times are those of one thread; other work on the machine disturbs them.\n\n\
    With --lanes they are those of the clock, and runs in lockstep share as many threads as there are cores for them."
)]
pub(super) struct Args {
    /// Environment to train on
    #[arg(long = "env", value_name = "ID", value_parser = name)]
    environment: String,
    /// Curriculum that teaches
    #[arg(long, value_name = "ID", value_parser = name)]
    curriculum: String,
    /// Cycles to train: with the default config 2 episodes and 40 gradient steps each
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = whole::<u64>(1..=100_000))]
    cycles: u64,
    /// Any config field but the budget, as in student.device=cuda [repeatable]
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Profile N processes at once against one alone, instead of parts
    #[arg(long, value_name = "N", value_parser = whole::<u16>(2..), group = "several")]
    beside: Option<u16>,
    /// Profile N runs in lockstep, with as many seeds, against one alone: speeds, and where the time goes
    #[arg(long, value_name = "N", value_parser = whole::<usize>(2..=1000), group = "several")]
    lanes: Option<usize>,
    /// Rounds of --beside or --lanes, one after the other
    #[arg(long, value_name = "N", default_value_t = 3, requires = "several", value_parser = whole::<u16>(1..))]
    rounds: u16,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(registry: &Registry, args: &Args) -> Exit {
    let planned = plan(registry, args)?;
    let (json, text) = match (args.beside, args.lanes) {
        (Some(runs), _) => {
            let found = beside::beside(&arguments(args), runs, args.rounds)?;
            (found.as_json(), found.as_text())
        }
        (None, Some(lanes)) => {
            let found = lockstep(registry, &planned, lanes, args.cycles, args.rounds)?;
            (found.as_json(), found.as_text())
        }
        (None, None) => {
            let found = profile(registry, &planned, args.cycles)?;
            (found.as_json(), found.as_text())
        }
    };
    print(&if args.json { format!("{json:#}\n") } else { text });
    Ok(ExitCode::Success)
}

/// The run to be profiled, its names and config checked.
fn plan(registry: &Registry, args: &Args) -> Result<PlannedRun, HarnessError> {
    for (option, names) in [("--env", &args.environment), ("--curriculum", &args.curriculum)] {
        if names.contains(',') {
            let reason =
                format!("`{names}` names several, and a profile is of one kind of run, with --lanes, too");
            return Err(HarnessError::Argument { option, reason });
        }
    }
    if registry.environment(&args.environment).is_none() {
        let accepted = registry.environments().iter().map(|entry| entry.spec.id);
        return Err(HarnessError::unknown("--env: ", "environment", &args.environment, accepted));
    }
    let mut protocol = Protocol::from_options();
    protocol.environments = vec![args.environment.clone()];
    protocol.curricula =
        registry.expand_curricula(std::slice::from_ref(&args.curriculum), "--curriculum: ")?;
    for assignment in &args.set {
        let layer = ConfigLayer::from_assignment("--set", assignment)?;
        if layer.table.contains_key("budget") {
            let reason =
                format!("`{assignment}` would change nothing; --cycles says how long a profile trains");
            return Err(HarnessError::Argument { option: "--set", reason });
        }
        protocol.set(layer);
    }
    let mut plan = Plan::new(&protocol, registry)?;
    warn_of_idle(&protocol, &plan);
    Ok(plan.runs.remove(0))
}

/// The command line of one of the processes of `--beside`.
fn arguments(args: &Args) -> Vec<String> {
    let cycles = args.cycles.to_string();
    let options =
        ["--env", &args.environment, "--curriculum", &args.curriculum, "--cycles", &cycles, "--json"];
    let set = args.set.iter().flat_map(|assignment| ["--set", assignment]);
    std::iter::once("profile").chain(options).chain(set).map(str::to_owned).collect()
}
