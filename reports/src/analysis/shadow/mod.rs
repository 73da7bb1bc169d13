//! What teachers that watched a student would have done, beside the one that acted: how far they agree, and
//! what each of them wanted where the student's success was measured.

pub mod agreement;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rayon::prelude::*;

use crate::analysis::frontier::FrontierFiles;
use crate::analysis::parts::{budget, third_of};
use crate::schema::{Beliefs, Frontier, RunKey, ShadowNote, Shadowing, Teaching};
use crate::stats::RankOrder;
use crate::store::problem::StoreProblem;
use crate::store::{self, Run, Store};
use agreement::Agreement;

/// The goals that a teacher wants most: this share of the pool.
pub const TOP: f64 = 0.1;

/// What the runs' records of their shadows say.
#[derive(Debug, Default)]
pub struct ShadowFiles {
    /// Every run that was watched.
    pub runs: BTreeMap<RunKey, WatchedRun>,
    /// What is wrong with these files.
    pub problems: Vec<StoreProblem>,
}

/// What the teachers of a run wanted: the one that acted first, then its shadows in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WatchedRun {
    /// Their curriculum ids.
    pub teachers: Vec<String>,
    /// A line for every evaluation and every shadow.
    pub notes: Vec<ShadowLine>,
    /// How far every two of them agree, in each third of the run.
    pub agreement: Vec<Agreement>,
    /// What each of them wanted where the student was measured, by evaluation.
    pub measured: BTreeMap<u64, Vec<Wanted>>,
    /// Why shadows fell silent, by id.
    pub failed: BTreeMap<String, String>,
}

/// A shadow at an evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowLine {
    /// Which evaluation, and after how many training steps.
    pub eval_index: u64,
    /// Training steps so far.
    pub step: u64,
    /// Its place among the run's teachers.
    pub teacher: usize,
    /// Proposals since the evaluation before, and those of them that were not of the pool.
    pub proposals: (u64, u64),
    /// Different goals of the pool among them.
    pub goals: u64,
    /// Rank correlation of its order of the pool with that of the teacher that acted; `None` where one of
    /// them has none, or makes no difference between goals.
    pub correlation: Option<f64>,
    /// Overlap of the goals that the two want most; `None` where one of them has no order.
    pub overlap: Option<f64>,
    /// Whether it had fallen silent.
    pub silent: bool,
}

/// What a teacher wanted at some moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Its probability of every goal of the pool, `[N]`.
    pub weights: Option<Vec<f32>>,
    /// Goals of the pool that it proposed since the evaluation before, or that were nearest to those, and how
    /// often.
    pub picks: Vec<(u32, u32)>,
    /// What it believed of every goal of the pool, if it tells; of the one that acted, the measure tells.
    pub beliefs: Option<Beliefs>,
}

impl ShadowFiles {
    /// Those of all runs of `store`, which lies in the folder `results` and has these `frontiers`. They are
    /// read run by run, and what is not needed any more is let go: all of it together would not be small.
    pub fn of(results: &Path, store: &Store, frontiers: &FrontierFiles) -> Self {
        let read = |run: &Run| {
            let (lines, mut problems) = store::shadowing(results, run);
            if lines.is_empty() {
                return (None, problems);
            }
            let (teaching, of_teaching) = store::teaching(results, run);
            problems.extend(of_teaching);
            let own = (run.key().curriculum.as_str(), budget(run));
            let watched = WatchedRun::of(own, &teaching, &lines, frontiers.of_run(run));
            (Some((run.key().clone(), watched)), problems)
        };
        let read: Vec<_> = store.runs().par_iter().map(read).collect();
        let mut files = Self::default();
        for (watched, problems) in read {
            files.runs.extend(watched);
            files.problems.extend(problems);
        }
        files
    }

    /// What one run's teachers wanted; `None` of a run that nobody watched.
    pub fn of_run(&self, run: &Run) -> Option<&WatchedRun> {
        self.runs.get(run.key())
    }
}

impl WatchedRun {
    /// Of the run of this `budget` in which `own` acted, as it tells in `teaching`: its shadows' `lines` and
    /// its `measures`, all by rising evaluation.
    pub fn of(
        (own, budget): (&str, u64),
        teaching: &[Teaching],
        lines: &[Shadowing],
        measures: &[Frontier],
    ) -> Self {
        let ids = lines.first().into_iter().flat_map(|line| &line.shadows).map(|note| note.id.clone());
        let mut run = Self { teachers: [own.to_owned()].into_iter().chain(ids).collect(), ..Self::default() };
        let acting: BTreeMap<u64, &Teaching> = teaching.iter().map(|line| (line.eval_index, line)).collect();
        let measured: BTreeMap<u64, &Frontier> =
            measures.iter().map(|measure| (measure.eval_index, measure)).collect();
        let goals = measures.iter().find_map(|measure| measure.goals.as_deref());
        let mut sums = agreement::Sums::of(run.teachers.len());
        for line in lines.iter().filter(|line| line.shadows.len() + 1 == run.teachers.len()) {
            let own = acting.get(&line.eval_index).copied();
            let measure = measured.get(&line.eval_index).copied();
            let of_own = order(
                own.and_then(|line| line.weights.as_deref()),
                measure.and_then(|measure| measure.beliefs.as_ref()),
            );
            let of_shadow = |note: &ShadowNote| order(note.weights.as_deref(), note.beliefs.as_ref());
            let orders: Vec<Option<RankOrder>> =
                [of_own].into_iter().chain(line.shadows.iter().map(of_shadow)).collect();
            let size = |order: &Option<RankOrder>| order.as_ref().map(RankOrder::len);
            let orders_fit = orders.iter().filter_map(size).collect::<BTreeSet<_>>().len() <= 1;
            let orders = if orders_fit { orders } else { vec![None; run.teachers.len()] };
            // Nobody has learned anything yet at step 0.
            if line.step > 0 {
                sums.add(third_of(line.step, budget), &orders);
            }
            for (teacher, note) in (1..).zip(&line.shadows) {
                run.notes.push(shadow_line(line, teacher, note, &orders));
                if let Some(reason) = &note.failed {
                    run.failed.entry(note.id.clone()).or_insert_with(|| reason.clone());
                }
            }
            if measure.is_some() {
                let own = own.map(|line| wanted_by_own(line, goals.unwrap_or_default())).unwrap_or_default();
                let of_shadow = |note: &ShadowNote| Wanted {
                    weights: note.weights.clone(),
                    picks: note.picks.clone(),
                    beliefs: note.beliefs.clone(),
                };
                let shadows = line.shadows.iter().map(of_shadow);
                run.measured.insert(line.eval_index, [own].into_iter().chain(shadows).collect());
            }
        }
        run.agreement = sums.agreement();
        run
    }
}

