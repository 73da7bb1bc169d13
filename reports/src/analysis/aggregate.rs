//! Methods summed up over environments (Agarwal et al. 2021, "Deep RL at the Edge of the Statistical
//! Precipice").

use crate::analysis::finals::Finals;
use crate::analysis::group::GroupKey;
use crate::stats::{self, Resampling};

/// Final success rate that [`stats::optimality_gap`] is measured from.
pub const TARGET: f64 = 1.0;
/// Thresholds of performance profiles: 0, 0.025, ... 1.
const PROFILE_INTERVALS: u32 = 40;

/// Methods and the environments in which all of them have results, with the final scores there.
///
/// Only there can methods be compared: a method that was run on easy environments alone would look good. A
/// method that was run in few environments would leave few to all others; see [`Shared::of`] for when it is
/// left out instead.
#[derive(Clone, Debug)]
pub struct Shared<'a> {
    /// Environment ids, in order.
    pub environments: Vec<&'a str>,
    /// Methods that lack so many environments that they are left out. The keys' environment means nothing.
    pub left_out: Vec<&'a GroupKey>,
    /// Every other method with its final scores, one stratum per environment. The key's environment means
    /// nothing.
    methods: Vec<(&'a GroupKey, Vec<Vec<f64>>)>,
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
    /// Runs in all environments.
    pub runs: usize,
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
    /// Methods are ranked by the number of their environments. Of all ways to keep the first k of them, k at
    /// least 2, the one with the most scores is taken (methods times the environments that all k have), among
    /// those that share [`FEWEST_SHARED`] environments if there is one; of equals the one with more methods.
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
        let mut ranked = methods.clone();
        // Stable: of methods with equally many environments the first come first.
        ranked.sort_by_key(|method| std::cmp::Reverse(common(&[*method]).len()));
        let worth = |count: &usize| {
            let shared = common(&ranked[..*count]).len();
            (shared >= FEWEST_SHARED, shared * count, *count)
        };
        let count = (2.min(ranked.len())..=ranked.len()).max_by_key(worth).unwrap_or(0);
        let environments = common(&ranked[..count]);
        let (kept, left_out): (Vec<&GroupKey>, Vec<&GroupKey>) =
            methods.into_iter().partition(|method| ranked[..count].contains(method));
        let strata = |method: &GroupKey| {
            environments.iter().filter_map(|environment| Some(find(environment, method)?.scores())).collect()
        };
        let methods = kept.into_iter().map(|method| (method, strata(method))).collect();
        Self { environments, left_out, methods }
    }

    /// Every method with its final scores, in order. Shape: one stratum per shared environment, one score per
    /// seed.
    pub fn methods(&self) -> &[(&'a GroupKey, Vec<Vec<f64>>)] {
        &self.methods
    }

    /// One aggregate per method, in order; none where nothing is shared.
    pub fn aggregates(&self, resampling: Resampling) -> Vec<Aggregate<'a>> {
        let aggregate = |(method, strata): &(&'a GroupKey, Vec<Vec<f64>>)| {
            let slices: Vec<&[f64]> = strata.iter().map(Vec::as_slice).collect();
            let all = strata.concat();
            let means: Option<Vec<f64>> = slices.iter().map(|scores| stats::mean(scores)).collect();
            let gap = |strata: &[Vec<f64>]| stats::optimality_gap(&strata.concat(), TARGET);
            let iqm = |strata: &[Vec<f64>]| stats::iqm(&strata.concat());
            Some(Aggregate {
                method,
                runs: all.len(),
                mean: stats::mean(&means?)?,
                iqm: stats::iqm(&all)?,
                iqm_ci: stats::stratified_interval(&slices, iqm, resampling),
                optimality_gap: stats::optimality_gap(&all, TARGET)?,
                optimality_gap_ci: stats::stratified_interval(&slices, gap, resampling),
            })
        };
        self.methods.iter().filter_map(aggregate).collect()
    }

    /// One profile per method, in order; none where nothing is shared.
    pub fn profiles(&self, resampling: Resampling) -> Vec<Profile<'a>> {
        let threshold = |index: u32| f64::from(index) / f64::from(PROFILE_INTERVALS);
        let thresholds: Vec<f64> = (0..=PROFILE_INTERVALS).map(threshold).collect();
        let profile = |(method, strata): &(&'a GroupKey, Vec<Vec<f64>>)| {
            let slices: Vec<&[f64]> = strata.iter().map(Vec::as_slice).collect();
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
        Finals { key, by_seed: (0..).zip(scores.iter().copied()).collect() }
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
        all.push(finals("B", "fourth", &[0.9]));
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
        all.push(finals("A", "fourth", &[0.9]));
        assert_eq!(cut(&all), ("ABC".to_owned(), 3, "fourth".to_owned()));
        all.extend([finals("A", "other", &[0.1]), finals("B", "other", &[0.1])]);
        assert_eq!(cut(&all), ("AB".to_owned(), 5, String::new()));
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
