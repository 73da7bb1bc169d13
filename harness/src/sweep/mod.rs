//! A sweep: all runs of a plan in one results folder.
//!
//! It goes through four steps, for whoever asks (`goalbench run`, the regression gate, a task of a job
//! array):
//!
//! 1. [`Sweep::survey`] compares the plan with what the folder holds and changes nothing.
//! 2. [`Sweep::prepare`] takes the folder and readies the runs that are still to be done.
//! 3. [`Prepared::carry_out`] does them in worker processes on this machine, or [`Prepared::submit`] hands
//!    them to Slurm, whose tasks then carry out [their share](Prepared::for_task).
//! 4. [`Endings`] says how every run came out, and which [`ExitCode`] follows.
//!
//! A [worker] is a process with one run. It tells its sweep what happens as [events](event::Event), and a
//! [`Reporter`] shows them.

pub mod endings;
pub mod event;
pub mod exit;
pub mod job;
pub mod local;
mod precision;
pub mod reporter;
pub mod signals;
pub mod slurm;
pub mod worker;

use std::path::{Path, PathBuf};

use reports::schema::{Manifest, Outcome};
use reports::store::layout;

use crate::error::HarnessError;
use crate::protocol::plan::Plan;
use crate::run::folder::{self, State};
use crate::run::lock::Lock;
use crate::run::manifest::{COMMIT, manifest};
use crate::tracking::EventFile;

pub use endings::Endings;
pub use exit::ExitCode;
pub use job::{Ending, Job};
pub use local::Conduct;
use reporter::Reporter;
use signals::Stopper;

/// The runs of a plan and what a results folder holds of them.
pub struct Sweep {
    results: PathBuf,
    jobs: Vec<Job>,
}

/// How to ready a sweep.
#[derive(Clone, Copy, Debug, Default)]
pub struct Preparation {
    /// Let failed runs go on from their last checkpoint.
    pub retry_failed: bool,
    /// Write event files for finished runs too.
    pub tensorboard: bool,
}

impl Sweep {
    /// Compares the plan with the results folder and changes nothing.
    ///
    /// # Errors
    /// [`HarnessError`] if any run was recorded with another config or cannot be read.
    pub fn survey(plan: &Plan, results: &Path) -> Result<Self, HarnessError> {
        let jobs = plan.runs.iter().map(|run| {
            let manifest = manifest(run);
            let folder = layout::run_dir(results, &run.key);
            let state = folder::inspect(&folder, &manifest)?;
            Ok(Job { manifest, config: run.config.clone(), folder, state })
        });
        Ok(Self { results: results.to_owned(), jobs: jobs.collect::<Result<_, HarnessError>>()? })
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

    /// Takes the results folder and readies its runs. Another process may have worked there since the survey:
    /// it looks again.
    ///
    /// # Errors
    /// [`HarnessError::Locked`] if another process has the folder; whatever keeps it from being read or
    /// written.
    pub fn prepare(mut self, preparation: Preparation) -> Result<Prepared, HarnessError> {
        let lock = Lock::take(&self.results)?;
        for job in &mut self.jobs {
            job.state = folder::inspect(&job.folder, &job.manifest)?;
            match &job.state {
                State::Ended(Outcome::Failed { .. }) if preparation.retry_failed => {
                    folder::reopen(&job.folder)?;
                    job.state = State::Begun;
                }
                State::Ended(_) if preparation.tensorboard => {
                    EventFile::rewrite(&job.folder)
                        .map_err(HarnessError::io(&job.folder, "write an event file in this folder"))?;
                }
                State::New | State::Begun | State::Ended(_) => {}
            }
        }
        Ok(Prepared { sweep: self, _lock: Some(lock) })
    }
}

/// A sweep whose runs can be carried out.
pub struct Prepared {
    sweep: Sweep,
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
        Ok((Self { sweep: Sweep { results, jobs }, _lock: None }, conduct))
    }

    /// All runs, in the order in which they are started.
    pub fn jobs(&self) -> &[Job] {
        &self.sweep.jobs
    }

    /// Those still to be done.
    pub fn open(&self) -> impl Iterator<Item = &Job> + Clone {
        self.sweep.open()
    }

    /// The results folder.
    pub fn results(&self) -> &Path {
        &self.sweep.results
    }

    /// Which unfinished runs were begun by a build of another commit, in a line each: they go on, to records
    /// that may differ from those of either build.
    ///
    /// # Errors
    /// [`HarnessError`] if a manifest cannot be read.
    pub fn begun_by_other_commits(&self) -> Result<Vec<String>, HarnessError> {
        let commit = |manifest: &Manifest| manifest.versions.get(COMMIT).cloned();
        let mut lines = Vec::new();
        for job in self.jobs().iter().filter(|job| job.state == State::Begun) {
            let (begun, now) = (commit(&folder::read_manifest(&job.folder)?.0), commit(&job.manifest));
            if begun != now {
                let [begun, now] = [begun, now].map(|commit| commit.unwrap_or_else(|| "unknown".to_owned()));
                let run = job.run();
                lines.push(format!("{run}: begun by a build of commit {begun}, goes on with {now}"));
            }
        }
        Ok(lines)
    }

    /// Carries out all runs that have not ended, on this machine. `reporter` hears of them; SIGINT and
    /// SIGTERM call `on_stop` once, then let the workers save and stop.
    ///
    /// # Errors
    /// [`HarnessError`] if run folders or threads cannot be made; endings of single runs are no errors.
    pub fn carry_out(
        &self,
        conduct: Conduct,
        reporter: &dyn Reporter,
        on_stop: impl Fn() + Send + 'static,
    ) -> Result<Endings, HarnessError> {
        let stopper = Stopper::listen(on_stop).map_err(HarnessError::system("listen for signals"))?;
        let endings = local::execute(self.jobs(), conduct, &stopper, reporter)?;
        Ok(Endings::new(self.jobs(), endings))
    }

    /// Submits all runs that have not ended as a Slurm job array.
    ///
    /// # Errors
    /// [`HarnessError`] if folders cannot be written or `sbatch` refuses.
    pub fn submit(&self, request: &slurm::Request) -> Result<Option<slurm::Submitted>, HarnessError> {
        slurm::submit(self.jobs(), self.results(), request)
    }

    /// The endings of those runs that had ended before.
    pub fn kept(&self) -> Endings {
        Endings::of_ended(self.jobs())
    }
}
