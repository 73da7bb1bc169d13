//! Scores of many runs on many tasks in few numbers (Agarwal et al. 2021, "Deep RL at the Edge of the
//! Statistical Precipice", section 4).

use super::mean;

/// Performance profile: for every threshold the share of runs whose score is above it, averaged over strata
/// so that each task counts the same. Shape: one share per threshold; `None` without strata or with an empty
/// one.
///
/// ```
/// let profile = reports::stats::performance_profile(&[&[0.25, 0.75], &[1.0]], &[0.5, 0.9]);
/// assert_eq!(profile, Some(vec![0.75, 0.5]));
/// ```
pub fn performance_profile(strata: &[&[f64]], thresholds: &[f64]) -> Option<Vec<f64>> {
    let share = |stratum: &[f64], threshold: f64| {
        let above: Vec<f64> = stratum.iter().map(|score| f64::from(u8::from(*score > threshold))).collect();
        mean(&above)
    };
    let profile = |&threshold: &f64| {
        let shares: Option<Vec<f64>> = strata.iter().map(|stratum| share(stratum, threshold)).collect();
        mean(&shares?)
    };
    thresholds.iter().map(profile).collect()
}

/// Optimality gap: by how much scores fall short of `target` on average, those above it counted as equal to
/// it. 0 is best. `None` for no scores.
///
/// ```
/// assert_eq!(reports::stats::optimality_gap(&[0.5, 1.0], 1.0), Some(0.25));
/// ```
pub fn optimality_gap(scores: &[f64], target: f64) -> Option<f64> {
    let shortfalls: Vec<f64> = scores.iter().map(|score| target - score.min(target)).collect();
    mean(&shortfalls)
}

/// Probability that a random run of `a` scores above a random run of `b` on the same task, ties counting one
/// half, averaged over tasks: the Mann-Whitney statistic over the number of pairs. `a` and `b` hold one
/// stratum per task in the same order; `None` if their numbers differ, there are none, or one is empty.
///
/// ```
/// let p = reports::stats::probability_of_improvement(&[&[0.9, 0.5]], &[&[0.5, 0.1]]);
/// assert_eq!(p, Some(0.875), "three wins and a tie of four");
/// ```
pub fn probability_of_improvement(a: &[&[f64]], b: &[&[f64]]) -> Option<f64> {
    if a.len() != b.len() {
        return None;
    }
    let win = |x: f64, y: f64| match x.total_cmp(&y) {
        _ if x == y => 0.5,
        std::cmp::Ordering::Greater => 1.0,
        _ => 0.0,
    };
    let task = |(a, b): (&&[f64], &&[f64])| {
        let wins: Vec<f64> = a.iter().flat_map(|&x| b.iter().map(move |&y| win(x, y))).collect();
        mean(&wins)
    };
    let tasks: Option<Vec<f64>> = a.iter().zip(b).map(task).collect();
    mean(&tasks?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profile_by_hand() {
        // Above 0.5: two of two and one of three; above 0.9: one of two and none of three.
        let strata: [&[f64]; 2] = [&[0.6, 1.0], &[0.9, 0.5, 0.1]];
        let profile = performance_profile(&strata, &[0.5, 0.9]).unwrap();
        assert!((profile[0] - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(profile[1], 0.25);
        assert_eq!(performance_profile(&[&[]], &[0.5]), None);
    }

    #[test]
    fn optimality_gap_by_hand() {
        assert_eq!(optimality_gap(&[0.5, 1.0, 2.0], 1.0), Some(0.5 / 3.0));
        assert_eq!(optimality_gap(&[], 1.0), None);
    }

    #[test]
    fn probability_of_improvement_by_hand() {
        // Task 1: 3 > 1, 3 > 2, 2 > 1, 2 = 2: 3.5 of 4. Task 2: never.
        let a: [&[f64]; 2] = [&[3.0, 2.0], &[0.0]];
        let b: [&[f64]; 2] = [&[1.0, 2.0], &[1.0]];
        assert_eq!(probability_of_improvement(&a, &b), Some(3.5 / 4.0 / 2.0));
        assert_eq!(probability_of_improvement(&a, &b[..1]), None);
        assert_eq!(probability_of_improvement(&[], &[]), None);
    }
}
