//! The trained policy of a run in open formats, for other programs.
//!
//! `policy.safetensors` holds the numbers, `policy.json` says what they are: an exported policy needs neither
//! this program nor its checkpoints.

mod about;
mod kept;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use agents::{DenseLayer, InputScaling, PolicyWeights};
use safetensors::tensor::{Dtype, TensorView, serialize};

use crate::Registry;
use crate::error::HarnessError;
use crate::files::sync;
use crate::fresh_folder::{FolderKind, FreshFolder};
use crate::run::policy::Policy;

/// Name of the file with the numbers.
pub const NUMBERS: &str = "policy.safetensors";
/// Name of the file that says what they are.
pub const ABOUT: &str = "policy.json";

const KIND: FolderKind = FolderKind { prefix: ".goalbench-export-", holds: &[NUMBERS, ABOUT] };

/// A policy as the content of its two files.
pub struct ExportedPolicy {
    /// That of [`NUMBERS`].
    pub numbers: Vec<u8>,
    /// That of [`ABOUT`].
    pub about: Vec<u8>,
}

impl ExportedPolicy {
    /// The policy of the run that `policy` was read from.
    ///
    /// # Errors
    /// [`HarnessError`] if the run's environment or student cannot be made here, or its state is not what was
    /// saved.
    pub fn of(registry: &Registry, policy: &Policy) -> Result<Self, HarnessError> {
        let env = policy.environment(registry)?;
        let student = policy.student(env.spec())?;
        let subject = policy.run();
        let weights = student.weights().map_err(HarnessError::unusable(subject, "read this run's policy"))?;
        let numbers = tensors(&weights).map_err(HarnessError::unusable(subject, "write down its numbers"))?;
        let about = about::text(policy, env.spec(), &weights, &numbers);
        Ok(Self { numbers, about: about.into_bytes() })
    }

    /// Its files by name.
    pub fn files(&self) -> [(&'static str, &[u8]); 2] {
        [(NUMBERS, &self.numbers), (ABOUT, &self.about)]
    }

    /// Writes them into the new folder `out`, which appears complete or not at all. Gives their paths.
    ///
    /// # Errors
    /// [`HarnessError::Exists`] if `out` does, [`HarnessError::Io`].
    pub fn write(&self, out: &Path) -> Result<Vec<PathBuf>, HarnessError> {
        let fresh = FreshFolder::beside(out, &KIND)?;
        for (name, bytes) in self.files() {
            let path = fresh.path().join(name);
            fs::write(&path, bytes)
                .and_then(|()| sync(&path))
                .map_err(HarnessError::io(out.join(name), "write this file"))?;
        }
        fresh.put(out)?;
        // The lock of the folder while it was new.
        let _ = fs::remove_file(out.join(reports::store::layout::LOCK));
        Ok(self.files().map(|(name, _)| out.join(name)).into())
    }
}

/// All numbers in the safetensors format, in single precision.
fn tensors(weights: &PolicyWeights) -> Result<Vec<u8>, safetensors::SafeTensorError> {
    let PolicyWeights { state, goal, layers } = weights;
    let mut named: Vec<(String, Vec<usize>, Vec<u8>)> = Vec::new();
    let mut name = |name: String, shape: Vec<usize>, numbers: &[f32]| {
        named.push((name, shape, numbers.iter().flat_map(|number| number.to_le_bytes()).collect()));
    };
    for (input, InputScaling { mean, scale, .. }) in [("state", state), ("goal", goal)] {
        name(format!("{input}.mean"), vec![mean.len()], mean);
        name(format!("{input}.scale"), vec![scale.len()], scale);
    }
    for (index, DenseLayer { inputs, outputs, weight, bias }) in layers.iter().enumerate() {
        name(about::weight(index), vec![*outputs, *inputs], weight);
        name(about::bias(index), vec![*outputs], bias);
    }
    let mut views = Vec::with_capacity(named.len());
    for (name, shape, bytes) in &named {
        views.push((name, TensorView::new(Dtype::F32, shape.clone(), bytes)?));
    }
    // One entry alone: a map of several has no order.
    let format = HashMap::from([("format".to_owned(), "pt".to_owned())]);
    serialize(views.iter().map(|(name, view)| (name, view)), &Some(format))
}
