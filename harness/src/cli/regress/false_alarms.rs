//! `goalbench regress false-alarms`.

use std::path::PathBuf;

use reports::gate::Baseline;
use reports::gate::false_alarms::{self, Simulation};
use reports::wording::{counted, counted_u64};

use super::options::{SettingsArgs, name_options};
use super::{Exit, print};
use crate::Registry;
use crate::cli::flags::whole;
use crate::protocol::plan::Plan;
use crate::regress;
use crate::sweep::ExitCode;

#[derive(clap::Args)]
#[command(
    after_help = "Exit code 1 if a larger share than --alpha failed. The same options give the same draws."
)]
pub(super) struct Args {
    /// Baseline file with more seeds than --now and --before together
    #[arg(long, value_name = "FILE")]
    baseline: PathBuf,
    /// Seeds of each simulated check
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole::<usize>(..))]
    now: usize,
    /// Other seeds that it is compared with
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = whole::<usize>(..))]
    before: usize,
    /// Simulated checks
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = whole::<u64>(..))]
    draws: u64,
    /// Seed of the draws
    #[arg(long, value_name = "SEED", default_value_t = 0, value_parser = whole::<u64>(..))]
    seed: u64,
    #[command(flatten)]
    settings: SettingsArgs,
}

pub(super) fn simulate(registry: &Registry, args: &Args) -> Exit {
    let baseline = Baseline::read(&args.baseline)?;
    let settings = args.settings.over(baseline.gate.settings)?;
    let plan = Plan::new(&regress::protocol(&baseline, &args.baseline, registry)?, registry)?;
    let cells = baseline.cells_of(&regress::expected(&plan), &args.baseline)?;
    let simulation = Simulation { now: args.now, before: args.before, draws: args.draws, seed: args.seed };
    let alarms =
        false_alarms::simulate(&cells, simulation, settings).map_err(name_options("--now, --before"))?;
    print(&format!(
        "{} of {} of {} against {} others failed: {:.2} % (95 % interval {:.2} % to {:.2} %); alpha {}, smallest \
         effect {}\n",
        alarms.failed,
        counted_u64(alarms.draws, "check"),
        counted(args.now, "seed"),
        args.before,
        alarms.rate() * 100.0,
        alarms.interval.0 * 100.0,
        alarms.interval.1 * 100.0,
        settings.alpha,
        settings.smallest_effect
    ));
    Ok(if alarms.rate() <= settings.alpha { ExitCode::Success } else { ExitCode::Failed })
}
