//! The command line.
//!
//! Exit codes: 0 all is well; 1 a run failed, a check found that something fell, or the report found damaged records; 2 wrong
//! input, nothing was done; 3 stopped by a signal, to be gone on with.

mod evaluate;
mod list;
mod merge;
mod profile;
mod protocol;
mod regress;
mod render;
mod report;
mod run;
mod status;
mod verify;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::Registry;
use crate::error::{HarnessError, explain};

/// Exit code where the work was done and something in it failed.
const FAILED: u8 = 1;
/// Exit code of a worker or sweep that a signal stopped: it can go on later.
const STOPPED: u8 = 3;
/// Exit code for wrong input.
pub(crate) const WRONG_INPUT: u8 = 2;
/// Exit code of a worker whose run another process is carrying out.
pub(crate) const TAKEN: u8 = 4;

/// Benchmarks automatic curricula for goal-conditioned reinforcement learning.
#[derive(Parser)]
#[command(
    name = "goalbench",
    version = env!("GOALBENCH_VERSION"),
    max_term_width = 100,
    arg_required_else_help = true,
    args_override_self = true
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// List environments, curricula, presets, suites, or every config field with its default
    List(list::Args),
    /// Train and evaluate: every environment with every curriculum and seed of a protocol
    Run(run::Args),
    /// Show how far the runs of a results folder are
    Status(status::Args),
    /// Bring the runs of several results folders together in a new one
    Merge(merge::Args),
    /// Draw the figures and tables of a results folder
    Report(report::Args),
    /// Play many more episodes with the trained policies of runs, to tell them apart
    Evaluate(evaluate::Args),
    /// Draw episodes of a trained run, or of random actions, as an animated GIF or PNG frames
    Render(render::Args),
    /// Replay traces recorded from the original environments and compare, step for step
    Verify(verify::Args),
    /// Guard against changes that make a method learn worse: record a baseline, check against it
    Regress(regress::Args),
    /// Train for a moment and show where the time goes: physics, matrix products, teacher, the rest
    Profile(profile::Args),
    /// Print built-in protocols, to start one's own from
    Protocol(protocol::Args),
    /// Carry out the one run whose manifest lies in FOLDER (what `run` starts for each run)
    #[command(hide = true)]
    Worker {
        /// The run's folder
        folder: PathBuf,
        /// Keep a TensorBoard event file
        #[arg(long)]
        tensorboard: bool,
    },
    /// Carry out task INDEX of a submitted job array (what `run --executor slurm` submits)
    #[command(hide = true)]
    Task {
        /// The list of tasks
        list: PathBuf,
        /// Which of them
        index: usize,
    },
    /// Succeed if students can live on a CUDA device here (what `run` asks before it starts any there)
    #[command(hide = true)]
    TryCuda,
}

/// The whole program with the environments and curricula of `registry`.
pub fn main(registry: Registry) -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command {
        Command::List(args) => list::list(&registry, &args),
        Command::Run(args) => run::run(&registry, &args),
        Command::Status(args) => status::show(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Report(args) => report::report(&registry, &args),
        Command::Evaluate(args) => evaluate::evaluate(&registry, &args),
        Command::Render(args) => render::render(&registry, &args),
        Command::Verify(args) => verify::verify(&args),
        Command::Regress(args) => regress::regress(&registry, &args),
        Command::Profile(args) => profile::run(&registry, &args),
        Command::Protocol(args) => protocol::protocol(&args),
        Command::Task { list, index } => run::task(&list, index),
        Command::TryCuda => run::device::try_cuda(),
        Command::Worker { folder, tensorboard } => worker(&registry, &folder, tensorboard),
    };
    result.unwrap_or_else(|error| {
        complain(&format!("goalbench: {}", explain(&error)));
        ExitCode::from(WRONG_INPUT)
    })
}

/// `goalbench worker`. Its exit code tells whether another attempt makes sense.
fn worker(registry: &Registry, folder: &Path, tensorboard: bool) -> Exit {
    match crate::executor::worker::work(registry, folder, tensorboard) {
        Ok(Some(_)) => Ok(ExitCode::SUCCESS),
        Ok(None) => Ok(ExitCode::from(STOPPED)),
        Err(HarnessError::Locked { .. }) => Ok(ExitCode::from(TAKEN)),
        Err(error) if error.is_transient() => {
            complain(&format!("goalbench: {error}"));
            Ok(ExitCode::from(FAILED))
        }
        Err(error) => Err(error),
    }
}

/// Writes to standard output. A reader that went away (`| head`) is no error.
fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Writes a line to standard error.
fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

type Exit = Result<ExitCode, HarnessError>;
