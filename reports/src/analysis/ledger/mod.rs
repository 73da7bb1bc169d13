//! The claims of the paper's sections 5.3 to 5.6 as testable statements, each with a verdict on the data at hand.
//!
//! Finished runs of the same evaluations are compared, paired by seed, by the exact sign-flip test
//! ([`stats::sign_flip`](crate::stats::sign_flip)); overlap of bands never counts. A verdict reads the interval that
//! inverts the test: what lies outside is refused. Where a claim (or a family of claims of one kind) looks at several
//! intervals, each is widened by Bonferroni's correction, so that all of them together keep the confidence.

mod effect;
mod verdict;
mod versus;

pub use effect::{Effect, FEWEST_PAIRS, Measure};
pub use verdict::{MARGIN, Verdict};
pub(crate) use versus::{corrected, versus};

use crate::analysis::ablation::{self, Ablation, Axis, Level};
use crate::analysis::complete::Pair;
use crate::analysis::group::{self, Group};
use crate::paper::{self, BASELINES};
use crate::stats::Resampling;
use verdict::{EQUIVALENT, NOT_ABOVE, SOME_ABOVE};

/// A claim and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Short name, unique in the ledger.
    pub id: String,
    /// Where the paper shows it.
    pub source: &'static str,
    /// What is claimed, as a statement that data can contradict.
    pub statement: String,
    /// When it counts as confirmed or refuted.
    pub rule: &'static str,
    /// What the data say.
    pub verdict: Verdict,
    /// The value whose effect decides, where the claim is about several: `Δ = 5`.
    pub value: Option<String>,
    /// The difference that decides: of several the one that the verdict hangs on.
    pub effect: Effect,
    /// Coverage of each interval after the correction.
    pub confidence: f64,
    /// What the verdict rests on, or what is missing for one.
    pub evidence: String,
}

/// The whole ledger: every claim, also those that the data say nothing about. `groups` come in order.
pub fn ledger(groups: &[Group<'_>], window: usize, resampling: Resampling) -> Vec<Entry> {
    let judge = Judge { groups, window, resampling };
    let mut entries = Vec::new();
    for measure in [Measure::Final, Measure::Area] {
        entries.extend(BASELINES.iter().map(|baseline| judge.baseline(baseline, measure)));
    }
    entries.extend(ABLATION_CLAIMS.iter().map(|claim| judge.ablation(claim)));
    entries
}

/// A claim about one field of TEACH's config.
struct AblationClaim {
    id: &'static str,
    axis: &'static Axis,
    /// The values that the claim is about, best first: it rests on the first that any run has, the others are shown and
    /// not tested. Empty: it rests on every value.
    about: &'static [&'static str],
    source: &'static str,
    statement: &'static str,
    rule: &'static str,
    verdict: fn(&[verdict::Interval]) -> Verdict,
    /// Which of several effects the verdict hangs on; how far each is from where it would not.
    weight: fn(&Effect) -> f64,
}

static ABLATION_CLAIMS: [AblationClaim; 3] = [
    AblationClaim {
        id: "target-confidence",
        axis: &ablation::CONFIDENCE,
        // Section 5.4 and Eq. 12 speak of a smooth value function alone; old results have no such runs.
        about: &["target-critic", "target"],
        source: "Figure 3",
        statement: "Confidence of the smooth value function (the target critic) gives no better final success than that \
                    of the online networks",
        rule: NOT_ABOVE,
        verdict: verdict::not_above,
        weight: highest,
    },
    AblationClaim {
        id: "window",
        axis: &ablation::WINDOW,
        about: &[],
        source: "Figure 4",
        statement: "Final success does not depend on the window n (each value against n = 10)",
        rule: EQUIVALENT,
        verdict: verdict::equivalent,
        weight: farthest,
    },
    AblationClaim {
        id: "interplay",
        axis: &ablation::INTERPLAY,
        about: &[],
        source: "Figure 5",
        statement: "A larger Δ can help: some Δ > 1 gives a higher final success than Δ = 1",
        rule: SOME_ABOVE,
        verdict: verdict::some_above,
        weight: best_supported,
    },
];

