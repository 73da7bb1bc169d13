//! The rules by which claims are judged: pure functions of effects, stated beside every verdict.

use super::effect::{Effect, PlaceEffect, sign, signs};
use crate::analysis::options::ReportOptions;
use crate::stats::{self, Resampling};

/// What the data at hand say about a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The data support it.
    Confirmed,
    /// The data contradict it.
    Refuted,
    /// The data allow both.
    Undecided,
    /// No data of this program could tell.
    Untestable,
}

impl Verdict {
    /// In lower case.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::Refuted => "refuted",
            Self::Undecided => "undecided",
            Self::Untestable => "not testable",
        }
    }
}

/// (low, high) of what the test at the corrected level does not refuse; `None` where there are too few seeds
/// for one.
pub(super) type Interval = Option<(f64, f64)>;

/// Slack for levels such as 1 - 0.9875, which is a rounding error below what it stands for.
const ROUNDING: f64 = 1e-9;

/// What claims are judged with: the options of the report, and the coverage that a claim is due after
/// correction for the claims beside it.
#[derive(Clone, Copy)]
pub(super) struct Bench<'a> {
    pub(super) options: &'a ReportOptions,
    pub(super) resampling: Resampling,
}

/// "A is above B" on average: what means and signs say together.
pub(super) struct OnAverage {
    pub(super) verdict: Verdict,
    /// Where the two disagree: what each says.
    pub(super) disagreement: Option<String>,
}

impl Bench<'_> {
    /// The chance of a false verdict that this claim may take.
    pub(super) fn level(&self) -> f64 {
        1.0 - self.resampling.confidence
    }

    /// The same bench where `count` tests share that chance.
    pub(super) fn shared(self, count: usize) -> Self {
        Self { resampling: super::corrected(self.resampling, count), ..self }
    }

    /// Intervals for "in every environment": where all of several hypotheses have to be refused at once, each
    /// may be tested at the whole level on its one side (Berger 1982), so that the two-sided interval covers
    /// 1 - 2α (the two one-sided tests of Schuirmann 1987).
    pub(super) fn one_sided(&self) -> Resampling {
        Resampling { confidence: (1.0 - 2.0 * self.level()).max(0.0), ..self.resampling }
    }

    /// "The first side is above the second" on average over environments: confirmed or refuted where the
    /// means of the pairs and their signs say so, each by its own exact test. `effect` has the interval of
    /// this bench.
    pub(super) fn above(&self, effect: &Effect) -> OnAverage {
        if effect.is_small(self.options) {
            return OnAverage { verdict: Verdict::Undecided, disagreement: None };
        }
        let means = match effect.interval {
            Some((low, _)) if low > 0.0 => Verdict::Confirmed,
            Some((_, high)) if high < 0.0 => Verdict::Refuted,
            _ => Verdict::Undecided,
        };
        let (share, p) = (effect.improvement.unwrap_or(0.5), effect.improvement_p.unwrap_or(1.0));
        let signs = match sign(share - 0.5) {
            _ if p > self.level() + ROUNDING => Verdict::Undecided,
            side if side > 0.0 => Verdict::Confirmed,
            side if side < 0.0 => Verdict::Refuted,
            _ => Verdict::Undecided,
        };
        if means == signs {
            return OnAverage { verdict: means, disagreement: None };
        }
        let disagreement = format!(
            "means and signs of the pairs disagree: {} by the means, {} by the signs (ahead in a share of \
             {share:.2}, p = {p:.4})",
            means.as_str(),
            signs.as_str()
        );
        OnAverage { verdict: Verdict::Undecided, disagreement: Some(disagreement) }
    }

    /// The environments in which `direction` times the difference is above `bound`, by the tests of the means
    /// and of the signs alike, at `level` for all environments together: Hochberg's correction (1988), valid
    /// where environments, which share no runs, are independent or correlate positively.
    pub(super) fn beyond<'e>(
        &self,
        effect: &'e Effect,
        bound: f64,
        direction: impl Fn(&PlaceEffect) -> f64,
        level: f64,
    ) -> Vec<&'e PlaceEffect> {
        if effect.is_small(self.options) {
            return Vec::new();
        }
        let p_values: Vec<f64> =
            effect.places.iter().map(|place| self.p_beyond(place, bound, direction(place))).collect();
        let adjusted = stats::hochberg(&p_values);
        let refused = effect.places.iter().zip(adjusted).filter(|(_, p)| *p <= level + ROUNDING);
        refused.map(|(place, _)| place).collect()
    }

    /// p-value of "no environment's difference is larger than `bound`", from all environments together.
    pub(super) fn p_together(&self, effect: &Effect, bound: f64) -> f64 {
        if effect.is_small(self.options) {
            return 1.0;
        }
        let p = |place: &PlaceEffect| self.p_beyond(place, bound, sign(place.difference));
        stats::fisher(&effect.places.iter().map(p).collect::<Vec<_>>())
    }

    /// Two-sided p-value of "`direction` times the difference is at most `bound`" in one environment: the
    /// larger of the tests of the means and of the signs; 1 where the data lie on its side.
    pub(super) fn p_beyond(&self, place: &PlaceEffect, bound: f64, direction: f64) -> f64 {
        let directed: Vec<f64> = place.differences.iter().map(|difference| difference * direction).collect();
        let p = |values: &[f64]| match stats::mean(values).map(sign) {
            Some(1.0) => stats::sign_flip(&[values], self.resampling).map_or(1.0, |test| test.p),
            _ => 1.0,
        };
        let shifted: Vec<f64> = directed.iter().map(|difference| difference - bound).collect();
        p(&shifted).max(p(&signs(&directed)))
    }

    /// Whether `holds` of every environment's [one-sided](Self::one_sided) interval.
    pub(super) fn everywhere(&self, effect: &Effect, holds: impl Fn((f64, f64)) -> bool) -> bool {
        !effect.places.is_empty()
            && !effect.is_small(self.options)
            && effect.places.iter().all(|place| place.interval(self.one_sided()).is_some_and(&holds))
    }
}

/// `MazeA (+0.23), MazeB (+0.19)`.
pub(super) fn named(places: &[&PlaceEffect]) -> String {
    places.iter().map(|place| place.named()).collect::<Vec<_>>().join(", ")
}
