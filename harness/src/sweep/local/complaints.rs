//! What a run's workers say on standard error: kept in the run's folder, for people.

use std::io::{Read, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{ChildStderr, ExitStatus};
use std::thread::JoinHandle;

use reports::store::layout;
use rustix::process::Signal;

/// Most bytes that are kept of one worker.
const MOST: u64 = 1 << 20;

/// Reads a worker's standard error on a thread of its own: a worker that says more than a pipe holds would
/// wait for ever.
///
/// It is a pipe and not the log file itself, so that a worker can complain even when the disk is full.
pub(super) struct Listener(JoinHandle<String>);

impl Listener {
    /// Begins to listen.
    pub(super) fn new(mut complaints: ChildStderr) -> Self {
        Self(std::thread::spawn(move || {
            let mut text = Vec::new();
            // If reading fails, the exit status still tells of the failure.
            let _ = (&mut complaints).take(MOST).read_to_end(&mut text);
            let _ = std::io::copy(&mut complaints, &mut std::io::sink());
            String::from_utf8_lossy(&text).into_owned()
        }))
    }

    /// All that the worker said.
    pub(super) fn text(self) -> String {
        self.0.join().unwrap_or_default()
    }
}

/// Appends what a worker said to the log of the run's workers.
///
/// # Errors
/// If it cannot be written.
pub(super) fn keep(folder: &Path, text: &str) -> std::io::Result<()> {
    if text.is_empty() {
        return Ok(());
    }
    let path = folder.join(layout::WORKER_LOG);
    guard::files::append(&path)?.write_all(text.as_bytes())
}

/// How a worker ended that could not send an event: it was killed, or a library aborted the process. What the
/// library printed is then all there is to know, so the first line on standard error is given as the reason.
pub(super) fn last_words(status: ExitStatus, complaints: &str) -> String {
    if status.signal() == Some(Signal::KILL.as_raw()) {
        return format!("killed from outside, as the system does when memory runs out ({status})");
    }
    let line = complaints.lines().map(str::trim).find(|line| !line.is_empty());
    format!("{} ({status})", line.unwrap_or("the worker ended without a word"))
}
