//! Runs side by side on this machine, in worker processes.

mod complaints;
mod conduct;
pub mod device;
pub mod limits;
mod supervise;

use std::sync::Mutex;

use super::cohort::cohorts;
use super::job::{Ending, Job};
use super::reporter::Reporter;
use super::signals::Stopper;
use crate::error::HarnessError;
use crate::run::folder::{self, State};
pub use conduct::Conduct;
pub(super) use conduct::this_program;
use supervise::Supervisor;

/// Carries out all `jobs` that have not ended, in order. Gives every job's ending.
///
/// # Errors
/// [`HarnessError`] if run folders or threads cannot be made; endings of single runs are no errors.
pub(super) fn execute(
    jobs: &[Job],
    conduct: Conduct,
    stopper: &Stopper,
    reporter: &dyn Reporter,
) -> Result<Vec<Ending>, HarnessError> {
    let program = this_program()?;
    for job in jobs.iter().filter(|job| job.state == State::New) {
        folder::create(&job.folder, &job.manifest)?;
    }
    let cohorts = cohorts(jobs, conduct.lanes);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(conduct.workers.min(cohorts.len().max(1)))
        .build()
        .map_err(HarnessError::system("start a thread per worker"))?;
    let supervisor = Supervisor { program, conduct, stopper, reporter };
    let endings: Vec<Mutex<Option<Ending>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    pool.in_place_scope_fifo(|scope| {
        for cohort in cohorts {
            let (supervisor, endings) = (&supervisor, &endings);
            scope.spawn_fifo(move |_| {
                let runs: Vec<&Job> = cohort.iter().map(|&index| &jobs[index]).collect();
                for (&index, found) in cohort.iter().zip(supervisor.see_through(&runs)) {
                    *endings[index].lock().expect("no holder of this lock panics") = Some(found);
                }
            });
        }
    });
    let endings = endings.into_iter().map(|ending| {
        ending.into_inner().expect("no holder of this lock panics").expect("the scope waits for every job")
    });
    Ok(endings.collect())
}
