//! What teachers that watched a student would have done, beside the one that acted: how far they agree, and
//! what each of them wanted where the student's success was measured.

pub mod agreement;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rayon::prelude::*;

use crate::analysis::frontier::FrontierFiles;
use crate::analysis::heat::third;
use crate::schema::{Beliefs, Frontier, RunKey, ShadowNote, Shadowing, Teaching};
use crate::stats::{self, RankOrder};
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
    /// Rank correlation of its weights with those of the teacher that acted; `None` where one of them has
    /// none, or makes no difference between goals.
    pub correlation: Option<f64>,
    /// Overlap of the goals that the two want most; `None` where one of them has no weights.
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
            let end = run.records.last().map_or(0, |record| record.step);
            let watched =
                WatchedRun::of(&run.key().curriculum, end, &teaching, &lines, frontiers.of_run(run));
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
    /// Of the run in which `own` acted, as it tells in `teaching`, up to step `end`: its shadows' `lines` and
    /// its `measures`, all by rising evaluation.
    pub fn of(
        own: &str,
        end: u64,
        teaching: &[Teaching],
        lines: &[Shadowing],
        measures: &[Frontier],
    ) -> Self {
        let ids = lines.first().into_iter().flat_map(|line| &line.shadows).map(|note| note.id.clone());
        let mut run = Self { teachers: [own.to_owned()].into_iter().chain(ids).collect(), ..Self::default() };
        let acting: BTreeMap<u64, &Teaching> = teaching.iter().map(|line| (line.eval_index, line)).collect();
        let measured: BTreeSet<u64> = measures.iter().map(|measure| measure.eval_index).collect();
        let goals = measures.iter().find_map(|measure| measure.goals.as_deref());
        let mut sums = agreement::Sums::of(run.teachers.len());
        for line in lines.iter().filter(|line| line.shadows.len() + 1 == run.teachers.len()) {
            let own = acting.get(&line.eval_index).copied();
            let of_own = own.and_then(|line| line.weights.as_deref());
            let weights = [of_own].into_iter().chain(line.shadows.iter().map(|note| note.weights.as_deref()));
            let orders: Vec<Option<RankOrder>> = weights.map(|weights| Some(order(weights?))).collect();
            let size = |order: &Option<RankOrder>| order.as_ref().map(RankOrder::len);
            let orders_fit = orders.iter().filter_map(size).collect::<BTreeSet<_>>().len() <= 1;
            let orders = if orders_fit { orders } else { vec![None; run.teachers.len()] };
            // Nobody has learned anything yet at step 0.
            if line.step > 0 {
                sums.add(third(line.step, end), &orders);
            }
            for (teacher, note) in (1..).zip(&line.shadows) {
                run.notes.push(shadow_line(line, teacher, note, &orders));
                if let Some(reason) = &note.failed {
                    run.failed.entry(note.id.clone()).or_insert_with(|| reason.clone());
                }
            }
            if measured.contains(&line.eval_index) {
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

fn order(weights: &[f32]) -> RankOrder {
    let weights: Vec<f64> = weights.iter().map(|&weight| f64::from(weight)).collect();
    stats::RankOrder::of(&weights, TOP)
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

/// The one of `goals` that is nearest to `goal`; the first of several.
fn nearest(goals: &[Vec<f32>], goal: &[f32]) -> Option<u32> {
    let apart = |other: &Vec<f32>| -> f32 { other.iter().zip(goal).map(|(a, b)| (a - b) * (a - b)).sum() };
    let found = goals.iter().map(apart).enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
    found.and_then(|(index, _)| u32::try_from(index).ok())
}
