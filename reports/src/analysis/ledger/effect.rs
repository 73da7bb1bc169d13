//! The difference between two ways to train, over environments, from runs paired by seed.

use super::verdict::Interval;
use crate::analysis::catalogue::Measure;
use crate::analysis::complete::Pair;
use crate::analysis::group;
use crate::analysis::scores;
use crate::stats::{self, Resampling};
use crate::store::Run;

/// Environments with fewer seeds that both sides have are left out: a mean of so few says little about an
/// environment.
pub const FEWEST_PAIRS: usize = 5;

/// A mean difference of success rates and what it rests on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effect {
    /// Mean over environments of the mean paired difference; `None` without an environment.
    pub difference: Option<f64>,
    /// Two-sided p-value of the sign-flip test of no difference ([`stats::sign_flip`]), uncorrected.
    pub p: Option<f64>,
    /// The interval that inverts that test; `None` where there are too few pairs for one.
    pub interval: Interval,
    /// Environments with at least [`FEWEST_PAIRS`] pairs.
    pub environments: Vec<String>,
    /// Those of them where the mean difference is above 0.
    pub ahead: usize,
    /// Those of them where it is below 0.
    pub behind: usize,
    /// Pairs in all of them.
    pub pairs: usize,
    /// Runs that count nowhere, in all environments: not finished, or not evaluated at the steps of the
    /// others.
    pub left_out: usize,
}

impl Effect {
    /// What to say where the claim cannot be tested, and why; `None` where it can.
    pub(super) fn lack(&self, resampling: Resampling) -> Option<String> {
        if self.environments.is_empty() {
            return Some(format!("no environment with {FEWEST_PAIRS} seeds of both"));
        }
        self.interval.is_none().then(|| {
            let lowest = stats::lowest_sign_flip_p(self.pairs, resampling);
            let level = 1.0 - resampling.confidence;
            format!(
                "too few seeds: p of {} pairs cannot fall below {lowest:.4}, {level:.4} is needed",
                self.pairs
            )
        })
    }

    /// `; 3 unfinished runs left out`, or nothing.
    pub(super) fn remark(&self) -> String {
        match self.left_out {
            0 => String::new(),
            1 => "; 1 run left out, not finished or with other evaluations".to_owned(),
            k => format!("; {k} runs left out, not finished or with other evaluations"),
        }
    }
}

/// The effect of `a` against `b` over `pairs` of groups, one per environment.
pub(super) fn effect(pairs: &[Pair<'_>], measure: Measure, window: usize, resampling: Resampling) -> Effect {
    let mut strata = Vec::new();
    let mut environments = Vec::new();
    for pair in pairs {
        let differences = differences(pair, measure, window);
        if differences.len() >= FEWEST_PAIRS {
            strata.push(differences);
            environments.push(pair.a.key.environment.clone());
        }
    }
    let slices: Vec<&[f64]> = strata.iter().map(Vec::as_slice).collect();
    let means: Vec<f64> = slices.iter().filter_map(|stratum| stats::mean(stratum)).collect();
    let test = stats::sign_flip(&slices, resampling);
    Effect {
        difference: stats::mean(&means),
        p: test.map(|test| test.p),
        interval: test.and_then(|test| test.interval),
        // A mean of rounding errors alone is neither.
        ahead: means.iter().filter(|mean| **mean > 1e-12).count(),
        behind: means.iter().filter(|mean| **mean < -1e-12).count(),
        pairs: strata.iter().map(Vec::len).sum(),
        environments,
        left_out: pairs.iter().map(|pair| pair.left_out).sum(),
    }
}

/// `a - b` for every seed that both have.
fn differences(pair: &Pair<'_>, measure: Measure, window: usize) -> Vec<f64> {
    let score = |run: &Run| match measure {
        Measure::Final => scores::final_score(&run.records, window),
        Measure::Area => scores::area_under_curve(&run.records),
    };
    group::shared_seeds(&pair.a, &pair.b).filter_map(|(a, b)| Some(score(a)? - score(b)?)).collect()
}
