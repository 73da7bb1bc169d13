//! The claims of the paper's sections 5.3 to 5.6 as testable statements, each with a verdict on the data at hand.
//!
//! Success rates are compared by paired bootstrap intervals; overlap of bands never counts. Where a claim (or a family
//! of claims of one kind) looks at several intervals, each is widened by Bonferroni's correction, so that all of them
//! together keep the confidence.

mod effect;
mod verdict;

use serde_json::{Value, json};

pub use effect::{Effect, FEWEST_PAIRS, Measure};
pub use verdict::{MARGIN, Verdict};

use crate::ablation::{self, Ablation, Axis};
use crate::group::{self, Group};
use crate::methods;
use crate::stats::Resampling;
use verdict::{ABOVE, EQUIVALENT, NOT_ABOVE, SOME_ABOVE};

/// The paper's baselines, as curriculum ids.
const BASELINES: [&str; 4] = ["vds", "procurl", "space", "her-iid"];

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
    /// The difference that decides: of several the largest in size.
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
    source: &'static str,
    statement: &'static str,
    rule: &'static str,
    /// The value that others are compared with.
    reference: fn() -> Value,
    verdict: fn(&[verdict::Interval]) -> Verdict,
}

static ABLATION_CLAIMS: [AblationClaim; 3] = [
    AblationClaim {
        id: "target-confidence",
        axis: &ablation::CONFIDENCE,
        source: "Figure 3",
        statement: "Confidence taken from the target networks gives no better final success than from the online \
                    networks",
        rule: NOT_ABOVE,
        reference: || json!("online"),
        verdict: |intervals| {
            intervals.first().map_or(Verdict::Undecided, |interval| verdict::not_above(*interval))
        },
    },
    AblationClaim {
        id: "window",
        axis: &ablation::WINDOW,
        source: "Figure 4",
        statement: "Final success does not depend on the window n (each value against n = 10)",
        rule: EQUIVALENT,
        reference: || json!(10),
        verdict: verdict::equivalent,
    },
    AblationClaim {
        id: "interplay",
        axis: &ablation::INTERPLAY,
        source: "Figure 5",
        statement: "A larger Δ can help: some Δ > 1 gives a higher final success than Δ = 1",
        rule: SOME_ABOVE,
        reference: || json!(1),
        verdict: verdict::some_above,
    },
];

/// What claims are judged by.
struct Judge<'a> {
    groups: &'a [Group<'a>],
    window: usize,
    resampling: Resampling,
}

