//! Carrying out the runs of a protocol, or finding them carried out.

use std::path::Path;

use crate::error::HarnessError;
use crate::executor::local::{self, Conduct};
use crate::executor::signals::Stopper;
use crate::executor::{Ending, Lock, survey};
use crate::progress;
use crate::protocol::plan::Plan;
use crate::run::folder::State;

/// Attempts that a run whose worker crashed is given besides the first.
const RETRIES: u32 = 1;

/// Whether all runs came to an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// They did, finished or failed.
    Ended,
    /// A signal stopped them.
    Stopped,
}

/// Carries out every run of `plan` in the folder `results`, `parallel` at a time, and shows progress on standard error.
///
/// # Errors
/// [`HarnessError`] if the folder is in use or holds other runs, if workers cannot be started, or a worker crashed for good.
pub fn carry_out(
    plan: &Plan,
    results: &Path,
    parallel: usize,
    stopper: &Stopper,
) -> Result<Progress, HarnessError> {
    let _lock = Lock::take(results)?;
    let jobs = survey(plan, results)?;
    let parallel = parallel.clamp(1, jobs.len().max(1));
    let display = progress::for_stderr(&jobs, parallel);
    let endings = local::execute(
        &jobs,
        Conduct { parallel, retries: RETRIES, tensorboard: false },
        stopper,
        display.as_ref(),
    )?;
    if endings.iter().any(|ending| matches!(ending, Ending::Stopped | Ending::Taken)) {
        return Ok(Progress::Stopped);
    }
    let crash = jobs.iter().zip(&endings).find_map(|(job, ending)| match ending {
        Ending::Crashed { reason } => Some(HarnessError::Run {
            run: job.manifest.run.to_string(),
            reason: format!("crashed: {reason}"),
        }),
        Ending::Ended(_) | Ending::Stopped | Ending::Taken => None,
    });
    crash.map_or(Ok(Progress::Ended), Err)
}

/// Checks that every run of `plan` has ended in `results`, with the same config.
///
/// # Errors
/// [`HarnessError`] naming the runs that are missing or of another config.
pub fn find(plan: &Plan, results: &Path) -> Result<(), HarnessError> {
    let jobs = survey(plan, results)?;
    let open: Vec<String> = jobs
        .iter()
        .filter(|job| !matches!(job.state, State::Ended(_)))
        .map(|job| job.manifest.run.to_string())
        .collect();
    match open.first() {
        None => Ok(()),
        Some(first) => {
            let reason = format!(
                "has not ended in {} ({} of {} runs have not)",
                results.display(),
                open.len(),
                jobs.len()
            );
            Err(HarnessError::Run { run: first.clone(), reason })
        }
    }
}
