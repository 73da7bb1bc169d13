//! Checks that a single line cannot show: ranges, keys, order, completeness.

use std::collections::BTreeMap;

use super::load::Loader;
use super::run_folder::JsonLine;
use crate::schema::{Learning, Outcome, Record, RunKey, Teaching, Timing};
use crate::store::layout;
use crate::store::problem::Fault;

/// A line that belongs to one evaluation.
trait OfEvaluation: JsonLine {
    /// Which evaluation.
    fn eval_index(&self) -> u64;

    /// The first thing about the line that rules it out of the files of `run`.
    fn misfit(&self, run: &RunKey) -> Option<Fault>;
}

/// The usable lines of the file of `T`, with their numbers, by rising evaluation and each evaluation once.
fn by_index<T: OfEvaluation>(loader: &mut Loader<'_>, run: &RunKey) -> BTreeMap<u64, (usize, T)> {
    let mut kept: BTreeMap<u64, (usize, T)> = BTreeMap::new();
    for (line, value) in loader.lines::<T>() {
        let eval_index = value.eval_index();
        let again = || kept.get(&eval_index).map(|(first, _)| Fault::Duplicate { eval_index, first: *first });
        match value.misfit(run).or_else(again) {
            Some(fault) => loader.fault(T::FILE, Some(line), fault),
            None => {
                kept.insert(eval_index, (line, value));
            }
        }
    }
    kept
}

fn values<T>(by_index: BTreeMap<u64, (usize, T)>) -> Vec<T> {
    by_index.into_values().map(|(_, value)| value).collect()
}

/// The usable timings of `records`, by rising evaluation: one that stands at another step than its
/// evaluation, or before the timing of the evaluation before it, is none. An ended run has one for every
/// evaluation.
pub(super) fn timings(
    loader: &mut Loader<'_>,
    run: &RunKey,
    records: &[Record],
    has_ended: bool,
) -> Vec<Timing> {
    let mut kept: Vec<Timing> = Vec::with_capacity(records.len());
    let mut found = by_index::<Timing>(loader, run);
    let lacks = |record: &&Record| has_ended && !found.contains_key(&record.eval_index);
    let lacking: Vec<u64> = records.iter().filter(lacks).map(|record| record.eval_index).collect();
    for gap in lacking.chunk_by(|a, b| a + 1 == *b) {
        loader.fault(layout::TIMING, None, Fault::Gap { from: gap[0], to: gap[gap.len() - 1] });
    }
    for record in records {
        let Some((line, timing)) = found.remove(&record.eval_index) else { continue };
        let before = kept.last().map_or(0.0, |before| before.wall_s);
        let fault = if timing.step != record.step {
            range("step", timing.step, "the step of the same evaluation")
        } else if timing.wall_s < before {
            range("wall_s", timing.wall_s, "no less than at the evaluation before")
        } else {
            None
        };
        match fault {
            Some(fault) => loader.fault(layout::TIMING, Some(line), fault),
            None => kept.push(timing),
        }
    }
    kept
}

/// How the student's learning stood, as far as it can be used, by rising evaluation.
pub(super) fn learning(loader: &mut Loader<'_>, run: &RunKey) -> Vec<Learning> {
    values(by_index(loader, run))
}

/// What the teacher did, as far as it can be used, by rising evaluation.
pub(super) fn teaching(loader: &mut Loader<'_>, run: &RunKey) -> Vec<Teaching> {
    values(by_index(loader, run))
}

/// The usable evaluations, by rising index and step.
pub(super) fn records(loader: &mut Loader<'_>, run: &RunKey) -> Vec<Record> {
    let found = by_index::<Record>(loader, run);
    let mut kept: Vec<Record> = Vec::with_capacity(found.len());
    let mut expected = 0;
    for (eval_index, (line, record)) in found {
        if eval_index > expected {
            loader.fault(layout::RECORDS, Some(line), Fault::Gap { from: expected, to: eval_index - 1 });
        }
        expected = eval_index.saturating_add(1);
        match kept.last() {
            Some(before) if before.step >= record.step => {
                let fault = Fault::Order { eval_index, step: record.step, previous: before.step };
                loader.fault(layout::RECORDS, Some(line), fault);
            }
            _ => kept.push(record),
        }
    }
    kept
}

/// A number that is not what it must be.
fn range(field: &str, value: impl ToString, accepted: &'static str) -> Option<Fault> {
    Some(Fault::Range { field: field.to_owned(), value: value.to_string(), accepted })
}

