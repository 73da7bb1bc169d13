//! Following a cohort of runs through its worker processes: events, crashes, attempts.

use std::io::{BufRead, BufReader};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};

use reports::store::{RunFolder, layout};
use reports::wording::counted_u64;

use super::complaints::{self, Listener};
use super::conduct::Conduct;
use crate::error::chain;
use crate::run::folder::State;
use crate::sweep::event::{Event, Told};
use crate::sweep::job::{Ending, Job};
use crate::sweep::reporter::Reporter;
use crate::sweep::signals::Stopper;

/// What all cohorts share.
pub(super) struct Supervisor<'a> {
    /// What workers are started from.
    pub(super) program: &'static str,
    pub(super) conduct: Conduct,
    pub(super) stopper: &'a Stopper,
    pub(super) reporter: &'a dyn Reporter,
}

/// What became of a run in one worker process.
#[derive(Clone)]
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
    /// What a worker's last word on a run says of it; `None` if it is not a last word.
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

/// A run on its way to its ending.
struct Followed<'a> {
    job: &'a Job,
    crashes: u32,
    ending: Option<Ending>,
}

impl Supervisor<'_> {
    /// Starts workers for `cohort` until each of its runs has ended, is stopped, or has crashed too often.
    /// Gives their endings in order.
    pub(super) fn see_through(&self, cohort: &[&Job]) -> Vec<Ending> {
        let mut runs: Vec<Followed<'_>> =
            cohort.iter().map(|job| Followed { job, crashes: 0, ending: None }).collect();
        for run in &mut runs {
            match &run.job.state {
                State::Ended(outcome) => self.end(run, Ending::Ended(outcome.clone())),
                _ if self.stopper.is_stopping() => run.ending = Some(Ending::Stopped),
                _ => self.reporter.started(run.job),
            }
        }
        loop {
            let mut open: Vec<&mut Followed<'_>> =
                runs.iter_mut().filter(|run| run.ending.is_none()).collect();
            if open.is_empty() {
                break;
            }
            self.attempt(&mut open);
        }
        runs.into_iter().map(|run| run.ending.expect("every run has ended")).collect()
    }

    fn end(&self, run: &mut Followed<'_>, ending: Ending) {
        self.reporter.ended(run.job, &ending);
        run.ending = Some(ending);
    }

    /// Lets one worker carry out `runs`, and takes in what became of each.
    fn attempt(&self, runs: &mut [&mut Followed<'_>]) {
        let Conduct { tensorboard, discard_replay, threads, lanes, overlap, .. } = self.conduct;
        let mut command = Command::new(self.program);
        // A process group of its own: Ctrl-C reaches this process alone, which then tells the workers.
        command.arg0("goalbench").arg("worker").process_group(0);
        let flags =
            [("--tensorboard", tensorboard), ("--discard-replay", discard_replay), ("--overlap", overlap)];
        for (flag, given) in flags {
            if given {
                command.arg(flag);
            }
        }
        command.arg("--threads").arg(threads.to_string()).arg("--width").arg(lanes.to_string());
        command.arg("--").args(runs.iter().map(|run| &run.job.folder));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let attempts = match command.spawn() {
            Ok(child) => self.follow(child, runs),
            Err(error) => {
                let reason = format!("cannot start a worker ({}): {error}", self.program);
                vec![Attempt::NotStarted(reason); runs.len()]
            }
        };
        for (run, attempt) in runs.iter_mut().zip(attempts) {
            self.judge(run, attempt);
        }
    }

    /// Takes in what became of a run that has not been told of yet.
    fn judge(&self, run: &mut Followed<'_>, attempt: Attempt) {
        match attempt {
            Attempt::Over(ending) if run.ending.is_none() => self.end(run, ending),
            Attempt::Over(_) => {}
            // The run is as it was.
            Attempt::NotStarted(reason) => self.end(run, Ending::Crashed { reason }),
            Attempt::Refused(reason) => {
                self.note_crash(run, &reason);
                self.end(run, Ending::Crashed { reason });
            }
            Attempt::Crash(_) if self.stopper.is_stopping() => self.end(run, Ending::Stopped),
            Attempt::Crash(reason) => {
                self.note_crash(run, &reason);
                if run.crashes == self.conduct.retries {
                    return self.end(run, Ending::Crashed { reason });
                }
                let left = counted_u64((self.conduct.retries - run.crashes).into(), "attempt");
                // The worker names what cannot be looked at.
                let next = match RunFolder::new(&run.job.folder).has(layout::CHECKPOINT) {
                    Ok(false) => "beginning anew",
                    Ok(true) | Err(_) => "going on from its checkpoint",
                };
                self.reporter.note(&format!("{}: {reason}; {next} ({left} left)", run.job.run()));
                run.crashes += 1;
            }
        }
    }

    /// What the worker `child` says of each of `runs`. Those whose ending it tells end at once.
    fn follow(&self, mut child: Child, runs: &mut [&mut Followed<'_>]) -> Vec<Attempt> {
        let _registered = self.stopper.register(&child);
        let listener = Listener::new(child.stderr.take().expect("stderr is piped"));
        let mut last = vec![None; runs.len()];
        for line in BufReader::new(child.stdout.take().expect("stdout is piped")).lines() {
            let Ok(line) = line else { break };
            match serde_json::from_str::<Told>(&line) {
                Ok(told) => self.hear(&told, runs, &mut last),
                Err(_) => {
                    let names = runs.iter().map(|run| run.job.run().to_string()).collect::<Vec<_>>();
                    self.reporter.note(&format!("{}: {line}", names.join(", ")));
                }
            }
        }
        let status = child.wait();
        let complaints = listener.text();
        for run in &*runs {
            if let Err(error) = complaints::keep(&run.job.folder, &complaints) {
                let run = run.job.run();
                self.reporter.note(&format!("{run}: cannot keep what its worker said: {error}"));
            }
        }
        let attempt = |last: Option<Attempt>| match (last, &status) {
            (Some(attempt @ (Attempt::Over(_) | Attempt::NotStarted(_))), _) => attempt,
            (Some(Attempt::Refused(reason)), Ok(status)) => Attempt::Refused(format!("{reason} ({status})")),
            (Some(Attempt::Crash(reason)), Ok(status)) => Attempt::Crash(format!("{reason} ({status})")),
            (None, Ok(status)) => Attempt::Crash(complaints::last_words(*status, &complaints)),
            (_, Err(error)) => Attempt::Crash(format!("cannot wait for the worker: {error}")),
        };
        last.into_iter().map(attempt).collect()
    }

    /// Takes in an event of a worker that carries out `runs`, of which `last` holds the last words so far.
    fn hear(&self, told: &Told, runs: &mut [&mut Followed<'_>], last: &mut [Option<Attempt>]) {
        let Told { lane, event } = told;
        let lanes = runs.iter_mut().zip(last).enumerate();
        for (_, (run, last)) in lanes.filter(|(index, _)| lane.is_none_or(|lane| lane == *index)) {
            match Attempt::of(event) {
                Some(_) if run.ending.is_some() => {}
                Some(attempt) => {
                    if let Attempt::Over(ending) = &attempt {
                        self.end(run, ending.clone());
                    }
                    *last = Some(attempt);
                }
                None => self.reporter.event(run.job, event),
            }
        }
    }

    /// Appends to the run's `crashes.jsonl`.
    fn note_crash(&self, run: &Followed<'_>, reason: &str) {
        if let Err(error) = RunFolder::new(&run.job.folder).note_crash(run.crashes, reason) {
            self.reporter.note(&format!("cannot note the crash: {}", chain(&error)));
        }
    }
}
