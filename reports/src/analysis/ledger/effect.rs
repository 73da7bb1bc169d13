//! The difference between two ways to train, over environments, from runs paired by seed.

use super::students;
use super::verdict::Interval;
use crate::analysis::catalogue::Measure;
use crate::analysis::complete::{self, Pair};
use crate::analysis::group;
use crate::analysis::options::ReportOptions;
use crate::analysis::scores;
use crate::schema::Record;
use crate::stats::{self, Resampling};
use crate::store::Run;
use crate::wording::{counted, is_or_are};

/// A mean difference of success rates and what it rests on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effect {
    /// Mean over environments of the mean paired difference; `None` without a pair.
    pub difference: Option<f64>,
    /// Two-sided p-value of the sign-flip test of no difference ([`stats::sign_flip`]), uncorrected.
    pub p: Option<f64>,
    /// The interval that inverts that test; `None` where there are too few pairs for one.
    pub interval: Interval,
    /// Probability of improvement within pairs: the share of pairs in which the first side is ahead, ties
    /// counting one half, mean over environments.
    pub improvement: Option<f64>,
    /// Two-sided p-value of the sign-flip test of the signs of the pairs, uncorrected.
    pub improvement_p: Option<f64>,
    /// Environments with a pair, with their pairs.
    pub places: Vec<PlaceEffect>,
    /// Pairs in all of them.
    pub pairs: usize,
    /// Runs that count nowhere, in all environments: not finished, or not evaluated at the steps of the
    /// others.
    pub left_out: usize,
    /// Runs that count although they failed, in all environments: 0 from their failure on.
    pub failed: usize,
    /// Pairs that do not count because a run of them failed and a failed run has no such measure, by
    /// environment: `MazeA (seed 3)`.
    pub unmeasured: Vec<String>,
    /// Environments that are not judged: no seed of both sides, or different students. With the reason.
    pub not_judged: Vec<String>,
}

/// What one environment says.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaceEffect {
    /// Environment id.
    pub environment: String,
    /// The difference of every pair, by seed. Shape: one number in [-1, 1] per pair; at least one.
    pub differences: Vec<f64>,
    /// Their mean.
    pub difference: f64,
}

impl PlaceEffect {
    fn of(environment: &str, differences: Vec<f64>) -> Option<Self> {
        let difference = stats::mean(&differences)?;
        Some(Self { environment: environment.to_owned(), differences, difference })
    }

    /// The interval of the sign-flip test of this environment alone.
    pub(super) fn interval(&self, resampling: Resampling) -> Interval {
        stats::sign_flip(&[&self.differences], resampling)?.interval
    }

    /// `MazeA (+0.23)`.
    pub(super) fn named(&self) -> String {
        format!("{} ({:+.2})", self.environment, self.difference)
    }

    /// -1, 0 or 1: which side is ahead here. A mean of rounding errors alone is neither.
    fn direction(&self) -> f64 {
        sign(self.difference)
    }
}

/// -1, 0 or 1. A difference of rounding errors alone is none.
pub(super) fn sign(difference: f64) -> f64 {
    if difference.abs() <= 1e-12 { 0.0 } else { difference.signum() }
}

pub(super) fn signs(differences: &[f64]) -> Vec<f64> {
    differences.iter().copied().map(sign).collect()
}

impl Effect {
    /// The effect over these environments.
    pub(super) fn over(places: Vec<PlaceEffect>, resampling: Resampling) -> Self {
        let strata: Vec<&[f64]> = places.iter().map(|place| place.differences.as_slice()).collect();
        let means: Vec<f64> = places.iter().map(|place| place.difference).collect();
        let signs: Vec<Vec<f64>> = strata.iter().map(|differences| signs(differences)).collect();
        let sign_means: Option<Vec<f64>> = signs.iter().map(|signs| stats::mean(signs)).collect();
        let signs: Vec<&[f64]> = signs.iter().map(Vec::as_slice).collect();
        let test = stats::sign_flip(&strata, resampling);
        Self {
            difference: stats::mean(&means),
            p: test.map(|test| test.p),
            interval: test.and_then(|test| test.interval),
            improvement: sign_means.and_then(|means| stats::mean(&means)).map(|mean| (1.0 + mean) / 2.0),
            improvement_p: stats::sign_flip(&signs, resampling).map(|test| test.p),
            pairs: strata.iter().map(|stratum| stratum.len()).sum(),
            places,
            ..Self::default()
        }
    }

    /// Ids of the environments with a pair.
    pub fn environments(&self) -> Vec<&str> {
        self.places.iter().map(|place| place.environment.as_str()).collect()
    }

    /// Environments where the mean difference is above 0.
    pub fn ahead(&self) -> usize {
        self.places.iter().filter(|place| place.direction() > 0.0).count()
    }

    /// Environments where it is below 0.
    pub fn behind(&self) -> usize {
        self.places.iter().filter(|place| place.direction() < 0.0).count()
    }

    /// Whether there are too few pairs for a verdict.
    pub(super) fn is_small(&self, options: &ReportOptions) -> bool {
        self.pairs < options.fewest_pairs
    }

