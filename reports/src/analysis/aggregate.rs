//! Methods summed up over environments (Agarwal et al. 2021, "Deep RL at the Edge of the Statistical
//! Precipice").

use crate::analysis::finals::Finals;
use crate::analysis::group::GroupKey;
use crate::analysis::weighted;
use crate::stats::{self, Resampling};

/// Final success rate that [`stats::optimality_gap`] is measured from.
pub const TARGET: f64 = 1.0;
/// Thresholds of performance profiles: 0, 0.025, ... 1.
const PROFILE_INTERVALS: u32 = 40;

/// Methods and the environments in which all of them have results, with the final scores there of the seeds
/// that all of them have.
///
/// Only there can methods be compared: a method that was run on easy environments alone would look good, and
/// so would one with most of its seeds in easy environments. A method that was run in few environments, or
/// with few seeds, would leave few to all others; see [`Shared::of`] for when it is left out instead.
#[derive(Clone, Debug)]
pub struct Shared<'a> {
    /// Environment ids, in order.
    pub environments: Vec<&'a str>,
    /// Seeds of each environment that all methods have. Where they have none in common all runs count there,
    /// those of each method together as much as those of any other. Shape: one list per environment.
    pub seeds: Vec<Vec<u64>>,
    /// Methods that lack so many environments or seeds that they are left out. The keys' environment means
    /// nothing.
    pub left_out: Vec<&'a GroupKey>,
    /// Every other method with its final scores, one stratum per environment. The key's environment means
    /// nothing.
    methods: Vec<(&'a GroupKey, Vec<Stratum>)>,
}

/// The final scores of a method in one environment.
#[derive(Clone, Debug, PartialEq)]
pub struct Stratum {
    /// (seed, final score), by rising seed.
    pub by_seed: Vec<(u64, f64)>,
    /// What each of them counts: 1 where methods share seeds.
    pub weight: f64,
    /// Those of them that failed, and count 0 from their failure on.
    pub failed: usize,
}

impl Stratum {
    fn scores(&self) -> Vec<f64> {
        self.by_seed.iter().map(|(_, score)| *score).collect()
    }
}

/// Methods are summed up over at least this many environments where that can be had.
pub const FEWEST_SHARED: usize = 2;

/// The final scores of a method in an environment.
pub(crate) fn finals_of<'a>(
    finals: &[&'a Finals],
    environment: &str,
    method: &GroupKey,
) -> Option<&'a Finals> {
    let is_it =
        |finals: &&&Finals| finals.key.environment == environment && finals.key.cmp_method(method).is_eq();
    finals.iter().find(is_it).copied()
}

/// A method over the shared environments.
#[derive(Clone, Debug, PartialEq)]
pub struct Aggregate<'a> {
    /// The method; the key's environment means nothing.
    pub method: &'a GroupKey,
    /// Runs in all environments that count.
    pub runs: usize,
    /// Those of them that failed, and count 0 from their failure on.
    pub failed: usize,
    /// Mean over environments of the mean over seeds.
    pub mean: f64,
    /// Interquartile mean of all runs.
    pub iqm: f64,
    /// Stratified bootstrap interval of it; `None` where an environment has one seed.
    pub iqm_ci: Option<(f64, f64)>,
    /// Optimality gap of all runs to [`TARGET`].
    pub optimality_gap: f64,
    /// Stratified bootstrap interval of it.
    pub optimality_gap_ci: Option<(f64, f64)>,
}

/// The performance profile of a method over the shared environments.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile<'a> {
    /// The method; the key's environment means nothing.
    pub method: &'a GroupKey,
    /// Final success rates in [0, 1], rising.
    pub thresholds: Vec<f64>,
    /// Share of runs above each of them ([`stats::performance_profile`]).
    pub shares: Vec<f64>,
    /// Pointwise stratified bootstrap intervals of the shares.
    pub intervals: Option<Vec<(f64, f64)>>,
}

