//! Methods against each other, in each environment.

use std::collections::BTreeMap;

use crate::analysis::complete::Pair;
use crate::analysis::finals::Finals;
use crate::analysis::group::{self, Group, GroupKey};
use crate::analysis::options::ReportOptions;
use crate::analysis::paired::{self, PairedDifference};
use crate::analysis::pairing;
use crate::analysis::scores;
use crate::stats::{self, Ddof, SignFlip, Welch};
use crate::store::Run;

/// Level that the tests of a family keep together.
pub const ALPHA: f64 = 0.05;
/// Power at which a comparison finds what is called detectable.
pub const TARGET_POWER: f64 = 0.8;

/// Which question a comparison belongs to. The p-values of each are corrected on their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TestFamily {
    /// Methods against the first method of their environment, in the order of tables: each variant against
    /// the same variant of it, where that exists, otherwise against its default.
    Methods,
    /// Variants of a method against its default in the same environment: those that the method alone has, and
    /// those of the first method.
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
/// side has; where pairs go together it errs to the safe side. The sign-flip test uses the pairs; its null is
/// that the two runs of a pair are exchangeable. It is silent for few of them.
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
    /// Runs of both that failed, and count 0 from their failure on.
    pub failed: usize,
    /// Seeds that both have: runs of one seed share initial weights, goals and evaluation episodes.
    pub pairs: usize,
    /// Why runs of one seed count as no pairs, where one side comes from an archive that was made otherwise.
    pub unpaired: Option<String>,
    /// Mean difference over those pairs; `None` without any.
    pub difference: Option<f64>,
    /// Paired bootstrap interval of it; `None` for fewer than two pairs.
    pub difference_ci: Option<(f64, f64)>,
    /// The same pairs by the [area](scores::area_under_curve) under their learning curves.
    pub area: Option<PairedDifference>,
    /// The sign-flip test of those pairs.
    pub sign_flip: Option<SignFlip>,
    /// Probability of improvement within those pairs: the share in which the method is ahead, ties one half.
    pub improvement: Option<f64>,
    /// Two-sided p-value of the sign-flip test of their signs, uncorrected.
    pub improvement_p: Option<f64>,
    /// Probability that a random run of the method scores above one of the reference.
    pub probability_of_improvement: Option<f64>,
    /// Welch's test of equal means; `None` where neither side varies.
    pub welch: Option<Welch>,
    /// Its p-value by Holm's correction for its family; 1 where all scores of both sides are equal. Where
    /// neither side varies and they differ, that of the exact permutation test of all runs in its place.
    pub p_holm: Option<f64>,
    /// Cohen's d.
    pub effect_size: Option<f64>,
    /// [`ALPHA`] over the number of tests of the family: the strictest level that Holm's correction asks for.
    pub level: f64,
    /// The smallest true difference of success rates that Welch's test finds at `level` with a power of
    /// [`TARGET_POWER`], given the seeds at hand (the fewer of both sides) and their spread.
    pub detectable: Option<f64>,
    /// p-value where neither side varies and they differ, so that Welch's test has none: the most extreme
    /// difference that there can be, by the exact permutation test of all runs.
    pub without_spread: Option<f64>,
    /// What the tests cannot say, and why.
    pub note: Option<&'static str>,
}

impl Comparison<'_> {
    /// What the tests cannot say and why, in words.
    pub fn said(&self) -> Option<String> {
        let unpaired = self.unpaired.as_ref().map(|reason| format!("no pairs: {reason}"));
        let parts: Vec<String> = self.note.map(str::to_owned).into_iter().chain(unpaired).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// The p-value that Holm's method corrects. Scores that are all equal differ in nothing, so that it is 1.
    fn p(&self) -> Option<f64> {
        self.welch.map(|test| test.p).or((self.note == Some(TIED)).then_some(1.0)).or(self.without_spread)
    }
}

/// Note where all scores are equal.
const TIED: &str = "all final scores of both sides are equal";
/// Note where Welch's test has no answer.
const NO_SPREAD: &str =
    "final scores vary on neither side, so p (Holm) is that of the exact permutation test, not of Welch's";
/// Note on sides of fewer than two runs.
const TOO_FEW: &str = "fewer than two runs on a side";

