//! Numbers that sum up one run.

use crate::schema::Record;
use crate::stats;

/// The running score after every evaluation: the mean success rate of the last `window` evaluations up to and
/// including it, or of all there are while they are fewer. Shape: one number in [0, 1] per record.
///
/// Averaging evens out the noise of evaluations of a few episodes each. Scores are rounded to 12 digits, so
/// that equal shares of successes are equal numbers and count as ties.
pub fn running_scores(records: &[Record], window: usize) -> Vec<f64> {
    let score = |end: usize| {
        let recent = &records[(end + 1).saturating_sub(window.max(1))..=end];
        let mean = recent.iter().map(|record| record.success_rate).sum::<f64>() / recent.len() as f64;
        (mean * 1e12).round() / 1e12
    };
    (0..records.len()).map(score).collect()
}

/// The running score after the last evaluation; `None` without evaluations.
pub fn final_score(records: &[Record], window: usize) -> Option<f64> {
    running_scores(records, window).last().copied()
}

/// The same as [`final_score`] of success at any step of an episode; `None` where one of these evaluations
/// has no record of it.
pub fn final_any_score(records: &[Record], window: usize) -> Option<f64> {
    let recent = &records[records.len().saturating_sub(window.max(1))..];
    let rates: Option<Vec<f64>> = recent.iter().map(|record| record.any_success_rate).collect();
    stats::mean(&rates?).map(|mean| (mean * 1e12).round() / 1e12)
}

/// (successes, episodes) of the last `window` evaluations together: what [`final_score`] rests on.
pub fn final_counts(records: &[Record], window: usize) -> (u64, u64) {
    let recent = &records[records.len().saturating_sub(window.max(1))..];
    let successes = |record: &Record| (record.success_rate * record.episodes as f64).round() as u64;
    (recent.iter().map(successes).sum(), recent.iter().map(|record| record.episodes).sum())
}

/// The first step at which the running score of `window` evaluations is at least `threshold`; `None` if it
/// never is (censored). The scores of fewer evaluations at the start do not count: a single lucky one would
/// do.
pub fn steps_to(records: &[Record], threshold: f64, window: usize) -> Option<u64> {
    let scores = running_scores(records, window);
    let full = records.iter().zip(scores).skip(window.saturating_sub(1));
    full.into_iter().find(|(_, score)| *score >= threshold).map(|(record, _)| record.step)
}

/// [`area`] under the success rate of an evaluation over its training steps. `None` for fewer than two
/// evaluations.
pub fn area_under_curve(records: &[Record]) -> Option<f64> {
    area(records.iter().map(|record| (record.step, record.success_rate)))
}

/// Area under the `(step, rate)` points of a curve by the trapezoid rule, divided by the steps it spans: a
/// mean success rate in [0, 1]. `None` where it spans no step.
///
/// ```
/// // (10 * 0.25 + 30 * 0.75) / 40
/// assert_eq!(reports::analysis::scores::area([(0, 0.0), (10, 0.5), (40, 1.0)]), Some(0.625));
/// ```
pub fn area(points: impl IntoIterator<Item = (u64, f64)>) -> Option<f64> {
    let mut points = points.into_iter();
    let first = points.next()?;
    let (mut last, mut sum) = (first, 0.0);
    for point in points {
        sum += (point.0 - last.0) as f64 * (last.1 + point.1) / 2.0;
        last = point;
    }
    let span = last.0 - first.0;
    (span > 0).then(|| sum / span as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn records(points: &[(u64, f64)]) -> Vec<Record> {
        let record = |(index, &(step, success_rate)): (usize, &(u64, f64))| Record {
            environment: "E".into(),
            curriculum: "c".into(),
            variant: "default".into(),
            seed: 0,
            step,
            eval_index: index as u64,
            episodes: 20,
            success_rate,
            any_success_rate: None,
            mean_return: -1.0,
            gradient_steps: 0,
            teacher: serde_json::Map::new(),
        };
        points.iter().enumerate().map(record).collect()
    }

    #[test]
    fn scores_by_hand() {
        let records = records(&[(0, 0.0), (10, 0.5), (20, 1.0), (30, 0.75)]);
        assert_eq!(running_scores(&records, 2), [0.0, 0.25, 0.75, 0.875]);
        assert_eq!(final_score(&records, 2), Some(0.875));
        assert_eq!(final_score(&records, 100), Some(0.5625));
        assert_eq!(final_score(&[], 2), None);
        // 20 episodes each: 20 + 15 successes.
        assert_eq!(final_counts(&records, 2), (35, 40));
        assert_eq!(final_counts(&records, 100), (45, 80));
        assert_eq!(final_counts(&[], 2), (0, 0));
    }

    #[test]
    fn success_at_any_step_by_hand() {
        let mut records = records(&[(0, 0.0), (10, 0.5), (20, 1.0)]);
        assert_eq!(final_any_score(&records, 2), None, "older than the field");
        for (record, rate) in records.iter_mut().skip(1).zip([0.75, 1.0]) {
            record.any_success_rate = Some(rate);
        }
        assert_eq!(final_any_score(&records, 2), Some(0.875));
        assert_eq!(final_any_score(&records, 3), None, "the first of three has no record of it");
        assert_eq!(final_any_score(&[], 2), None);
    }

    #[test]
    fn equal_shares_give_equal_scores() {
        // The floating-point sums differ in their last bit.
        let (a, b) = (records(&[(0, 0.1), (1, 0.2), (2, 0.3)]), records(&[(0, 0.3), (1, 0.2), (2, 0.1)]));
        assert_ne!(0.1 + 0.2 + 0.3, 0.3 + 0.2 + 0.1);
        assert_eq!(final_score(&a, 3), final_score(&b, 3));
    }

    #[test]
    fn first_step_above_a_threshold_by_hand() {
        let records = records(&[(0, 0.0), (10, 0.5), (20, 1.0), (30, 0.75)]);
        assert_eq!(steps_to(&records, 0.5, 1), Some(10));
        assert_eq!(steps_to(&records, 0.5, 2), Some(20));
        assert_eq!(steps_to(&records, 0.9, 2), None);
    }

    #[test]
    fn a_partial_window_reaches_nothing() {
        let records = records(&[(0, 1.0), (10, 0.0), (20, 0.5), (30, 0.5)]);
        // The first evaluation alone has 1, the first two have 0.5; the first three 0.5 in the mean.
        assert_eq!(steps_to(&records, 0.5, 1), Some(0));
        assert_eq!(steps_to(&records, 0.5, 2), Some(10));
        assert_eq!(steps_to(&records, 0.5, 3), Some(20));
        assert_eq!(steps_to(&records, 0.5, 5), None);
    }

    #[test]
    fn area_by_hand() {
        // Uneven steps: (10 * 0.25 + 30 * 0.75) / 40.
        assert_eq!(area_under_curve(&records(&[(0, 0.0), (10, 0.5), (40, 1.0)])), Some(0.625));
        assert_eq!(area_under_curve(&records(&[(0, 0.5)])), None);
    }
}
