//! Whether a run's files are those that its workers left: what whoever goes on from them, copies or counts
//! them must know.

use std::path::Path;

use reports::schema::{Manifest, Outcome};
use reports::store::{RunFolder, layout};

use super::{outcome, read_manifest};
use crate::config::RunConfig;
use crate::error::HarnessError;
use crate::run::checkpoint::{self, CHECKPOINT, CheckpointError, REPLAY};
use reports::wording::counted;

/// A run whose files are sound.
#[derive(Clone, Debug)]
pub struct Sound {
    /// What it is.
    pub manifest: Manifest,
    /// The config in its manifest.
    pub config: RunConfig,
    /// How it ended; `None` if it has not.
    pub outcome: Option<Outcome>,
    /// Whether it has a checkpoint, without which its policy is lost.
    pub has_checkpoint: bool,
}

/// Reads all files of the run in `folder` that results and a resume rest on, and changes nothing. Nobody may
/// be carrying it out meanwhile.
///
/// Of a run that has ended, records must have the checksums that they ended with. Of one that may go on, they
/// must go on from the checkpoint, and the replay log must hold every episode that the checkpoint needs.
///
/// # Errors
/// [`HarnessError::Damaged`], [`HarnessError::Manifest`] or [`HarnessError::Store`] naming the first file
/// that is not what was written.
pub fn check(folder: &Path) -> Result<Sound, HarnessError> {
    let run = RunFolder::new(folder);
    let (manifest, config) = read_manifest(folder)?;
    run.check_place(&manifest)?;
    let outcome = outcome(folder, &manifest)?;
    let is_finished = matches!(outcome, Some(Outcome::Finished { .. }));
    let checkpoint = match checkpoint::read(folder, &manifest) {
        // Nothing goes on from it any more, so that programs may differ.
        Err(CheckpointError::Version { .. }) if is_finished => {
            return Ok(Sound { manifest, config, outcome, has_checkpoint: true });
        }
        checkpoint => checkpoint?,
    };
    match &checkpoint {
        Some(checkpoint) if !is_finished => {
            checkpoint.progress.check(&run)?;
            let (state, steps) = (checkpoint.trainer.student(), checkpoint.trainer.training_steps());
            // A run that only lacks its end needs no replay buffer any more, and may have lost it.
            if checkpoint.trainer.step() < config.budget.steps {
                agents::check_replay(&config.student, state, steps, &run.file(REPLAY))
                    .map_err(HarnessError::unusable(folder.display(), "go on from this run's checkpoint"))?;
            }
        }
        None if !is_finished => check_beginning(folder)?,
        _ => {}
    }
    Ok(Sound { manifest, config, outcome, has_checkpoint: checkpoint.is_some() })
}

/// Refuses to begin anew over records that a checkpoint must have followed: the checkpoint was lost, and the
/// records would be lost as well.
///
/// # Errors
/// [`HarnessError::Damaged`], or [`HarnessError::Io`] if the records cannot be read.
pub fn check_beginning(folder: &Path) -> Result<(), HarnessError> {
    /// Evaluations that are recorded before the first checkpoint is saved.
    const BEFORE_CHECKPOINT: usize = 2;
    let recorded = RunFolder::new(folder).bytes(layout::RECORDS)?.unwrap_or_default();
    let recorded = recorded.iter().filter(|&&byte| byte == b'\n').count();
    if recorded > BEFORE_CHECKPOINT {
        let reason = format!(
            "is missing, though records of {} exist; delete this run's folder to train it anew",
            counted(recorded, "evaluation")
        );
        return Err(HarnessError::Damaged { path: folder.join(CHECKPOINT), reason });
    }
    Ok(())
}
