//! What a run's workers say on standard error: kept whole in the run's folder, one line of it told.

use std::fs::{self, File, OpenOptions};
use std::io::{Read, Seek, SeekFrom};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};

use reports::layout;
use reports::record::RunKey;
use rustix::process::Signal;

/// The log of one run's workers, with the place at which one of them begins.
pub(super) struct Complaints {
    path: PathBuf,
    file: File,
    begin: u64,
}

impl Complaints {
    /// Opens the log in the run's folder for another worker.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn open(folder: &Path) -> std::io::Result<Self> {
        let path = folder.join(layout::WORKER_LOG);
        let mut file = OpenOptions::new().create(true).append(true).read(true).open(&path)?;
        let begin = file.seek(SeekFrom::End(0))?;
        Ok(Self { path, file, begin })
    }

    /// The log as a process's standard error.
    ///
    /// # Errors
    /// If the system has no more files to give.
    pub(super) fn stdio(&self) -> std::io::Result<Stdio> {
        Ok(self.file.try_clone()?.into())
    }

    /// What the worker said. A log in which nobody ever said anything is removed.
    pub(super) fn close(mut self) -> String {
        let mut text = Vec::new();
        // What cannot be read is not told; the exit status still speaks of the failure.
        let _ = self.file.seek(SeekFrom::Start(self.begin)).and_then(|_| self.file.read_to_end(&mut text));
        if self.begin == 0 && text.is_empty() {
            let _ = fs::remove_file(&self.path);
        }
        String::from_utf8_lossy(&text).into_owned()
    }
}

/// How a worker of `run` ended: the line in which it said why (its own message, what follows "panicked at", or else its
/// first) and its exit status.
pub(super) fn describe(run: &RunKey, status: ExitStatus, complaints: &str) -> String {
    let mut lines = complaints.lines().map(str::trim).filter(|line| !line.is_empty());
    let own = lines.clone().find(|line| line.starts_with("goalbench: "));
    let panic = lines.clone().skip_while(|line| !line.contains("panicked at")).nth(1);
    match own.or(panic).or_else(|| lines.next()) {
        Some(line) => {
            // Whoever shows it says which program and which run.
            let line = line.strip_prefix("goalbench: ").unwrap_or(line);
            let line = line.strip_prefix(&format!("{run}: ")).unwrap_or(line);
            format!("{line} ({status})")
        }
        None if status.signal() == Some(Signal::KILL.as_raw()) => {
            format!("killed from outside, as the system does when memory runs out ({status})")
        }
        None => format!("the worker ended without a word ({status})"),
    }
}
