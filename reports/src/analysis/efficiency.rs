//! Sample efficiency over environments: the interquartile mean of all runs while they train (Agarwal et al.
//! 2021, "Deep RL at the Edge of the Statistical Precipice", section 4).

use rayon::prelude::*;

use crate::analysis::aggregate::{Shared, Stratum};
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::scores;
use crate::analysis::weighted;
use crate::stats::{self, Resampling};
use crate::store::Run;

/// Shares of the budget: 0, 0.05, ... 1.
const INTERVALS: u32 = 20;
/// Most resamples behind each band: it is read off a figure, and no verdict rests on it.
const MOST_RESAMPLES: usize = 2_000;

/// The sample-efficiency curve of a method over the shared environments.
#[derive(Clone, Debug, PartialEq)]
pub struct Efficiency<'a> {
    /// The method; the key's environment means nothing.
    pub method: &'a GroupKey,
    /// Shares in [0, 1] of the steps that all runs of an environment have taken.
    pub shares: Vec<f64>,
    /// Interquartile mean of the success rates of all runs at each share: of single evaluations, not
    /// smoothed.
    pub iqm: Vec<f64>,
    /// Pointwise stratified bootstrap intervals; `None` where an environment has one seed.
    pub intervals: Option<Vec<(f64, f64)>>,
}

/// The curves of the methods of `shared`, in order, over its environments and seeds. `groups` hold their
/// runs.
pub fn curves<'a>(groups: &[&Group<'_>], shared: &Shared<'a>, resampling: Resampling) -> Vec<Efficiency<'a>> {
    let shares: Vec<f64> = (0..=INTERVALS).map(|index| f64::from(index) / f64::from(INTERVALS)).collect();
    let resampling = Resampling { resamples: resampling.resamples.min(MOST_RESAMPLES), ..resampling };
    let curve = |(method, strata): &(&'a GroupKey, Vec<Stratum>)| {
        let weights = shared.weights(strata);
        // [environment][run][share]
        let rates: Option<Vec<Vec<Vec<f64>>>> = shared
            .environments
            .iter()
            .zip(strata)
            .map(|(environment, stratum)| {
                let is_it = |group: &&&Group<'_>| {
                    group.key.environment == *environment && group.key.cmp_method(method).is_eq()
                };
                let end = common_end(groups, environment);
                let counts = |run: &&&Run| stratum.by_seed.iter().any(|(seed, _)| *seed == run.key().seed);
                let runs = groups.iter().find(is_it)?.runs.iter().filter(counts);
                Some(runs.map(|run| rates_at(run, &shares, end)).collect())
            })
            .collect();
        let rates = rates?;
        let mut iqm = Vec::with_capacity(shares.len());
        let mut intervals: Option<Vec<(f64, f64)>> = Some(Vec::with_capacity(shares.len()));
        for index in 0..shares.len() {
            let at: Vec<Vec<f64>> =
                rates.iter().map(|runs| runs.iter().map(|rates| rates[index]).collect()).collect();
            let slices: Vec<&[f64]> = at.iter().map(Vec::as_slice).collect();
            let of_resample = |strata: &[Vec<f64>]| weighted::iqm(strata, weights.as_deref());
            iqm.push(of_resample(&at)?);
            let interval = stats::stratified_interval(&slices, of_resample, resampling);
            intervals = intervals.zip(interval).map(|(mut all, one)| {
                all.push(one);
                all
            });
        }
        Some(Efficiency { method, shares: shares.clone(), iqm, intervals })
    };
    shared.methods().par_iter().filter_map(curve).collect()
}

/// The last step that every run of an environment has reached.
fn common_end(groups: &[&Group<'_>], environment: &str) -> u64 {
    let runs =
        groups.iter().filter(|group| group.key.environment == environment).flat_map(|group| &group.runs);
    runs.filter_map(|run| run.records.last()).map(|record| record.step).min().unwrap_or(0)
}

/// The success rate of a run at each share of `end` steps, on the line between two evaluations; 0 before the
/// first one. Shape: one number per share.
fn rates_at(run: &Run, shares: &[f64], end: u64) -> Vec<f64> {
    let step = |share: &f64| (share * end as f64).round() as u64;
    shares.iter().map(|share| scores::rate_at(&run.records, step(share)).unwrap_or(0.0)).collect()
}
