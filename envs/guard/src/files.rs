//! Regular files, and nothing else.
//!
//! A pipe without a writer keeps whoever opens or reads it waiting, a device never ends. So everything that
//! is no regular file is refused: first by its name, since to open a device may already do something, then
//! once more when it is open, since the name may lead elsewhere by then.

use std::fs::{self, File, FileType, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::OFlags;

/// Opens the file at `path` for reading. Links are followed.
///
/// # Errors
/// What the system refuses, [`ErrorKind::NotFound`] only where nothing lies at all;
/// [`ErrorKind::InvalidData`] if it is no regular file, or a link that leads nowhere.
pub fn open(path: &Path) -> io::Result<File> {
    regular(&fs::metadata(path).map_err(|error| absent(path, error))?)?;
    opened(OpenOptions::new().read(true), OFlags::empty(), path)
}

/// Paths of all that lies in the folder at `path`, sorted; `None` where nothing lies at `path`.
///
/// # Errors
/// What the system refuses; [`ErrorKind::InvalidData`] if it is a link that leads nowhere.
pub fn entries(path: &Path) -> io::Result<Option<Vec<PathBuf>>> {
    let entries = match fs::read_dir(path).map_err(|error| absent(path, error)) {
        Ok(entries) => entries,
        // A path that leads through a file is told when the folder is to be created.
        Err(error) if is_absent(&error) => return Ok(None),
        Err(error) => return Err(error),
    };
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    Ok(Some(paths))
}

/// Whether anything lies at `path`, be it a link that leads nowhere.
///
/// # Errors
/// What keeps it from being known, such as a folder that may not be searched.
pub fn is_there(path: &Path) -> io::Result<bool> {
    match fs::symlink_metadata(path) {
        Ok(_) => Ok(true),
        Err(error) if is_absent(&error) => Ok(false),
        Err(error) => Err(error),
    }
}

/// Whether an error says that nothing lies at a path, and no more than that.
pub fn is_absent(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// What `error`, met at `path`, means: the system calls a link that leads nowhere a file that is not there.
fn absent(path: &Path, error: io::Error) -> io::Error {
    let is_link = || fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink());
    if error.kind() == ErrorKind::NotFound && is_link() {
        return io::Error::new(ErrorKind::InvalidData, "it is a link that leads nowhere");
    }
    error
}
/// The most bytes of a file that [`read`] takes in: more than any file of this program holds. A file may
/// claim any size without taking room on the disk, and would fill the memory.
pub const MOST: u64 = 4 << 30;
/// The most bytes of a file that [`read_to_string`] takes in.
pub const MOST_TEXT: u64 = 64 << 20;

/// All bytes of the file at `path`.
///
/// # Errors
/// As [`open`]; [`ErrorKind::InvalidData`] if it holds more than [`MOST`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let expected = file.metadata()?.len();
    if expected > MOST {
        return Err(too_large(MOST));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve(expected as usize)?;
    within(file, MOST, &mut bytes)?;
    Ok(bytes)
}

/// The text of the file at `path`, which a person may have written.
///
/// # Errors
/// As [`open`]; [`ErrorKind::InvalidData`] if it holds more than [`MOST_TEXT`] or is not UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    text_within(open(path)?, MOST_TEXT)
}

/// The text that `source` holds, which may unpack to more than there is room for.
///
/// # Errors
/// What `source` refuses; [`ErrorKind::InvalidData`] if it holds more than `most` bytes or is not UTF-8.
pub fn text_within(source: impl Read, most: u64) -> io::Result<String> {
    let mut bytes = Vec::new();
    within(source, most, &mut bytes)?;
    String::from_utf8(bytes).map_err(|error| io::Error::new(ErrorKind::InvalidData, error.utf8_error()))
}

fn within(source: impl Read, most: u64, bytes: &mut Vec<u8>) -> io::Result<()> {
    source.take(most + 1).read_to_end(bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(()) }
}

fn too_large(most: u64) -> io::Error {
    let reason = format!("it holds more than {} MB, the most that is read", most >> 20);
    io::Error::new(ErrorKind::InvalidData, reason)
}

/// Opens the file at `path` for reading and writing, creates it if need be and keeps what it holds. A link is
/// refused: it could lead to any file of the user's.
///
/// # Errors
/// As [`open`].
pub fn update(path: &Path) -> io::Result<File> {
    own(OpenOptions::new().read(true).write(true).create(true).truncate(false), path)
}

/// The same for writing at the end.
///
/// # Errors
/// As [`open`].
pub fn append(path: &Path) -> io::Result<File> {
    own(OpenOptions::new().append(true).create(true), path)
}

/// Copies the file at `from` to `to`, where nothing may lie yet.
///
/// # Errors
/// As [`open`]; [`ErrorKind::AlreadyExists`].
pub fn copy(from: &Path, to: &Path) -> io::Result<()> {
    let mut source = open(from)?;
    let mut target = OpenOptions::new().write(true).create_new(true).open(to)?;
    io::copy(&mut source, &mut target).map(drop)
}

