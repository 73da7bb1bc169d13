//! Claims about the values of a setting, found in variants that differ in it alone.

use super::effect::{self, Effect};
use super::rules::Tested;
use super::verdict::{Bench, Verdict};
use super::{Judge, LedgerEntry};
use crate::analysis::ablation::{self, Ablation, Level};
use crate::analysis::catalogue::{Axis, Claim, Measure, Rule};
use crate::analysis::complete::Pair;
use crate::analysis::group::{self, Group};
use crate::analysis::options::ReportOptions;
use crate::stats::Resampling;
use crate::wording::counted;

/// What a claim about the values of a field says of them.
pub(super) struct Values<'a> {
    pub(super) axis: &'a Axis,
    pub(super) about: &'a [&'static str],
    pub(super) measure: Measure,
    pub(super) rule: Rule,
}

/// A value of a field, and runs with it paired with runs of the paper's own value.
type Candidate<'a> = (String, Vec<Pair<'a>>);

impl Judge<'_> {
    /// The values of a field against the paper's own one, over `groups`.
    pub(super) fn values(
        &self,
        claim: &Claim,
        groups: &[Group<'_>],
        Values { axis, about, measure, rule }: &Values<'_>,
    ) -> LedgerEntry {
        let Axis { symbol, reference, .. } = axis;
        let ablations = ablation::ablations(groups, axis);
        let chosen = about.iter().copied().find(|value| has(groups, axis, value));
        let (repeats, others) = candidates(groups, &ablations, reference, chosen);
        let is_tested = |value: &str| about.is_empty() || chosen == Some(value);
        let (tested, extras): (Vec<_>, Vec<_>) = others.into_iter().partition(|(value, _)| is_tested(value));
        let effects = |values: Vec<Candidate<'_>>, resampling| -> Vec<Tested> {
            let effect = |pairs: &[Pair<'_>]| effect::effect(pairs, *measure, self.options, resampling);
            values.iter().map(|(value, pairs)| (format!("{symbol} = {value}"), effect(pairs))).collect()
        };
        let bench = Bench { options: self.options, resampling: self.options.resampling };
        let each = bench.shared(tested.len().max(1) * rule.tests());
        let tested = effects(tested, each.resampling);
        let finding = rule.judge(&tested, bench, each);
        let shown = |value: &Tested| shown(value, self.options, each.resampling);
        let mut texts: Vec<String> = tested.iter().map(shown).collect();
        texts.extend(finding.notes);
        let extras = effects(extras, bench.resampling);
        texts.extend(extras.iter().map(|value| beside(value, self.options)));
        let repeated = |(value, _): &Candidate<'_>| {
            format!("{symbol} = {value}: the same runs as {symbol} = {reference}, not tested")
        };
        texts.extend(repeats.iter().map(repeated));
        texts.extend(substitution(symbol, about.first().copied(), chosen));
        let method = self.options.catalogue.title(&self.options.catalogue.paper.method);
        let nothing = || format!("no two variants of {method} differ in this setting alone");
        LedgerEntry {
            id: claim.id.to_owned(),
            source: claim.source,
            statement: claim.statement.to_owned(),
            rule: rule.words(self.options.margin),
            verdict: finding.verdict.unwrap_or(Verdict::Undecided),
            value: finding.value,
            effect: finding.effect,
            confidence: finding.confidence,
            evidence: if texts.is_empty() { nothing() } else { texts.join("; ") },
        }
    }
}

/// Every value but the reference with its pairs: first those that come to the same as the reference, which
/// can be neither above nor below it, then the others.
fn candidates<'a>(
    groups: &[Group<'a>],
    ablations: &[Ablation<'_>],
    reference: &str,
    chosen: Option<&str>,
) -> (Vec<Candidate<'a>>, Vec<Candidate<'a>>) {
    let candidates = values(ablations, reference, chosen).into_iter().map(|value| {
        let pairs = pairs(groups, ablations, &value, reference);
        (value, pairs)
    });
    candidates.partition(|(_, pairs)| {
        !pairs.is_empty() && pairs.iter().all(|pair| group::is_repeated(&pair.a, &pair.b))
    })
}

/// Whether there are runs with this value in the field of `axis`.
fn has(groups: &[Group<'_>], axis: &Axis, value: &str) -> bool {
    let configs = groups.iter().filter_map(|group| group.runs.first()).map(|run| &run.manifest.config);
    configs.filter_map(|config| config.pointer(&axis.pointer)).any(|other| ablation::text(other) == value)
}

/// Comparable runs with `value` and with `reference`, for every ablation that has both; the first of each
/// environment.
fn pairs<'a>(
    groups: &[Group<'a>],
    ablations: &[Ablation<'_>],
    value: &str,
    reference: &str,
) -> Vec<Pair<'a>> {
    let mut pairs: Vec<Pair<'_>> = Vec::new();
    for ablation in ablations {
        let group = |text: &str| {
            let level = ablation.levels.iter().find(|level| level.text() == text)?;
            groups.get(level.group)
        };
        let Some((a, b)) = group(value).zip(group(reference)) else { continue };
        if pairs.iter().all(|other| other.a.key.environment != a.key.environment) {
            pairs.push(Pair::of(a, b));
        }
    }
    pairs
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
fn shown((value, effect): &Tested, options: &ReportOptions, resampling: Resampling) -> String {
    let difference = effect.difference.map_or_else(String::new, |difference| format!("{difference:+.2}"));
    let interval = effect
        .interval
        .filter(|_| !effect.is_small(options))
        .map(|(low, high)| format!("{difference} [{low:+.2}, {high:+.2}], {}", standing(effect)));
    let lack = || {
        let lack = effect.lack(options, resampling).unwrap_or_default();
        if difference.is_empty() { lack } else { format!("{difference}, {lack}") }
    };
    format!("{value}: {}{}", interval.unwrap_or_else(lack), effect.remark(options))
}

/// A value that a claim is not about.
fn beside((value, effect): &Tested, options: &ReportOptions) -> String {
    let what = match effect.difference {
        Some(difference) => format!("{difference:+.2}, {}", standing(effect)),
        None => effect.lack(options, options.resampling).unwrap_or_default(),
    };
    format!("{value}, not what the claim is about and not tested: {what}{}", effect.remark(options))
}

fn standing(effect: &Effect) -> String {
    let (ahead, behind, all) = (effect.ahead(), effect.behind(), effect.places.len());
    format!("ahead in {ahead} and behind in {behind} of {}", counted(all, "environment"))
}

/// What is said where a claim rests on another value than the one that it is about first.
fn substitution(symbol: &str, first: Option<&str>, chosen: Option<&str>) -> Option<String> {
    let first = first?;
    let other = chosen.filter(|value| *value != first)?;
    Some(format!("no run has {symbol} = {first}, so {symbol} = {other} is tested in its place"))
}
