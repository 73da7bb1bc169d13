//! Numbers that sum up one run.

use crate::schema::Record;
use crate::stats;

/// The last `window` evaluations of a student that has been trained, or all there are while they are fewer.
/// Evaluation 0, of the untrained student, is never among them.
fn last(records: &[Record], window: usize) -> &[Record] {
    let trained = &records[records.partition_point(|record| record.eval_index == 0)..];
    &trained[trained.len().saturating_sub(window.max(1))..]
}

/// Mean of success rates; `None` without one. [Rounded](stats::rounded), so that equal shares of successes
/// count as ties.
fn mean_rate(rates: impl Iterator<Item = f64>) -> Option<f64> {
    stats::mean(&rates.collect::<Vec<_>>()).map(stats::rounded)
}

/// The episodes of an evaluation that ended in success.
pub fn successes(record: &Record) -> u64 {
    (record.success_rate * record.episodes as f64).round() as u64
}

/// The mean success rate of the last `window` evaluations, which evens out the noise of evaluations of a few
/// episodes each; of all there are where they are fewer. Evaluation 0, of the untrained student, does not
/// count; `None` where there is no other.
pub fn final_score(records: &[Record], window: usize) -> Option<f64> {
    mean_rate(last(records, window).iter().map(|record| record.success_rate))
}

/// The same as [`final_score`] of success at any step of an episode; `None` where one of these evaluations
/// has no record of it.
pub fn final_any_score(records: &[Record], window: usize) -> Option<f64> {
    let rates: Option<Vec<f64>> =
        last(records, window).iter().map(|record| record.any_success_rate).collect();
    mean_rate(rates?.into_iter())
}

/// (successes, episodes) of the last `window` evaluations together: what [`final_score`] rests on.
pub fn final_counts(records: &[Record], window: usize) -> (u64, u64) {
    let recent = last(records, window);
    (recent.iter().map(successes).sum(), recent.iter().map(|record| record.episodes).sum())
}

/// The step of the first evaluation with a success rate of at least `threshold`, from which on the mean of
/// `window` evaluations is no lower either: a single lucky evaluation of a few episodes does not count, and
/// none is dated later for the sake of smoothing. `None` if there is none (censored).
pub fn steps_to(records: &[Record], threshold: f64, window: usize) -> Option<u64> {
    let window = window.max(1);
    let reaches = |next: &&[Record]| {
        next[0].success_rate >= threshold
            && mean_rate(next.iter().map(|record| record.success_rate)).is_some_and(|mean| mean >= threshold)
    };
    records.windows(window).find(reaches).map(|next| next[0].step)
}

/// The success rate at `step` training steps, between two evaluations on the line through both; `None` before
/// the first and after the last one.
pub fn rate_at(records: &[Record], step: u64) -> Option<f64> {
    value_at(records.iter().map(|record| (record.step, record.success_rate)), step)
}

/// The value at `step` on the line through `points` of rising steps; `None` before the first and after the
/// last one.
pub fn value_at(points: impl Iterator<Item = (u64, f64)>, step: u64) -> Option<f64> {
    let mut before = None;
    for (at, value) in points {
        if at == step {
            return Some(value);
        }
        if at > step {
            let (from, start): (u64, f64) = before?;
            return Some(start + (value - start) * ((step - from) as f64 / (at - from) as f64));
        }
        before = Some((at, value));
    }
    None
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
    use crate::testing::records;

    #[test]
    fn scores_by_hand() {
        let records = records(&[(0, 0.0), (10, 0.5), (20, 1.0), (30, 0.75)]);
        assert_eq!(final_score(&records, 2), Some(0.875));
        // The untrained student's does not count, however few others there are.
        assert_eq!(final_score(&records, 100), Some(0.75));
        assert_eq!(final_score(&records[..2], 5), Some(0.5));
        assert_eq!(final_score(&records[..1], 5), None);
        assert_eq!(final_score(&[], 2), None);
        // 20 episodes each: 20 + 15 successes.
        assert_eq!(final_counts(&records, 2), (35, 40));
        assert_eq!(final_counts(&records, 100), (45, 60));
        assert_eq!(final_counts(&records[..1], 100), (0, 0));
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
        assert_eq!(final_any_score(&records, 3), Some(0.875), "the untrained student's does not count");
        records[1].any_success_rate = None;
        assert_eq!(final_any_score(&records, 2), None, "one of them has no record of it");
        assert_eq!(final_any_score(&[], 2), None);
    }

    #[test]
    fn equal_shares_give_equal_scores() {
        // The floating-point sums differ in their last bit.
        let (a, b) = (
            records(&[(0, 0.0), (1, 0.1), (2, 0.2), (3, 0.3)]),
            records(&[(0, 0.0), (1, 0.3), (2, 0.2), (3, 0.1)]),
        );
        assert_ne!(0.1 + 0.2 + 0.3, 0.3 + 0.2 + 0.1);
        assert_eq!(final_score(&a, 3), final_score(&b, 3));
    }

    #[test]
    fn first_step_above_a_threshold_by_hand() {
        let records = records(&[(0, 0.0), (10, 0.5), (20, 1.0), (30, 0.75)]);
        assert_eq!(steps_to(&records, 0.5, 1), Some(10));
        // The mean over two evaluations is 0.75 by then; looking back it would be 0.25.
        assert_eq!(steps_to(&records, 0.5, 2), Some(10));
        assert_eq!(steps_to(&records, 0.9, 1), Some(20));
        assert_eq!(steps_to(&records, 0.9, 2), None, "0.875 over two");
    }

    #[test]
    fn a_lucky_evaluation_reaches_nothing() {
        let records = records(&[(0, 1.0), (10, 0.0), (20, 0.5), (30, 0.5)]);
        assert_eq!(steps_to(&records, 0.5, 1), Some(0));
        assert_eq!(steps_to(&records, 0.6, 2), None);
        // Of two: 1 and 0 have 0.5 in the mean.
        assert_eq!(steps_to(&records, 0.5, 2), Some(0));
        assert_eq!(steps_to(&records[1..], 0.5, 2), Some(20));
        assert_eq!(steps_to(&records[1..], 0.5, 3), None, "too few evaluations follow");
    }

    #[test]
    fn rates_between_evaluations_lie_on_a_line() {
        let records = records(&[(10, 0.25), (20, 0.75), (40, 0.5)]);
        let rates = [9, 10, 15, 20, 30, 40, 41].map(|step| rate_at(&records, step));
        assert_eq!(rates, [None, Some(0.25), Some(0.5), Some(0.75), Some(0.625), Some(0.5), None]);
    }

    #[test]
    fn area_by_hand() {
        // Uneven steps: (10 * 0.25 + 30 * 0.75) / 40.
        assert_eq!(area_under_curve(&records(&[(0, 0.0), (10, 0.5), (40, 1.0)])), Some(0.625));
        assert_eq!(area_under_curve(&records(&[(0, 0.5)])), None);
    }
}
