//! A process that was started to be killed.

use std::{
    fs,
    path::Path,
    process::{Child, ExitStatus},
    thread,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process};

use crate::error::{Error, Result};

/// Nothing that is started here takes longer, unless it hangs.
const PATIENCE: Duration = Duration::from_secs(600);

/// A running goalbench. Dropped, it ends with its workers.
pub(crate) struct Victim {
    child: Child,
}

impl Victim {
    pub(crate) fn new(child: Child) -> Self {
        Self { child }
    }

    /// How it ended, if it has.
    pub(crate) fn ended(&mut self) -> Result<Option<ExitStatus>> {
        self.child.try_wait().map_err(|source| Error::Start { command: "goalbench".to_owned(), source })
    }

    /// Waits for its end; `None` if that does not come.
    pub(crate) fn end(&mut self) -> Result<Option<ExitStatus>> {
        let begun = Instant::now();
        loop {
            match self.ended()? {
                None if begun.elapsed() < PATIENCE => thread::sleep(Duration::from_millis(5)),
                ended => return Ok(ended),
            }
        }
    }

    fn pid(&self) -> Option<Pid> {
        i32::try_from(self.child.id()).ok().and_then(Pid::from_raw)
    }

    /// Its worker processes.
    pub(crate) fn workers(&self) -> Vec<Pid> {
        let own = processes().into_iter().filter(|process| parent(*process) == Some(self.child.id()));
        own.filter_map(Pid::from_raw).collect()
    }

    /// Sends it `signal`.
    pub(crate) fn signal(&self, signal: Signal) {
        if let Some(pid) = self.pid() {
            tell(pid, signal);
        }
    }
}

impl Drop for Victim {
    fn drop(&mut self) {
        let workers = self.workers();
        // One that has ended and was waited for is not signalled: its id may be another's by now.
        if let Ok(None) = self.child.try_wait() {
            self.signal(Signal::KILL);
            workers.into_iter().for_each(|worker| tell(worker, Signal::KILL));
            let _ = self.child.wait();
        }
    }
}

/// Signals a process; one that has gone needs no signal.
pub(crate) fn tell(process: Pid, signal: Signal) {
    let _ = kill_process(process, signal);
}

/// Waits until no process is left that was started to work in `folder`; false if one stays.
pub(crate) fn is_left_alone(folder: &Path) -> bool {
    let name = folder.as_os_str().as_encoded_bytes();
    let works = |process: &i32| {
        let words = fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
        words.windows(name.len()).any(|part| part == name)
    };
    let begun = Instant::now();
    while processes().iter().any(works) {
        if begun.elapsed() > PATIENCE {
            return false;
        }
        thread::sleep(Duration::from_millis(2));
    }
    true
}

/// All processes that can be seen.
fn processes() -> Vec<i32> {
    let entries = fs::read_dir("/proc").into_iter().flatten();
    entries.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok()).collect()
}

/// The parent of a process. In `/proc/N/stat` it is the second field after the name, which stands in brackets
/// and may itself hold any character.
fn parent(process: i32) -> Option<u32> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    stat.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use std::{process::Command, time::Duration, time::Instant};

    use super::{Victim, is_left_alone, parent};

    #[test]
    fn workers_are_found_and_end_with_their_victim() {
        let folder = tempfile::tempdir().unwrap();
        let mut shell = Command::new("sh");
        shell.args(["-c", "sh -c 'sleep 60; true' \"$0\" & wait"]).arg(folder.path());
        let victim = Victim::new(shell.spawn().unwrap());
        let begun = Instant::now();
        while victim.workers().is_empty() {
            assert!(begun.elapsed() < Duration::from_secs(10));
        }
        let own = i32::try_from(std::process::id()).unwrap();
        assert_eq!(parent(own), Some(std::os::unix::process::parent_id()));
        drop(victim);
        assert!(is_left_alone(folder.path()));
    }
}
