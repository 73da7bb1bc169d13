//! `goalbench run`.

pub(super) mod device;
mod dry;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use reports::schema::{Manifest, Outcome};

use super::{Exit, FAILED, STOPPED, complain, print};
use crate::Registry;
use crate::config::layer::Layer;
use crate::config::seeds;
use crate::error::HarnessError;
use crate::executor::local::{self, Conduct};
use crate::executor::signals::Stopper;
use crate::executor::slurm::{self, Request};
use crate::executor::{Ending, Job, Lock, survey};
use crate::progress;
use crate::protocol::plan::Plan;
use crate::protocol::{Protocol, presets};
use crate::run::folder::{self, State};
use crate::run::manifest::COMMIT;
use crate::tracking::EventFile;

#[derive(clap::Args)]
#[command(after_help = "Without PROTOCOL and --preset, --env and --curriculum say what to run.\n\
    Runs that are already finished in the results folder are kept; one recorded with another config is refused.")]
pub(super) struct Args {
    /// Protocol file (TOML); `goalbench protocol show quickstart` prints one to start from
    #[arg(conflicts_with = "preset")]
    protocol: Option<PathBuf>,
    /// Built-in protocol; `goalbench list presets` names them
    #[arg(long, value_name = "NAME")]
    preset: Option<String>,
    /// Environments or suites instead of the protocol's, separated by commas
    #[arg(long = "env", value_name = "ID,...", value_delimiter = ',')]
    environments: Vec<String>,
    /// Curricula instead of the protocol's, separated by commas
    #[arg(long = "curriculum", value_name = "ID,...", value_delimiter = ',')]
    curricula: Vec<String>,
    /// Seeds instead of the protocol's: a range such as 0..7 (0 to 6), a list such as 0,3
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<String>,
    /// Training steps per run; short for --set budget.steps=N
    #[arg(long, value_name = "N")]
    steps: Option<u64>,
    /// Where the student computes: cpu or cuda; short for --set student.device=NAME
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    /// Any config field, as in curriculum.teach.window=5; `goalbench list config` shows them all [repeatable]
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Results folder [default: results/NAME, after the protocol's name]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Runs side by side, one thread each [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// How often a run whose worker crashed is begun again from its checkpoint
    #[arg(long, value_name = "N", default_value_t = 2)]
    retries: u32,
    /// Print progress as JSON lines on standard output, for scripts
    #[arg(long, conflicts_with = "dry_run")]
    json: bool,
    /// Keep a TensorBoard event file beside each run's records (tensorboard --logdir DIR/runs)
    #[arg(long)]
    tensorboard: bool,
    /// Let runs that failed (diverged learning, unstable physics) go on from their last checkpoint, too; on the CPU
    /// they fail again at the same step unless the program changed
    #[arg(long)]
    retry_failed: bool,
    /// Where runs are carried out
    #[arg(long, value_enum, default_value_t = Executor::Local)]
    executor: Executor,
    #[command(flatten)]
    slurm: SlurmArgs,
    /// Print the plan and what it would take at this machine's speed, and change nothing
    #[arg(long)]
    dry_run: bool,
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
    /// Time limit of a task, as in 12:00:00; a run that needs longer goes on when the same command submits it again
    #[arg(long, value_name = "TIME")]
    time: Option<String>,
    /// Memory of a task, as in 2G
    #[arg(long, value_name = "SIZE")]
    mem: Option<String>,
    /// Most tasks at once
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    at_once: Option<u32>,
    /// Runs per array task, one after the other [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
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
        (Executor::Slurm, _) if args.jobs.is_some() => {
            let reason = "is for runs on this machine; with --executor slurm use --at-once".into();
            Err(HarnessError::Argument { option: "--jobs", reason })
        }
        _ => Ok(()),
    }
}

pub(super) fn run(registry: &Registry, args: &Args) -> Exit {
    check_executor(args)?;
    let protocol = protocol(registry, args)?;
    let plan = Plan::new(&protocol, registry)?;
    let results = args.out.clone().unwrap_or_else(|| PathBuf::from("results").join(folder_name(&plan.name)));
    let jobs = survey(&plan, &results)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let open = jobs.iter().filter(|job| !matches!(job.state, State::Ended(_))).count();
    // No more threads than runs to watch, whatever number was asked for.
    let parallel = args.jobs.map_or(cores, usize::from).min(open.max(1));
    if args.dry_run {
        return dry::dry_run(registry, &plan, &jobs, &results, parallel);
    }
    if args.executor == Executor::Local {
        device::check(&plan, &jobs)?;
    }
    let _lock = Lock::take(&results)?;
    // Another `run` may have worked here between the first look and the lock.
    let mut jobs = survey(&plan, &results)?;
    if args.retry_failed {
        for job in jobs.iter_mut().filter(|job| matches!(job.state, State::Ended(Outcome::Failed { .. }))) {
            folder::reopen(&job.folder)?;
            job.state = State::Begun;
        }
    }
    tell_other_commits(&jobs)?;
    if args.tensorboard {
        for job in jobs.iter().filter(|job| matches!(job.state, State::Ended(_))) {
            // No worker will: it ended before.
            EventFile::rewrite(&job.folder)
                .map_err(HarnessError::io(&job.folder, "write an event file in this folder"))?;
        }
    }
    if args.executor == Executor::Slurm {
        return submit(&jobs, &results, &plan.name, args);
    }
    let display = if args.json {
        progress::json(|line| print(&format!("{line}\n")))
    } else {
        progress::for_stderr(&jobs, parallel)
    };
    let stopper = Stopper::listen(|| {
        complain("goalbench: stopping; runs save their checkpoints (once more to stop at once)")
    })
    .map_err(HarnessError::io("goalbench", "listen for signals"))?;
    let conduct = Conduct { parallel, retries: args.retries, tensorboard: args.tensorboard };
    let endings = local::execute(&jobs, conduct, &stopper, display.as_ref())?;
    drop(display);
    summarise(&jobs, &endings, &results, args.json)
}

