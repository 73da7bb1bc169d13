//! The rules by which claims are judged: pure functions of intervals, stated beside every verdict.

use super::Effect;
use crate::analysis::catalogue::Rule;

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

/// (low, high) of what the test at the corrected level does not refuse; `None` where there are too few seeds
/// for one.
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

impl Rule {
    /// The rule in words.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::NotAbove => {
                "refuted if the interval lies wholly above 0; otherwise confirmed if it lies below 0.1"
            }
            Self::Equivalent => {
                "confirmed if every interval lies within ±0.1, refuted if one lies wholly outside"
            }
            Self::SomeAbove => {
                "confirmed if one interval lies wholly above 0, refuted if every interval lies below 0"
            }
        }
    }

    /// What the intervals of all values say.
    pub(super) fn judge(self, intervals: &[Interval]) -> Verdict {
        match self {
            Self::NotAbove => not_above(intervals),
            Self::Equivalent => equivalent(intervals),
            Self::SomeAbove => some_above(intervals),
        }
    }

    /// Which of several effects the verdict hangs on: how far each is from where it would not.
    pub(super) fn weight(self, effect: &Effect) -> f64 {
        match self {
            Self::NotAbove => highest(effect),
            Self::Equivalent => farthest(effect),
            Self::SomeAbove => best_supported(effect),
        }
    }
}

/// "None is any better".
fn not_above(intervals: &[Interval]) -> Verdict {
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
fn equivalent(intervals: &[Interval]) -> Verdict {
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
fn some_above(intervals: &[Interval]) -> Verdict {
    let verdicts: Vec<Verdict> = intervals.iter().map(|interval| above(*interval)).collect();
    if verdicts.contains(&Verdict::Confirmed) {
        Verdict::Confirmed
    } else if !verdicts.is_empty() && verdicts.iter().all(|verdict| *verdict == Verdict::Refuted) {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    }
}

/// How well "above" is supported: by the lower end of the interval, without one by the difference, below all
/// that have one.
fn best_supported(effect: &Effect) -> f64 {
    effect
        .interval
        .map_or_else(|| effect.difference.map_or(-8.0, |difference| difference - 4.0), |(low, _)| low)
}

/// How far from "none is above": first those wholly above 0 by how far they are, then the others by the upper
/// end of the interval.
fn highest(effect: &Effect) -> f64 {
    let Some((low, high)) = effect.interval else {
        return effect.difference.map_or(-8.0, |difference| difference - 4.0);
    };
    if low > 0.0 { 4.0 + low } else { high }
}

/// How far from "no difference": first those wholly outside the margin by how far they are, then the others
/// by the end of the interval that is farther from 0.
fn farthest(effect: &Effect) -> f64 {
    let Some((low, high)) = effect.interval else {
        return effect.difference.map_or(-8.0, |difference| difference.abs() - 4.0);
    };
    let outside = low.max(-high);
    if outside >= MARGIN { 4.0 + outside } else { high.max(-low) }
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

    #[test]
    fn what_a_verdict_hangs_on_weighs_most() {
        let effect = |interval| Effect { interval: Some(interval), ..Effect::default() };
        let heaviest = |weight: fn(&Effect) -> f64, intervals: &[(f64, f64)]| {
            let weights: Vec<f64> = intervals.iter().map(|interval| weight(&effect(*interval))).collect();
            (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b]))
        };
        // "None is above" is undecided for the wide one, and refuted by the one above 0.
        assert_eq!(heaviest(highest, &[(-0.02, 0.05), (-0.3, 0.3)]), Some(1));
        assert_eq!(heaviest(highest, &[(0.01, 0.05), (-0.3, 0.3)]), Some(0));
        assert_eq!(heaviest(best_supported, &[(-0.02, 0.05), (-0.3, 0.3)]), Some(0));
        assert_eq!(heaviest(farthest, &[(-0.02, 0.05), (-0.3, 0.2)]), Some(1));
        assert_eq!(heaviest(farthest, &[(0.12, 0.15), (-0.3, 0.2)]), Some(0));
        assert!(highest(&Effect::default()) < highest(&effect((-1.0, -1.0))), "no interval comes last");
    }
}
