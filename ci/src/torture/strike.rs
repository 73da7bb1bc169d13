//! The ways to strike a sweep.

use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;

use rustix::process::Signal;

use super::{
    moments::Moments,
    victim::{Victim, tell},
};

/// Whom, and with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Strike {
    /// SIGKILL to one worker; the sweep tries that run again.
    Worker,
    /// SIGKILL to all workers.
    Workers,
    /// SIGKILL to the sweep; its workers notice.
    Parent,
    /// SIGKILL to the sweep and all workers, as when memory or power ends.
    Everything,
    /// SIGTERM to the sweep, which saves and stops.
    Terminate,
    /// SIGINT to the sweep and all workers, as from a terminal.
    Interrupt,
    /// SIGKILL to a merge.
    Merge,
}

/// What is done to one sweep before it is begun again, by turns. A run is given up after its third crash, so
/// that no sweep loses more than two workers.
pub(crate) const ROUNDS: [&[Strike]; 7] = [
    &[Strike::Parent],
    &[Strike::Worker, Strike::Parent],
    &[Strike::Everything],
    &[Strike::Terminate],
    &[Strike::Workers, Strike::Everything],
    &[Strike::Interrupt],
    &[Strike::Worker, Strike::Workers, Strike::Terminate],
];

impl Strike {
    /// Whether it is a SIGKILL: other signals ask, and are obeyed in good order.
    pub(crate) fn is_kill(self) -> bool {
        !matches!(self, Self::Terminate | Self::Interrupt)
    }

    /// Whether the sweep goes on after it.
    pub(crate) fn is_survived(self) -> bool {
        matches!(self, Self::Worker | Self::Workers)
    }

    /// Strikes `victim`; false if there is nobody to strike.
    pub(crate) fn carry_out(self, victim: &Victim, moments: &mut Moments) -> bool {
        let mut workers = victim.workers();
        let (parent, all) = match self {
            Self::Worker => {
                workers = Vec::from_iter(moments.one_of(&workers));
                (None, Some(Signal::KILL))
            }
            Self::Workers => (None, Some(Signal::KILL)),
            Self::Parent | Self::Merge => (Some(Signal::KILL), None),
            Self::Everything => (Some(Signal::KILL), Some(Signal::KILL)),
            Self::Terminate => (Some(Signal::TERM), None),
            Self::Interrupt => (Some(Signal::INT), Some(Signal::INT)),
        };
        // The sweep first: alive, it would start workers in place of those killed.
        if let Some(signal) = parent {
            victim.signal(signal);
        }
        if let Some(signal) = all {
            workers.iter().for_each(|worker| tell(*worker, signal));
        }
        parent.is_some() || !workers.is_empty()
    }

    /// Whether a sweep may end so after it.
    pub(crate) fn explains(self, status: ExitStatus) -> bool {
        /// Stopped by a signal, to go on later.
        const STOPPED: i32 = 3;
        let signal = match self {
            Self::Terminate => Signal::TERM,
            Self::Interrupt => Signal::INT,
            _ => Signal::KILL,
        };
        status.success()
            // Before it listens for signals, a program ends by them.
            || status.signal() == Some(signal.as_raw())
            || (!self.is_kill() && status.code() == Some(STOPPED))
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::process::ExitStatusExt;
    use std::process::ExitStatus;

    use super::{ROUNDS, Strike};

    #[test]
    fn only_what_a_strike_does_explains_an_end() {
        let code = |code: i32| ExitStatus::from_raw(code << 8);
        assert!(Strike::Parent.explains(ExitStatus::from_raw(9)) && Strike::Parent.explains(code(0)));
        assert!(!Strike::Parent.explains(code(3)) && !Strike::Parent.explains(ExitStatus::from_raw(11)));
        assert!(Strike::Terminate.explains(code(3)) && !Strike::Terminate.explains(code(1)));
    }

    #[test]
    fn every_round_ends_its_sweep_and_gives_no_run_up() {
        for round in ROUNDS {
            let (last, before) = round.split_last().unwrap();
            assert!(!last.is_survived() && before.iter().all(|strike| strike.is_survived()));
            assert!(before.len() <= 2);
        }
    }
}
