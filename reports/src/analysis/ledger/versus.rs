//! The main claims: TEACH against a baseline, judged on pairs of runs that the caller chose.

use super::Entry;
use super::effect::{self, Measure};
use super::verdict::{self, ABOVE};
use crate::analysis::complete::Pair;
use crate::methods;
use crate::stats::Resampling;

/// Intervals wide enough that `count` of them hold together (Bonferroni's correction).
pub(crate) fn corrected(resampling: Resampling, count: usize) -> Resampling {
    let miss = (1.0 - resampling.confidence) / count.max(1) as f64;
    Resampling { confidence: 1.0 - miss, ..resampling }
}

/// The claim that TEACH is above `baseline` by `measure`, on `pairs` of TEACH with it, one per environment. `resampling`
/// holds the coverage after correction; final scores average `window` evaluations.
pub(crate) fn versus(
    pairs: &[Pair<'_>],
    baseline: &str,
    measure: Measure,
    window: usize,
    resampling: Resampling,
) -> Entry {
    let effect = effect::effect(pairs, measure, window, resampling);
    let title = methods::title(baseline);
    let (id, statement) = match measure {
        Measure::Final => (
            "final",
            format!("TEACH reaches a higher final success than {title} on average over environments"),
        ),
        Measure::Area => (
            "area",
            format!(
                "TEACH learns faster than {title} on average over environments: more area under its learning curve"
            ),
        ),
    };
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
    Entry {
        id: format!("{id}-{baseline}"),
        source: "Figures 2 and 6",
        statement,
        rule: ABOVE,
        verdict: verdict::above(effect.interval),
        value: None,
        effect,
        confidence: resampling.confidence,
        evidence,
    }
}
