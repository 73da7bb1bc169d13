//! The main claims: the paper's method against a baseline, judged on pairs of runs that the caller chose.

use super::LedgerEntry;
use super::effect;
use super::verdict::{self, ABOVE};
use crate::analysis::catalogue::{Claim, Measure};
use crate::analysis::complete::Pair;
use crate::stats::Resampling;

/// Intervals wide enough that `count` of them hold together (Bonferroni's correction).
pub(crate) fn corrected(resampling: Resampling, count: usize) -> Resampling {
    let miss = (1.0 - resampling.confidence) / count.max(1) as f64;
    Resampling { confidence: 1.0 - miss, ..resampling }
}

/// The claim that the paper's method is above a baseline.
pub(crate) struct Above<'a> {
    pub(crate) claim: &'a Claim,
    pub(crate) measure: Measure,
    /// The baseline's curriculum id.
    pub(crate) baseline: &'a str,
    pub(crate) title: &'a str,
}

impl Above<'_> {
    /// The claim on `pairs` of the method with the baseline, one per environment. `resampling` holds the
    /// coverage after correction; final scores average `window` evaluations.
    pub(crate) fn judge(&self, pairs: &[Pair<'_>], window: usize, resampling: Resampling) -> LedgerEntry {
        let Self { claim, measure, baseline, title } = *self;
        let effect = effect::effect(pairs, measure, window, resampling);
        let counts = || {
            let (ahead, behind, all) = (effect.ahead, effect.behind, effect.environments.len());
            format!(
                "ahead in {ahead} and behind in {behind} of {all} environments, {} pairs of runs",
                effect.pairs
            )
        };
        let evidence = match (effect.lack(resampling), effect.environments.is_empty()) {
            (None, _) => counts(),
            (Some(lack), true) => lack,
            (Some(lack), false) => format!("{}; {lack}", counts()),
        };
        let evidence = evidence + &effect.remark();
        LedgerEntry {
            id: format!("{}-{baseline}", claim.id),
            source: claim.source,
            statement: claim.statement.replace("{baseline}", title),
            rule: ABOVE,
            verdict: verdict::above(effect.interval),
            value: None,
            effect,
            confidence: resampling.confidence,
            evidence,
        }
    }
}