/// Compares every method with its reference; `groups` come sorted by key, and `compared` says which of them
/// stand for their method ([`group::compared`]). Variants whose runs are those of their reference are left
/// out.
pub fn comparisons<'a>(
    groups: &'a [Group<'_>],
    compared: &[bool],
    options: &ReportOptions,
) -> Vec<Comparison<'a>> {
    let mut comparisons = Vec::new();
    for index in 0..groups.len() {
        let Some((family, reference)) = reference(groups, compared, index) else { continue };
        let pair = Pair::of(&groups[index], reference);
        // A setting that comes to the same in the method is no test of it. Methods that tie are a result.
        if family == TestFamily::Methods || !group::is_repeated(&pair.a, &pair.b) {
            let keys = (&groups[index].key, &reference.key);
            comparisons.push(compare(family, keys, &pair, options));
        }
    }
    for family in [TestFamily::Methods, TestFamily::Variants] {
        let is_tested = |one: &&mut Comparison<'_>| one.family == family && one.p().is_some();
        let tested: Vec<&mut Comparison<'_>> = comparisons.iter_mut().filter(is_tested).collect();
        let level = ALPHA / tested.len().max(1) as f64;
        let p_values: Vec<f64> = tested.iter().filter_map(|one| one.p()).collect();
        // A search of milliseconds, and most comparisons have the same number of seeds.
        let mut detectable: BTreeMap<u64, Option<f64>> = BTreeMap::new();
        for (one, adjusted) in tested.into_iter().zip(stats::holm(&p_values)) {
            one.p_holm = Some(adjusted);
            one.level = level;
            let seeds = one.n.0.min(one.n.1) as u64;
            let search = || stats::detectable_effect(seeds, level, TARGET_POWER);
            let d = *detectable.entry(seeds).or_insert_with(search);
            // In `detectable` stands the spread so far.
            one.detectable = one.detectable.zip(d).map(|(spread, d)| spread * d);
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
    let here = || {
        let all = groups.iter().zip(compared);
        all.filter(|(other, _)| other.key.environment == key.environment)
    };
    let of = |curriculum: &str, variant: &str| {
        let is_it = |other: &&Group<'_>| other.key.is_of(curriculum) && other.key.variant == variant;
        here().map(|(other, _)| other).find(is_it)
    };
    if compared[index] {
        let first = here().find(|(_, compared)| **compared)?.0;
        if first.key.curriculum != key.curriculum {
            let same = of(&first.key.curriculum.id, &key.variant);
            return Some((TestFamily::Methods, same.unwrap_or(first)));
        }
        if first.key == *key {
            return None;
        }
    }
    Some((TestFamily::Variants, of(&key.curriculum.id, "default").filter(|other| other.key != *key)?))
}

fn compare<'a>(
    family: TestFamily,
    (method, reference): (&'a GroupKey, &'a GroupKey),
    pair: &Pair<'_>,
    options: &ReportOptions,
) -> Comparison<'a> {
    let (ours, theirs) = (Finals::of(&pair.a, options.window), Finals::of(&pair.b, options.window));
    let unpaired = pairing::obstacle(&pair.a, &pair.b);
    let (here, there) = (ours.scores(), theirs.scores());
    let pairs = if unpaired.is_none() { paired::pairs(&ours.by_seed, &theirs.by_seed) } else { Vec::new() };
    let paired = PairedDifference::of(&pairs, options);
    let area = |run: &Run| scores::area_under_curve(&run.records);
    let areas = if unpaired.is_none() { group::paired(&pair.a, &pair.b, area) } else { Vec::new() };
    let wins: Vec<f64> = pairs.iter().map(|(a, b)| f64::from(i8::from(a > b) - i8::from(a < b))).collect();
    let welch = stats::welch(&here, &there);
    let is_tied = here.iter().chain(&there).all(|score| Some(score) == here.first());
    let note = match (welch, here.len().min(there.len())) {
        (Some(_), _) => None,
        (None, 0 | 1) => Some(TOO_FEW),
        (None, _) if is_tied => Some(TIED),
        (None, _) => Some(NO_SPREAD),
    };
    Comparison {
        family,
        method,
        reference,
        n: (here.len(), there.len()),
        left_out: pair.left_out,
        failed: pair.failed,
        pairs: pairs.len(),
        unpaired,
        difference: paired.map(|paired| paired.mean),
        difference_ci: paired.and_then(|paired| paired.interval),
        area: PairedDifference::of(&areas, options),
        sign_flip: paired.and_then(|paired| paired.sign_flip),
        improvement: stats::mean(&wins).map(|mean| (1.0 + mean) / 2.0),
        improvement_p: stats::sign_flip(&[&wins], options.resampling).map(|test| test.p),
        probability_of_improvement: stats::probability_of_improvement(&[&here], &[&there]),
        welch,
        p_holm: None,
        effect_size: stats::effect_size(&here, &there),
        level: ALPHA,
        detectable: spread(&here, &there),
        without_spread: (note == Some(NO_SPREAD)).then(|| separated_p(here.len(), there.len())),
        note,
    }
}

/// p of the exact permutation test where all scores of one side are equal, and all of the other are equal to
/// something else: of all ways to tell `n + m` runs apart only the one found is as extreme, and for sides of
/// one size the opposite one.
fn separated_p(n: usize, m: usize) -> f64 {
    let extreme = if n == m { 2.0 } else { 1.0 };
    extreme / stats::permutations(n.min(m), n.max(m))
}

/// The root mean square of both standard deviations; `None` where a side has fewer than two scores.
fn spread(a: &[f64], b: &[f64]) -> Option<f64> {
    let variance = |scores: &[f64]| Some(stats::std_dev(scores, Ddof::Sample)?.powi(2));
    Some(f64::midpoint(variance(a)?, variance(b)?).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_of_sides_without_spread_is_that_of_the_permutation_test() {
        for (n, m) in [(2, 2), (7, 7), (3, 7), (7, 3), (2, 5)] {
            let exact = stats::permutation(&vec![1.0; n], &vec![0.0; m]).unwrap().either;
            assert!((separated_p(n, m) - exact).abs() < 1e-12, "{n} and {m}: {exact}");
        }
    }
}
