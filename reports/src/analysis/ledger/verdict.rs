//! The rules by which claims are judged: pure functions of intervals, stated beside every verdict.

/// What the data at hand say about a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The data support it.
    Confirmed,
    /// The data contradict it.
    Refuted,
    /// The data allow both.
    Undecided,
}

impl Verdict {
    /// In lower case.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Refuted => "refuted",
            Self::Undecided => "undecided",
        }
    }
}

/// Differences smaller than this make no difference: success rates, a tenth of the range.
pub const MARGIN: f64 = 0.1;

/// (low, high) of what the test at the corrected level does not refuse; `None` where there are too few seeds for one.
pub(super) type Interval = Option<(f64, f64)>;

/// "A is above B".
pub(super) const ABOVE: &str = "confirmed if the whole interval lies above 0, refuted if it lies below 0";

/// See [`ABOVE`].
pub(super) fn above(interval: Interval) -> Verdict {
    match interval {
        Some((low, _)) if low > 0.0 => Verdict::Confirmed,
        Some((_, high)) if high < 0.0 => Verdict::Refuted,
        _ => Verdict::Undecided,
    }
}

/// "None is any better".
pub(super) const NOT_ABOVE: &str =
    "refuted if the interval lies wholly above 0; otherwise confirmed if it lies below 0.1";

/// See [`NOT_ABOVE`].
pub(super) fn not_above(intervals: &[Interval]) -> Verdict {
    if intervals.iter().any(|interval| interval.is_some_and(|(low, _)| low > 0.0)) {
        Verdict::Refuted
    } else if !intervals.is_empty()
        && intervals.iter().all(|interval| interval.is_some_and(|(_, high)| high < MARGIN))
    {
        Verdict::Confirmed
    } else {
        Verdict::Undecided
    }
}

/// "It makes no difference".
pub(super) const EQUIVALENT: &str =
    "confirmed if every interval lies within ±0.1, refuted if one lies wholly outside";

/// See [`EQUIVALENT`].
pub(super) fn equivalent(intervals: &[Interval]) -> Verdict {
    let outside = |(low, high): (f64, f64)| low >= MARGIN || high <= -MARGIN;
    let within = |(low, high): (f64, f64)| low > -MARGIN && high < MARGIN;
    if intervals.iter().any(|interval| interval.is_some_and(outside)) {
        Verdict::Refuted
    } else if !intervals.is_empty() && intervals.iter().all(|interval| interval.is_some_and(within)) {
        Verdict::Confirmed
    } else {
        Verdict::Undecided
    }
}

/// "At least one is above".
pub(super) const SOME_ABOVE: &str =
    "confirmed if one interval lies wholly above 0, refuted if every interval lies below 0";

/// See [`SOME_ABOVE`].
pub(super) fn some_above(intervals: &[Interval]) -> Verdict {
    let verdicts: Vec<Verdict> = intervals.iter().map(|interval| above(*interval)).collect();
    if verdicts.contains(&Verdict::Confirmed) {
        Verdict::Confirmed
    } else if !verdicts.is_empty() && verdicts.iter().all(|verdict| *verdict == Verdict::Refuted) {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::Verdict::{Confirmed, Refuted, Undecided};
    use super::*;

    const ABOVE_MARGIN: Interval = Some((0.15, 0.3));
    const SMALL_GAIN: Interval = Some((0.01, 0.05));
    const NEAR_ZERO: Interval = Some((-0.05, 0.05));
    const WIDE: Interval = Some((-0.3, 0.3));
    const BELOW: Interval = Some((-0.3, -0.15));

    #[test]
    fn verdicts_on_one_interval() {
        let all = [ABOVE_MARGIN, SMALL_GAIN, NEAR_ZERO, WIDE, BELOW, None];
        assert_eq!(all.map(above), [Confirmed, Confirmed, Undecided, Undecided, Refuted, Undecided]);
        let not_above = all.map(|interval| not_above(&[interval]));
        assert_eq!(not_above, [Refuted, Refuted, Confirmed, Undecided, Confirmed, Undecided]);
    }

    #[test]
    fn verdicts_on_several_intervals() {
        assert_eq!(equivalent(&[NEAR_ZERO, SMALL_GAIN]), Confirmed);
        assert_eq!(equivalent(&[NEAR_ZERO, BELOW]), Refuted);
        assert_eq!(equivalent(&[NEAR_ZERO, WIDE]), Undecided);
        assert_eq!(equivalent(&[NEAR_ZERO, None]), Undecided);
        assert_eq!(equivalent(&[]), Undecided);
        assert_eq!(equivalent(&[ABOVE_MARGIN]), Refuted);
        assert_eq!(equivalent(&[Some((-0.3, 0.05))]), Undecided);
        assert_eq!(equivalent(&[Some((-0.05, 0.3))]), Undecided);
        assert_eq!(not_above(&[NEAR_ZERO, BELOW]), Confirmed);
        assert_eq!(not_above(&[NEAR_ZERO, SMALL_GAIN]), Refuted);
        assert_eq!(not_above(&[NEAR_ZERO, WIDE]), Undecided);
        assert_eq!(not_above(&[NEAR_ZERO, None]), Undecided);
        assert_eq!(not_above(&[]), Undecided);
        assert_eq!(some_above(&[BELOW, SMALL_GAIN]), Confirmed);
        assert_eq!(some_above(&[BELOW, BELOW]), Refuted);
        assert_eq!(some_above(&[BELOW, None]), Undecided);
        assert_eq!(some_above(&[]), Undecided);
    }
}