/// How well "above" is supported: by the lower end of the interval, without one by the difference, below all that have
/// one.
fn best_supported(effect: &Effect) -> f64 {
    effect
        .interval
        .map_or_else(|| effect.difference.map_or(-8.0, |difference| difference - 4.0), |(low, _)| low)
}

/// How far from "none is above": first those wholly above 0 by how far they are, then the others by the upper end of the
/// interval.
fn highest(effect: &Effect) -> f64 {
    let Some((low, high)) = effect.interval else {
        return effect.difference.map_or(-8.0, |difference| difference - 4.0);
    };
    if low > 0.0 { 4.0 + low } else { high }
}

/// How far from "no difference": first those wholly outside the margin by how far they are, then the others by the end
/// of the interval that is farther from 0.
fn farthest(effect: &Effect) -> f64 {
    let Some((low, high)) = effect.interval else {
        return effect.difference.map_or(-8.0, |difference| difference.abs() - 4.0);
    };
    let outside = low.max(-high);
    if outside >= MARGIN { 4.0 + outside } else { high.max(-low) }
}

/// What claims are judged by.
struct Judge<'a> {
    groups: &'a [Group<'a>],
    window: usize,
    resampling: Resampling,
}

impl Judge<'_> {
    /// TEACH against a baseline, in every environment that has both with default settings.
    fn baseline(&self, baseline: &str, measure: Measure) -> Entry {
        let resampling = corrected(self.resampling, BASELINES.len());
        let default = |environment: &str, curriculum: &str| {
            self.groups.iter().find(|group| {
                let key = &group.key;
                (key.environment.as_str(), key.curriculum.as_str(), key.variant.as_str())
                    == (environment, curriculum, "default")
            })
        };
        let teach = self.groups.iter().filter(|group| group.key.curriculum == paper::METHOD);
        let teach = teach.filter(|group| group.key.variant == "default");
        let pairs: Vec<Pair<'_>> = teach
            .filter_map(|group| Some(Pair::of(group, default(&group.key.environment, baseline)?)))
            .collect();
        versus(&pairs, baseline, measure, self.window, resampling)
    }

    fn ablation(&self, claim: &AblationClaim) -> Entry {
        let Axis { symbol, reference, .. } = *claim.axis;
        let ablations = ablation::ablations(self.groups, claim.axis);
        let about = claim.about.iter().copied().find(|value| self.has(claim.axis, value));
        let values = values(&ablations, reference, about);
        let candidates = values.into_iter().map(|value| {
            let pairs = self.pairs(&ablations, &value, reference);
            (value, pairs)
        });
        // A value that comes to the same as the reference can be neither above nor below it.
        let (repeats, others): (Vec<_>, Vec<_>) = candidates.partition(|(_, pairs)| {
            !pairs.is_empty() && pairs.iter().all(|pair| group::is_repeated(&pair.a, &pair.b))
        });
        let is_tested = |value: &str| claim.about.is_empty() || about == Some(value);
        let (tested, extras): (Vec<_>, Vec<_>) = others.into_iter().partition(|(value, _)| is_tested(value));
        let effects = |values: Vec<(String, Vec<Pair<'_>>)>, resampling| -> Vec<(String, Effect)> {
            let effect = |pairs: &[Pair<'_>]| effect::effect(pairs, Measure::Final, self.window, resampling);
            values.iter().map(|(value, pairs)| (format!("{symbol} = {value}"), effect(pairs))).collect()
        };
        let resampling = corrected(self.resampling, tested.len());
        let effects_tested = effects(tested, resampling);
        let mut texts: Vec<String> = effects_tested.iter().map(|value| shown(value, resampling)).collect();
        texts.extend(effects(extras, self.resampling).iter().map(|value| beside(value, self.resampling)));
        let repeated = |(value, _): &(String, _)| {
            format!("{symbol} = {value}: the same runs as {symbol} = {reference}, not tested")
        };
        texts.extend(repeats.iter().map(repeated));
        texts.extend(substitution(claim, about));
        let intervals: Vec<verdict::Interval> =
            effects_tested.iter().map(|(_, effect)| effect.interval).collect();
        let weight = |(_, effect): &(String, Effect)| (claim.weight)(effect);
        let decisive = effects_tested.into_iter().max_by(|a, b| weight(a).total_cmp(&weight(b)));
        let (value, effect) = decisive.map_or_else(Default::default, |(value, effect)| (Some(value), effect));
        let nothing = || "no two variants of TEACH differ in this setting alone".to_owned();
        Entry {
            id: claim.id.to_owned(),
            source: claim.source,
            statement: claim.statement.to_owned(),
            rule: claim.rule,
            verdict: (claim.verdict)(&intervals),
            value,
            effect,
            confidence: resampling.confidence,
            evidence: if texts.is_empty() { nothing() } else { texts.join("; ") },
        }
    }

    /// Whether there are runs with this value in the field of `axis`.
    fn has(&self, axis: &Axis, value: &str) -> bool {
        let configs =
            self.groups.iter().filter_map(|group| group.runs.first()).map(|run| &run.manifest.config);
        configs.filter_map(|config| config.pointer(axis.pointer)).any(|other| ablation::text(other) == value)
    }

    /// Comparable runs with `value` and with `reference`, for every ablation that has both; the first of each
    /// environment.
    fn pairs(&self, ablations: &[Ablation<'_>], value: &str, reference: &str) -> Vec<Pair<'_>> {
        let mut pairs: Vec<Pair<'_>> = Vec::new();
        for ablation in ablations {
            let group = |text: &str| {
                let level = ablation.levels.iter().find(|level| level.text() == text)?;
                self.groups.get(level.group)
            };
            let Some((a, b)) = group(value).zip(group(reference)) else { continue };
            if pairs.iter().all(|other| other.a.key.environment != a.key.environment) {
                pairs.push(Pair::of(a, b));
            }
        }
        pairs
    }
}

/// The values of all ablations but the reference, in order of appearance, and the one that the claim is `about`, also
/// where it is in no ablation.
fn values(ablations: &[Ablation<'_>], reference: &str, about: Option<&str>) -> Vec<String> {
    let mut values: Vec<String> = Vec::new();
    let levels = ablations.iter().flat_map(|ablation| &ablation.levels).map(Level::text);
    for value in levels.chain(about.map(str::to_owned)) {
        if value != reference && !values.contains(&value) {
            values.push(value);
        }
    }
    values
}

/// `n = 3: +0.02 [-0.05, +0.08], ahead in 1 and behind in 1 of 2 environments`, or what a test lacks.
fn shown((value, effect): &(String, Effect), resampling: Resampling) -> String {
    let difference = effect.difference.map_or_else(String::new, |difference| format!("{difference:+.2}"));
    let interval = effect
        .interval
        .map(|(low, high)| format!("{difference} [{low:+.2}, {high:+.2}], {}", standing(effect)));
    let lack = || {
        let lack = effect.lack(resampling).unwrap_or_default();
        if difference.is_empty() { lack } else { format!("{difference}, {lack}") }
    };
    format!("{value}: {}{}", interval.unwrap_or_else(lack), effect.remark())
}

/// A value that a claim is not about.
fn beside((value, effect): &(String, Effect), resampling: Resampling) -> String {
    let what = match effect.difference {
        Some(difference) => format!("{difference:+.2}, {}", standing(effect)),
        None => effect.lack(resampling).unwrap_or_default(),
    };
    format!("{value}, not what the claim is about and not tested: {what}{}", effect.remark())
}

fn standing(effect: &Effect) -> String {
    let (ahead, behind, all) = (effect.ahead, effect.behind, effect.environments.len());
    format!("ahead in {ahead} and behind in {behind} of {all} environments")
}

/// What is said where a claim rests on another value than the one that it is about first.
fn substitution(claim: &AblationClaim, about: Option<&str>) -> Option<String> {
    let (first, symbol) = (*claim.about.first()?, claim.axis.symbol);
    let other = about.filter(|value| *value != first)?;
    Some(format!("no run has {symbol} = {first}, so {symbol} = {other} is tested in its place"))
}

#[cfg(test)]
mod tests {
    use super::*;

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
