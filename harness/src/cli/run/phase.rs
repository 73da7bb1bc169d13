//! All runs of one plan in one results folder, carried out here or handed to Slurm.

use std::cell::OnceCell;
use std::path::Path;

use reports::wording::counted;

use super::summary::{problems, summarise};
use super::{Args, Executor};
use crate::Registry;
use crate::cli::{Exit, complain, print};
use crate::console::word;
use crate::error::HarnessError;
use crate::memory;
use crate::protocol::plan::Plan;
use crate::protocol::{Protocol, copy};
use crate::sweep::cohort::fewer_than;
use crate::sweep::lanes::Decided;
use crate::sweep::signals::Stopper;
use crate::sweep::slurm::{self, Request, Submitted};
use crate::sweep::{Conduct, Endings, ExitCode, Job, Lanes, Prepared, Reopen, Sweep, local, reporter};

/// A command, for each of its plans.
pub(super) struct Command<'a> {
    pub(super) registry: &'a Registry,
    pub(super) args: &'a Args,
    /// What was asked for.
    pub(super) protocol: &'a Protocol,
    /// The results folder, which keeps a copy of the protocol.
    pub(super) results: &'a Path,
    /// Words for sbatch.
    pub(super) further: Vec<String>,
    /// Listens for signals from the first run on; one for all plans, so that a stop stops all.
    stopper: OnceCell<Stopper>,
}

/// What became of a plan.
pub(super) enum Done {
    /// Its runs came out so.
    Here(Endings),
    /// Slurm has them.
    Submitted(Submitted),
    /// There was nothing to submit: all had ended before, so.
    Before(Endings),
}

impl<'a> Command<'a> {
    pub(super) fn new(
        (registry, args): (&'a Registry, &'a Args),
        protocol: &'a Protocol,
        results: &'a Path,
        further: Vec<String>,
    ) -> Self {
        Self { registry, args, protocol, results, further, stopper: OnceCell::new() }
    }

    /// What the folder holds of the plan; refuses a device that is not there.
    pub(super) fn survey(&self, plan: &Plan, folder: &Path) -> Result<Sweep, HarnessError> {
        let Args { extend, retry_failed, .. } = *self.args;
        let sweep = Sweep::survey(plan, folder, Reopen { extend, retry_failed })?;
        if self.args.executor == Executor::Local && !self.args.dry_run {
            sweep.check_device().map_err(HarnessError::flag("--device"))?;
        }
        Ok(sweep)
    }

    /// Carries the runs of a plan out in `folder`, or hands them to Slurm.
    pub(super) fn carry_out(&self, plan: &Plan, folder: &Path) -> Result<Done, HarnessError> {
        let Self { registry, args, protocol, results, .. } = *self;
        let sweep = self.survey(plan, folder)?;
        let lanes = decide(registry, args, sweep.open())?;
        if let Some(note) = &lanes.note {
            complain(&format!("goalbench: {note}"));
        }
        match args.executor {
            Executor::Local => {
                local::limits::make_room(conduct(args, &lanes, sweep.open().count()).workers)?;
                for line in sweep.slow_precisions(registry)? {
                    complain(&format!("goalbench: {line}"));
                }
            }
            Executor::Slurm => slurm::check(folder)?,
        }
        sweep.try_out(args.executor == Executor::Slurm)?;
        let sweep = sweep.prepare(args.tensorboard)?;
        for line in sweep.begun_by_other_builds()? {
            complain(&format!("goalbench: {line}"));
        }
        for line in sweep.lacking_times() {
            complain(&format!("goalbench: {line}"));
        }
        match args.executor {
            Executor::Local => {
                let conduct = conduct(args, &lanes, sweep.open().count());
                warn_of_memory(registry, &sweep, conduct);
                copy::save(protocol, results)?;
                self.here(&sweep, conduct).map(Done::Here)
            }
            Executor::Slurm => {
                let submitted = sweep.submit(&self.request(&plan.name, &lanes))?;
                if let Err(error) = copy::save(protocol, results) {
                    if let Some(submitted) = &submitted {
                        // The job is in the queue all the same.
                        let _ = tell_submitted(submitted, folder);
                    }
                    return Err(error);
                }
                Ok(submitted.map_or_else(|| Done::Before(sweep.kept()), Done::Submitted))
            }
        }
    }

    fn here(&self, sweep: &Prepared, conduct: Conduct) -> Result<Endings, HarnessError> {
        let parallel = conduct.at_a_time(sweep.open().count());
        let reporter = if self.args.json {
            reporter::json(|line| print(&format!("{line}\n")))
        } else {
            reporter::for_stderr(sweep.jobs(), parallel, self.args.detail.detail())
        };
        // Bars leave the screen before anything else is said.
        sweep.carry_out(conduct, reporter.as_ref(), self.stopper()?)
    }

