//! A sweep: all runs of a plan in one results folder.
//!
//! It goes through four steps, for whoever asks (`goalbench run`, the regression gate, a task of a job
//! array):
//!
//! 1. [`Sweep::survey`] compares the plan with what the folder holds, and [`Sweep::try_out`] tries whether
//!    its runs can begin. Both change nothing.
//! 2. [`Sweep::prepare`] takes the folder and readies the runs that are still to be done.
//! 3. [`Prepared::carry_out`] does them in worker processes on this machine, or [`Prepared::submit`] hands
//!    them to Slurm, whose tasks then carry out [their share](Prepared::for_task).
//! 4. [`Endings`] says how every run came out, and which [`ExitCode`] follows.
//!
//! A [worker] is a process with one run, or with a [cohort] of runs in lockstep. It tells its sweep what
//! happens as [events](event::Event), and a [`Reporter`] shows them.

mod cell;
pub mod cohort;
pub mod endings;
pub(crate) mod errand;
pub mod event;
pub mod exit;
pub mod job;
pub mod lanes;
pub mod local;
mod precision;
pub mod reporter;
pub mod signals;
pub mod slurm;
pub mod trial;
pub mod worker;

use std::path::{Path, PathBuf};

use reports::schema::Outcome;
use reports::store::layout;

use crate::error::HarnessError;
use crate::protocol::plan::Plan;
use crate::run::folder::{self, State};
use crate::run::lock::Lock;
use crate::run::manifest::{manifest, other_build};
use crate::tracking;

pub use endings::Endings;
pub use exit::ExitCode;
pub use job::{Ending, Job};
pub use lanes::Lanes;
pub use local::Conduct;
use reporter::Reporter;
use signals::Stopper;

/// The runs of a plan and what a results folder holds of them.
pub struct Sweep {
    results: PathBuf,
    jobs: Vec<Job>,
    reopen: Reopen,
}

/// Which ended runs go on.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reopen {
    /// Train runs on that were recorded with a smaller budget and differ in nothing else.
    pub extend: bool,
    /// Let failed runs go on from their last checkpoint.
    pub retry_failed: bool,
}

impl Sweep {
    /// Compares the plan with the results folder and changes nothing. Runs that have ended go on if `reopen`
    /// says so.
    ///
    /// # Errors
    /// [`HarnessError`] if any run of the plan's cells was recorded with another config, other seeds
    /// included, or any run of the plan cannot be read.
    pub fn survey(plan: &Plan, results: &Path, reopen: Reopen) -> Result<Self, HarnessError> {
        let jobs = plan.runs.iter().map(|run| {
            let manifest = manifest(run);
            let folder = layout::run_dir(results, &run.key);
            Ok(Job { manifest, config: run.config.clone(), folder, state: State::New })
        });
        let jobs = jobs.collect::<Result<_, HarnessError>>()?;
        let mut sweep = Self { results: results.to_owned(), jobs, reopen };
        sweep.look()?;
        // Whatever is decided before the folder is taken is decided for these, too.
        for job in sweep.jobs.iter_mut().filter(|job| reopen.retry_failed && has_failed(job)) {
            job.state = State::Begun;
        }
        Ok(sweep)
    }

    /// Looks what the folder holds of every run.
    fn look(&mut self) -> Result<(), HarnessError> {
        let extend = self.reopen.extend;
        for job in &mut self.jobs {
            job.state = folder::inspect(&job.folder, &job.manifest)?;
            if let (State::Shorter(recorded), false) = (&job.state, extend) {
                let (folder, recorded, wanted) = (job.folder.clone(), *recorded, job.steps());
                return Err(HarnessError::Shorter { folder, recorded, wanted });
            }
        }
        cell::check(&self.jobs)
    }

    /// All runs, in the order in which they are started.
    pub fn jobs(&self) -> &[Job] {
        &self.jobs
    }

    /// Those still to be done.
    pub fn open(&self) -> impl Iterator<Item = &Job> + Clone {
        self.jobs.iter().filter(|job| job.is_open())
    }

    /// Refuses a device that this machine does not have, before anything is written.
    ///
    /// # Errors
    /// [`HarnessError::Device`] saying what is missing.
    pub fn check_device(&self) -> Result<(), HarnessError> {
        local::device::check(self.open())
    }

    /// Tries out, before anything is written, whether the runs that are still to be done can begin, on this
    /// machine or, where they are carried out `elsewhere`, as far as this machine can tell.
    ///
    /// # Errors
    /// [`HarnessError::Trial`] naming the first that cannot, and why.
    pub fn try_out(&self, elsewhere: bool) -> Result<(), HarnessError> {
        trial::check(&self.jobs, elsewhere)
    }

