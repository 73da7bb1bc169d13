//! Set-up, quickstart, selftest, planted faults and torture of this workspace, behind the aliases
//! `cargo setup`, `cargo quickstart`, `cargo selftest`, `cargo faults` and `cargo torture`.

#![allow(clippy::print_stderr, reason = "telling the user about each step is what this program is for")]

mod cargo;
mod checks;
mod console;
mod error;
mod faults;
#[cfg(test)]
mod house;
mod pins;
mod pip;
mod setup;
mod stamp;
mod torture;
mod unpack;

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Parser, Subcommand};

use crate::{error::Result, stamp::Depth};

/// Fetches the native libraries and runs what needs them.
#[derive(Parser)]
#[command(bin_name = "cargo")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Fetch libtorch, MuJoCo and the robot models into .native (about 0.6 GB to fetch, 0.5 GB kept).
    ///
    /// Done once; later it only looks whether everything is there, and fetches anew what is missing, damaged
    /// or of another version. A folder of your own, named in LIBTORCH, MUJOCO_DYNAMIC_LINK_DIR or
    /// GOALBENCH_ASSETS, is used in place of a fetched one.
    Setup {
        /// Also compare the hash of every file with that at unpacking.
        #[arg(long)]
        verify: bool,
    },
    /// Set up if need be, build, run the small preset and draw its report.
    Quickstart {
        /// Arguments for `goalbench run`; paths are relative to the project folder.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Show that the regression gate works: plant known faults in a copy of the project, one at a time, and
    /// check each faulty program against a baseline. Takes a build and a check per fault.
    Faults {
        /// Which faults [default: all].
        #[arg(long, value_name = "NAME", value_delimiter = ',')]
        only: Vec<String>,
        /// Baseline file, relative to the project folder [default: the committed one that has what a fault
        /// touches].
        #[arg(long, value_name = "FILE")]
        baseline: Option<PathBuf>,
        /// Arguments for `goalbench regress check`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
    /// Kill sweeps, workers and merges at random moments, begin them again, and check that the results equal
    /// those of a sweep that was never killed, byte for byte.
    ///
    /// A kill takes two or three seconds. If anything differs, the exit code is 1, each difference is named
    /// and the folders are kept.
    Torture {
        #[command(flatten)]
        options: torture::Options,
    },
    /// Set up if need be and run every test of the workspace.
    Selftest {
        /// Arguments for `cargo test`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
}

/// Runs the task; the exit code is that of the first command that failed.
fn run(task: Task) -> Result<cargo::Code> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let project = package.parent().unwrap_or(package);
    let native = project.join(".native");
    match task {
        Task::Setup { verify } => {
            setup::set_up(&native, if verify { Depth::Hashes } else { Depth::Sizes })?;
            Ok(0)
        }
        Task::Quickstart { arguments } => {
            setup::set_up(&native, Depth::Sizes)?;
            cargo::quickstart(project, &arguments)
        }
        Task::Faults { only, baseline, arguments } => {
            setup::set_up(&native, Depth::Sizes)?;
            faults::faults(project, baseline.as_deref(), &only, &arguments)
        }
        Task::Torture { options } => {
            setup::set_up(&native, Depth::Sizes)?;
            torture::torture(project, &options)
        }
        Task::Selftest { arguments } => {
            setup::set_up(&native, Depth::Sizes)?;
            cargo::selftest(project, &arguments)
        }
    }
}

fn main() -> ExitCode {
    match run(Arguments::parse().task) {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            eprintln!("error: {}", error::in_one_line(&error));
            ExitCode::FAILURE
        }
    }
}
