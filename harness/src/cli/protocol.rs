//! `goalbench protocol`.

use super::{Exit, print};
use crate::protocol::presets;
use crate::sweep::ExitCode;

#[derive(clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Print a preset as the TOML protocol that it is
    Show {
        /// Its name; `goalbench list presets` names them all
        name: String,
    },
}

pub(super) fn protocol(args: &Args) -> Exit {
    let Command::Show { name } = &args.command;
    print(presets::find(name)?.text);
    Ok(ExitCode::Success)
}
