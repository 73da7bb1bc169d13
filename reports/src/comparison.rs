//! Methods against each other, in each environment.

use crate::finals::Finals;
use crate::group::GroupKey;
use crate::stats::{self, Resampling, Welch};

/// Level of the tests whose power is reported.
pub const ALPHA: f64 = 0.05;
/// Power that the needed seeds are counted for.
pub const TARGET_POWER: f64 = 0.8;

/// The final scores of a method compared with those of the first method of its environment, in the order of tables:
/// TEACH where it was run. Differences are method minus reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison<'a> {
    /// Which method.
    pub method: &'a GroupKey,
    /// What it is compared with, in the same environment.
    pub reference: &'a GroupKey,
    /// Seeds of the method and of the reference.
    pub n: (usize, usize),
    /// Seeds that both have: runs of one seed share initial weights, goals and evaluation episodes.
    pub pairs: usize,
    /// Mean difference over those pairs; `None` without any.
    pub difference: Option<f64>,
    /// Paired bootstrap interval of it; `None` for fewer than two pairs.
    pub difference_ci: Option<(f64, f64)>,
    /// Probability that a random run of the method scores above one of the reference.
    pub probability_of_improvement: Option<f64>,
    /// Welch's test of equal means.
    pub welch: Option<Welch>,
    /// Its p-value by Holm's correction for all comparisons of the report.
    pub p_holm: Option<f64>,
    /// Cohen's d.
    pub effect_size: Option<f64>,
    /// Power to find an effect of that size with the seeds at hand (the fewer of both sides) at level [`ALPHA`].
    pub power: Option<f64>,
    /// Seeds on each side that would find it with a power of [`TARGET_POWER`].
    pub needed_seeds: Option<u64>,
}

/// Compares every method with the first one of its environment; `finals` come sorted by key.
pub fn comparisons<'a>(finals: &[&'a Finals], resampling: Resampling) -> Vec<Comparison<'a>> {
    let mut comparisons = Vec::new();
    for environment in finals.chunk_by(|a, b| a.key.environment == b.key.environment) {
        let (reference, methods) = (environment[0], &environment[1..]);
        comparisons.extend(methods.iter().map(|method| compare(method, reference, resampling)));
    }
    let tested: Vec<usize> = (0..comparisons.len()).filter(|&i| comparisons[i].welch.is_some()).collect();
    let p_values: Vec<f64> = tested.iter().filter_map(|&i| Some(comparisons[i].welch?.p)).collect();
    for (index, adjusted) in tested.into_iter().zip(stats::holm(&p_values)) {
        comparisons[index].p_holm = Some(adjusted);
    }
    comparisons
}

fn compare<'a>(method: &'a Finals, reference: &'a Finals, resampling: Resampling) -> Comparison<'a> {
    let (here, there) = (method.scores(), reference.scores());
    let pairs = method.pairs(reference);
    let differences: Vec<f64> = pairs.iter().map(|(a, b)| a - b).collect();
    let effect_size = stats::effect_size(&here, &there);
    let fewer = here.len().min(there.len()) as u64;
    Comparison {
        method: &method.key,
        reference: &reference.key,
        n: (here.len(), there.len()),
        pairs: pairs.len(),
        difference: stats::mean(&differences),
        difference_ci: stats::paired_interval(&pairs, resampling),
        probability_of_improvement: stats::probability_of_improvement(&[&here], &[&there]),
        welch: stats::welch(&here, &there),
        p_holm: None,
        effect_size,
        power: effect_size.and_then(|d| stats::power(d, fewer, ALPHA)),
        needed_seeds: effect_size.and_then(|d| stats::needed_seeds(d, ALPHA, TARGET_POWER)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finals(environment: &str, curriculum: &str, by_seed: &[(u64, f64)]) -> Finals {
        let key = GroupKey {
            environment: environment.into(),
            curriculum: curriculum.into(),
            variant: "default".into(),
        };
        Finals { key, by_seed: by_seed.to_vec() }
    }

    #[test]
    fn every_method_is_compared_with_the_first_of_its_environment() {
        let all = [
            finals("A", "teach", &[(0, 0.9), (1, 0.8), (2, 1.0)]),
            finals("A", "vds", &[(1, 0.2), (2, 0.5), (3, 0.4)]),
            finals("A", "her-iid", &[(0, 0.7), (1, 0.9)]),
            finals("B", "vds", &[(0, 0.5)]),
        ];
        let compared = comparisons(
            &all.iter().collect::<Vec<_>>(),
            Resampling { resamples: 100, ..Resampling::default() },
        );
        let names: Vec<(&str, &str)> = compared
            .iter()
            .map(|c| (c.method.curriculum.as_str(), c.reference.curriculum.as_str()))
            .collect();
        assert_eq!(names, [("vds", "teach"), ("her-iid", "teach")]);
        // Seeds 1 and 2: (0.2 - 0.8 + 0.5 - 1.0) / 2. No run of VDS is above any of TEACH.
        assert_eq!((compared[0].n, compared[0].pairs), ((3, 3), 2));
        assert!((compared[0].difference.unwrap() + 0.55).abs() < 1e-12);
        assert_eq!(compared[0].probability_of_improvement, Some(0.0));
        // Of six pairs, 0.7 wins none; 0.9 wins one and ties one.
        assert_eq!(compared[1].probability_of_improvement, Some(1.5 / 6.0));
        // Two tests: the smaller p-value is doubled.
        let p = compared.iter().map(|c| c.welch.unwrap().p).fold(f64::INFINITY, f64::min);
        assert!(compared.iter().any(|c| c.p_holm == Some(2.0 * p)));
    }
}
