//! The trained policy of a run, as of its last checkpoint.

use std::path::{Path, PathBuf};

use agents::Agent;
use envs::{EnvOptions, GoalEnv, Spec};
use reports::schema::{Manifest, RunKey};

use super::checkpoint::{self, CHECKPOINT};
use super::folder;
use super::state::TrainerState;
use crate::Registry;
use crate::config::RunConfig;
use crate::error::{Cause, HarnessError};

/// What a run's folder holds of its student, read at one moment. The folder is only read, and a run in
/// progress may go on: its checkpoint is replaced whole.
pub struct Policy {
    folder: PathBuf,
    manifest: Manifest,
    config: RunConfig,
    trainer: TrainerState,
}

impl Policy {
    /// Reads the run in `folder`.
    ///
    /// # Errors
    /// [`HarnessError`] if there is no run, or the run has no checkpoint yet, is damaged, or has an
    /// environment or curriculum that `registry` lacks.
    pub fn read(registry: &Registry, folder: &Path) -> Result<Self, HarnessError> {
        let (manifest, config) = folder::read_manifest(folder)?;
        registry.check(&manifest.run)?;
        let saved = checkpoint::read(folder, &manifest)?;
        let saved = saved.ok_or_else(|| HarnessError::Missing {
            path: folder.join(CHECKPOINT),
            reason: "is missing: the run has not come to its first checkpoint yet, or has lost it".into(),
        })?;
        Ok(Self { folder: folder.to_owned(), manifest, config, trainer: saved.trainer })
    }

    /// Which run this is.
    pub fn run(&self) -> &RunKey {
        &self.manifest.run
    }

    /// What the run is.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Training steps behind the policy.
    pub fn step(&self) -> u64 {
        self.trainer.step()
    }

    /// Training steps of the whole run.
    pub fn steps(&self) -> u64 {
        self.config.budget.steps
    }

    /// Whether it was trained with MuJoCo's native CCD; means nothing where nothing is simulated.
    pub fn native_ccd(&self) -> bool {
        self.config.physics.native_ccd
    }

    /// A new instance of the environment that the run trains on.
    ///
    /// # Errors
    /// [`HarnessError`] if it cannot be made.
    ///
    /// # Panics
    /// If `registry` is not the one that [`Policy::read`] was given and lacks the environment.
    pub fn environment(&self, registry: &Registry) -> Result<Box<dyn GoalEnv>, HarnessError> {
        let entry = registry.environment(&self.run().environment).expect("it was checked when read");
        let options = EnvOptions { native_ccd: self.config.physics.native_ccd };
        entry.make(&options).map_err(self.unusable("make this run's environment"))
    }

    /// The student, without its experience, on the calling thread. `spec` is that of [`Policy::environment`].
    ///
    /// # Errors
    /// [`HarnessError`] if this machine cannot run it, or its state is not what was saved.
    pub fn student(&self, spec: &Spec) -> Result<Box<dyn Agent>, HarnessError> {
        agents::prepare_thread();
        let mut student = agents::make(&self.config.student, spec, self.run().seed)
            .map_err(self.unusable("make this run's student"))?;
        student.load_policy(self.trainer.student()).map_err(self.unusable("load this run's student"))?;
        Ok(student)
    }

    fn unusable<E: Into<Cause>>(&self, action: &'static str) -> impl FnOnce(E) -> HarnessError {
        HarnessError::unusable(self.folder.display(), action)
    }
}
