//! The final scores of every group: what tables, aggregates and comparisons are made of.

use crate::analysis::complete;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::scores;

/// The final scores of one group.
#[derive(Clone, Debug, PartialEq)]
pub struct Finals {
    /// Which group.
    pub key: GroupKey,
    /// (seed, [`scores::final_score`]), by rising seed.
    pub by_seed: Vec<(u64, f64)>,
    /// Seeds whose run failed, and counts 0 from its failure on.
    pub failed: Vec<u64>,
}

impl Finals {
    /// The final scores of a group's runs, averaged over their last `window` evaluations.
    pub fn of(group: &Group<'_>, window: usize) -> Self {
        let score =
            |run: &&crate::store::Run| Some((run.key().seed, scores::final_score(&run.records, window)?));
        let failed = group.runs.iter().filter(|run| complete::is_completed(run)).map(|run| run.key().seed);
        Self {
            key: group.key.clone(),
            by_seed: group.runs.iter().filter_map(score).collect(),
            failed: failed.collect(),
        }
    }

    /// The scores alone. Shape: one number in [0, 1] per seed.
    pub fn scores(&self) -> Vec<f64> {
        self.by_seed.iter().map(|(_, score)| *score).collect()
    }
}