fn own(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    match fs::symlink_metadata(path) {
        Ok(found) => regular(&found)?,
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    opened(options, OFlags::NOFOLLOW, path)
}

/// Opens without waiting for anybody, and looks at what is open.
fn opened(options: &mut OpenOptions, more: OFlags, path: &Path) -> io::Result<File> {
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY | more;
    let file = options.custom_flags(flags.bits().cast_signed()).open(path)?;
    regular(&file.metadata()?)?;
    Ok(file)
}

pub(crate) fn regular(found: &Metadata) -> io::Result<()> {
    let kind = found.file_type();
    if kind.is_file() {
        return Ok(());
    }
    let reason = if kind.is_symlink() {
        "it is a link, and nothing is written through links".to_owned()
    } else {
        format!("it is {}; a regular file is expected", name(kind))
    };
    Err(io::Error::new(ErrorKind::InvalidData, reason))
}

fn name(kind: FileType) -> &'static str {
    if kind.is_dir() {
        "a folder"
    } else if kind.is_fifo() {
        "a pipe"
    } else if kind.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::os::unix::fs::symlink;
    use std::os::unix::net::UnixListener;

    use rustix::fs::{CWD, Mode, mkfifoat};

    use super::*;

    fn refusal<T>(result: io::Result<T>) -> String {
        let error = result.err().expect("it is refused");
        assert_eq!(error.kind(), ErrorKind::InvalidData);
        error.to_string()
    }

    #[test]
    fn only_regular_files_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        mkfifoat(CWD, place("pipe"), Mode::RUSR | Mode::WUSR).unwrap();
        let _socket = UnixListener::bind(place("socket")).unwrap();
        symlink("/dev/zero", place("device")).unwrap();
        symlink(place("pipe"), place("linked")).unwrap();
        for (name, kind) in [("pipe", "pipe"), ("socket", "socket"), ("device", "device"), ("linked", "pipe")]
        {
            let expected = format!("it is a {kind}; a regular file is expected");
            assert_eq!(refusal(read(&place(name))), expected);
            assert_eq!(refusal(copy(&place(name), &place("copy"))), expected);
        }
        assert_eq!(refusal(open(folder.path())), "it is a folder; a regular file is expected");
        for write in [update, append] {
            assert!(refusal(write(&place("pipe"))).contains("a pipe"));
            assert!(refusal(write(&place("socket"))).contains("a socket"));
            assert!(refusal(write(&place("device"))).contains("a link"));
        }
        assert!(!place("copy").exists());
    }

    #[test]
    fn what_would_fill_the_memory_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large");
        let file = fs::File::create(&path).unwrap();
        file.set_len(MOST_TEXT).unwrap();
        assert_eq!(read_to_string(&path).unwrap().len() as u64, MOST_TEXT);
        file.set_len(MOST_TEXT + 1).unwrap();
        assert_eq!(refusal(read_to_string(&path)), "it holds more than 64 MB, the most that is read");
        // It takes no room on the disk.
        file.set_len(1 << 40).unwrap();
        assert_eq!(refusal(read(&path)), "it holds more than 4096 MB, the most that is read");
        assert_eq!(text_within(&b"abc"[..], 3).unwrap(), "abc");
        assert_eq!(text_within(&b"abcd"[..], 3).unwrap_err().kind(), ErrorKind::InvalidData);
        assert_eq!(text_within(&b"\xff"[..], 3).unwrap_err().kind(), ErrorKind::InvalidData);
    }

    #[test]
    fn links_are_read_and_never_written_through() {
        let folder = tempfile::tempdir().unwrap();
        let [target, link, dangling] = ["target", "link", "dangling"].map(|name| folder.path().join(name));
        fs::write(&target, "kept").unwrap();
        symlink(&target, &link).unwrap();
        symlink(folder.path().join("nowhere"), &dangling).unwrap();
        assert_eq!(read_to_string(&link).unwrap(), "kept");
        for (write, place) in [(update as fn(&Path) -> _, &link), (append, &link), (update, &dangling)] {
            assert!(refusal(write(place)).contains("nothing is written through links"));
        }
        assert_eq!(copy(&target, &dangling).unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read_to_string(&target).unwrap(), "kept");
        assert!(!folder.path().join("nowhere").exists());
        for told in [refusal(open(&dangling)), refusal(entries(&dangling))] {
            assert_eq!(told, "it is a link that leads nowhere");
        }
        assert_eq!(entries(&folder.path().join("nowhere")).unwrap(), None);
        assert_eq!(
            entries(folder.path()).unwrap().unwrap(),
            [dangling.clone(), link.clone(), target.clone()]
        );
        assert!(is_there(&dangling).unwrap() && !is_there(&target.join("below")).unwrap());
        symlink("loop", folder.path().join("loop")).unwrap();
        assert!(is_there(&folder.path().join("loop/below")).is_err(), "nobody knows");

        update(&target).unwrap().write_all(b"K").unwrap();
        append(&target).unwrap().write_all(b"!").unwrap();
        assert_eq!(read(&target).unwrap(), b"Kept!");
    }
}
