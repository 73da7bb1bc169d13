//! `goalbench run`.

mod dry;
mod phase;
mod search;
mod summary;

use std::path::{Path, PathBuf};

use guard::text::short;

use super::flags::{DetailFlags, JobsFlag, ProtocolFlags, SeedsFlag, name, whole};
use super::{Exit, print, warn_of_idle};
use crate::Registry;
use crate::config::layer::ConfigLayer;
use crate::error::HarnessError;
use crate::outputs;
use crate::protocol::Protocol;
use crate::protocol::plan::Plan;
use crate::sweep::signals::Stopper;
use crate::sweep::{ExitCode, Lanes, Prepared, reporter};
use phase::Command;
use summary::summarise;

#[derive(clap::Args)]
#[command(after_help = "Without PROTOCOL and --preset, --env and --curriculum say what to run.\n\
    Runs that are already finished in the results folder are kept; one recorded with another config is refused.")]
pub(super) struct Args {
    #[command(flatten)]
    protocol: ProtocolFlags,
    /// Environments or suites instead of the protocol's, separated by commas
    #[arg(long = "env", value_name = "ID,...", value_delimiter = ',', value_parser = name)]
    environments: Vec<String>,
    /// Curricula instead of the protocol's, separated by commas
    #[arg(long = "curriculum", value_name = "ID,...", value_delimiter = ',', value_parser = name)]
    curricula: Vec<String>,
    /// Curricula that watch each run and propose goals that nobody plays, separated by commas, or `all`;
    /// short for --set shadow=[ID,...]
    #[arg(long, value_name = "all|ID,...", value_delimiter = ',', value_parser = name)]
    shadow: Vec<String>,
    #[command(flatten)]
    seeds: SeedsFlag,
    /// Training steps per run, as in 100000, 1e5 or 100k; short for --set budget.steps=N
    #[arg(long, value_name = "N", value_parser = whole::<u64>(..))]
    steps: Option<u64>,
    /// Where the student computes: cpu or cuda; short for --set student.device=NAME
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    /// Any config field, as in curriculum.teach.window=5; `goalbench help config` explains them all
    /// [repeatable]
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Results folder [default: results/NAME, after the protocol's name]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    jobs: JobsFlag,
    /// Runs that one worker trains in lockstep, at most: a number, or `auto`, which is 1 on a CPU and as many
    /// as fit the memory on a GPU. They are of one environment, and their students' gradient steps are alike
    #[arg(long, value_name = "N|auto", default_value = "auto")]
    lanes: Lanes,
    /// Let two halves of each cohort take turns: one plays its episodes on the cores while the other learns
    /// on the device. Meant for a GPU, which would wait otherwise; on a CPU, whose cores do both, little is
    /// gained
    #[arg(long)]
    overlap: bool,
    /// How often a run whose worker crashed is begun again from its checkpoint
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = whole::<u32>(..))]
    retries: u32,
    #[command(flatten)]
    detail: DetailFlags,
    /// Print progress as JSON lines on standard output, for scripts
    #[arg(long, conflicts_with_all = ["dry_run", "quiet", "verbose"])]
    json: bool,
    /// Keep a TensorBoard event file beside each run's records (tensorboard --logdir DIR/runs)
    #[arg(long)]
    tensorboard: bool,
    /// Let runs that failed (diverged learning, unstable physics) go on from their last checkpoint, too; on
    /// the CPU they fail again at the same step unless the program changed
    #[arg(long)]
    retry_failed: bool,
    /// Train runs that were recorded with a smaller budget on to this one: they go on from their last
    /// checkpoint, and what they have recorded stays
    #[arg(long)]
    extend: bool,
    /// Remove the replay buffer of each run when it finishes, which saves 10 to 400 MB a run of the paper's
    /// length; the run cannot be trained on with --extend then
    #[arg(long)]
    discard_replay: bool,
    /// Where runs are carried out
    #[arg(long, value_enum, default_value_t = Executor::Local)]
    executor: Executor,
    #[command(flatten)]
    slurm: SlurmArgs,
    /// Print the plan and what it would take at this machine's speed, and change nothing
    #[arg(long)]
    dry_run: bool,
    /// Print the resolved config of every kind of run in the plan, as TOML, and do nothing else
    #[arg(long, conflicts_with_all = ["dry_run", "json"])]
    print_config: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Executor {
    /// Worker processes on this machine
    Local,
    /// A Slurm job array
    Slurm,
}