/// The order in which a teacher wants the goals of the pool: that of its scores where it told one of every
/// goal, else that of its weights. Weights of teachers that take turns among a few goals, or that share a
/// weight among the goals of a region, differ for other reasons than what the teacher wants.
fn order(weights: Option<&[f32]>, beliefs: Option<&Beliefs>) -> Option<RankOrder> {
    let scores = beliefs.and_then(|beliefs| beliefs.scores.as_ref());
    let scores = scores.and_then(|scores| scores.iter().copied().collect::<Option<Vec<f32>>>());
    let values: Vec<f64> = scores.as_deref().or(weights)?.iter().map(|&value| f64::from(value)).collect();
    Some(RankOrder::of(&values, TOP))
}

fn shadow_line(
    line: &Shadowing,
    teacher: usize,
    note: &ShadowNote,
    orders: &[Option<RankOrder>],
) -> ShadowLine {
    let pair = || orders[0].as_ref().zip(orders[teacher].as_ref());
    ShadowLine {
        eval_index: line.eval_index,
        step: line.step,
        teacher,
        proposals: (note.picks.iter().map(|(_, times)| u64::from(*times)).sum(), note.elsewhere),
        goals: note.picks.len() as u64,
        correlation: pair().and_then(|(own, other)| own.correlation(other)),
        overlap: pair().and_then(|(own, other)| own.overlap(other)),
        silent: note.failed.is_some(),
    }
}

/// What the teacher that acts did, counted as its shadows' proposals are; `goals` are those of the pool,
/// `[N][G]`.
fn wanted_by_own(line: &Teaching, goals: &[Vec<f32>]) -> Wanted {
    let mut counts: BTreeMap<u32, u32> = BTreeMap::new();
    for (index, goal) in line.goals.iter().enumerate() {
        let picked = line.picks.as_ref().and_then(|picks| *picks.get(index)?);
        if let Some(pick) = picked.or_else(|| nearest(goals, goal)) {
            *counts.entry(pick).or_default() += 1;
        }
    }
    Wanted { weights: line.weights.clone(), picks: counts.into_iter().collect(), beliefs: None }
}

/// The one of `goals` that is nearest to `goal`; the first of several. Runs count their shadows' proposals by
/// the same rule, from the same numbers of single precision.
fn nearest(goals: &[Vec<f32>], goal: &[f32]) -> Option<u32> {
    let square = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)).powi(2);
    let apart = |other: &Vec<f32>| other.iter().zip(goal).map(square).sum::<f64>().sqrt();
    let found = goals.iter().map(apart).enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
    found.and_then(|(index, _)| u32::try_from(index).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_ordered_by_score_where_all_have_one_and_by_weight_elsewhere() {
        let scored = |scores: [Option<f32>; 3]| Beliefs { success: None, scores: Some(scores.to_vec()) };
        let weights = Some(&[0.5, 0.25, 0.25][..]);
        let expected = |values: [f64; 3]| Some(RankOrder::of(&values, TOP));
        let scores = scored([Some(0.0), Some(1.0), Some(2.0)]);
        assert_eq!(order(weights, Some(&scores)), expected([0.0, 1.0, 2.0]));
        assert_eq!(order(None, Some(&scores)), expected([0.0, 1.0, 2.0]));
        let partly = scored([Some(0.0), None, Some(2.0)]);
        assert_eq!(order(weights, Some(&partly)), expected([0.5, 0.25, 0.25]));
        assert_eq!((order(weights, None), order(None, None)), (expected([0.5, 0.25, 0.25]), None));
        // Nothing is known yet: no order, whatever the weights are.
        let even = order(weights, Some(&scored([Some(0.0); 3]))).expect("an order");
        assert_eq!(even.correlation(&order(weights, None).expect("an order")), None);
    }

    /// Squares of 1,000,000.000001 and of 1,000,000 are the same in single precision.
    #[test]
    fn the_nearest_goal_is_found_in_double_precision() {
        assert_eq!(nearest(&[vec![1_000.0, 0.001], vec![1_000.0, 0.0]], &[0.0, 0.0]), Some(1));
        assert_eq!(nearest(&[vec![1.0], vec![1.0]], &[3.0]), Some(0), "the first of several");
        assert_eq!(nearest(&[], &[3.0]), None);
    }
}
