//! Methods against each other, in each environment.

use crate::analysis::complete::Pair;
use crate::analysis::finals::Finals;
use crate::analysis::group::{self, Group, GroupKey};
use crate::stats::{self, Resampling, SignFlip, Welch};

/// Level that the tests of a family keep together.
pub const ALPHA: f64 = 0.05;
/// Power that the needed seeds are counted for.
pub const TARGET_POWER: f64 = 0.8;

/// Which question a comparison belongs to. The p-values of each are corrected on their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TestFamily {
    /// Methods against the first method of their environment, in the order of tables.
    Methods,
    /// Variants of a method against its default in the same environment.
    Variants,
}

impl TestFamily {
    /// In lower case.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Methods => "methods",
            Self::Variants => "variants",
        }
    }
}

/// The final scores of a method compared with those of its reference, from their comparable runs. Differences
/// are method minus reference.
///
/// Welch's test leaves aside that runs of one seed share their start, and so it also uses seeds that only one
/// side has; where pairs go together it errs to the safe side. The sign-flip test uses the pairs and assumes
/// nothing about how scores are distributed, but is silent for few of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison<'a> {
    /// What it belongs to.
    pub family: TestFamily,
    /// Which method.
    pub method: &'a GroupKey,
    /// What it is compared with, in the same environment.
    pub reference: &'a GroupKey,
    /// Comparable runs of the method and of the reference.
    pub n: (usize, usize),
    /// Runs of both that are not comparable: not finished, or not evaluated at the steps of the others.
    pub left_out: usize,
    /// Seeds that both have: runs of one seed share initial weights, goals and evaluation episodes.
    pub pairs: usize,
    /// Mean difference over those pairs; `None` without any.
    pub difference: Option<f64>,
    /// Paired bootstrap interval of it; `None` for fewer than two pairs.
    pub difference_ci: Option<(f64, f64)>,
    /// The sign-flip test of those pairs.
    pub sign_flip: Option<SignFlip>,
    /// Probability that a random run of the method scores above one of the reference.
    pub probability_of_improvement: Option<f64>,
    /// Welch's test of equal means.
    pub welch: Option<Welch>,
    /// Its p-value by Holm's correction for its family.
    pub p_holm: Option<f64>,
    /// Cohen's d.
    pub effect_size: Option<f64>,
    /// [`ALPHA`] over the number of tests of the family: the strictest level that Holm's correction asks for.
    pub level: f64,
    /// Power to find an effect of that size with the seeds at hand (the fewer of both sides) at `level`.
    pub power: Option<f64>,
    /// Seeds on each side that would find it at `level` with a power of [`TARGET_POWER`].
    pub needed_seeds: Option<u64>,
}

/// Compares every method with its reference; `groups` come sorted by key, and `compared` says which of them
/// stand for their method ([`group::compared`]). Variants whose runs are those of their reference are left
/// out.
pub fn comparisons<'a>(
    groups: &'a [Group<'_>],
    compared: &[bool],
    window: usize,
    resampling: Resampling,
) -> Vec<Comparison<'a>> {
    let mut comparisons = Vec::new();
    for index in 0..groups.len() {
        let Some((family, reference)) = reference(groups, compared, index) else { continue };
        let pair = Pair::of(&groups[index], reference);
        if !group::is_repeated(&pair.a, &pair.b) {
            let keys = (&groups[index].key, &reference.key);
            comparisons.push(compare(family, keys, &pair, window, resampling));
        }
    }
    for family in [TestFamily::Methods, TestFamily::Variants] {
        let is_tested = |one: &&mut Comparison<'_>| one.family == family && one.welch.is_some();
        let tested: Vec<&mut Comparison<'_>> = comparisons.iter_mut().filter(is_tested).collect();
        let level = ALPHA / tested.len().max(1) as f64;
        let p_values: Vec<f64> = tested.iter().filter_map(|one| Some(one.welch?.p)).collect();
        for (one, adjusted) in tested.into_iter().zip(stats::holm(&p_values)) {
            one.p_holm = Some(adjusted);
            one.level = level;
            one.power = one.effect_size.and_then(|d| stats::power(d, one.n.0.min(one.n.1) as u64, level));
            one.needed_seeds = one.effect_size.and_then(|d| stats::needed_seeds(d, level, TARGET_POWER));
        }
    }
    comparisons
}

/// What group `index` is compared with, and in which family; `None` for a reference itself.
fn reference<'a, 'b>(
    groups: &'a [Group<'b>],
    compared: &[bool],
    index: usize,
) -> Option<(TestFamily, &'a Group<'b>)> {
    let key = &groups[index].key;
    let here = |other: &Group<'_>| other.key.environment == key.environment;
    if compared[index] {
        let first = groups.iter().zip(compared).find(|(other, compared)| **compared && here(other))?.0;
        return (first.key != *key).then_some((TestFamily::Methods, first));
    }
    let default = |other: &&Group<'_>| {
        here(other) && other.key.curriculum == key.curriculum && other.key.variant == "default"
    };
    Some((TestFamily::Variants, groups.iter().find(default)?))
}

fn compare<'a>(
    family: TestFamily,
    (method, reference): (&'a GroupKey, &'a GroupKey),
    pair: &Pair<'_>,
    window: usize,
    resampling: Resampling,
) -> Comparison<'a> {
    let (ours, theirs) = (Finals::of(&pair.a, window), Finals::of(&pair.b, window));
    let (here, there, pairs) = (ours.scores(), theirs.scores(), ours.pairs(&theirs));
    let differences: Vec<f64> = pairs.iter().map(|(a, b)| a - b).collect();
    Comparison {
        family,
        method,
        reference,
        n: (here.len(), there.len()),
        left_out: pair.left_out,
        pairs: pairs.len(),
        difference: stats::mean(&differences),
        difference_ci: stats::paired_interval(&pairs, resampling),
        sign_flip: stats::sign_flip(&[&differences], resampling),
        probability_of_improvement: stats::probability_of_improvement(&[&here], &[&there]),
        welch: stats::welch(&here, &there),
        p_holm: None,
        effect_size: stats::effect_size(&here, &there),
        level: ALPHA,
        power: None,
        needed_seeds: None,
    }
}
