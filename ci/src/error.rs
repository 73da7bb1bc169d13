//! What can go wrong. An error and its causes make one line, which says what to do where something can be
//! done.

use std::{
    io,
    path::{Path, PathBuf},
    process::ExitStatus,
};

/// Errors of this program.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    #[error(
        "no native libraries for {system} on {processor}: x86-64 Linux with glibc 2.28 or newer is supported (Debian 10, Ubuntu 20.04 and later)"
    )]
    Platform { system: &'static str, processor: &'static str },
    #[error(
        "no C++ compiler: `{command}` does not run ({reason}); install one (Debian: apt install g++) or name yours in CXX"
    )]
    Compiler { command: String, reason: String },
    #[error(
        "no Python: `python3` does not run ({reason}); install it with pip (Debian: apt install python3-pip)"
    )]
    Python { reason: String },
    #[error("no pip: `python3 -m pip` fails ({reason}); install it (Debian: apt install python3-pip)")]
    Pip { reason: String },
    #[error("pip could not fetch {title}: {reason}")]
    Download { title: &'static str, reason: String },
    #[error(
        "pip did not bring the pinned wheel of {project} {version} (sha256 {sha256}), only: {brought}",
        brought = if brought.is_empty() { "nothing".to_owned() } else { brought.join(", ") }
    )]
    WrongWheel { project: &'static str, version: &'static str, sha256: &'static str, brought: Vec<String> },
    #[error(
        "the disk is too full: set-up needs {} in {} while it works, {} are free",
        crate::console::megabytes(*needed), folder.display(), crate::console::megabytes(*free)
    )]
    DiskFull { folder: PathBuf, needed: u64, free: u64 },
    #[error("{variable} is {folder}, not an absolute path: cargo reads it in other folders too", folder = folder.display())]
    OwnRelative { variable: &'static str, folder: PathBuf },
    #[error(
        "{variable} is {folder}, which holds no {proof}: correct it, or unset it and set-up fetches {title}",
        folder = folder.display()
    )]
    OwnIncomplete { variable: &'static str, folder: PathBuf, proof: &'static str, title: &'static str },
    #[error("{wheel}", wheel = wheel.display())]
    Archive { wheel: PathBuf, source: zip::result::ZipError },
    #[error("{wheel}: refused, its entry {entry:?} is no plain file inside the archive's own folder", wheel = wheel.display())]
    UnsafeEntry { wheel: PathBuf, entry: String },
    #[error("{wheel}: holds no {entry}", wheel = wheel.display())]
    NoSuchEntry { wheel: PathBuf, entry: &'static str },
    #[error("cannot {action} {path}", path = path.display())]
    Io { action: &'static str, path: PathBuf, source: io::Error },
    #[error("no fault `{name}`; there are {}", known.join(", "))]
    NoFault { name: String, known: Vec<&'static str> },
    #[error("{file}: the text that a fault replaces does not stand there once: {text}")]
    NoPlace { file: String, text: String },
    #[error("git cannot list the files of {}: {reason}", folder.display())]
    Git { folder: PathBuf, reason: String },
    #[error("the faulty program does not build ({status})")]
    Build { status: ExitStatus },
    #[error("the check neither passed nor failed ({status}): `goalbench regress check` says why")]
    Check { status: ExitStatus },
    #[error("`{command}`: {ended}\n  {said}")]
    Torture { command: String, ended: String, said: String },
    #[error("cannot start `{command}`")]
    Start { command: String, source: io::Error },
}

/// Shorthand of this program.
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// Wraps an I/O error with what was being done to which path: `.map_err(doing("read", path))`.
pub(crate) fn doing(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Error {
    move |source| Error::Io { action, path: path.to_owned(), source }
}

/// An error with its causes, outermost first.
pub(crate) fn in_one_line(error: &dyn std::error::Error) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let text = error.to_string();
        // Some libraries' errors already end in the text of their cause.
        if !line.ends_with(&text) {
            line = format!("{line}: {text}");
        }
        cause = error.source();
    }
    line
}

/// Why a program did not start. If it is not there, the system's own message would speak of a file.
pub(crate) fn why_not_started(error: &io::Error) -> String {
    if error.kind() == io::ErrorKind::NotFound { "not found".to_owned() } else { error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_follow_their_error_on_the_same_line() {
        let refused = io::Error::other("disk on fire");
        let error = doing("read", Path::new("stamp.json"))(refused);
        assert_eq!(in_one_line(&error), "cannot read stamp.json: disk on fire");
        let source = zip::result::ZipError::Io(io::Error::other("disk on fire"));
        let error = Error::Archive { wheel: "w.whl".into(), source };
        assert_eq!(in_one_line(&error), "w.whl: i/o error: disk on fire", "said once");
    }
}
