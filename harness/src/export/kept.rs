//! A policy that was exported before.

use std::io;
use std::path::Path;

use guard::files;
use reports::schema::Manifest;
use serde::Deserialize;
use sha2::{Digest, Sha256};

use super::{ABOUT, ExportedPolicy, NUMBERS};
use crate::error::HarnessError;

/// What [`ABOUT`] says of which policy it is.
#[derive(Deserialize)]
struct Identity {
    config_hash: String,
    sha256: String,
}

/// What is wrong with it.
#[derive(Debug, thiserror::Error)]
#[error(
    "it is not the policy of the run, or its numbers are not those that it was exported with; delete it, or unpack its archive \
     again"
)]
struct OtherPolicy;

impl ExportedPolicy {
    /// The policy of the run of `manifest` that lies in `folder`; `None` if none does.
    ///
    /// # Errors
    /// [`HarnessError::Io`] if a file of it cannot be read, [`HarnessError::Unusable`] if it is another one.
    pub fn kept(folder: &Path, manifest: &Manifest) -> Result<Option<Self>, HarnessError> {
        let [about, numbers] = [ABOUT, NUMBERS].map(|name| folder.join(name));
        if !files::is_there(&about).map_err(HarnessError::io(&about, "look for this file"))? {
            return Ok(None);
        }
        let read = |path: &Path| files::read(path).map_err(HarnessError::io(path, "read this file"));
        let policy = Self { numbers: read(&numbers)?, about: read(&about)? };
        let identity: Identity = serde_json::from_slice(&policy.about)
            .map_err(io::Error::from)
            .map_err(HarnessError::io(&about, "read this file"))?;
        let sum: String = Sha256::digest(&policy.numbers).iter().map(|byte| format!("{byte:02x}")).collect();
        if identity.config_hash == manifest.hash && identity.sha256 == sum {
            Ok(Some(policy))
        } else {
            Err(HarnessError::unusable(folder.display(), "take this policy")(OtherPolicy))
        }
    }
}
