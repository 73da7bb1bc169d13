//! How far a sweep is: what bars and lines both show.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use reports::schema::RunKey;
use reports::store::RunFolder;

use crate::pace;
use crate::sweep::event::Event;
use crate::sweep::job::{Ending, Job};

/// All runs of a sweep.
pub(super) struct Tally {
    /// Number of runs.
    pub(super) runs: usize,
    /// Runs that have ended, now or before: neither those that were stopped nor those that crashed.
    pub(super) ended: usize,
    current: BTreeMap<RunKey, Running>,
    /// Steps of all runs that were open when the sweep began.
    total: u64,
    /// Steps that this sweep took in runs that no worker is on any more.
    taken: u64,
    /// Steps that checkpoints brought along, or that stopped runs leave to another sweep.
    not_here: u64,
    begun: Instant,
}

/// A run with a worker.
pub(super) struct Running {
    begun: Instant,
    /// When the worker first told its step, and that step: 0, or its checkpoint's.
    first: Option<(Instant, u64)>,
    /// Training steps so far.
    pub(super) step: u64,
    /// Success rate of the last evaluation in this sweep.
    pub(super) success: Option<f64>,
    recorded: Option<f64>,
}

impl Running {
    /// Steps taken since the worker began.
    fn taken(&self) -> u64 {
        self.step - self.first.map_or(self.step, |(_, step)| step.min(self.step))
    }

    /// Training steps per second as recorded; before the first steps are, as seen from here.
    pub(super) fn steps_per_s(&self) -> Option<f64> {
        let seen = |(at, _): (Instant, u64)| pace::steps_per_s(self.taken(), at.elapsed().as_secs_f64());
        self.recorded.or_else(|| self.first.and_then(seen))
    }

    /// How long the rest of `steps` takes at that speed.
    pub(super) fn left(&self, steps: u64) -> Option<Duration> {
        self.steps_per_s().map(|speed| pace::seconds(steps.saturating_sub(self.step) as f64 / speed))
    }

    /// Time since the worker was started.
    pub(super) fn elapsed(&self) -> Duration {
        self.begun.elapsed()
    }
}

impl Tally {
    pub(super) fn new(jobs: &[Job]) -> Self {
        Self {
            runs: jobs.len(),
            ended: 0,
            current: BTreeMap::new(),
            total: jobs.iter().filter(|job| job.is_open()).map(Job::steps).fold(0, u64::saturating_add),
            taken: 0,
            not_here: 0,
            begun: Instant::now(),
        }
    }

    pub(super) fn started(&mut self, job: &Job) {
        let running = Running { begun: Instant::now(), first: None, step: 0, success: None, recorded: None };
        self.current.insert(job.run().clone(), running);
    }

    /// Takes in what a worker told; gives its run as it is then.
    pub(super) fn heard(&mut self, job: &Job, event: &Event) -> Option<&Running> {
        let running = self.current.get_mut(job.run())?;
        let (Event::Step { step } | Event::Evaluated { step, .. }) = event else { return None };
        running.step = *step;
        if running.first.is_none() {
            running.first = Some((Instant::now(), *step));
            self.not_here = self.not_here.saturating_add(*step);
        }
        if let Event::Evaluated { success_rate, .. } = event {
            running.success = Some(*success_rate);
            running.recorded = pace::recorded(&RunFolder::new(&job.folder));
        }
        Some(running)
    }

    /// Takes in how a run ended; gives it as it last was, if it had a worker.
    pub(super) fn ended(&mut self, job: &Job, ending: &Ending) -> Option<Running> {
        let last = self.current.remove(job.run());
        if let Some(running) = &last {
            self.taken = self.taken.saturating_add(running.taken());
        }
        match ending {
            Ending::Ended(_) => self.ended += 1,
            Ending::Stopped | Ending::Taken | Ending::Crashed { .. } => {
                let step = last.as_ref().map_or(0, |running| running.step);
                self.not_here = self.not_here.saturating_add(job.steps().saturating_sub(step));
            }
        }
        last
    }

    /// Steps that this sweep took, and those that it has to take.
    fn steps(&self) -> (u64, u64) {
        let running = self.current.values().map(Running::taken).fold(0, u64::saturating_add);
        (self.taken.saturating_add(running), self.total.saturating_sub(self.not_here))
    }

    /// The share of its steps that this sweep has taken, in [0, 1].
    pub(super) fn share(&self) -> f64 {
        let (taken, all) = self.steps();
        (taken as f64 / all.max(1) as f64).min(1.0)
    }

    /// Training steps per second of all runs in progress together.
    pub(super) fn steps_per_s(&self) -> Option<f64> {
        self.current.values().filter_map(Running::steps_per_s).reduce(|a, b| a + b)
    }

    /// How long the sweep still takes if it goes on as it has.
    pub(super) fn left(&self) -> Option<Duration> {
        let (taken, all) = self.steps();
        pace::time_left(taken, all, self.begun.elapsed())
    }

    /// `2/16 runs`: how many have ended.
    pub(super) fn of_runs(&self) -> String {
        format!("{}/{}", self.ended, reports::wording::counted(self.runs, "run"))
    }
}
