//! Statistics of a teacher's choices that make sense for every method: recorded at every evaluation beside
//! the teacher's own numbers.

use std::collections::BTreeMap;

use curricula::{Proposal, ProposedGoal, Rank};
use reports::schema::Teaching;
use serde::{Deserialize, Serialize};

/// Sums over the episodes since the last evaluation, of numbers that [`Teaching`] does not hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ranks {
    /// Sum of places relative to their sets, each in [0, 1].
    sum: f64,
    /// Episodes whose goal has a place in a set of at least two.
    count: u64,
}

impl Ranks {
    /// Takes in the rank of one more episode's goal.
    pub fn push(&mut self, rank: Rank) {
        if let Some(relative) = relative_place(rank) {
            self.sum += relative;
            self.count += 1;
        }
    }

    /// Mean place, from 0 (always the first of the set) to 1 (always the last), 1/2 if all are chosen equally
    /// often. NaN without a rank.
    fn mean(self) -> f64 {
        self.sum / self.count as f64
    }
}

/// place / (size − 1), in [0, 1]; nothing in a set of one.
fn relative_place(Rank { place, of }: Rank) -> Option<f64> {
    (of > 1).then(|| place as f64 / (of - 1) as f64)
}

/// A record of no episodes yet.
pub fn no_episodes() -> Teaching {
    Teaching { picks: Some(Vec::new()), ..Teaching::default() }
}

/// Adds the goal that was proposed for an episode to what is recorded.
pub fn note(teaching: &mut Teaching, ranks: &mut Ranks, proposal: &Proposal) {
    let narrow = |index: usize| u32::try_from(index).unwrap_or(u32::MAX);
    let Proposal { ref goal, score, rank } = *proposal;
    let picks = teaching.picks.get_or_insert_default();
    let before = picks.len();
    picks.push(if let ProposedGoal::Pool(index) = *goal { Some(narrow(index)) } else { None });
    // A score that is infinite in single precision has no JSON form.
    let score = score.map(|score| score as f32).filter(|score| score.is_finite());
    push(&mut teaching.scores, before, score);
    push(&mut teaching.ranks, before, rank.map(|rank| narrow(rank.place)));
    if let Some(rank) = rank {
        ranks.push(rank);
    }
}

/// Appends an episode's number to a list that exists only for teachers with such numbers. If there is no list
/// yet, the `before` episodes so far had no such number.
fn push<T: Clone>(list: &mut Option<Vec<Option<T>>>, before: usize, value: Option<T>) {
    if value.is_some() || list.is_some() {
        list.get_or_insert_with(|| vec![None; before]).push(value);
    }
}

/// The numbers for the records: always the same names in the same order, NaN where there is nothing to tell.
pub fn statistics(teaching: &Teaching, ranks: Ranks) -> [(&'static str, f64); 4] {
    let picks: Vec<u32> = teaching.picks.iter().flatten().flatten().copied().collect();
    let [distinct, effective] = spread(&picks);
    let scores = teaching.scores.as_deref().unwrap_or_default();
    let pairs: Vec<(f64, f64)> = scores
        .iter()
        .zip(&teaching.successes)
        .filter_map(|(score, &success)| Some((f64::from((*score)?), f64::from(u8::from(success)))))
        .collect();
    [
        (names::PICKED_GOALS, distinct),
        (names::EFFECTIVE_PICKS, effective),
        (names::PICK_RANK_MEAN, ranks.mean()),
        (names::SCORE_SUCCESS_CORRELATION, correlation(&pairs)),
    ]
}

/// The number of different goals in `picks`, and exp(entropy) of their shares: the number of equally frequent
/// goals that would be as hard to predict. NaN without a pick.
fn spread(picks: &[u32]) -> [f64; 2] {
    if picks.is_empty() {
        return [f64::NAN; 2];
    }
    let mut counts: BTreeMap<u32, u64> = BTreeMap::new();
    picks.iter().for_each(|&pick| *counts.entry(pick).or_default() += 1);
    let share = |count: u64| count as f64 / picks.len() as f64;
    let entropy: f64 = counts.values().map(|&count| -share(count) * share(count).ln()).sum();
    [counts.len() as f64, entropy.exp()]
}

/// Pearson's correlation of the pairs, in [−1, 1]; NaN where one side does not vary.
fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let (x, y) = pairs.iter().fold((0.0, 0.0), |(x, y), pair| (x + pair.0 / n, y + pair.1 / n));
    let moments = pairs.iter().fold([0.0; 3], |[xx, xy, yy], pair| {
        let (dx, dy) = (pair.0 - x, pair.1 - y);
        [xx + dx * dx, xy + dx * dy, yy + dy * dy]
    });
    let [xx, xy, yy] = moments;
    // A side that varies by no more than rounding counts as constant.
    let flat = |sum: f64, mean: f64| sum <= n * (1e-12 * mean).powi(2);
    if pairs.is_empty() || flat(xx, x) || flat(yy, y) { f64::NAN } else { xy / (xx * yy).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_by_hand() {
        // Shares 1/2, 1/4, 1/4: entropy 1.5 ln 2, effective 2^1.5.
        let [distinct, effective] = spread(&[7, 7, 3, 9]);
        assert_eq!(distinct, 3.0);
        assert!((effective - 2f64.powf(1.5)).abs() < 1e-12);
        assert_eq!(spread(&[5, 5]), [1.0, 1.0]);
        assert!(spread(&[]).iter().all(|number| number.is_nan()));
    }

    #[test]
    fn correlation_by_hand() {
        // x 1, 2, 3, 4 against 0, 0, 1, 1: covariance sum 2, variance sums 5 and 1.
        let pairs = [(1.0, 0.0), (2.0, 0.0), (3.0, 1.0), (4.0, 1.0)];
        assert!((correlation(&pairs) - 2.0 / 5f64.sqrt()).abs() < 1e-12);
        assert!((correlation(&[(1.0, 1.0), (2.0, 0.0)]) + 1.0).abs() < 1e-12);
        assert!(correlation(&[(1.0, 1.0), (2.0, 1.0)]).is_nan());
        assert!(correlation(&[(0.1, 1.0), (0.1, 0.0), (0.1, 0.0)]).is_nan());
        assert!(correlation(&[]).is_nan());
    }

    #[test]
    fn lists_are_as_long_as_there_are_episodes_or_absent() {
        let (mut teaching, mut ranks) = (no_episodes(), Ranks::default());
        note(&mut teaching, &mut ranks, &Proposal::native());
        assert_eq!((&teaching.picks, &teaching.scores), (&Some(vec![None]), &None));
        note(&mut teaching, &mut ranks, &Proposal::pool(4).scored(0.5));
        note(&mut teaching, &mut ranks, &Proposal::pool(4).scored(f64::NEG_INFINITY));
        assert_eq!(teaching.picks, Some(vec![None, Some(4), Some(4)]));
        assert_eq!(teaching.scores, Some(vec![None, Some(0.5), None]));
        assert_eq!(teaching.ranks, None);
    }

    #[test]
    fn no_method_may_use_a_name_of_these() {
        let recorded = statistics(&no_episodes(), Ranks::default()).map(|(name, _)| name);
        assert_eq!(recorded, names::OF_PICKS);
    }

    #[test]
    fn places_are_relative_to_their_sets() {
        let mut ranks = Ranks::default();
        assert!(ranks.mean().is_nan());
        // A set of one says nothing; the last of 5 and the second of 3.
        for (place, of) in [(0, 1), (4, 5), (1, 3)] {
            ranks.push(Rank { place, of });
        }
        assert_eq!(ranks.mean(), 0.75);
    }
}
