//! `goalbench regress`: the regression gate.

mod check;
mod false_alarms;
mod options;
mod record;

use clap::Subcommand;

use super::{Exit, print};
use crate::Registry;

#[derive(clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Carry out a protocol and keep its curves as the baseline of later checks
    Record(record::Args),
    /// Carry out a baseline's protocol again and compare: exit code 1 if anything learned worse
    Check(check::Args),
    /// Count how often unchanged code would fail, by splitting the runs of a large baseline at random
    FalseAlarms(false_alarms::Args),
}

pub(super) fn regress(registry: &Registry, args: &Args) -> Exit {
    match &args.command {
        Command::Record(args) => record::record(registry, args),
        Command::Check(args) => check::check(registry, args),
        Command::FalseAlarms(args) => false_alarms::simulate(registry, args),
    }
}