/// Options of `--executor slurm`.
#[derive(clap::Args)]
#[command(next_help_heading = "With --executor slurm")]
struct SlurmArgs {
    /// Partition of the tasks
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Time limit of a task, as in 12:00:00; a run that needs longer goes on when the same command submits it
    /// again
    #[arg(long, value_name = "TIME")]
    time: Option<String>,
    /// Memory of a task, as in 2G
    #[arg(long, value_name = "SIZE")]
    mem: Option<String>,
    /// Most tasks at once
    #[arg(long, value_name = "N", value_parser = whole::<u32>(1..))]
    at_once: Option<u32>,
    /// Runs per array task, or cohorts with --lanes, one after the other [default: 1]
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..))]
    chunk: Option<u16>,
    /// A further option for sbatch, as in --sbatch=--account=me [repeatable]
    #[arg(long = "sbatch", value_name = "OPTION", allow_hyphen_values = true)]
    extra: Vec<String>,
}

/// Refuses options that the chosen executor would ignore.
fn check_executor(args: &Args) -> Result<(), HarnessError> {
    let SlurmArgs { partition, time, mem, at_once, chunk, extra } = &args.slurm;
    let given = [
        ("--partition", partition.is_some()),
        ("--time", time.is_some()),
        ("--mem", mem.is_some()),
        ("--at-once", at_once.is_some()),
        ("--chunk", chunk.is_some()),
        ("--sbatch", !extra.is_empty()),
    ];
    match (args.executor, given.iter().find(|(_, given)| *given)) {
        (Executor::Local, Some((option, _))) => {
            Err(HarnessError::Argument { option, reason: "is for job arrays; add --executor slurm".into() })
        }
        (Executor::Slurm, _) if args.json => {
            let reason = "tells of runs on this machine; for job arrays use goalbench status --json".into();
            Err(HarnessError::Argument { option: "--json", reason })
        }
        (Executor::Slurm, _) if args.jobs.is_given() => {
            let reason = "is for runs on this machine; with --executor slurm use --at-once".into();
            Err(HarnessError::Argument { option: "--jobs", reason })
        }
        _ => Ok(()),
    }
}

impl Args {
    /// Where the runs of the protocol `name` lie once the command has ended; `None` if it carries out none
    /// here.
    pub(super) fn results(&self, name: &str) -> Option<PathBuf> {
        let stays_here = self.executor == Executor::Local && !self.dry_run && !self.print_config;
        stays_here.then(|| results(self, name))
    }
}

impl Args {
    /// Whether the built-in protocol `name` is to be run, and no other.
    pub(super) fn is_preset(&self, name: &str) -> bool {
        self.protocol.inputs().is_empty() && self.protocol.preset.as_deref() == Some(name)
    }
}

/// The results folder of the protocol `name`.
fn results(args: &Args, name: &str) -> PathBuf {
    let results = args.out.clone().unwrap_or_else(|| PathBuf::from("results").join(name));
    outputs::unlike_an_option(results)
}

