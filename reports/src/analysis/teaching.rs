//! What teachers picked: the numbers of their records that say how they choose, per environment, curriculum
//! and variant.

use std::collections::BTreeMap;

pub use names::PICKED_GOALS;

use crate::analysis::group::{Group, GroupKey};
use crate::schema::Record;
use crate::stats;

/// The numbers in records that say how a teacher chooses.
pub static NUMBERS: [&str; 5] = [
    PICKED_GOALS,
    names::EFFECTIVE_PICKS,
    names::EFFECTIVE_GOALS,
    names::PICK_RANK_MEAN,
    names::SCORE_SUCCESS_CORRELATION,
];

/// What the table says about one group.
#[derive(Clone, Debug, PartialEq)]
pub struct PickSummary {
    /// Which group.
    pub key: GroupKey,
    /// Seeds that the numbers are of ([`Group::settled`]).
    pub n_seeds: usize,
    /// [`mean_over_training`] of each of [`NUMBERS`], then the mean over the seeds that have one; no entry
    /// where none has.
    means: BTreeMap<&'static str, f64>,
}

impl PickSummary {
    /// The numbers of a group.
    pub fn of(group: &Group<'_>) -> Self {
        let group = group.settled();
        let mean = |name: &'static str| {
            let by_seed: Vec<f64> =
                group.runs.iter().filter_map(|run| mean_over_training(&run.records, name)).collect();
            Some((name, stats::mean(&by_seed)?))
        };
        let means = NUMBERS.into_iter().filter_map(mean).collect();
        Self { key: group.key.clone(), n_seeds: group.runs.len(), means }
    }

    /// The number `name` of [`NUMBERS`]; `None` where no seed has it.
    pub fn mean(&self, name: &str) -> Option<f64> {
        self.means.get(name).copied()
    }

    /// Whether there is anything to say.
    pub fn tells(&self) -> bool {
        !self.means.is_empty()
    }
}

/// The mean of the teacher's number `name` over the evaluations after evaluation 0, before which there was no
/// training, as far as it is defined; `None` if it never is.
pub fn mean_over_training(records: &[Record], name: &str) -> Option<f64> {
    let trained = records.iter().filter(|record| record.eval_index > 0);
    let numbers: Vec<f64> = trained.filter_map(|record| record.teacher.get(name)?.as_f64()).collect();
    stats::mean(&numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::record;
    use serde_json::{Map, Value, json};

    #[test]
    fn means_by_hand() {
        let told = |(eval_index, value): (u64, Value)| Record {
            eval_index,
            teacher: Map::from_iter([("picked_goals".to_owned(), value)]),
            ..record()
        };
        let values = [json!(900), json!(10), json!(null), json!(14.5), json!(11.5)];
        let records: Vec<Record> = (0..).zip(values).map(told).collect();
        // Without the untrained student's, and without the one that is not defined: (10 + 14.5 + 11.5) / 3.
        assert_eq!(mean_over_training(&records, "picked_goals"), Some(12.0));
        assert_eq!(mean_over_training(&records, "effective_picks"), None);
        assert_eq!(mean_over_training(&records[..1], "picked_goals"), None);
    }
}