impl<'a> Shared<'a> {
    /// Finds what the methods share; `finals` come sorted by key, those without scores count as absent.
    ///
    /// Methods are ranked by the number of their environments, then of their runs. Of all ways to keep the
    /// first k of them, k at least 2, the one with the most scores is taken (methods times the seeds that all
    /// k have in the environments that all have), among those that share [`FEWEST_SHARED`] environments if
    /// there is one; of equals the one with more methods.
    pub fn of(finals: impl IntoIterator<Item = &'a Finals>) -> Self {
        let finals: Vec<&'a Finals> =
            finals.into_iter().filter(|finals| !finals.by_seed.is_empty()).collect();
        let mut methods: Vec<&GroupKey> = finals.iter().map(|finals| &finals.key).collect();
        methods.sort_by(|a, b| a.cmp_method(b));
        methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
        let mut environments: Vec<&str> =
            finals.iter().map(|finals| finals.key.environment.as_str()).collect();
        environments.dedup();
        let find = |environment: &str, method: &GroupKey| finals_of(&finals, environment, method);
        let common = |methods: &[&GroupKey]| -> Vec<&'a str> {
            let has_all =
                |environment: &&&str| methods.iter().all(|method| find(environment, method).is_some());
            environments.iter().filter(has_all).copied().collect()
        };
        let seeds = |methods: &[&GroupKey], environment: &str| -> Vec<u64> {
            let mut of_each = methods.iter().filter_map(|method| find(environment, method));
            let Some(first) = of_each.next() else { return Vec::new() };
            let others: Vec<&Finals> = of_each.collect();
            let has = |other: &&Finals, seed: u64| other.by_seed.iter().any(|(has, _)| *has == seed);
            let first = first.by_seed.iter().map(|(seed, _)| *seed);
            first.filter(|&seed| others.iter().all(|other| has(other, seed))).collect()
        };
        let mut ranked = methods.clone();
        let runs = |method: &GroupKey| -> usize {
            let of_it = finals.iter().filter(|finals| finals.key.cmp_method(method).is_eq());
            of_it.map(|finals| finals.by_seed.len()).sum()
        };
        // Stable: of methods with equally many environments and runs the first come first.
        ranked.sort_by_key(|method| std::cmp::Reverse((common(&[*method]).len(), runs(method))));
        let worth = |count: &usize| {
            let kept = &ranked[..*count];
            let shared = common(kept);
            let scores: usize =
                shared.iter().map(|environment| seeds(kept, environment).len().max(1) * count).sum();
            (shared.len() >= FEWEST_SHARED, scores, *count)
        };
        let count = (2.min(ranked.len())..=ranked.len()).max_by_key(worth).unwrap_or(0);
        let environments = common(&ranked[..count]);
        let (kept, left_out): (Vec<&GroupKey>, Vec<&GroupKey>) =
            methods.into_iter().partition(|method| ranked[..count].contains(method));
        let seeds: Vec<Vec<u64>> = environments.iter().map(|environment| seeds(&kept, environment)).collect();
        let stratum = |method: &GroupKey, (environment, seeds): (&&str, &Vec<u64>)| {
            let finals = find(environment, method)?;
            let counts = |seed: &u64| seeds.is_empty() || seeds.contains(seed);
            let fewest =
                kept.iter().filter_map(|method| Some(find(environment, method)?.by_seed.len())).min();
            let by_seed: Vec<(u64, f64)> =
                finals.by_seed.iter().filter(|(seed, _)| counts(seed)).copied().collect();
            let weight = if seeds.is_empty() { fewest? as f64 / by_seed.len() as f64 } else { 1.0 };
            let failed = finals.failed.iter().filter(|seed| counts(seed)).count();
            Some(Stratum { by_seed, weight, failed })
        };
        let strata = |method: &GroupKey| {
            environments.iter().zip(&seeds).filter_map(|place| stratum(method, place)).collect()
        };
        let methods = kept.iter().map(|&method| (method, strata(method))).collect();
        Self { environments, seeds, left_out, methods }
    }

    /// Every method with its final scores, in order, one stratum per shared environment.
    pub fn methods(&self) -> &[(&'a GroupKey, Vec<Stratum>)] {
        &self.methods
    }

    /// Which seeds count, for captions: `the 7 seeds that all of them have in each`.
    pub fn said(&self) -> String {
        let counts = self.seeds.iter().map(Vec::len).filter(|&count| count > 0);
        let (fewest, most) = (counts.clone().min(), counts.max());
        let shared = match (fewest, most) {
            (Some(1), Some(1)) => "of the seed that all of them have in each".to_owned(),
            (Some(n), Some(most)) if n == most => format!("of the {n} seeds that all of them have in each"),
            (Some(n), Some(most)) => format!("of the {n} to {most} seeds that all of them have in each"),
            _ => String::new(),
        };
        let without: Vec<&str> = self
            .environments
            .iter()
            .zip(&self.seeds)
            .filter(|(_, seeds)| seeds.is_empty())
            .map(|(environment, _)| *environment)
            .collect();
        if without.is_empty() {
            return shared;
        }
        let all = "of all runs, weighted so that each method counts the same";
        match shared.as_str() {
            "" => all.to_owned(),
            _ => format!("{shared}, but in {} {all}, for they share no seed there", without.join(", ")),
        }
    }

    /// Fewest runs of a method in an environment.
    pub fn fewest_runs(&self) -> usize {
        self.strata().map(|stratum| stratum.by_seed.len()).min().unwrap_or(0)
    }

    /// Runs of all methods that count although they failed.
    pub fn failed(&self) -> usize {
        self.strata().map(|stratum| stratum.failed).sum()
    }

    /// What a run of each stratum of a method counts; `None` where methods share seeds in every environment,
    /// and all count the same.
    pub(crate) fn weights(&self, strata: &[Stratum]) -> Option<Vec<f64>> {
        let differ = self.seeds.iter().any(Vec::is_empty);
        differ.then(|| strata.iter().map(|stratum| stratum.weight).collect())
    }

    fn strata(&self) -> impl Iterator<Item = &Stratum> {
        self.methods.iter().flat_map(|(_, strata)| strata)
    }

    /// One aggregate per method, in order; none where nothing is shared.
    pub fn aggregates(&self, resampling: Resampling) -> Vec<Aggregate<'a>> {
        let aggregate = |(method, strata): &(&'a GroupKey, Vec<Stratum>)| {
            let weights = self.weights(strata);
            let scores: Vec<Vec<f64>> = strata.iter().map(Stratum::scores).collect();
            let slices: Vec<&[f64]> = scores.iter().map(Vec::as_slice).collect();
            let means: Option<Vec<f64>> = slices.iter().map(|scores| stats::mean(scores)).collect();
            let gap = |strata: &[Vec<f64>]| weighted::optimality_gap(strata, weights.as_deref(), TARGET);
            let iqm = |strata: &[Vec<f64>]| weighted::iqm(strata, weights.as_deref());
            Some(Aggregate {
                method,
                runs: scores.iter().map(Vec::len).sum(),
                failed: strata.iter().map(|stratum| stratum.failed).sum(),
                mean: stats::mean(&means?)?,
                iqm: iqm(&scores)?,
                iqm_ci: stats::stratified_interval(&slices, iqm, resampling),
                optimality_gap: gap(&scores)?,
                optimality_gap_ci: stats::stratified_interval(&slices, gap, resampling),
            })
        };
        self.methods.iter().filter_map(aggregate).collect()
    }

    /// One profile per method, in order; none where nothing is shared.
    pub fn profiles(&self, resampling: Resampling) -> Vec<Profile<'a>> {
        let threshold = |index: u32| f64::from(index) / f64::from(PROFILE_INTERVALS);
        let thresholds: Vec<f64> = (0..=PROFILE_INTERVALS).map(threshold).collect();
        let profile = |(method, strata): &(&'a GroupKey, Vec<Stratum>)| {
            // Every environment counts the same here, whatever its runs.
            let scores: Vec<Vec<f64>> = strata.iter().map(Stratum::scores).collect();
            let slices: Vec<&[f64]> = scores.iter().map(Vec::as_slice).collect();
            let shares = stats::performance_profile(&slices, &thresholds)?;
            let of_resample = |strata: &[Vec<f64>]| {
                let slices: Vec<&[f64]> = strata.iter().map(Vec::as_slice).collect();
                stats::performance_profile(&slices, &thresholds)
            };
            let intervals = stats::stratified_intervals(&slices, of_resample, resampling);
            Some(Profile { method, thresholds: thresholds.clone(), shares, intervals })
        };
        self.methods.iter().filter_map(profile).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    fn finals(environment: &str, curriculum: &str, scores: &[f64]) -> Finals {
        let key = GroupKey::new(&Catalogue::default(), environment, curriculum, "default");
        Finals { key, by_seed: (0..).zip(scores.iter().copied()).collect(), failed: Vec::new() }
    }

    #[test]
    fn only_environments_of_every_method_count() {
        let all = [
            finals("A", "first", &[0.2, 0.4]),
            finals("A", "second", &[0.5, 0.5]),
            finals("B", "first", &[1.0, 1.0]),
            finals("C", "first", &[0.6, 0.8]),
            finals("C", "second", &[0.1, 0.9]),
        ];
        let shared = Shared::of(&all);
        assert_eq!(shared.environments, ["A", "C"]);
        let aggregates = shared.aggregates(Resampling { resamples: 100, ..Resampling::default() });
        let methods: Vec<&str> = aggregates.iter().map(|a| a.method.curriculum.id.as_str()).collect();
        assert_eq!(methods, ["first", "second"]);
        // By hand, for the first: mean of 0.3 and 0.7; of 0.2, 0.4, 0.6, 0.8 the middle two; gap 1 - 0.5.
        assert!((aggregates[0].mean - 0.5).abs() < 1e-12);
        assert!((aggregates[0].iqm - 0.5).abs() < 1e-12);
        assert!((aggregates[0].optimality_gap - 0.5).abs() < 1e-12);
        let (low, high) = aggregates[0].iqm_ci.unwrap();
        assert!(low < 0.5 && 0.5 < high);
    }

    #[test]
    fn a_method_of_few_environments_is_left_out() {
        let in_all =
            |curriculum| ["A", "B", "C"].map(|environment| finals(environment, curriculum, &[0.2, 0.4]));
        let mut all = [in_all("first"), in_all("second"), in_all("third")].concat();
        all.push(finals("B", "fourth", &[0.9, 0.7]));
        // A run is there, but none that counts.
        all.push(finals("C", "fourth", &[]));
        let cut = |all: &[Finals]| {
            let mut all: Vec<&Finals> = all.iter().collect();
            all.sort_by(|a, b| a.key.cmp(&b.key));
            let shared = Shared::of(all);
            let left_out: Vec<&str> = shared.left_out.iter().map(|key| key.curriculum.id.as_str()).collect();
            (shared.environments.concat(), shared.methods.len(), left_out.join(" "))
        };
        // Three methods in three environments are more than four in one.
        assert_eq!(cut(&all), ("ABC".to_owned(), 3, "fourth".to_owned()));
        // Four in two are not fewer than three in three once there are five in two.
        all.push(finals("A", "fourth", &[0.9, 0.7]));
        assert_eq!(cut(&all), ("ABC".to_owned(), 3, "fourth".to_owned()));
        all.extend([finals("A", "other", &[0.1, 0.3]), finals("B", "other", &[0.1, 0.3])]);
        assert_eq!(cut(&all), ("AB".to_owned(), 5, String::new()));
    }

    #[test]
    fn only_seeds_of_every_method_count() {
        let by_seed = |environment: &str, curriculum: &str, by_seed: &[(u64, f64)]| Finals {
            by_seed: by_seed.to_vec(),
            ..finals(environment, curriculum, &[])
        };
        // The same scores seed by seed; the second lacks most of the hard environment, and so the bad scores.
        let easy = [(0, 0.9), (1, 0.8), (2, 1.0)];
        let hard = [(0, 0.1), (1, 0.0), (2, 0.2)];
        let all = [
            by_seed("A", "first", &easy),
            by_seed("A", "second", &easy),
            by_seed("B", "first", &hard),
            by_seed("B", "second", &hard[2..]),
        ];
        let shared = Shared::of(&all);
        assert_eq!(shared.seeds, [vec![0, 1, 2], vec![2]]);
        assert_eq!(shared.said(), "of the 1 to 3 seeds that all of them have in each");
        let resampling = Resampling { resamples: 50, ..Resampling::default() };
        let [first, second] = &shared.aggregates(resampling)[..] else { panic!("two methods") };
        assert_eq!(
            (first.mean, first.iqm, first.optimality_gap),
            (second.mean, second.iqm, second.optimality_gap)
        );
        assert_eq!((first.runs, second.runs), (4, 4));
        let profiles = shared.profiles(resampling);
        assert_eq!(profiles[0].shares, profiles[1].shares);
    }

    #[test]
    fn methods_without_a_seed_in_common_count_the_same() {
        let finals = |environment: &str, curriculum: &str, seeds: std::ops::Range<u64>, score: f64| Finals {
            by_seed: seeds.map(|seed| (seed, score)).collect(),
            ..finals(environment, curriculum, &[])
        };
        // Equal methods; in the hard environment one has runs of other seeds, and fewer.
        let all = [
            finals("A", "first", 0..4, 1.0),
            finals("A", "second", 0..4, 1.0),
            finals("B", "first", 0..6, 0.0),
            finals("B", "second", 10..12, 0.0),
        ];
        let shared = Shared::of(&all);
        let said = "of the 4 seeds that all of them have in each, but in B of all runs, weighted so that each \
                    method counts the same, for they share no seed there";
        assert_eq!(shared.said(), said);
        let [first, second] = &shared.aggregates(Resampling::default())[..] else { panic!("two methods") };
        assert_eq!((first.runs, second.runs), (10, 6));
        assert!(
            (first.iqm - second.iqm).abs() < 1e-12
                && (first.optimality_gap - second.optimality_gap).abs() < 1e-12
        );
        // Weights of 4 and 2: of six, 1.5 are cut off at each end; 0.5 at 0 and 2.5 at 1 are left.
        assert!((first.iqm - 2.5 / 3.0).abs() < 1e-12, "{}", first.iqm);
    }

    #[test]
    fn nothing_shared_gives_nothing() {
        let all = [finals("A", "first", &[0.2]), finals("B", "second", &[0.5])];
        let shared = Shared::of(&all);
        assert!(shared.environments.is_empty());
        assert_eq!(shared.aggregates(Resampling::default()), []);
        assert_eq!(shared.profiles(Resampling::default()), []);
    }
}
