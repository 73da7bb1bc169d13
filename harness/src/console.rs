//! What the program says: the only writer to standard output, and the only one to standard error.
//!
//! A reader that went away (`| head`) has had enough, which is no error. Anything else that keeps a text from
//! being written, such as a full disk behind `> file`, is: the work goes on, whoever asked for it is told
//! once, and [`end`] turns a success into a failure.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::Mutex;

use guard::text::shown;
use os_display::Quotable;

use crate::outputs::unlike_an_option;
use crate::sweep::ExitCode;

/// `path` as a word of a command that people copy into a shell: quoted where it needs to be, and unlike an
/// option.
pub(crate) fn word(path: &Path) -> String {
    unlike_an_option(path.to_owned()).maybe_quote().to_string()
}

/// How far a stream can be written to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Health {
    Sound,
    /// Nobody reads it any more.
    Closed,
    /// Something is missing in it.
    Broken,
}

static OUTPUT: Mutex<Health> = Mutex::new(Health::Sound);
static COMPLAINTS: Mutex<Health> = Mutex::new(Health::Sound);

/// Writes to standard output. Control characters from files and names are shown, not obeyed by the terminal.
pub(crate) fn print(text: &str) {
    printed(|| {
        let mut out = std::io::stdout().lock();
        out.write_all(shown(text).as_bytes()).and_then(|()| out.flush())
    });
}

/// Takes note of what became of a text that `write` puts on standard output by means of its own.
pub(crate) fn printed(write: impl FnOnce() -> std::io::Result<()>) {
    if let Some(error) = attempt(&OUTPUT, write) {
        complain(&format!("goalbench: cannot write to standard output: {error}"));
    }
}

/// Writes a line to standard error, as [`print`] does.
pub(crate) fn complain(text: &str) {
    // In one piece: several threads and processes write here.
    let line = format!("{}\n", shown(text));
    // If this fails there is nobody left to tell but whoever reads the exit code.
    let _ = attempt(&COMPLAINTS, || std::io::stderr().write_all(line.as_bytes()));
}

/// Writes unless the stream is closed or broken already: what follows a gap would be misread. Gives the error
/// that broke it.
fn attempt(stream: &Mutex<Health>, write: impl FnOnce() -> std::io::Result<()>) -> Option<std::io::Error> {
    let mut health = stream.lock().expect("no holder of this lock panics");
    if *health != Health::Sound {
        return None;
    }
    let error = write().err()?;
    *health = if error.kind() == ErrorKind::BrokenPipe { Health::Closed } else { Health::Broken };
    (*health == Health::Broken).then_some(error)
}

/// Ends the program whose work ended with `code`. Nothing is cleaned up: what libtorch and MuJoCo would do at
/// the end of a process takes a quarter of a short command's time, and everything that was written is
/// flushed.
pub(crate) fn end(code: ExitCode) -> ! {
    signal_hook::low_level::exit(i32::from(verdict(code) as u8))
}

/// The exit code of the program whose work ended with `code`: a success that could not be told is a failure.
fn verdict(code: ExitCode) -> ExitCode {
    let broken = [&OUTPUT, &COMPLAINTS]
        .iter()
        .any(|stream| *stream.lock().expect("no holder of this lock panics") == Health::Broken);
    if broken && code == ExitCode::Success { ExitCode::Failed } else { code }
}

/// Narrowest terminal that bars are drawn on.
pub(crate) const FEWEST_COLUMNS: usize = 20;

/// Whether standard error is a terminal whose user takes more than plain text: colours, lines drawn anew.
pub(crate) fn takes_sequences() -> bool {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_plain = std::env::var_os("TERM").is_none_or(|kind| kind.is_empty() || kind == "dumb");
    !is_plain && !is_set("NO_COLOR") && std::io::stderr().is_terminal()
}

/// Width of the terminal that standard error is; `None` where only plain lines can be shown: it is none, it
/// does not say how wide it is or is too narrow, or its user asks for plain text by `TERM=dumb` or
/// `NO_COLOR`.
pub(crate) fn columns() -> Option<usize> {
    if !takes_sequences() {
        return None;
    }
    let (_, columns) = ::console::Term::stderr().size_checked()?;
    Some(usize::from(columns)).filter(|columns| *columns >= FEWEST_COLUMNS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_in_commands_are_what_a_shell_makes_of_them() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        use std::process::Command;

        let odd: [&[u8]; 14] = [
            b"plain/x-1.2",
            b"$(id)",
            b"spa ce",
            b"new\nline",
            b"it's",
            b"~",
            b"~root",
            b"#x",
            b"a\x1b[31mb",
            b"\"",
            b"`x`",
            b"res\xffults",
            b"*",
            "é\u{202e}手".as_bytes(),
        ];
        for bytes in odd {
            let word = word(Path::new(OsStr::from_bytes(bytes)));
            assert!(!word.chars().any(char::is_control), "{word:?}");
            let script = format!("printf %s {word}");
            let told = Command::new("bash").args(["-c", &script]).env("LC_ALL", "C.UTF-8").output().unwrap();
            assert_eq!(told.stdout, bytes, "{word}");
        }
        assert_eq!([word(Path::new("a/b")), word(Path::new("-x"))], ["a/b", "./-x"]);
    }

    #[test]
    fn a_reader_that_went_away_is_no_error_and_a_full_disk_is_one() {
        let fails = |kind: ErrorKind| move || Err(std::io::Error::from(kind));
        let stream = Mutex::new(Health::Sound);
        assert!(attempt(&stream, || Ok(())).is_none());
        assert!(attempt(&stream, fails(ErrorKind::StorageFull)).is_some());
        assert!(attempt(&stream, fails(ErrorKind::StorageFull)).is_none(), "it is told once");
        assert!(*stream.lock().unwrap() == Health::Broken);

        let pipe = Mutex::new(Health::Sound);
        assert!(attempt(&pipe, fails(ErrorKind::BrokenPipe)).is_none());
        assert!(attempt(&pipe, fails(ErrorKind::StorageFull)).is_none(), "nothing more is written to it");
        assert!(*pipe.lock().unwrap() == Health::Closed);
    }
}
