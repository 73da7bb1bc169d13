//! The main claims: the paper's method against a baseline, judged on pairs of runs that the caller chose.

use super::LedgerEntry;
use super::effect::{self, Effect, PlaceEffect};
use super::verdict::{Bench, Verdict, named};
use crate::analysis::catalogue::{Claim, Measure};
use crate::analysis::complete::Pair;
use crate::analysis::options::ReportOptions;
use crate::stats::Resampling;
use crate::wording::counted;

/// Intervals wide enough that `count` of them hold together (Bonferroni's correction).
pub(crate) fn corrected(resampling: Resampling, count: usize) -> Resampling {
    let miss = (1.0 - resampling.confidence) / count.max(1) as f64;
    Resampling { confidence: 1.0 - miss, ..resampling }
}

/// "A is above B".
const ABOVE: &str = "confirmed if the whole interval lies above 0 and the signs of the pairs say the same at that level, \
                     refuted if both say so of below 0";

/// "A is above B wherever one looks".
fn consistent(margin: f64) -> String {
    format!(
        "confirmed if above on average (means and signs), ahead in more than half of the environments, and in each the \
         one-sided interval lies above -{margin}; refuted if one environment is below 0 (corrected over environments)"
    )
}

/// The claim that the paper's method is above a baseline.
pub(crate) struct Versus<'a> {
    pub(crate) claim: &'a Claim,
    pub(crate) measure: Measure,
    /// The baseline's curriculum id.
    pub(crate) baseline: &'a str,
    pub(crate) title: &'a str,
}

impl Versus<'_> {
    /// The claim on `pairs` of the method with the baseline, one per environment. `resampling` holds the
    /// coverage after correction.
    pub(crate) fn judge(
        &self,
        pairs: &[Pair<'_>],
        options: &ReportOptions,
        resampling: Resampling,
    ) -> LedgerEntry {
        let effect = effect::effect(pairs, self.measure, options, resampling);
        let above = Bench { options, resampling }.above(&effect);
        let evidence = [Some(standing(&effect, options, resampling)), above.disagreement];
        self.entry(ABOVE.to_owned(), above.verdict, (effect, resampling), evidence, options)
    }

    /// The claim that it is so wherever one looks, on the same pairs.
    pub(super) fn judge_everywhere(
        &self,
        pairs: &[Pair<'_>],
        options: &ReportOptions,
        resampling: Resampling,
    ) -> LedgerEntry {
        let effect = effect::effect(pairs, self.measure, options, resampling);
        let bench = Bench { options, resampling };
        let average = bench.above(&effect);
        // One side alone is tested: "not below 0".
        let behind = bench.beyond(&effect, 0.0, |_| -1.0, 2.0 * bench.level());
        let most = 2 * effect.ahead() > effect.places.len();
        let never_far_behind = bench.everywhere(&effect, |(low, _)| low > -options.margin);
        let verdict = if !behind.is_empty() {
            Verdict::Refuted
        } else if average.verdict == Verdict::Confirmed && most && never_far_behind {
            Verdict::Confirmed
        } else {
            Verdict::Undecided
        };
        let below = (!behind.is_empty()).then(|| format!("below 0, corrected: {}", named(&behind)));
        let evidence = [
            Some(standing(&effect, options, resampling)),
            below,
            by_environment(&effect, options),
            average.disagreement,
        ];
        self.entry(consistent(options.margin), verdict, (effect, resampling), evidence, options)
    }

    fn entry(
        &self,
        rule: String,
        verdict: Verdict,
        (effect, resampling): (Effect, Resampling),
        evidence: impl IntoIterator<Item = Option<String>>,
        options: &ReportOptions,
    ) -> LedgerEntry {
        let Self { claim, baseline, title, .. } = *self;
        let evidence: Vec<String> = evidence.into_iter().flatten().collect();
        LedgerEntry {
            id: format!("{}-{baseline}", claim.id),
            source: claim.source,
            statement: claim.statement.replace("{baseline}", title),
            rule,
            verdict,
            value: None,
            evidence: evidence.join("; ") + &effect.remark(options),
            confidence: resampling.confidence,
            effect,
        }
    }
}

/// In how many environments it is ahead, over how many pairs, and what is missing for a test.
fn standing(effect: &Effect, options: &ReportOptions, resampling: Resampling) -> String {
    let counts = || {
        let (ahead, behind, all) = (effect.ahead(), effect.behind(), effect.places.len());
        format!(
            "ahead in {ahead} and behind in {behind} of {}, {} of runs",
            counted(all, "environment"),
            counted(effect.pairs, "pair")
        )
    };
    match effect.lack(options, resampling) {
        None => counts(),
        Some(lack) if effect.pairs == 0 => lack,
        Some(lack) => format!("{}; {lack}", counts()),
    }
}

/// What every environment says by its own test alone, uncorrected.
fn by_environment(effect: &Effect, options: &ReportOptions) -> Option<String> {
    let (mut ahead, mut behind, mut open) = (Vec::new(), Vec::new(), Vec::new());
    for place in &effect.places {
        let of: &mut Vec<&PlaceEffect> = match place.interval(options.resampling) {
            Some((low, _)) if low > 0.0 => &mut ahead,
            Some((_, high)) if high < 0.0 => &mut behind,
            _ => &mut open,
        };
        of.push(place);
    }
    let part = |what: &str, places: &[&PlaceEffect]| {
        (!places.is_empty()).then(|| format!("{what} {}", named(places)))
    };
    let parts = [part("ahead in", &ahead), part("behind in", &behind), part("open in", &open)];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| format!("each by its own test, uncorrected: {}", parts.join(", ")))
}
