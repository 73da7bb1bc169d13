//! The command line: a file or folder per command, one row each in `Command`.
//!
//! A command reads its flags, calls the library, prints to standard output, and says how it ended: an
//! [`ExitCode`], or a [`HarnessError`], which is printed with its causes and makes the exit code 2.
//!
//! # How to add a flag
//!
//! 1. Add a field to the `Args` of the command, as in `cli/run/mod.rs`. Its doc comment is the help text,
//!    whose first line is all that `-h` shows. Say the unit, and end with `[default: ...]` where clap cannot
//!    know the default, or with `[repeatable]`.
//! 2. Let clap refuse what it can: `value_parser` for ranges, `conflicts_with` and `requires` for
//!    combinations. For everything else return [`HarnessError::Argument`] with the flag's name and what is
//!    accepted.
//! 3. A flag that other commands have as well goes into a struct of `cli/flags.rs` with
//!    `#[command(flatten)]`, so that it is called, explained and read in one way.
//! 4. Hand the value on as a field of the library's own type (`Conduct`, `Reopen`, `slurm::Request`):
//!    the library knows no flags. Where it refuses a value, the command adds the flag's name with
//!    [`HarnessError::flag`]. A flag that is short for a config field, as `--steps` is, becomes a
//!    [`ConfigLayer`](crate::config::layer::ConfigLayer) instead.
//! 5. Add a wrong value to `harness/tests/wrong_input.rs` and the flag to the page that tells of its command
//!    (`harness/docs/`).

mod completions;
mod evaluate;
mod export;
mod flags;
mod help;
mod list;
mod merge;
mod misuse;
mod pack;
mod profile;
mod protocol;
mod quickstart;
mod regress;
mod render;
mod report;
mod run;
mod status;
mod unpack;
mod verify;

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

use clap::{Parser, Subcommand};

use crate::Registry;
use crate::console::{self, complain, print};
use crate::error::{HarnessError, chain};
use crate::estimate;
use crate::protocol::Protocol;
use crate::protocol::plan::Plan;
use crate::sweep::{ExitCode, local, trial, worker};

/// Benchmarks automatic curricula for goal-conditioned reinforcement learning.
#[derive(Parser)]
#[command(
    name = "goalbench",
    version = env!("GOALBENCH_VERSION"),
    max_term_width = 100,
    arg_required_else_help = true,
    args_override_self = true,
    disable_help_subcommand = true
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Train a small comparison and draw its report: TEACH against HER-IID on a maze and on FetchReach
    Quickstart(quickstart::Args),
    /// List environments, curricula, presets, suites, or every config field with its default
    List(list::Args),
    /// Train and evaluate: every environment with every curriculum and seed of a protocol
    Run(run::Args),
    /// Show how far the runs of a results folder are
    Status(status::Args),
    /// Bring the runs of several results folders together in a new one
    Merge(merge::Args),
    /// Pack a results folder as one file that can be cited and given away
    Pack(pack::Args),
    /// Unpack an archive of `pack` into a new results folder
    Unpack(unpack::Args),
    /// Draw the figures and tables of a results folder
    Report(report::Args),
    /// Play many more episodes with the trained policies of runs, to tell them apart
    Evaluate(evaluate::Args),
    /// Write a trained policy in open formats, for other programs
    Export(export::Args),
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
    /// Print a script that completes commands and options in a shell
    Completions(completions::CompletionsArgs),
    /// Write a page of the manual for each command
    Man(completions::ManArgs),
    /// Explain a command, or print a page: every config field (`help config`), a curriculum in Python (`help
    /// python`), a tutorial; `help help` lists them
    Help(help::Args),
    /// Carry out the runs whose manifests lie in FOLDERS, in lockstep (what `run` starts for each cohort)
    #[command(hide = true)]
    Worker {
        /// The runs' folders
        #[arg(required = true)]
        folders: Vec<PathBuf>,
        /// Keep a TensorBoard event file
        #[arg(long)]
        tensorboard: bool,
        /// Remove the replay buffer of a run once it has finished
        #[arg(long)]
        discard_replay: bool,
        /// Threads for all runs
        #[arg(long, default_value_t = 1)]
        threads: usize,
        /// Lanes that a GPU's products are made for
        #[arg(long, default_value_t = 1)]
        width: usize,
        /// Let two halves of the cohort take turns between cores and device
        #[arg(long)]
        overlap: bool,
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
    /// Try out runs given as JSON lines (what `run` starts before it writes anything)
    #[command(hide = true)]
    TryRuns,
    /// Measure how fast runs are, which are given as JSON lines (what `run --dry-run` starts)
    #[command(hide = true)]
    MeasureRuns {
        /// Cohorts at a time
        parallel: usize,
        /// Threads of each, at most
        threads: usize,
    },
}

