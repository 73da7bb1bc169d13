//! What must be there before anything is fetched.

use std::{
    env,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::{
    error::{Error, Result, doing, why_not_started},
    pins::Part,
};

/// Fails on any platform but that of the pinned wheels.
pub(crate) fn platform() -> Result<()> {
    if cfg!(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu")) {
        return Ok(());
    }
    Err(Error::Platform { system: env::consts::OS, processor: env::consts::ARCH })
}

/// Fails when the C++ compiler that builds torch-sys (`CXX`, else `c++`) does not run.
pub(crate) fn compiler() -> Result<()> {
    let command = env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    let mut words = command.split_whitespace();
    let refused = |reason| Error::Compiler { command: command.clone(), reason };
    let program = words.next().ok_or_else(|| refused("CXX is empty".to_owned()))?;
    let status = Command::new(program)
        .args(words)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map_err(|error| refused(why_not_started(&error)))?;
    if status.success() { Ok(()) } else { Err(refused(status.to_string())) }
}

/// Spare room for what is not counted: folders, the stamp, pip's log.
const SPARE_BYTES: u64 = 50_000_000;

/// The most disk space in bytes that fetching `parts` one after another takes at any time.
///
/// For each part there are first two copies of its wheels, since pip copies them out of its temporary folder,
/// then the wheels and the unpacked part, then the part alone.
pub(crate) fn space_needed(parts: &[&Part]) -> u64 {
    let mut kept = 0;
    let mut most = 0;
    for part in parts {
        let download = part.download_bytes();
        most = most.max(kept + (2 * download).max(download + part.unpacked_bytes));
        kept += part.unpacked_bytes;
    }
    most + SPARE_BYTES
}

/// Fails when fewer than `needed` bytes are free in `folder`.
pub(crate) fn space(needed: u64, folder: &Path) -> Result<()> {
    let free = fs4::available_space(folder).map_err(doing("ask for the free space of", folder))?;
    if free < needed { Err(Error::DiskFull { folder: folder.to_owned(), needed, free }) } else { Ok(()) }
}

/// The user's own folder for `part`, if its environment variable (`value`) names another one than set-up's
/// own.
///
/// # Errors
/// When it is no absolute path or does not hold what it should.
pub(crate) fn own_folder(part: &Part, value: Option<PathBuf>, native: &Path) -> Result<Option<PathBuf>> {
    let Some(folder) = value.filter(|folder| !is_ours(folder, part, native)) else { return Ok(None) };
    if !folder.is_absolute() {
        return Err(Error::OwnRelative { variable: part.variable, folder });
    }
    if !folder.join(part.proof).is_file() {
        return Err(Error::OwnIncomplete {
            variable: part.variable,
            folder,
            proof: part.proof,
            title: part.title,
        });
    }
    Ok(Some(folder))
}

/// Whether `folder` is the one that set-up makes. Cargo's configuration names it in the variable that users
/// set too.
fn is_ours(folder: &Path, part: &Part, native: &Path) -> bool {
    let same_parent =
        |parent: &Path| parent == native || parent.canonicalize().ok() == native.canonicalize().ok();
    folder.file_name() == Some(part.name.as_ref()) && folder.parent().is_some_and(same_parent)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::tempdir;

    use super::*;
    use crate::pins::PARTS;

    #[test]
    fn space_is_the_peak_over_the_parts_in_turn() {
        let [libtorch, mujoco, assets] = &PARTS;
        // Two copies of the wheel outweigh wheel and content: 2 x 26,174,405.
        assert_eq!(space_needed(&[assets]), 52_348_810 + SPARE_BYTES);
        // libtorch first: 2 x 543,563,777 = 1,087,127,554, which the later, smaller parts stay below.
        assert_eq!(space_needed(&[libtorch, mujoco, assets]), 1_087_127_554 + SPARE_BYTES);
        // Here the second adds to what the first leaves: 5,200,000 + 2 x 26,174,405.
        assert_eq!(space_needed(&[mujoco, assets]), 57_548_810 + SPARE_BYTES);
    }

    #[test]
    fn a_full_disk_is_an_error_with_both_figures() {
        let home = tempdir().unwrap();
        space(1, home.path()).unwrap();
        let error = space(u64::MAX, home.path()).unwrap_err().to_string();
        assert!(error.starts_with("the disk is too full: set-up needs 18446744073710 MB in "), "{error}");
    }

    #[test]
    fn the_folder_of_cargos_configuration_is_not_the_users_own() {
        let native = tempdir().unwrap();
        let part = &PARTS[1];
        assert_eq!(own_folder(part, None, native.path()).unwrap(), None);
        assert_eq!(own_folder(part, Some(native.path().join("mujoco")), native.path()).unwrap(), None);
    }

    #[test]
    fn a_folder_of_the_users_own_must_be_absolute_and_complete() {
        let (native, own) = (tempdir().unwrap(), tempdir().unwrap());
        let part = &PARTS[1];
        let ask = |folder: &Path| own_folder(part, Some(folder.to_owned()), native.path());
        let error = ask(own.path()).unwrap_err().to_string();
        assert!(error.contains("which holds no libmujoco.so"), "{error}");
        fs::write(own.path().join("libmujoco.so"), "").unwrap();
        assert_eq!(ask(own.path()).unwrap().as_deref(), Some(own.path()));
        assert!(ask(Path::new("some/where")).unwrap_err().to_string().contains("not an absolute path"));
    }
}
