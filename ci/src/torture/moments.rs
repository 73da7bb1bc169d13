//! What chance decides: when to strike, and whom. The same seed decides the same.

use std::{
    fs,
    path::Path,
    thread,
    time::{Duration, Instant, SystemTime},
};

use rand::{Rng, SeedableRng, rngs::StdRng, seq::IndexedRandom};

use super::{compare, victim::Victim};
use crate::error::Result;

/// The longest wait for a moment that the clock alone decides, in milliseconds: a program has begun by then,
/// and has saved a few checkpoints.
const LONGEST: u64 = 600;
/// The longest wait for something to be saved.
const PATIENCE: Duration = Duration::from_secs(5);
/// The longest wait after it was saved, in microseconds: while the next files are written.
const AFTER: u64 = 30_000;

/// A source of moments.
pub(crate) struct Moments {
    random: StdRng,
}

impl Moments {
    pub(crate) fn new(seed: u64) -> Self {
        Self { random: StdRng::seed_from_u64(seed) }
    }

    /// A number below `end`.
    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.random.random_range(0..end)
    }

    /// One of `items`.
    pub(crate) fn one_of<T: Copy>(&mut self, items: &[T]) -> Option<T> {
        items.choose(&mut self.random).copied()
    }

    /// Waits until the next moment to strike `victim`, which works in `folder`: any, or, half of the time,
    /// one just after something was saved there. Returns early if the victim ends.
    pub(crate) fn wait(&mut self, victim: &mut Victim, folder: &Path) -> Result<()> {
        let at_random = self.random.random();
        let (longest, after) = if at_random {
            (Duration::from_millis(self.below(LONGEST)), Duration::ZERO)
        } else {
            (PATIENCE, Duration::from_micros(self.below(AFTER)))
        };
        let begun = Instant::now();
        let before = last_change(folder);
        while begun.elapsed() < longest && victim.ended()?.is_none() {
            if !at_random && last_change(folder) != before {
                break;
            }
            thread::sleep(Duration::from_millis(1));
        }
        thread::sleep(after);
        Ok(())
    }
}

/// When something in the folders of runs was last created, replaced or removed.
fn last_change(folder: &Path) -> Option<SystemTime> {
    let runs = compare::run_folders(folder);
    runs.iter().filter_map(|run| fs::metadata(run).and_then(|run| run.modified()).ok()).max()
}
