//! What was done so far.

use std::{collections::BTreeMap, time::Duration};

use super::strike::Strike;

/// Counts of what hit a living process.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) laps: u32,
    strikes: BTreeMap<Strike, u32>,
}

impl Tally {
    pub(crate) fn count(&mut self, strike: Strike) {
        *self.strikes.entry(strike).or_default() += 1;
    }

    /// Strikes that were SIGKILLs.
    pub(crate) fn kills(&self) -> u32 {
        self.strikes.iter().filter(|(strike, _)| strike.is_kill()).map(|(_, count)| count).sum()
    }

    /// All of it in a line.
    pub(crate) fn line(&self, elapsed: Duration) -> String {
        let of = |strike| self.strikes.get(&strike).copied().unwrap_or_default();
        format!(
            "kills: {} (sweeps {}, workers {}, both {}, merges {}), stops by signal: {}, laps: {}, seconds: {}",
            self.kills(),
            of(Strike::Parent),
            of(Strike::Worker) + of(Strike::Workers),
            of(Strike::Everything),
            of(Strike::Merge),
            of(Strike::Terminate) + of(Strike::Interrupt),
            self.laps,
            elapsed.as_secs()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_kills_count_as_kills() {
        let mut tally = Tally::default();
        for strike in [Strike::Parent, Strike::Worker, Strike::Workers, Strike::Interrupt, Strike::Merge] {
            tally.count(strike);
        }
        assert_eq!(tally.kills(), 4);
        let line = tally.line(Duration::from_millis(1999));
        assert_eq!(
            line,
            "kills: 4 (sweeps 1, workers 2, both 0, merges 1), stops by signal: 1, laps: 0, seconds: 1"
        );
    }
}
