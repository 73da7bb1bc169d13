//! Of the goals of a pool: what share a student ever solved, what share of these it forgot, and how it fares
//! at the hardest.

use crate::analysis::complete;
use crate::analysis::frontier::FrontierFiles;
use crate::analysis::group::{Group, GroupKey};
use crate::schema::Frontier;
use crate::stats;
use crate::store::Run;

/// A goal is solved by a measured success of at least this.
pub const SOLVED: f64 = 0.8;
/// A goal that was solved is forgotten if its last measured success lies below this. That is far enough below
/// [`SOLVED`] that chance in a few episodes seldom looks like forgetting.
pub const FORGOTTEN: f64 = 0.5;

/// What the measures of one run say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Mean over goals of the last measured success.
    pub success: f64,
    /// Share of the goals that were solved in at least one measure.
    pub solved: f64,
    /// Share of these that are forgotten; `None` where none was solved.
    pub forgotten: Option<f64>,
    /// Mean of the last measured success over the worst tenth of the goals ([`stats::cvar`]).
    pub worst_tenth: f64,
    /// The same over the worst quarter.
    pub worst_quarter: f64,
}

impl Coverage {
    /// What `measures`, by rising evaluation, say; `None` of none.
    pub fn of(measures: &[Frontier]) -> Option<Self> {
        let last = measures.last()?.rates();
        let mut solved = vec![false; last.len()];
        for measure in measures {
            for (solved, rate) in solved.iter_mut().zip(measure.rates()) {
                *solved |= rate >= SOLVED;
            }
        }
        let ever = solved.iter().filter(|&&solved| solved).count() as f64;
        let lost = solved.iter().zip(&last).filter(|&(&solved, &rate)| solved && rate < FORGOTTEN).count();
        Some(Self {
            success: stats::mean(&last)?,
            solved: ever / last.len() as f64,
            forgotten: (ever > 0.0).then(|| lost as f64 / ever),
            worst_tenth: stats::cvar(&last, 0.1)?,
            worst_quarter: stats::cvar(&last, 0.25)?,
        })
    }

    /// The same of a run that failed after these `measures` and counts 0 from then on: as if it had been
    /// measured once more, without any success. What it had solved it has forgotten.
    pub fn of_failed(measures: &[Frontier]) -> Self {
        let solved = Self::of(measures).map_or(0.0, |before| before.solved);
        Self {
            success: 0.0,
            solved,
            forgotten: (solved > 0.0).then_some(1.0),
            worst_tenth: 0.0,
            worst_quarter: 0.0,
        }
    }
}

/// What the table says about one group of runs: means over those of them that count.
#[derive(Clone, Debug, PartialEq)]
pub struct CoverageSummary {
    /// Which group.
    pub key: GroupKey,
    /// Its runs that count ([`Group::settled`]) and were measured, or failed before that.
    pub n_seeds: usize,
    /// Means of [`Coverage`]; that of forgotten goals is over the runs that solved some.
    pub mean: Coverage,
}

impl CoverageSummary {
    /// The numbers of a group; `None` if none of its runs was measured.
    pub fn of(group: &Group<'_>, files: &FrontierFiles) -> Option<Self> {
        let group = group.settled();
        if group.runs.iter().all(|run| files.of_run(run).is_empty()) {
            return None;
        }
        let of_run = |run: &&Run| match files.of_run(run) {
            measures if complete::is_completed(run) => Some(Coverage::of_failed(measures)),
            measures => Coverage::of(measures),
        };
        let runs: Vec<Coverage> = group.runs.iter().filter_map(of_run).collect();
        let mean = |of: fn(&Coverage) -> f64| stats::mean(&runs.iter().map(of).collect::<Vec<_>>());
        let forgotten: Vec<f64> = runs.iter().filter_map(|run| run.forgotten).collect();
        let mean = Coverage {
            success: mean(|run| run.success)?,
            solved: mean(|run| run.solved)?,
            forgotten: stats::mean(&forgotten),
            worst_tenth: mean(|run| run.worst_tenth)?,
            worst_quarter: mean(|run| run.worst_quarter)?,
        };
        Some(Self { key: group.key, n_seeds: runs.len(), mean })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_by_hand() {
        let measure = |eval_index, successes: [u64; 5]| Frontier {
            eval_index,
            episodes: 5,
            successes: successes.to_vec(),
            ..Frontier::default()
        };
        // The first goal is kept, the second forgotten, the third only worse than it was, the fourth never
        // solved, the fifth solved at last.
        let measures = [measure(0, [0; 5]), measure(1, [4, 5, 4, 3, 0]), measure(2, [5, 2, 3, 1, 4])];
        let coverage = Coverage::of(&measures).expect("three measures");
        assert_eq!((coverage.solved, coverage.forgotten), (0.8, Some(0.25)));
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
        close(coverage.success, 0.6);
        // Half of the worst goal; the worst one and a quarter of the next: (0.2 + 0.25 · 0.4) / 1.25.
        close(coverage.worst_tenth, 0.2);
        close(coverage.worst_quarter, 0.24);
        let untrained = Coverage::of(&measures[..1]).expect("a measure");
        assert_eq!((untrained.solved, untrained.forgotten), (0.0, None));
        assert_eq!(Coverage::of(&[]), None);
        // What was solved in some measure stays so; a student of no use has forgotten all of it.
        let failed = Coverage::of_failed(&measures);
        assert_eq!((failed.success, failed.solved, failed.forgotten), (0.0, 0.8, Some(1.0)));
        assert_eq!((failed.worst_tenth, failed.worst_quarter), (0.0, 0.0));
        assert_eq!((Coverage::of_failed(&[]).solved, Coverage::of_failed(&[]).forgotten), (0.0, None));
    }
}
