//! What the user sees: a line per step, and on a terminal a line that counts the bytes.

use std::{
    io::{self, IsTerminal, Write},
    time::Duration,
};

/// Prints one line about a step of `task`. Standard error, as cargo's own: standard output is for results.
pub(crate) fn step(task: &str, text: &str) {
    eprintln!("{task}: {text}");
}

/// Shows how far a download is, on one line that is rewritten; prints nothing if standard error is no
/// terminal.
pub(crate) fn progress(done: u64, total: u64) {
    let mut terminal = io::stderr();
    if terminal.is_terminal() {
        // The line is decoration: a terminal that refuses it must not end the download.
        let _ = write!(terminal, "\r\x1b[K  {} of {}", megabytes(done.min(total)), megabytes(total));
        let _ = terminal.flush();
    }
}

/// Removes the line of [`progress`].
pub(crate) fn end_progress() {
    let mut terminal = io::stderr();
    if terminal.is_terminal() {
        let _ = write!(terminal, "\r\x1b[K");
    }
}

/// A size in decimal megabytes, for people.
pub(crate) fn megabytes(bytes: u64) -> String {
    match bytes as f64 / 1e6 {
        small if small < 10.0 => format!("{small:.1} MB"),
        large => format!("{large:.0} MB"),
    }
}

/// A duration in seconds, for people.
pub(crate) fn seconds(duration: Duration) -> String {
    format!("{:.1} s", duration.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_decimal_megabytes() {
        assert_eq!(megabytes(543_563_777), "544 MB");
        assert_eq!(megabytes(6_783_128), "6.8 MB");
    }
}
