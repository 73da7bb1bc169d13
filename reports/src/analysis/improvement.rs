//! Probability that the first method of a report scores above each other one, over the environments and seeds
//! that both have, a variant against the same variant.

use crate::analysis::aggregate::finals_of;
use crate::analysis::finals::Finals;
use crate::analysis::group::GroupKey;
use crate::analysis::paired;
use crate::stats::{self, Resampling};

/// The probability of improvement of one method on another (Agarwal et al. 2021, section 4).
#[derive(Clone, Debug, PartialEq)]
pub struct Improvement<'a> {
    /// The method that may be better; the key's environment means nothing.
    pub method: &'a GroupKey,
    /// The one it is compared with.
    pub other: &'a GroupKey,
    /// Environments that both have.
    pub environments: usize,
    /// Fewest runs of one of them in an environment.
    pub fewest_runs: usize,
    /// P(method > other) on the same environment, ties counting one half, averaged over environments.
    pub probability: f64,
    /// Bootstrap interval, stratified by method and environment; `None` where one has a single seed.
    pub interval: Option<(f64, f64)>,
}

/// The first method against each other one that shares an environment with it, in order; against a variant
/// the same variant of the first method, if that shares one, so that the setting itself makes no difference.
/// `finals` come sorted by key, those without scores count as absent.
pub fn improvements<'a>(finals: &[&'a Finals], resampling: Resampling) -> Vec<Improvement<'a>> {
    let finals: Vec<&'a Finals> =
        finals.iter().filter(|finals| !finals.by_seed.is_empty()).copied().collect();
    let mut methods: Vec<&'a GroupKey> = finals.iter().map(|finals| &finals.key).collect();
    methods.sort_by(|a, b| a.cmp_method(b));
    methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
    let Some((&first, others)) = methods.split_first() else { return Vec::new() };
    let against = |other: &&'a GroupKey| {
        let is_same =
            |method: &&&GroupKey| method.curriculum == first.curriculum && method.variant == other.variant;
        let same = methods.iter().find(is_same).filter(|_| other.curriculum != first.curriculum);
        let with_same = same.and_then(|same| improvement(&finals, same, other, resampling));
        with_same.or_else(|| improvement(&finals, first, other, resampling))
    };
    others.iter().filter_map(against).collect()
}

/// `method` against `other`; `None` if they share no environment.
fn improvement<'a>(
    finals: &[&'a Finals],
    method: &'a GroupKey,
    other: &'a GroupKey,
    resampling: Resampling,
) -> Option<Improvement<'a>> {
    let (ours, theirs): (Vec<Vec<f64>>, Vec<Vec<f64>>) = finals
        .iter()
        .filter(|finals| finals.key.cmp_method(method).is_eq())
        .filter_map(|ours| {
            let theirs = finals_of(finals, &ours.key.environment, other)?;
            let pairs = paired::pairs(&ours.by_seed, &theirs.by_seed);
            // Without a seed in common all runs count: within an environment that favours neither.
            Some(if pairs.is_empty() { (ours.scores(), theirs.scores()) } else { pairs.into_iter().unzip() })
        })
        .unzip();
    let environments = ours.len();
    let strata: Vec<&[f64]> = ours.iter().chain(&theirs).map(Vec::as_slice).collect();
    let probability = |strata: &[&[f64]]| {
        let (a, b) = strata.split_at(environments);
        stats::probability_of_improvement(a, b)
    };
    let of_resample = |strata: &[Vec<f64>]| {
        let slices: Vec<&[f64]> = strata.iter().map(Vec::as_slice).collect();
        probability(&slices)
    };
    Some(Improvement {
        method,
        other,
        environments,
        fewest_runs: strata.iter().map(|stratum| stratum.len()).min().unwrap_or(0),
        probability: probability(&strata)?,
        interval: stats::stratified_interval(&strata, of_resample, resampling),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    #[test]
    fn improvement_by_hand() {
        let finals = |environment: &str, curriculum: &str, scores: &[f64]| Finals {
            key: GroupKey::new(&Catalogue::default(), environment, curriculum, "default"),
            by_seed: (0..).zip(scores.iter().copied()).collect(),
            failed: Vec::new(),
        };
        // A: of four pairs three wins and a tie; B: one win of four.
        let all = [
            finals("A", "first", &[0.5, 0.9]),
            // What one of the two lacks does not count: a third seed here, or an environment.
            finals("A", "second", &[0.1, 0.5, 0.9]),
            finals("B", "first", &[0.2, 0.4]),
            finals("B", "second", &[0.3, 0.6]),
            finals("C", "first", &[1.0, 1.0]),
            finals("D", "second", &[]),
        ];
        let found = improvements(
            &all.iter().collect::<Vec<_>>(),
            Resampling { resamples: 200, ..Resampling::default() },
        );
        assert_eq!((found.len(), found[0].environments), (1, 2));
        assert!((found[0].probability - (3.5 / 4.0 + 1.0 / 4.0) / 2.0).abs() < 1e-12);
        let (low, high) = found[0].interval.unwrap();
        assert!(low < found[0].probability && found[0].probability < high);
    }

    #[test]
    fn a_variant_is_set_against_the_same_variant_of_the_first_method() {
        let finals = |curriculum: &str, variant: &str, score: f64| Finals {
            key: GroupKey::new(&Catalogue::default(), "A", curriculum, variant),
            by_seed: vec![(0, score), (1, score)],
            failed: Vec::new(),
        };
        let all = [
            finals("first", "default", 0.9),
            finals("first", "wide", 0.1),
            finals("second", "default", 0.5),
            finals("second", "deep", 0.5),
            finals("second", "wide", 0.5),
        ];
        let found = improvements(&all.iter().collect::<Vec<_>>(), Resampling::default());
        let said: Vec<String> = found
            .iter()
            .map(|one| format!("{}-{}: {}", one.method.variant, one.other.name(), one.probability))
            .collect();
        let expected = [
            "default-first (wide): 1",
            "default-second: 1",
            "default-second (deep): 1",
            "wide-second (wide): 0",
        ];
        assert_eq!(said, expected);
        assert!(found.iter().all(|one| one.fewest_runs == 2));
    }
}
