//! Measures of every goal of the pool: what the student can really do, beside what its teacher believes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `frontier`: measures of the student's success at every goal of the pool, at some evaluations.
///
/// The episodes are played greedily on instances of their own. They train nobody, no teacher hears of them,
/// and no budget pays for them: with and without them a run trains, and records everything else, in the same
/// way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table with the keys `every` and `episodes`")]
pub struct FrontierOptions {
    /// Evaluations between measures: the untrained student is measured, every so many evaluations after that
    /// one, and the last one of the run. 0 measures nothing.
    ///
    /// Unit: evaluations. Range: at least 0. Source: a choice.
    pub every: u64,
    /// Greedy episodes towards every goal of the pool in a measure.
    ///
    /// Unit: episodes. Range: 1 to 1,000,000. Source: a choice.
    pub episodes: u64,
}

impl Default for FrontierOptions {
    fn default() -> Self {
        Self { every: 0, episodes: 5 }
    }
}

impl FrontierOptions {
    /// Whether anything is measured.
    pub fn is_on(&self) -> bool {
        self.every > 0
    }

    /// Whether the evaluation `eval_index`, which may be the `last` of the run, is one that measures.
    pub fn is_due(&self, eval_index: u64, last: bool) -> bool {
        self.is_on() && (last || eval_index.is_multiple_of(self.every))
    }

    /// Episodes that all measures of a run take, which is evaluated `evaluations` times after the untrained
    /// student, with a pool of `size` goals.
    pub fn all_episodes(&self, evaluations: u64, size: u64) -> u64 {
        if !self.is_on() {
            return 0;
        }
        let measures = 1 + evaluations.div_ceil(self.every);
        measures.saturating_mul(size).saturating_mul(self.episodes)
    }

    /// Whether these are the options of a run that says nothing of them.
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::FrontierOptions;

    #[test]
    fn the_first_every_so_many_and_the_last_are_measured() {
        let due = |every: u64| -> Vec<u64> {
            let options = FrontierOptions { every, episodes: 3 };
            (0..=7).filter(|&index| options.is_due(index, index == 7)).collect()
        };
        assert_eq!(due(0), [0; 0]);
        assert_eq!(due(1), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(due(3), [0, 3, 6, 7]);
        assert_eq!(due(7), [0, 7]);
        assert_eq!(due(100), [0, 7]);
        let episodes = |every| FrontierOptions { every, episodes: 3 }.all_episodes(7, 20);
        assert_eq!([0, 1, 3, 100].map(episodes), [0, 480, 240, 120]);
    }
}
