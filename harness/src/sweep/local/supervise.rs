//! Following one run through its worker processes: events, crashes, attempts.

use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};

use reports::store::{RunFolder, layout};
use reports::wording::counted_u64;

use super::complaints::{self, Listener};
use super::conduct::Conduct;
use crate::error::chain;
use crate::run::folder::State;
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};
use crate::sweep::reporter::Reporter;
use crate::sweep::signals::Stopper;

/// What all jobs share.
pub(super) struct Supervisor<'a> {
    /// What workers are started from.
    pub(super) program: &'static str,
    pub(super) conduct: Conduct,
    pub(super) stopper: &'a Stopper,
    pub(super) reporter: &'a dyn Reporter,
}

/// How one worker process ended.
enum Attempt {
    Over(Ending),
    /// Trying again would not help.
    Refused(String),
    /// The system started no worker, and would start none a moment later.
    NotStarted(String),
    /// It may go better another time.
    Crash(String),
}

impl Attempt {
    /// What a worker's last word says of its attempt; `None` if it is not a last word.
    fn of(event: &Event) -> Option<Self> {
        match event {
            Event::Ended { outcome } => Some(Self::Over(Ending::Ended(outcome.clone()))),
            Event::Stopped { .. } => Some(Self::Over(Ending::Stopped)),
            Event::Taken => Some(Self::Over(Ending::Taken)),
            Event::Refused { reason } => Some(Self::Refused(reason.clone())),
            Event::Broken { reason } => Some(Self::Crash(reason.clone())),
            Event::Step { .. } | Event::Evaluated { .. } => None,
        }
    }
}

impl Supervisor<'_> {
    /// Starts workers for `job` until it ends, is stopped, or has crashed too often.
    pub(super) fn see_through(&self, job: &Job) -> Ending {
        if let State::Ended(outcome) = &job.state {
            let ending = Ending::Ended(outcome.clone());
            self.reporter.ended(job, &ending);
            return ending;
        }
        if self.stopper.is_stopping() {
            return Ending::Stopped;
        }
        self.reporter.started(job);
        let ending = self.attempts(job);
        self.reporter.ended(job, &ending);
        ending
    }

    fn attempts(&self, job: &Job) -> Ending {
        let mut attempt = 0;
        loop {
            match self.attempt(job) {
                Attempt::Over(ending) => return ending,
                // The run is as it was.
                Attempt::NotStarted(reason) => return Ending::Crashed { reason },
                Attempt::Refused(reason) => {
                    self.note_crash(job, attempt, &reason);
                    return Ending::Crashed { reason };
                }
                Attempt::Crash(_) if self.stopper.is_stopping() => return Ending::Stopped,
                Attempt::Crash(reason) => {
                    self.note_crash(job, attempt, &reason);
                    if attempt == self.conduct.retries {
                        return Ending::Crashed { reason };
                    }
                    let left = counted_u64((self.conduct.retries - attempt).into(), "attempt");
                    // The worker names what cannot be looked at.
                    let next = match RunFolder::new(&job.folder).has(layout::CHECKPOINT) {
                        Ok(false) => "beginning anew",
                        Ok(true) | Err(_) => "going on from its checkpoint",
                    };
                    self.reporter.note(&format!("{}: {reason}; {next} ({left} left)", job.run()));
                    attempt += 1;
                }
            }
        }
    }

    fn attempt(&self, job: &Job) -> Attempt {
        let mut command = Command::new(self.program);
        // A process group of its own: Ctrl-C reaches this process alone, which then tells the workers.
        command.arg0("goalbench").arg("worker").process_group(0);
        for (flag, given) in
            [("--tensorboard", self.conduct.tensorboard), ("--discard-replay", self.conduct.discard_replay)]
        {
            if given {
                command.arg(flag);
            }
        }
        command.arg("--").arg(&job.folder);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        match command.spawn() {
            Ok(child) => self.follow(child, job),
            Err(error) => Attempt::NotStarted(format!("cannot start a worker ({}): {error}", self.program)),
        }
    }

    fn follow(&self, mut child: Child, job: &Job) -> Attempt {
        let _registered = self.stopper.register(&child);
        let listener = Listener::new(child.stderr.take().expect("stderr is piped"));
        let mut last = None;
        for line in BufReader::new(child.stdout.take().expect("stdout is piped")).lines() {
            let Ok(line) = line else { break };
            match serde_json::from_str::<Event>(&line) {
                Ok(event) => match Attempt::of(&event) {
                    Some(attempt) => last = Some(attempt),
                    None => self.reporter.event(job, &event),
                },
                Err(_) => self.reporter.note(&format!("{}: {line}", job.run())),
            }
        }
        let status = child.wait();
        let complaints = listener.text();
        if let Err(error) = complaints::keep(&job.folder, &complaints) {
            self.reporter.note(&format!("{}: cannot keep what its worker said: {error}", job.run()));
        }
        match (last, status) {
            (Some(attempt @ (Attempt::Over(_) | Attempt::NotStarted(_))), _) => attempt,
            (Some(Attempt::Refused(reason)), Ok(status)) => Attempt::Refused(format!("{reason} ({status})")),
            (Some(Attempt::Crash(reason)), Ok(status)) => Attempt::Crash(format!("{reason} ({status})")),
            (None, Ok(status)) => Attempt::Crash(complaints::last_words(status, &complaints)),
            (_, Err(error)) => Attempt::Crash(format!("cannot wait for the worker: {error}")),
        }
    }

    /// Appends to the run's `crashes.jsonl`.
    fn note_crash(&self, job: &Job, attempt: u32, reason: &str) {
        if let Err(error) = RunFolder::new(&job.folder).note_crash(attempt, reason) {
            self.reporter.note(&format!("cannot note the crash: {}", chain(&error)));
        }
    }
}