pub(super) fn run(registry: &Registry, args: &Args) -> Exit {
    check_executor(args)?;
    let further = words(&args.slurm.extra)?;
    let protocol = protocol(registry, args)?;
    let plan = Plan::new(&protocol, registry)?;
    let trials = protocol.trials(registry)?;
    warn_of_idle(&protocol, &plan);
    let results = results(args, &plan.name);
    let command = Command::new((registry, args), &protocol, &results, further);
    if args.print_config {
        print(&match &trials {
            Some(trials) => search::configs(&command, trials)?,
            None => plan.configs(),
        });
        return Ok(ExitCode::Success);
    }
    if args.extend && args.out.is_none() && !args.protocol.is_given() {
        let reason =
            "needs --out, since without it the results folder is named after the command, budget included";
        return Err(HarnessError::Argument { option: "--extend", reason: reason.to_owned() });
    }
    if args.extend && trials.is_some() {
        let reason = "does not go with [search]: trials of another length can lead to another choice; choose another --out";
        return Err(HarnessError::Argument { option: "--extend", reason: reason.to_owned() });
    }
    outputs::folder("--out", &results, &args.protocol.inputs())?;
    match (&trials, args.dry_run) {
        (None, false) => command.carry_out(&plan, &results)?.told(&results, args.json),
        (None, true) => dry::dry_run(registry, args, &plan, &command.survey(&plan, &results)?, &results),
        (Some(trials), false) => search::run(&command, trials),
        (Some(trials), true) => search::dry_run(&command, trials),
    }
}

/// The words of the options for sbatch, which are given as one would type them in a shell.
fn words(options: &[String]) -> Result<Vec<String>, HarnessError> {
    let split = |option: &String| {
        let reason = || format!("`{option}`: its quotes do not match");
        shlex::split(option).ok_or_else(|| HarnessError::Argument { option: "--sbatch", reason: reason() })
    };
    Ok(options.iter().map(split).collect::<Result<Vec<_>, _>>()?.concat())
}

/// `goalbench task`: what a task of the job array does.
pub(super) fn task(list: &Path, index: usize) -> Exit {
    let (sweep, conduct) = Prepared::for_task(list, index)?;
    let reporter = reporter::lines(sweep.jobs(), conduct.at_a_time(sweep.open().count()));
    let stopper = Stopper::listen(|| {}).map_err(HarnessError::system("listen for signals"))?;
    let endings = sweep.carry_out(conduct, reporter.as_ref(), &stopper)?;
    Ok(summarise(&endings, sweep.results(), false))
}

fn protocol(registry: &Registry, args: &Args) -> Result<Protocol, HarnessError> {
    let written = args.protocol.text()?;
    let is_named = written.is_some();
    let mut protocol = match written {
        Some(written) => Protocol::parse(&written.name, &written.text, registry)?,
        None if args.environments.is_empty() || args.curricula.is_empty() => {
            let reason = "give a protocol file, --preset NAME, or both --env and --curriculum".to_owned();
            return Err(HarnessError::Argument { option: "run", reason });
        }
        None => Protocol::from_options(),
    };
    if !args.shadow.is_empty() {
        let ids = args.shadow.iter().map(|id| id.as_str().into()).collect();
        let option = format!("--shadow {}", short(&args.shadow.join(",")));
        protocol.watch(ConfigLayer::from_option(option, &["shadow"], toml::Value::Array(ids)));
    }
    if !args.environments.is_empty() {
        protocol.environments = registry.expand_environments(&args.environments, "--env: ")?;
    }
    if !args.curricula.is_empty() {
        protocol.curricula = registry.expand_curricula(&args.curricula, "--curriculum: ")?;
    }
    protocol.seeds = args.seeds.or(protocol.seeds)?;
    if let Some(steps) = args.steps {
        // More steps than TOML's integers can hold are refused like any other number that is too large.
        let value = i64::try_from(steps).unwrap_or(i64::MAX);
        let option = format!("--steps {steps}");
        protocol.set(ConfigLayer::from_option(option, &["budget", "steps"], value.into()));
    }
    if let Some(device) = &args.device {
        let option = format!("--device {}", short(device));
        protocol.set(ConfigLayer::from_option(option, &["student", "device"], device.as_str().into()));
    }
    for assignment in &args.set {
        protocol.set(ConfigLayer::from_assignment("--set", assignment)?);
    }
    if !is_named {
        protocol.name_by_options();
    }
    Ok(protocol)
}