impl Judge<'_> {
    /// Intervals wide enough that `count` of them hold together.
    fn corrected(&self, count: usize) -> Resampling {
        let miss = (1.0 - self.resampling.confidence) / count.max(1) as f64;
        Resampling { confidence: 1.0 - miss, ..self.resampling }
    }

    /// TEACH against a baseline, in every environment that has both with default settings.
    fn baseline(&self, baseline: &str, measure: Measure) -> Entry {
        let resampling = self.corrected(BASELINES.len());
        let default = |environment: &str, curriculum: &str| {
            self.groups.iter().find(|group| {
                let key = &group.key;
                (key.environment.as_str(), key.curriculum.as_str(), key.variant.as_str())
                    == (environment, curriculum, "default")
            })
        };
        let teach = self.groups.iter().filter(|group| group.key.curriculum == "teach");
        let teach = teach.filter(|group| group.key.variant == "default");
        let pairs: Vec<_> =
            teach.filter_map(|group| Some((group, default(&group.key.environment, baseline)?))).collect();
        let effect = effect::effect(&pairs, measure, self.window, resampling);
        let title = methods::title(baseline);
        let (id, statement) = match measure {
            Measure::Final => ("final", format!("TEACH reaches a higher final success than {title}")),
            Measure::Area => {
                ("area", format!("TEACH learns faster than {title}: more area under its learning curve"))
            }
        };
        let evidence = if effect.environments.is_empty() {
            format!("no environment with {FEWEST_PAIRS} seeds of both")
        } else {
            let (ahead, all) = (effect.ahead, effect.environments.len());
            format!("ahead in {ahead} of {all} environments, {} pairs of runs", effect.pairs)
        };
        Entry {
            id: format!("{id}-{baseline}"),
            source: "Figures 2 and 6",
            statement,
            rule: ABOVE,
            verdict: verdict::above(effect.interval),
            effect,
            confidence: resampling.confidence,
            evidence,
        }
    }

    fn ablation(&self, claim: &AblationClaim) -> Entry {
        let reference = (claim.reference)();
        let Axis { symbol, .. } = *claim.axis;
        let ablations = ablation::ablations(self.groups, claim.axis);
        let mut values: Vec<&Value> = Vec::new();
        for level in ablations.iter().flat_map(|ablation| &ablation.levels) {
            if *level.value != reference && !values.contains(&level.value) {
                values.push(level.value);
            }
        }
        let name = |value: &Value| {
            format!("{symbol} = {}", value.as_str().map_or_else(|| value.to_string(), str::to_owned))
        };
        let candidates =
            values.into_iter().map(|value| (name(value), self.pairs(&ablations, value, &reference)));
        // A value that comes to the same as the reference can be neither above nor below it.
        let (repeats, tested): (Vec<_>, Vec<_>) = candidates
            .partition(|(_, pairs)| !pairs.is_empty() && pairs.iter().all(|(a, b)| group::is_repeated(a, b)));
        let resampling = self.corrected(tested.len());
        let effects: Vec<(String, Effect)> = tested
            .into_iter()
            .map(|(name, pairs)| (name, effect::effect(&pairs, Measure::Final, self.window, resampling)))
            .collect();
        let intervals: Vec<verdict::Interval> = effects.iter().map(|(_, effect)| effect.interval).collect();
        let repeats: Vec<String> = repeats.into_iter().map(|(name, _)| name).collect();
        let evidence = evidence(&effects, &repeats, &name(&reference));
        let size = |effect: &Effect| effect.difference.map_or(-1.0, f64::abs);
        let largest =
            effects.into_iter().map(|(_, effect)| effect).max_by(|a, b| size(a).total_cmp(&size(b)));
        Entry {
            id: claim.id.to_owned(),
            source: claim.source,
            statement: claim.statement.to_owned(),
            rule: claim.rule,
            verdict: (claim.verdict)(&intervals),
            effect: largest.unwrap_or_default(),
            confidence: resampling.confidence,
            evidence,
        }
    }

    /// Groups with `value` and with `reference`, for every ablation that has both; the first of each environment.
    fn pairs(
        &self,
        ablations: &[Ablation<'_>],
        value: &Value,
        reference: &Value,
    ) -> Vec<(&Group<'_>, &Group<'_>)> {
        let mut pairs: Vec<(&Group<'_>, &Group<'_>)> = Vec::new();
        for ablation in ablations {
            let group = |value: &Value| {
                let level = ablation.levels.iter().find(|level| level.value == value)?;
                self.groups.get(level.group)
            };
            let Some(pair) = group(value).zip(group(reference)) else { continue };
            if pairs.iter().all(|(other, _)| other.key.environment != pair.0.key.environment) {
                pairs.push(pair);
            }
        }
        pairs
    }
}

/// `n = 3: +0.02 [-0.05, +0.08] in 2 environments; ...`, and which values are no others than the `reference`.
fn evidence(effects: &[(String, Effect)], repeats: &[String], reference: &str) -> String {
    if effects.is_empty() && repeats.is_empty() {
        return "no two variants of TEACH differ in this setting alone".to_owned();
    }
    let tested = |(value, effect): &(String, Effect)| match (effect.difference, effect.interval) {
        (Some(difference), Some((low, high))) => {
            let environments = effect.environments.len();
            format!("{value}: {difference:+.2} [{low:+.2}, {high:+.2}] in {environments} environments")
        }
        _ => format!("{value}: no environment with {FEWEST_PAIRS} seeds of both"),
    };
    let repeated = |value: &String| format!("{value}: the same runs as {reference}, not tested");
    effects.iter().map(tested).chain(repeats.iter().map(repeated)).collect::<Vec<_>>().join("; ")
}