    /// What to say where the claim cannot be tested, and why; `None` where it can.
    pub(super) fn lack(&self, options: &ReportOptions, resampling: Resampling) -> Option<String> {
        if self.pairs == 0 && self.unmeasured.is_empty() {
            return Some("no pair of runs with the same seed".to_owned());
        }
        if self.is_small(options) {
            let few = counted(self.pairs, "pair");
            return Some(format!(
                "too few seeds: {few} of runs, {} {} needed",
                options.fewest_pairs,
                is_or_are(options.fewest_pairs)
            ));
        }
        self.interval.is_none().then(|| {
            let lowest = stats::lowest_sign_flip_p(self.pairs, resampling);
            let level = 1.0 - resampling.confidence;
            format!(
                "too few seeds: p of {} cannot fall below {lowest:.4}, {level:.4} is needed",
                counted(self.pairs, "pair")
            )
        })
    }

    /// What a reader should know of the pairs: `; few pairs: MazeA (4, -0.80); 3 runs left out ...`, or
    /// nothing.
    pub(super) fn remark(&self, options: &ReportOptions) -> String {
        let few: Vec<&PlaceEffect> =
            self.places.iter().filter(|place| place.differences.len() < options.fewest_pairs).collect();
        let mut text = String::new();
        if few.len() == self.places.len() && few.len() > 1 {
            text += &format!("; fewer than {} in each environment", counted(options.fewest_pairs, "pair"));
        } else if !few.is_empty() {
            let named = |place: &&PlaceEffect| {
                format!("{} ({}, {:+.2})", place.environment, place.differences.len(), place.difference)
            };
            text += &format!("; few pairs: {}", few.iter().map(named).collect::<Vec<_>>().join(", "));
        }
        if self.pairs > stats::MOST_ENUMERATED {
            text += &format!("; p from {} random flips", options.resampling.resamples);
        }
        if !self.not_judged.is_empty() {
            text += &format!("; not judged: {}", self.not_judged.join(", "));
        }
        text += &match self.failed {
            0 => String::new(),
            1 => "; 1 failed run counts 0 from its failure on".to_owned(),
            k => format!("; {k} failed runs count 0 from their failure on"),
        };
        if !self.unmeasured.is_empty() {
            text += &format!("; no pair, for a run of it failed: {}", self.unmeasured.join(", "));
        }
        text + &match self.left_out {
            0 => String::new(),
            k => format!("; {} left out, not finished or with other evaluations", counted(k, "run")),
        }
    }
}

/// The effect of `a` against `b` over `pairs` of groups, one per environment. Runs of different students are
/// left out unless the options say otherwise.
pub(super) fn effect(
    pairs: &[Pair<'_>],
    measure: Measure,
    options: &ReportOptions,
    resampling: Resampling,
) -> Effect {
    let (mut places, mut unmeasured, mut not_judged) = (Vec::new(), Vec::new(), Vec::new());
    let mut failed = 0;
    for pair in pairs {
        let environment = &pair.a.key.environment;
        let unlike =
            if options.mixed_students { None } else { students::unlike(pair, &options.catalogue.paper) };
        if let Some(settings) = unlike {
            not_judged.push(format!("{environment} (different students: {settings})"));
            continue;
        }
        let broken = if counts_failed(measure) { Vec::new() } else { broken(pair) };
        if !broken.is_empty() {
            unmeasured.push(format!("{environment} ({})", of_seeds(&broken)));
        }
        match PlaceEffect::of(environment, differences(pair, measure, options)) {
            Some(place) => {
                places.push(place);
                failed += if counts_failed(measure) { pair.failed } else { 0 };
            }
            None if broken.is_empty() => not_judged.push(format!("{environment} (no seed of both)")),
            None => {}
        }
    }
    let left_out = pairs.iter().map(|pair| pair.left_out).sum();
    Effect { left_out, failed, unmeasured, not_judged, ..Effect::over(places, resampling) }
}

/// Whether a run that failed, and counts 0 from then on, has this measure. Its zeros do not change from one
/// to the next, so that it would be the least noisy of all.
fn counts_failed(measure: Measure) -> bool {
    measure != Measure::Noise
}

/// The seeds of the pairs in which a run failed.
fn broken(pair: &Pair<'_>) -> Vec<u64> {
    let failed = group::shared_seeds(&pair.a, &pair.b)
        .filter(|(a, b)| complete::is_completed(a) || complete::is_completed(b));
    failed.map(|(a, _)| a.key().seed).collect()
}

/// `seed 3`, `seeds 3, 5`.
fn of_seeds(seeds: &[u64]) -> String {
    let list = seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    format!("{} {list}", if seeds.len() == 1 { "seed" } else { "seeds" })
}

/// `a - b` for every seed that both have, as far as both have the measure.
fn differences(pair: &Pair<'_>, measure: Measure, options: &ReportOptions) -> Vec<f64> {
    let score = |run: &Run| match measure {
        Measure::Final => scores::final_score(&run.records, options.window),
        Measure::Area => scores::area_under_curve(&run.records),
        Measure::Noise if complete::is_completed(run) => None,
        Measure::Noise => noise(&run.records),
    };
    group::paired(&pair.a, &pair.b, score).into_iter().map(|(a, b)| a - b).collect()
}

/// Mean size of the change of the success rate from an evaluation to the next; `None` for fewer than two.
fn noise(records: &[Record]) -> Option<f64> {
    let changes: Vec<f64> =
        records.windows(2).map(|two| (two[1].success_rate - two[0].success_rate).abs()).collect();
    stats::mean(&changes)
}