/// The whole program with the environments and curricula of `registry`. It ends the process, with an
/// [`ExitCode`].
pub fn main(registry: Registry) -> ! {
    let cli: Cli = match misuse::parse() {
        Ok(cli) => cli,
        Err(answer) => console::end(without_a_command(answer)),
    };
    outlive_file_limits();
    let result = match cli.command {
        Command::Quickstart(args) => quickstart::quickstart(&registry, &args),
        Command::List(args) => list::list(&registry, &args),
        Command::Run(args) => run::run(&registry, &args),
        Command::Status(args) => status::show(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Pack(args) => pack::run(&registry, &args),
        Command::Unpack(args) => unpack::run(&args),
        Command::Report(args) => report::report(&registry, &args),
        Command::Evaluate(args) => evaluate::evaluate(&registry, &args),
        Command::Export(args) => export::export(&registry, &args),
        Command::Render(args) => render::render(&registry, &args),
        Command::Verify(args) => verify::verify(&args),
        Command::Regress(args) => regress::regress(&registry, &args),
        Command::Profile(args) => profile::run(&registry, &args),
        Command::Protocol(args) => protocol::protocol(&args),
        Command::Completions(args) => completions::completions(&registry, &misuse::command::<Cli>(), &args),
        Command::Man(args) => completions::man(&misuse::command::<Cli>(), &args),
        Command::Help(args) => help::help(&registry, misuse::command::<Cli>(), &args),
        Command::Task { list, index } => run::task(&list, index),
        Command::TryCuda => local::device::try_cuda(),
        Command::TryRuns => trial::try_runs(&registry),
        Command::MeasureRuns { parallel, threads } => estimate::measure_runs(&registry, parallel, threads),
        Command::Worker { folders, tensorboard, discard_replay, threads, width, overlap } => {
            let keeping = worker::Keeping { tensorboard, discard_replay, threads, width, overlap };
            let worked = worker::work(&registry, &folders, keeping);
            worked.errors.iter().for_each(complain_of);
            Ok(worked.code())
        }
    };
    let code = result.unwrap_or_else(|error| {
        complain_of(&error);
        if is_want_of_room(&error) { ExitCode::Failed } else { ExitCode::WrongInput }
    });
    console::end(code)
}

/// Shows the help or version that was asked for, or what is wrong with the command line.
fn without_a_command(answer: clap::Error) -> ExitCode {
    if answer.use_stderr() {
        // Nobody is left to be told if this fails.
        let _ = std::io::stderr().write_all(misuse::text::<Cli>(answer).as_bytes());
        return ExitCode::WrongInput;
    }
    console::printed(|| answer.print().and_then(|()| std::io::stdout().flush()));
    ExitCode::Success
}

/// Makes a file that outgrows the system's limit (`ulimit -f`) an error of that write, like a full disk,
/// where it would end the process.
fn outlive_file_limits() {
    // If the system refuses, all stays as it was.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Whether a disk was full, or a limit on files reached: no input of the user's was wrong.
fn is_want_of_room(error: &HarnessError) -> bool {
    use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    let causes = std::iter::successors(Some(error as &dyn std::error::Error), |error| error.source());
    let mut kinds = causes.filter_map(|cause| Some(cause.downcast_ref::<std::io::Error>()?.kind()));
    kinds.any(|kind| matches!(kind, StorageFull | QuotaExceeded | FileTooLarge))
}

/// Writes an error and what caused it to standard error.
fn complain_of(error: &HarnessError) {
    complain(&format!("goalbench: {}", chain(error)));
}

/// Warns of what changes nothing in a plan.
fn warn_of_idle(protocol: &Protocol, plan: &Plan) {
    for note in protocol.idle(plan) {
        complain(&format!("goalbench: warning: {note}"));
    }
}

type Exit = Result<ExitCode, HarnessError>;
