//! The claims of a paper as testable statements, each with a verdict on the data at hand.
//!
//! Finished runs of the same evaluations are compared, paired by seed, by the exact sign-flip test
//! ([`stats::sign_flip`](crate::stats::sign_flip)); overlap of bands never counts. A verdict reads the
//! interval that inverts the test: what lies outside is refused. Where a claim (or a family of claims of one
//! kind) looks at several intervals, each is widened by Bonferroni's correction, so that all of them together
//! keep the confidence.

mod effect;
mod verdict;
mod versus;

pub use effect::{Effect, FEWEST_PAIRS};
pub use verdict::{MARGIN, Verdict};
pub(crate) use versus::{Above, corrected};

use crate::analysis::ablation::{self, Ablation, Level};
use crate::analysis::catalogue::{Axis, Catalogue, Claim, ClaimKind, Measure, Rule};
use crate::analysis::complete::Pair;
use crate::analysis::group::{self, Group};
use crate::stats::Resampling;

/// A claim and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct LedgerEntry {
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

/// The whole ledger: every claim of the catalogue's paper, also those that the data say nothing about.
/// `groups` come in order.
pub fn ledger(
    groups: &[Group<'_>],
    catalogue: &Catalogue,
    window: usize,
    resampling: Resampling,
) -> Vec<LedgerEntry> {
    let judge = Judge { groups, catalogue, window, resampling };
    let judged = |claim: &Claim| match claim.kind {
        ClaimKind::AboveBaselines(measure) => judge.above_baselines(claim, measure),
        ClaimKind::Values { axis, about, rule } => {
            let axis = catalogue.paper.axis(axis);
            axis.map(|axis| judge.values(claim, &Values { axis, about, rule })).into_iter().collect()
        }
    };
    catalogue.paper.claims.iter().flat_map(judged).collect()
}

/// What a claim about the values of a field says of them.
struct Values<'a> {
    axis: &'a Axis,
    about: &'a [&'static str],
    rule: Rule,
}

/// A value of a field, and runs with it paired with runs of the paper's own value.
type Candidate<'a> = (String, Vec<Pair<'a>>);

/// What claims are judged by.
struct Judge<'a> {
    groups: &'a [Group<'a>],
    catalogue: &'a Catalogue,
    window: usize,
    resampling: Resampling,
}

impl Judge<'_> {
    /// The paper's method against each of its baselines, in every environment that has both with default
    /// settings.
    fn above_baselines(&self, claim: &Claim, measure: Measure) -> Vec<LedgerEntry> {
        let paper = &self.catalogue.paper;
        let resampling = corrected(self.resampling, paper.baselines.len());
        let default = |environment: &str, curriculum: &str| {
            self.groups.iter().find(|group| {
                let key = &group.key;
                (key.environment.as_str(), key.curriculum.id.as_str(), key.variant.as_str())
                    == (environment, curriculum, "default")
            })
        };
        let own = || {
            let own = self.groups.iter().filter(|group| group.key.is_of(&paper.method));
            own.filter(|group| group.key.variant == "default")
        };
        let judged = |baseline: &String| {
            let pairs: Vec<Pair<'_>> = own()
                .filter_map(|group| Some(Pair::of(group, default(&group.key.environment, baseline)?)))
                .collect();
            let claim = Above { claim, measure, baseline, title: &self.catalogue.title(baseline) };
            claim.judge(&pairs, self.window, resampling)
        };
        paper.baselines.iter().map(judged).collect()
    }

    /// The values of a field against the paper's own one.
    fn values(&self, claim: &Claim, Values { axis, about, rule }: &Values<'_>) -> LedgerEntry {
        let Axis { symbol, reference, .. } = axis;
        let ablations = ablation::ablations(self.groups, axis);
        let preferred = about.first().copied();
        let chosen = about.iter().copied().find(|value| self.has(axis, value));
        let (repeats, others) = self.candidates(&ablations, reference, chosen);
        let is_tested = |value: &str| about.is_empty() || chosen == Some(value);
        let (tested, extras): (Vec<_>, Vec<_>) = others.into_iter().partition(|(value, _)| is_tested(value));
        let effects = |values: Vec<Candidate<'_>>, resampling| -> Vec<(String, Effect)> {
            let effect = |pairs: &[Pair<'_>]| effect::effect(pairs, Measure::Final, self.window, resampling);
            values.iter().map(|(value, pairs)| (format!("{symbol} = {value}"), effect(pairs))).collect()
        };
        let resampling = corrected(self.resampling, tested.len());
        let effects_tested = effects(tested, resampling);
        let mut texts: Vec<String> = effects_tested.iter().map(|value| shown(value, resampling)).collect();
        texts.extend(effects(extras, self.resampling).iter().map(|value| beside(value, self.resampling)));
        let repeated = |(value, _): &Candidate<'_>| {
            format!("{symbol} = {value}: the same runs as {symbol} = {reference}, not tested")
        };
        texts.extend(repeats.iter().map(repeated));
        texts.extend(substitution(symbol, preferred, chosen));
        let intervals: Vec<verdict::Interval> =
            effects_tested.iter().map(|(_, effect)| effect.interval).collect();
        let weight = |(_, effect): &(String, Effect)| rule.weight(effect);
        let decisive = effects_tested.into_iter().max_by(|a, b| weight(a).total_cmp(&weight(b)));
        let (value, effect) = decisive.map_or_else(Default::default, |(value, effect)| (Some(value), effect));
        let method = self.catalogue.title(&self.catalogue.paper.method);
        let nothing = || format!("no two variants of {method} differ in this setting alone");
        LedgerEntry {
            id: claim.id.to_owned(),
            source: claim.source,
            statement: claim.statement.to_owned(),
            rule: rule.as_str(),
            verdict: rule.judge(&intervals),
            value,
            effect,
            confidence: resampling.confidence,
            evidence: if texts.is_empty() { nothing() } else { texts.join("; ") },
        }
    }

    /// Every value but the reference with its pairs: first those that come to the same as the reference,
    /// which can be neither above nor below it, then the others.
    fn candidates(
        &self,
        ablations: &[Ablation<'_>],
        reference: &str,
        chosen: Option<&str>,
    ) -> (Vec<Candidate<'_>>, Vec<Candidate<'_>>) {
        let values = values(ablations, reference, chosen);
        let candidates = values.into_iter().map(|value| {
            let pairs = self.pairs(ablations, &value, reference);
            (value, pairs)
        });
        candidates.partition(|(_, pairs)| {
            !pairs.is_empty() && pairs.iter().all(|pair| group::is_repeated(&pair.a, &pair.b))
        })
    }

    /// Whether there are runs with this value in the field of `axis`.
    fn has(&self, axis: &Axis, value: &str) -> bool {
        let configs =
            self.groups.iter().filter_map(|group| group.runs.first()).map(|run| &run.manifest.config);
        configs.filter_map(|config| config.pointer(&axis.pointer)).any(|other| ablation::text(other) == value)
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

/// The values of all ablations but the reference, in order of appearance, and the one that the claim is
/// `about`, also where it is in no ablation.
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
fn substitution(symbol: &str, first: Option<&str>, chosen: Option<&str>) -> Option<String> {
    let first = first?;
    let other = chosen.filter(|value| *value != first)?;
    Some(format!("no run has {symbol} = {first}, so {symbol} = {other} is tested in its place"))
}