    /// Takes the results folder and readies its runs; with `tensorboard`, finished ones get event files, too.
    /// Another process may have worked there since the survey: it looks again.
    ///
    /// # Errors
    /// [`HarnessError::Locked`] if another process has the folder; whatever keeps it from being read or
    /// written.
    pub fn prepare(mut self, tensorboard: bool) -> Result<Prepared, HarnessError> {
        let is_new = !self.results.exists();
        let lock = Lock::take(&self.results)?;
        self.look()?;
        cell::forget_unbegun(&self.results, &self.jobs)?;
        // What earlier sweeps left half-written when they were killed.
        guard::fresh::sweep(&self.results);
        self.jobs.iter().for_each(|job| guard::fresh::sweep(&job.folder));
        let mut lacks = Vec::new();
        let retry_failed = self.reopen.retry_failed;
        for job in &mut self.jobs {
            if let State::Shorter(_) = job.state {
                folder::extend(&job.folder, &job.manifest)?;
                job.state = folder::inspect(&job.folder, &job.manifest)?;
            }
            match &job.state {
                State::Ended(Outcome::Failed { .. }) if retry_failed => {
                    folder::reopen(&job.folder, &job.manifest)?;
                    job.state = State::Begun;
                }
                State::Ended(_) if tensorboard => {
                    let lack = tracking::catch_up(&job.folder)
                        .map_err(HarnessError::io(&job.folder, "write an event file in this folder"))?;
                    lacks.extend(lack);
                }
                State::New | State::Shorter(_) | State::Begun | State::Ended(_) => {}
            }
        }
        Ok(Prepared { sweep: self, is_new, lacks, _lock: Some(lock) })
    }
}

fn has_failed(job: &Job) -> bool {
    matches!(job.state, State::Ended(Outcome::Failed { .. }))
}

/// A sweep whose runs can be carried out.
pub struct Prepared {
    sweep: Sweep,
    /// Whether there was no results folder before.
    is_new: bool,
    /// What event files of ended runs lack, in a line each.
    lacks: Vec<String>,
    /// A task of a job array has none: its runs' own locks keep others away.
    _lock: Option<Lock>,
}

impl Prepared {
    /// The share of the task `index` of the job array whose list lies at `list`, and how to carry it out.
    ///
    /// # Errors
    /// [`HarnessError`] if the list or a run's folder is not what was submitted.
    pub fn for_task(list: &Path, index: usize) -> Result<(Self, Conduct), HarnessError> {
        let slurm::Share { results, jobs, conduct } = slurm::share(list, index)?;
        let sweep = Sweep { results, jobs, reopen: Reopen::default() };
        Ok((Self { sweep, is_new: false, lacks: Vec::new(), _lock: None }, conduct))
    }

    /// All runs, in the order in which they are started.
    pub fn jobs(&self) -> &[Job] {
        &self.sweep.jobs
    }

    /// Those still to be done.
    pub fn open(&self) -> impl Iterator<Item = &Job> + Clone {
        self.sweep.open()
    }

    /// What event files of runs that had ended lack, in a line each: times that were lost.
    pub fn lacking_times(&self) -> &[String] {
        &self.lacks
    }

    /// The results folder.
    pub fn results(&self) -> &Path {
        &self.sweep.results
    }

    /// Which unfinished runs were begun by another build of this program, in a line each: they go on, to
    /// records that may differ from those of either build.
    ///
    /// # Errors
    /// [`HarnessError`] if a manifest cannot be read.
    pub fn begun_by_other_builds(&self) -> Result<Vec<String>, HarnessError> {
        let mut lines = Vec::new();
        for job in self.jobs().iter().filter(|job| job.state == State::Begun) {
            let found = folder::read_manifest(&job.folder)?.0;
            lines.extend(other_build(&found, &job.manifest).map(|how| format!("{}: {how}", job.run())));
        }
        Ok(lines)
    }

    /// Carries out all runs that have not ended, on this machine. `reporter` hears of them; SIGINT and
    /// SIGTERM, for which `stopper` listens, let the workers save and stop.
    ///
    /// # Errors
    /// [`HarnessError`] if run folders or threads cannot be made; endings of single runs are no errors.
    pub fn carry_out(
        &self,
        conduct: Conduct,
        reporter: &dyn Reporter,
        stopper: &Stopper,
    ) -> Result<Endings, HarnessError> {
        let endings = local::execute(self.jobs(), conduct, stopper, reporter)?;
        Ok(Endings::new(self.jobs(), endings))
    }

    /// Submits all runs that have not ended as a Slurm job array.
    ///
    /// # Errors
    /// [`HarnessError`] if folders cannot be written or `sbatch` refuses.
    pub fn submit(&self, request: &slurm::Request) -> Result<Option<slurm::Submitted>, HarnessError> {
        let submitted = slurm::submit(self.jobs(), self.results(), request);
        if submitted.is_err() {
            // Nothing was submitted, so leave no trace. A folder that cannot be removed does no harm.
            let new = self.jobs().iter().filter(|job| job.state == State::New);
            new.for_each(|job| drop(folder::forget(&job.folder, self.results())));
            let _ = std::fs::remove_dir(self.results().join(slurm::FOLDER));
            if self.is_new {
                let _ = std::fs::remove_file(self.results().join(layout::LOCK));
                let _ = std::fs::remove_dir(self.results());
            }
        }
        submitted
    }

    /// The endings of those runs that had ended before.
    pub fn kept(&self) -> Endings {
        Endings::of_ended(self.jobs())
    }
}
