//! Statistics of runs of which those of one stratum count more than those of another.

use crate::stats;

/// [`stats::iqm`] of all runs. `weights` say what a run of each stratum counts: a quarter of the weight is
/// cut off at each end, parts of runs included. Without them all count the same.
pub fn iqm(strata: &[Vec<f64>], weights: Option<&[f64]>) -> Option<f64> {
    let Some(weights) = weights else { return stats::iqm(&strata.concat()) };
    let mut runs: Vec<(f64, f64)> = weighted(strata, weights).collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = runs.iter().map(|(_, weight)| weight).sum();
    let (from, to) = (all / 4.0, all * 3.0 / 4.0);
    let (mut below, mut sum) = (0.0, 0.0);
    for (score, weight) in runs {
        let inside = (below + weight).min(to) - f64::max(below, from);
        sum += score * inside.max(0.0);
        below += weight;
    }
    (all > 0.0).then(|| sum / (to - from))
}

/// [`stats::optimality_gap`] of all runs to `target`, weighted likewise.
pub fn optimality_gap(strata: &[Vec<f64>], weights: Option<&[f64]>, target: f64) -> Option<f64> {
    let Some(weights) = weights else { return stats::optimality_gap(&strata.concat(), target) };
    let all: f64 = weighted(strata, weights).map(|(_, weight)| weight).sum();
    let gap: f64 =
        weighted(strata, weights).map(|(score, weight)| weight * (target - score.min(target))).sum();
    (all > 0.0).then(|| gap / all)
}

/// (score, weight) of all runs.
fn weighted(strata: &[Vec<f64>], weights: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    strata.iter().zip(weights).flat_map(|(scores, &weight)| scores.iter().map(move |&score| (score, weight)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_weights_nothing_changes() {
        let strata = [vec![0.0, 0.25, 0.75], vec![1.0, 0.5]];
        assert_eq!(iqm(&strata, None), stats::iqm(&strata.concat()));
        assert_eq!(optimality_gap(&strata, None, 1.0), Some(0.5));
    }

    #[test]
    fn weights_by_hand() {
        // Weights 2, 2, 1, 1, 1, 1: the middle 4 of 8 are one of those at 0.2, and those at 0.4 and 0.6.
        let strata = [vec![0.2, 0.2], vec![0.8, 0.4, 0.6, 1.0]];
        let close = |found: Option<f64>, expected: f64| (found.unwrap() - expected).abs() < 1e-12;
        assert!(close(iqm(&strata, Some(&[2.0, 1.0])), (2.0 * 0.2 + 0.4 + 0.6) / 4.0));
        assert!(close(optimality_gap(&strata, Some(&[2.0, 1.0]), 1.0), (4.0 * 0.8 + 0.2 + 0.6 + 0.4) / 8.0));
        assert_eq!(iqm(&[], Some(&[])), None);
    }
}
