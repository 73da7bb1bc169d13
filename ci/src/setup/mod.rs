//! Brings the native parts into `.native`: each fetched, checked, unpacked beside its place and renamed into
//! it.
//!
//! However set-up ends, even if it is killed, every part is afterwards the old one, the new one or absent,
//! and never half of one: the only change to a part's folder is a rename. A killed set-up leaves only folders
//! of its own, which the next one removes.

use std::{
    env,
    fs::{self, File, TryLockError},
    io::ErrorKind,
    path::{Path, PathBuf},
    time::Instant,
};

use crate::{
    checks,
    console::{megabytes, seconds, step},
    error::{Error, Result, doing},
    pins::{PARTS, Part, Wheel},
    pip,
    stamp::{Depth, Stamp, State, hash_file, inspect},
    unpack,
};

/// Prefix of the folders that set-up works in.
const WORK_PREFIX: &str = "tmp-";

/// Prefix of the lines that set-up prints.
const TASK: &str = "set-up";

/// Puts every part of the project below `native` in order: fetches the parts that are missing, damaged or of
/// other pins.
///
/// # Errors
/// If something needed is not there (see [`checks`]), or if fetching or unpacking fails. Parts that were
/// fetched before the failure stay.
pub(crate) fn set_up(native: &Path, depth: Depth) -> Result<()> {
    checks::platform()?;
    checks::compiler()?;
    fs::create_dir_all(native).map_err(doing("create", native))?;
    let _lock = lock(native)?;
    remove_leftovers(native)?;
    let mut wanted = Vec::new();
    for part in &PARTS {
        if let Some(folder) = checks::own_folder(part, env::var_os(part.variable).map(PathBuf::from), native)?
        {
            say(part, &format!("{} is set, using {}", part.variable, folder.display()));
        } else if !is_intact(part, native, depth) {
            wanted.push(part);
        }
    }
    if wanted.is_empty() {
        return Ok(());
    }
    pip::require()?;
    checks::space(checks::space_needed(&wanted), native)?;
    wanted.into_iter().try_for_each(|part| bring(part, native, pip::download))
}

/// Prints one line about a part.
fn say(part: &Part, text: &str) {
    step(TASK, &format!("{}: {text}", part.title));
}

/// Whether a part is complete; prints what was found.
fn is_intact(part: &Part, native: &Path, depth: Depth) -> bool {
    let found = inspect(&native.join(part.name), part, depth);
    match &found {
        State::Intact if depth == Depth::Hashes => say(part, "present, every file as it was unpacked"),
        State::Intact => say(part, "present"),
        State::Missing => say(part, "missing"),
        State::Outdated => say(part, "what is there is of other pins"),
        State::Damaged(what) => say(part, &format!("damaged, {what}")),
    }
    found == State::Intact
}

/// Fetches one part with `fetch`, which is given the part, the folder for its wheels and one to work in, and
/// puts it in place of what was there.
fn bring(part: &Part, native: &Path, fetch: impl FnOnce(&Part, &Path, &Path) -> Result<()>) -> Result<()> {
    let work = tempfile::Builder::new().prefix(WORK_PREFIX).tempdir_in(native);
    let work = work.map_err(doing("create a folder in", native))?;
    let wheels = work.path().join("wheels");
    fs::create_dir(&wheels).map_err(doing("create", &wheels))?;

    say(part, &format!("fetching {}", megabytes(part.download_bytes())));
    let start = Instant::now();
    fetch(part, &wheels, work.path())?;
    let fetched = start.elapsed();

    let start = Instant::now();
    let made = work.path().join(part.name);
    make(part, &wheels, &made)?;
    swap(&made, &native.join(part.name), &work.path().join("old"))?;
    say(
        part,
        &format!("fetched in {}, checked and unpacked in {}", seconds(fetched), seconds(start.elapsed())),
    );
    Ok(())
}

/// Makes the folder of a part, including its stamp, from the pinned wheels in `wheels`.
fn make(part: &Part, wheels: &Path, folder: &Path) -> Result<()> {
    let brought = hashes(wheels)?;
    let mut stamp = Stamp { recipe: part.recipe(), ..Stamp::default() };
    for wheel in part.wheels {
        unpack::unpack(pinned(wheel, &brought)?, wheel.takes, folder, &mut stamp)?;
    }
    unpack::add(part.additions, folder, &mut stamp)?;
    stamp.write(folder)
}

/// The files of a folder with their hashes.
fn hashes(folder: &Path) -> Result<Vec<(PathBuf, String)>> {
    let entries = fs::read_dir(folder).map_err(doing("read", folder))?;
    entries
        .map(|entry| {
            let path = entry.map_err(doing("read", folder))?.path();
            let hash = hash_file(&path).map_err(doing("read", &path))?;
            Ok((path, hash))
        })
        .collect()
}

/// The file that is the pinned wheel, recognised by its hash and not by its name.
fn pinned<'a>(wheel: &Wheel, brought: &'a [(PathBuf, String)]) -> Result<&'a Path> {
    let found = brought.iter().find(|(_, hash)| hash == wheel.sha256);
    found.map(|(path, _)| path.as_path()).ok_or_else(|| Error::WrongWheel {
        project: wheel.project,
        version: wheel.version,
        sha256: wheel.sha256,
        brought: brought.iter().map(|(path, hash)| format!("{} (sha256 {hash})", path.display())).collect(),
    })
}

/// Puts `new` in place of `old`, which goes to `aside` if it exists.
fn swap(new: &Path, old: &Path, aside: &Path) -> Result<()> {
    match fs::rename(old, aside) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(doing("move away", old)(error)),
        _ => (),
    }
    fs::rename(new, old).map_err(|error| {
        // Restores the old part. If that fails too, the first error is still the one to report.
        let _ = fs::rename(aside, old);
        doing("put in place", old)(error)
    })
}

/// Waits until no other set-up works in `native`. The lock ends with the returned file or with the process.
fn lock(native: &Path) -> Result<File> {
    let path = native.join("lock");
    let file = File::create(&path).map_err(doing("create", &path))?;
    match file.try_lock() {
        Ok(()) => (),
        Err(TryLockError::WouldBlock) => {
            step(TASK, "another one is at work in this project, waiting for it to end");
            file.lock().map_err(doing("lock", &path))?;
        }
        Err(TryLockError::Error(error)) => return Err(doing("lock", &path)(error)),
    }
    Ok(file)
}

/// Removes what killed set-ups left. The caller must hold the lock: the folders of a running set-up look the
/// same.
fn remove_leftovers(native: &Path) -> Result<()> {
    for entry in fs::read_dir(native).map_err(doing("read", native))? {
        let entry = entry.map_err(doing("read", native))?;
        if entry.file_name().to_string_lossy().starts_with(WORK_PREFIX) {
            step(TASK, "removing what one that did not end left behind");
            fs::remove_dir_all(entry.path()).map_err(doing("remove", &entry.path()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
