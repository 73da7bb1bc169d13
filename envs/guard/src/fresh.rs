//! Files that appear whole or not at all.
//!
//! They are written under a name of their own beside the place where they belong, and renamed when they are
//! complete. A process that is killed in between leaves that name behind. Its file was locked for as long as
//! the process lived: [`sweep`] removes what has such a name and nobody's lock.

use std::fs::{self, File, Permissions};
use std::io::{self, ErrorKind, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;

use tempfile::NamedTempFile;

use crate::files;

const PREFIX: &str = ".goalbench-";
const SUFFIX: &str = ".new";
/// Characters between them, which no two files share.
const RANDOM: usize = 12;

/// A new file in `folder`, to be renamed into place; as readable as any other new file (the umask applies),
/// because folders of results are shared.
///
/// # Errors
/// If it cannot be created.
pub fn file(folder: &Path) -> io::Result<NamedTempFile> {
    loop {
        let file = tempfile::Builder::new()
            .prefix(PREFIX)
            .suffix(SUFFIX)
            .rand_bytes(RANDOM)
            .permissions(Permissions::from_mode(0o666))
            .tempfile_in(folder)?;
        // Where files cannot be locked no sweep can lock them either, so that they stay.
        let _ = file.as_file().lock();
        // A sweep may have found it before it was locked.
        if file.as_file().metadata()?.nlink() > 0 {
            return Ok(file);
        }
    }
}

/// Renames the complete `file` to `path`, in place of the file or link there.
///
/// # Errors
/// If it cannot be renamed; [`ErrorKind::InvalidData`] if a device or anything else lies there that is no
/// file.
pub fn put(file: NamedTempFile, path: &Path) -> io::Result<File> {
    // To go through a link is to look where it leads: `/dev/stdout` is one.
    match fs::metadata(path) {
        Ok(found) => files::regular(&found)?,
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    Ok(file.persist(path)?)
}

/// Writes `bytes` to `path` in place of what is there.
///
/// # Errors
/// As [`put`], or if they cannot be written; what was there then stays.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    written(path, bytes).and_then(|file| put(file, path)).map(drop)
}

/// The same, through to the disk before it is in place.
///
/// # Errors
/// As [`write()`].
pub fn write_through(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let file = written(path, bytes)?;
    file.as_file().sync_all()?;
    put(file, path).map(drop)
}

/// A file with `bytes` that will belong at `path`.
fn written(path: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut file = file(folder.unwrap_or(Path::new(".")))?;
    file.write_all(bytes)?;
    Ok(file)
}

/// Removes from `folder` what killed processes left of [`file()`]s. Whatever has another name, is no regular
/// file or is being written stays, and so does what cannot be removed: it does no harm.
pub fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        if name.to_str().is_some_and(is_ours) {
            let _ = remove_abandoned(&entry.path());
        }
    }
}

fn is_ours(name: &str) -> bool {
    let random = name.strip_prefix(PREFIX).and_then(|name| name.strip_suffix(SUFFIX));
    random.is_some_and(|part| part.len() == RANDOM && part.bytes().all(|byte| byte.is_ascii_alphanumeric()))
}

fn remove_abandoned(path: &Path) -> io::Result<()> {
    if !fs::symlink_metadata(path)?.is_file() {
        return Ok(());
    }
    let file = files::open(path)?;
    // Its writer may have renamed it since, and another file have come in its place.
    let is_still_there = |file: &File| {
        let (held, named) = (file.metadata()?, fs::symlink_metadata(path)?);
        Ok::<_, io::Error>((held.dev(), held.ino()) == (named.dev(), named.ino()))
    };
    match file.try_lock() {
        Ok(()) if is_still_there(&file)? => fs::remove_file(path),
        Ok(()) => Ok(()),
        Err(error) => Err(io::Error::new(ErrorKind::WouldBlock, error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_nobody_writes_is_swept_away() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let (kept, held) = file(folder.path()).unwrap().keep().map(|(file, path)| (path, file)).unwrap();
        let others = [".tmpAbCdEf", "checkpoint.bin", ".goalbench-notes.new", ".goalbench-0123456789ab"];
        for name in others {
            fs::write(place(name), "theirs").unwrap();
        }
        let linked = place(".goalbench-0123456789ab.new");
        std::os::unix::fs::symlink(place("checkpoint.bin"), &linked).unwrap();
        sweep(folder.path());
        assert!(kept.exists(), "it is being written");
        drop(held);
        sweep(folder.path());
        assert!(!kept.exists(), "its writer is gone");
        assert!(others.iter().all(|name| place(name).exists()) && linked.is_symlink());
    }

    #[test]
    fn files_and_links_are_replaced_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let [target, link, null] = ["target", "link", "null"].map(|name| folder.path().join(name));
        fs::write(&target, "kept").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        std::os::unix::fs::symlink("/dev/null", &null).unwrap();
        for write in [write, write_through] {
            write(&link, b"new").unwrap();
            assert_eq!(
                (fs::read(&target).unwrap(), fs::read(&link).unwrap()),
                (b"kept".into(), b"new".into())
            );
            assert!(!link.is_symlink());
            assert!(write(&folder.path().join("nowhere/file"), b"new").is_err());
            assert_eq!(write(&null, b"new").unwrap_err().kind(), ErrorKind::InvalidData);
            assert!(null.is_symlink() && write(folder.path(), b"new").is_err());
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3, "nothing is left behind");
    }
}
