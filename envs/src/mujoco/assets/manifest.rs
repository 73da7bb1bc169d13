//! The content that the model files must have.
//!
//! One changed digit in a model changes every trajectory without any other sign, so files are compared with
//! the digests of those that the recordings were made with.

use std::path::Path;

use sha2::{Digest, Sha256};

use crate::error::EnvError;

/// The output of `sha256sum` for the files of gymnasium-robotics 1.4.2's `assets/` that are used here.
const MANIFEST: &str = include_str!("manifest.sha256");

/// Checks all files below `folder` that the models of a `family` (`fetch` or `hand`) are made of.
///
/// # Errors
/// [`EnvError::Asset`] for the first that is missing or different.
pub(super) fn check(folder: &Path, family: &str) -> Result<(), EnvError> {
    let belongs = |name: &str| {
        name.split('/').next() == Some(family)
            || name.starts_with(&format!("stls/{family}/"))
            || name.starts_with("textures/")
    };
    for (digest, name) in
        MANIFEST.lines().filter_map(|line| line.split_once("  ")).filter(|(_, name)| belongs(name))
    {
        let path = folder.join(name);
        let broken =
            |reason: &str, source| EnvError::Asset { path: path.clone(), reason: reason.into(), source };
        let content =
            guard::files::read(&path).map_err(|error| broken("cannot be read", Some(error.into())))?;
        if hex(&Sha256::digest(content)) != digest {
            return Err(broken("its content is not that of gymnasium-robotics 1.4.2", None));
        }
    }
    Ok(())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::{MANIFEST, check, hex};

    #[test]
    fn the_manifest_lists_every_file_once() {
        let names: std::collections::BTreeSet<_> = MANIFEST.lines().map(|line| &line[66..]).collect();
        assert_eq!((names.len(), MANIFEST.lines().count()), (45, 45));
        assert!(check(&crate::mujoco::assets::folder(), "hand").is_ok());
    }

    #[test]
    fn digests_are_lower_case_hexadecimal() {
        assert_eq!(hex(&[0x0a, 0xf0]), "0af0");
    }
}