/// Says which unfinished runs were begun by a build of another commit: they go on, to records that may differ from those of
/// either build.
fn tell_other_commits(jobs: &[Job]) -> Result<(), HarnessError> {
    let commit = |manifest: &Manifest| manifest.versions.get(COMMIT).cloned();
    for job in jobs.iter().filter(|job| job.state == State::Begun) {
        let (begun, now) = (commit(&folder::read_manifest(&job.folder)?.0), commit(&job.manifest));
        if begun != now {
            let [begun, now] = [begun, now].map(|commit| commit.unwrap_or_else(|| "unknown".to_owned()));
            complain(&format!(
                "goalbench: {}: begun by a build of commit {begun}, goes on with {now}",
                job.manifest.run
            ));
        }
    }
    Ok(())
}

fn submit(jobs: &[Job], results: &Path, name: &str, args: &Args) -> Exit {
    let request = Request {
        name: format!("goalbench-{}", folder_name(name)),
        partition: args.slurm.partition.clone(),
        time: args.slurm.time.clone(),
        memory: args.slurm.mem.clone(),
        at_once: args.slurm.at_once,
        chunk: args.slurm.chunk.map_or(1, usize::from),
        retries: args.retries,
        tensorboard: args.tensorboard,
        extra: args.slurm.extra.clone(),
    };
    let place = results.display();
    let Some((id, tasks)) = slurm::submit(jobs, results, &request)? else {
        print("nothing to submit\n");
        let ended = jobs.iter().filter_map(|job| match &job.state {
            State::Ended(outcome) => Some(Ending::Ended(outcome.clone())),
            State::New | State::Begun => None,
        });
        return summarise(jobs, &ended.collect::<Vec<_>>(), results, false);
    };
    print(&format!("submitted job {id} with {tasks} tasks; next: goalbench status {place}\n"));
    Ok(ExitCode::SUCCESS)
}

/// `goalbench task`: what a task of the job array does.
pub(super) fn task(list: &Path, index: usize) -> Exit {
    let (jobs, endings) = slurm::task(list, index)?;
    let results = list.ancestors().nth(3).unwrap_or(list);
    summarise(&jobs, &endings, results, false)
}

fn protocol(registry: &Registry, args: &Args) -> Result<Protocol, HarnessError> {
    let mut protocol = match (&args.protocol, &args.preset) {
        (Some(path), _) => Protocol::read(path, registry)?,
        (None, Some(name)) => presets::find(name)?.protocol(registry)?,
        (None, None) if args.environments.is_empty() || args.curricula.is_empty() => {
            let reason = "give a protocol file, --preset NAME, or both --env and --curriculum".to_owned();
            return Err(HarnessError::Argument { option: "run", reason });
        }
        (None, None) => Protocol::from_options(),
    };
    if !args.environments.is_empty() {
        protocol.environments = registry.expand_environments(&args.environments, "--env: ")?;
    }
    if !args.curricula.is_empty() {
        protocol.curricula = registry.expand_curricula(&args.curricula, "--curriculum: ")?;
    }
    if let Some(text) = &args.seeds {
        protocol.seeds =
            seeds::parse(text).map_err(|reason| HarnessError::Argument { option: "--seeds", reason })?;
    }
    if let Some(steps) = args.steps {
        protocol.set_steps(steps);
    }
    if let Some(device) = &args.device {
        protocol.set_device(device);
    }
    for assignment in &args.set {
        protocol.set(Layer::from_set(assignment)?);
    }
    Ok(protocol)
}

/// A protocol's name as a folder name.
fn folder_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' }).collect()
}

/// Says what came out and gives the exit code. With `json` the events have told it before.
fn summarise(jobs: &[Job], endings: &[Ending], results: &Path, json: bool) -> Exit {
    let (mut failed, mut stopped, mut taken) = (0, 0, 0);
    for (job, ending) in jobs.iter().zip(endings) {
        let run = &job.manifest.run;
        match ending {
            Ending::Ended(Outcome::Finished { .. }) => {}
            Ending::Stopped => stopped += 1,
            Ending::Taken => taken += 1,
            Ending::Ended(Outcome::Failed { step, reason }) => {
                failed += 1;
                complain(&format!("goalbench: {run}: failed at step {step}: {reason}"));
            }
            Ending::Crashed { reason } => {
                failed += 1;
                complain(&format!("goalbench: {run}: crashed: {reason}"));
            }
        }
    }
    let (place, total) = (results.display(), jobs.len());
    if failed > 0 {
        complain(&format!(
            "goalbench: {failed} of {total} runs failed; the records of the others are in {place}; crashed ones go on \
             with the same command, failed ones with --retry-failed"
        ));
    }
    if stopped > 0 {
        complain(&format!(
            "goalbench: {stopped} of {total} runs stopped; the same command goes on with them"
        ));
    }
    if taken > 0 {
        complain(&format!(
            "goalbench: {taken} of {total} runs are being carried out by another process; see goalbench status {place}"
        ));
    }
    if failed + stopped + taken == 0 && !json {
        print(&format!("{total} runs finished; records in {place}; next: goalbench report {place}\n"));
    }
    Ok(match (failed, stopped + taken) {
        (0, 0) => ExitCode::SUCCESS,
        (0, _) => ExitCode::from(STOPPED),
        _ => ExitCode::from(FAILED),
    })
}