    fn stopper(&self) -> Result<&Stopper, HarnessError> {
        if let Some(stopper) = self.stopper.get() {
            return Ok(stopper);
        }
        let stopper = Stopper::listen(|| {
            complain("goalbench: stopping; runs save their checkpoints (once more to stop at once)");
        });
        let stopper = stopper.map_err(HarnessError::system("listen for signals"))?;
        Ok(self.stopper.get_or_init(|| stopper))
    }

    fn request(&self, name: &str, lanes: &Decided) -> Request {
        let args = self.args;
        Request {
            name: format!("goalbench-{name}"),
            partition: args.slurm.partition.clone(),
            time: args.slurm.time.clone(),
            memory: args.slurm.mem.clone(),
            at_once: args.slurm.at_once,
            chunk: args.slurm.chunk.map_or(1, usize::from),
            lanes: lanes.lanes,
            overlap: args.overlap,
            gpu: lanes.gpu,
            retries: args.retries,
            tensorboard: args.tensorboard,
            discard_replay: args.discard_replay,
            extra: self.further.clone(),
        }
    }
}

impl Done {
    /// Says what became of a plan whose runs lie in `folder`, and gives the exit code.
    pub(super) fn told(self, folder: &Path, json: bool) -> Exit {
        Ok(match self {
            Self::Here(endings) => summarise(&endings, folder, json),
            Self::Before(endings) => {
                print("nothing to submit\n");
                summarise(&endings, folder, json)
            }
            Self::Submitted(submitted) => tell_submitted(&submitted, folder),
        })
    }
}

/// Says that Slurm has the runs of `folder`.
pub(super) fn tell_submitted(submitted: &Submitted, folder: &Path) -> ExitCode {
    let (job, tasks) = (&submitted.job, counted(submitted.tasks, "task"));
    print(&format!("submitted job {job} with {tasks}; next: goalbench status {}\n", word(folder)));
    ExitCode::Success
}

/// Says what went wrong with the runs of `folder` and gives the exit code; nothing of a good end.
pub(super) fn code(endings: &Endings, folder: &Path) -> ExitCode {
    problems(endings, folder);
    endings.exit_code()
}

/// How many of the `open` runs go in lockstep; says so where that is fewer than were asked for.
pub(super) fn decide<'a>(
    registry: &Registry,
    args: &Args,
    open: impl Iterator<Item = &'a Job> + Clone,
) -> Result<Decided, HarnessError> {
    let elsewhere = args.executor == Executor::Slurm;
    let decided =
        args.lanes.decide(registry, open.clone(), elsewhere, threads(args, open.clone().count()))?;
    if args.overlap {
        decided.check_overlap()?;
    }
    if let (Lanes::Number(lanes), Some(note)) = (args.lanes, fewer_than(decided.lanes, open))
        && lanes > 1
    {
        complain(&format!("goalbench: {note}"));
    }
    Ok(decided)
}

/// Threads that compute for `open` runs in lockstep here: with --overlap, each half has its own.
pub(super) fn threads(args: &Args, open: usize) -> usize {
    args.jobs.for_runs(open) * if args.overlap { 2 } else { 1 }
}

/// How `open` runs are carried out here.
pub(super) fn conduct(args: &Args, lanes: &Decided, open: usize) -> Conduct {
    // No more threads than there are runs, whatever number was asked for.
    let threads = args.jobs.for_runs(open);
    let shared = Conduct::share(threads, lanes.lanes);
    let Args { retries, tensorboard, discard_replay, overlap, .. } = *args;
    let conduct = Conduct { retries, tensorboard, discard_replay, overlap, ..shared };
    // There is one GPU, and its cohort takes all the threads there are.
    if lanes.gpu { Conduct { workers: 1, threads, ..conduct } } else { conduct }
}

/// Says before it happens that runs may need more memory than there is.
fn warn_of_memory(registry: &Registry, sweep: &Prepared, conduct: Conduct) {
    let size =
        |job: &Job| Some(memory::of_run(&job.config, &registry.environment(&job.run().environment)?.spec));
    let sizes: Vec<u64> = sweep.open().filter_map(size).collect();
    let parallel = conduct.at_a_time(sizes.len());
    if let Some(text) = memory::available().and_then(|available| memory::warning(sizes, parallel, available))
    {
        complain(&format!("goalbench: {text}"));
    }
}
