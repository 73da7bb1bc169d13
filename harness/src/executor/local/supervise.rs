//! Following one run through its worker processes: events, crashes, attempts.

use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};

use reports::store::RunFolder;

use super::Conduct;
use super::complaints::{self, Listener, describe};
use crate::error::chain;
use crate::executor::event::Event;
use crate::executor::signals::Stopper;
use crate::executor::{Ending, Job};
use crate::progress::Display;
use crate::run::folder::State;

/// Exit code with which a worker refuses its input: trying again would not help.
const REFUSED: i32 = crate::cli::WRONG_INPUT as i32;

/// Exit code with which a worker leaves a run to the process that is carrying it out.
const TAKEN: i32 = crate::cli::TAKEN as i32;

/// The program that this process was started from, also when another one has been built in its place since.
const THIS_PROGRAM: &str = "/proc/self/exe";

/// What all jobs share.
pub(super) struct Supervisor<'a> {
    pub(super) conduct: Conduct,
    pub(super) stopper: &'a Stopper,
    pub(super) display: &'a dyn Display,
}

/// How one worker process ended.
enum Attempt {
    Over(Ending),
    /// It may go better another time.
    Crash(String),
}

impl Supervisor<'_> {
    /// Starts workers for `job` until it ends, is stopped, or has crashed too often.
    pub(super) fn see_through(&self, job: &Job) -> Ending {
        if let State::Ended(outcome) = &job.state {
            let ending = Ending::Ended(outcome.clone());
            self.display.ended(job, &ending);
            return ending;
        }
        if self.stopper.is_stopping() {
            return Ending::Stopped;
        }
        self.display.started(job);
        let ending = self.attempts(job);
        self.display.ended(job, &ending);
        ending
    }

    fn attempts(&self, job: &Job) -> Ending {
        let mut attempt = 0;
        loop {
            match self.attempt(job) {
                Attempt::Over(ending) => {
                    if let Ending::Crashed { reason } = &ending {
                        self.note_crash(job, attempt, reason);
                    }
                    return ending;
                }
                Attempt::Crash(_) if self.stopper.is_stopping() => return Ending::Stopped,
                Attempt::Crash(reason) => {
                    self.note_crash(job, attempt, &reason);
                    if attempt == self.conduct.retries {
                        return Ending::Crashed { reason };
                    }
                    let left = self.conduct.retries - attempt;
                    self.display.note(&format!(
                        "{}: {reason}; going on from its checkpoint ({left} attempts left)",
                        job.manifest.run
                    ));
                    attempt += 1;
                }
            }
        }
    }

    fn attempt(&self, job: &Job) -> Attempt {
        let mut command = Command::new(THIS_PROGRAM);
        // A process group of its own: Ctrl-C reaches this process alone, which then tells the workers.
        command.arg0("goalbench").arg("worker").arg(&job.folder).process_group(0);
        if self.conduct.tensorboard {
            command.arg("--tensorboard");
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        match command.spawn() {
            Ok(child) => self.follow(child, job),
            Err(error) => Attempt::Crash(format!("cannot start a worker: {error}")),
        }
    }

    fn follow(&self, mut child: Child, job: &Job) -> Attempt {
        let _registered = self.stopper.register(&child);
        let listener = Listener::new(child.stderr.take().expect("stderr is piped"));
        let mut last = None;
        for line in BufReader::new(child.stdout.take().expect("stdout is piped")).lines() {
            let Ok(line) = line else { break };
            match serde_json::from_str(&line) {
                Ok(Event::Ended { outcome }) => last = Some(Ending::Ended(outcome)),
                Ok(Event::Stopped { .. }) => last = Some(Ending::Stopped),
                Ok(event) => self.display.event(job, &event),
                Err(_) => self.display.note(&format!("{}: {line}", job.manifest.run)),
            }
        }
        let status = child.wait();
        let complaints = listener.text();
        if let Err(error) = complaints::keep(&job.folder, &complaints) {
            self.display.note(&format!("{}: cannot keep what its worker said: {error}", job.manifest.run));
        }
        match (last, status) {
            (Some(ending), _) => Attempt::Over(ending),
            (None, Ok(status)) if status.code() == Some(TAKEN) => Attempt::Over(Ending::Taken),
            (None, Ok(status)) if status.code() == Some(REFUSED) => {
                Attempt::Over(Ending::Crashed { reason: describe(&job.manifest.run, status, &complaints) })
            }
            (None, Ok(status)) => Attempt::Crash(describe(&job.manifest.run, status, &complaints)),
            (None, Err(error)) => Attempt::Crash(format!("cannot wait for the worker: {error}")),
        }
    }

    /// Appends to the run's `crashes.jsonl`.
    fn note_crash(&self, job: &Job, attempt: u32, reason: &str) {
        if let Err(error) = RunFolder::new(&job.folder).note_crash(attempt, reason) {
            self.display.note(&format!("cannot note the crash: {}", chain(&error)));
        }
    }
}