impl OfEvaluation for Record {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, run: &RunKey) -> Option<Fault> {
        let found = RunKey {
            environment: self.environment.clone(),
            curriculum: self.curriculum.clone(),
            variant: self.variant.clone(),
            seed: self.seed,
        };
        if found != *run {
            return Some(Fault::Foreign { found, expected: run.clone() });
        }
        if self.episodes == 0 {
            return range("episodes", 0, "at least 1");
        }
        let rates = [("success_rate", Some(self.success_rate)), ("any_success_rate", self.any_success_rate)];
        for (field, rate) in rates.into_iter().filter_map(|(field, rate)| Some((field, rate?))) {
            if !(0.0..=1.0).contains(&rate) {
                return range(field, rate, "a number in [0, 1]");
            }
            // Within rounding: shares are written with all digits they have.
            let successes = rate * self.episodes as f64;
            if (successes - successes.round()).abs() > 1e-6 {
                let value = format!("{rate} of {} episodes", self.episodes);
                return range(field, value, "a whole number of successes");
            }
        }
        if let Some(any) = self.any_success_rate.filter(|any| *any < self.success_rate) {
            return range("any_success_rate", any, "at least success_rate");
        }
        if !(self.mean_return.is_finite() && self.mean_return <= 0.0) {
            return range("mean_return", self.mean_return, "a number of at most 0");
        }
        if self.uncharged_steps > self.probe_steps {
            return range("uncharged_steps", self.uncharged_steps, "at most probe_steps");
        }
        if self.probe_steps - self.uncharged_steps > self.step {
            return range(
                "probe_steps",
                self.probe_steps,
                "at most step, but for those that are not charged",
            );
        }
        let (name, value) = self.teacher.iter().find(|(_, value)| !value.is_number() && !value.is_null())?;
        range(&format!("teacher.{name}"), value, "a number or null")
    }
}

impl OfEvaluation for Timing {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, _: &RunKey) -> Option<Fault> {
        let Self { wall_s, evaluation_s, teacher_s, learning_s, .. } = *self;
        if !(wall_s.is_finite() && wall_s >= 0.0) {
            return range("wall_s", wall_s, "a number of at least 0");
        }
        let parts =
            [("evaluation_s", Some(evaluation_s)), ("teacher_s", teacher_s), ("learning_s", learning_s)];
        let (field, value) = parts
            .into_iter()
            .filter_map(|(field, value)| Some((field, value?)))
            .find(|(_, value)| !(0.0..=wall_s).contains(value))?;
        range(field, value, "a number in [0, wall_s]")
    }
}

impl OfEvaluation for Learning {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, _: &RunKey) -> Option<Fault> {
        let Self { critic_loss, critic_gradient_norm, actor_gradient_norm, .. } = *self;
        let (field, value) = [
            ("critic_loss", critic_loss),
            ("critic_gradient_norm", critic_gradient_norm),
            ("actor_gradient_norm", actor_gradient_norm),
        ]
        .into_iter()
        .filter_map(|(field, value)| Some((field, value?)))
        .find(|(_, value)| *value < 0.0)?;
        range(field, value, "a number of at least 0")
    }
}

impl OfEvaluation for Teaching {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, _: &RunKey) -> Option<Fault> {
        let Self { goals, successes, weights, picks, scores, ranks, .. } = self;
        let lengths = [
            ("successes", Some(successes.len())),
            ("picks", picks.as_ref().map(Vec::len)),
            ("scores", scores.as_ref().map(Vec::len)),
            ("ranks", ranks.as_ref().map(Vec::len)),
        ];
        let mut given = lengths.into_iter().filter_map(|(field, length)| Some((field, length?)));
        if let Some((field, length)) = given.find(|(_, length)| *length != goals.len()) {
            return range(field, format!("{length} long"), "as many entries as goals");
        }
        let sound = |goal: &Vec<f32>| goal.len() == goals[0].len() && goal.iter().all(|x| x.is_finite());
        if let Some(goal) = goals.iter().find(|goal| !sound(goal)) {
            return range("goals", format!("{goal:?}"), "goals of finite numbers, all of one length");
        }
        let weights = weights.as_deref()?;
        if let Some(weight) = weights.iter().find(|weight| !(0.0..=1.0).contains(*weight)) {
            return range("weights", weight, "numbers in [0, 1]");
        }
        let beyond = |pick: &&u32| **pick as usize >= weights.len();
        let pick = picks.iter().flatten().flatten().find(beyond)?;
        range("picks", pick, "indices below the number of weights")
    }
}

/// What is to be said of a run that has ended: that it failed, and that its last evaluation lies behind its
/// end.
pub(super) fn outcome(outcome: &Outcome, last_step: Option<u64>) -> Vec<Fault> {
    let (Outcome::Finished { step: end } | Outcome::Failed { step: end, .. }) = *outcome;
    let after = last_step.filter(|&step| step > end).map(|step| Fault::AfterEnd { step, end });
    let failed = match outcome {
        Outcome::Finished { .. } => None,
        Outcome::Failed { step, reason } => Some(Fault::Failed { step: *step, reason: reason.clone() }),
    };
    after.into_iter().chain(failed).collect()
}
