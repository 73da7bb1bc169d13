//! Sample efficiency over environments: the interquartile mean of all runs while they train (Agarwal et al.
//! 2021, "Deep RL at the Edge of the Statistical Precipice", section 4).

use rayon::prelude::*;

use crate::analysis::group::{Group, GroupKey};
use crate::analysis::scores;
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
    /// Interquartile mean of the running scores of all runs at each share.
    pub iqm: Vec<f64>,
    /// Pointwise stratified bootstrap intervals; `None` where an environment has one seed.
    pub intervals: Option<Vec<(f64, f64)>>,
}

/// The curves of all methods, in order. `groups` are those that are compared, sorted by key; only
/// `environments` count, which every method has.
pub fn curves<'a>(
    groups: &[&'a Group<'_>],
    environments: &[&str],
    window: usize,
    resampling: Resampling,
) -> Vec<Efficiency<'a>> {
    let shared: Vec<&Group<'_>> = groups
        .iter()
        .copied()
        .filter(|group| environments.contains(&group.key.environment.as_str()))
        .collect();
    let mut methods: Vec<&GroupKey> = shared.iter().map(|group| &group.key).collect();
    methods.sort_by(|a, b| a.cmp_method(b));
    methods.dedup_by(|a, b| a.cmp_method(b).is_eq());
    let shares: Vec<f64> = (0..=INTERVALS).map(|index| f64::from(index) / f64::from(INTERVALS)).collect();
    let resampling = Resampling { resamples: resampling.resamples.min(MOST_RESAMPLES), ..resampling };

    let curve = |method: &&'a GroupKey| {
        let of_method = shared.iter().filter(|group| group.key.cmp_method(method).is_eq());
        // [environment][run][share]
        let strata: Vec<Vec<Vec<f64>>> = of_method
            .map(|group| {
                let end = common_end(&shared, &group.key.environment);
                group.runs.iter().map(|run| scores_at(run, &shares, end, window)).collect()
            })
            .collect();
        let mut iqm = Vec::with_capacity(shares.len());
        let mut intervals: Option<Vec<(f64, f64)>> = Some(Vec::with_capacity(shares.len()));
        for index in 0..shares.len() {
            let at: Vec<Vec<f64>> =
                strata.iter().map(|runs| runs.iter().map(|scores| scores[index]).collect()).collect();
            let slices: Vec<&[f64]> = at.iter().map(Vec::as_slice).collect();
            iqm.push(stats::iqm(&at.concat())?);
            let of_resample = |strata: &[Vec<f64>]| stats::iqm(&strata.concat());
            let interval = stats::stratified_interval(&slices, of_resample, resampling);
            intervals = intervals.zip(interval).map(|(mut all, one)| {
                all.push(one);
                all
            });
        }
        Some(Efficiency { method, shares: shares.clone(), iqm, intervals })
    };
    methods.par_iter().filter_map(curve).collect()
}

/// The last step that every run of an environment has reached.
fn common_end(groups: &[&Group<'_>], environment: &str) -> u64 {
    let runs =
        groups.iter().filter(|group| group.key.environment == environment).flat_map(|group| &group.runs);
    runs.filter_map(|run| run.records.last()).map(|record| record.step).min().unwrap_or(0)
}

/// The running score of a run at each share of `end` steps: that of the last evaluation up to there. Shape:
/// one number per share; 0 before the first evaluation.
fn scores_at(run: &Run, shares: &[f64], end: u64, window: usize) -> Vec<f64> {
    let scores = scores::running_scores(&run.records, window);
    let at = |share: &f64| {
        let step = (share * end as f64).round() as u64;
        let evaluations = run.records.partition_point(|record| record.step <= step);
        evaluations.checked_sub(1).map_or(0.0, |last| scores[last])
    };
    shares.iter().map(at).collect()
}
