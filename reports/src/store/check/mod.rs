//! Checks that a single line cannot show: ranges, keys, order, completeness.

mod beliefs;
mod shadow;

use std::collections::BTreeMap;

use crate::schema::{Frontier, Learning, Manifest, Outcome, Record, RunKey, Shadowing, Teaching, Timing};
use crate::store::layout;
use crate::store::limits::{self, Limits};
use crate::store::load::Loader;
use crate::store::problem::Fault;
use crate::store::run_folder::JsonLine;
use crate::wording::counted_u64;

/// A line that belongs to one evaluation.
trait OfEvaluation: JsonLine {
    /// Which evaluation.
    fn eval_index(&self) -> u64;

    /// The first thing about the line that rules it out of the files of `run`.
    fn misfit(&self, run: &RunKey, limits: &Limits) -> Option<Fault>;
}

/// The usable lines of the file of `T`, with their numbers, by rising evaluation and each evaluation once.
fn by_index<T: OfEvaluation>(loader: &mut Loader<'_>, manifest: &Manifest) -> BTreeMap<u64, (usize, T)> {
    let limits = Limits::of(manifest);
    let mut kept: BTreeMap<u64, (usize, T)> = BTreeMap::new();
    for (line, value) in loader.lines::<T>() {
        let eval_index = value.eval_index();
        let again = || kept.get(&eval_index).map(|(first, _)| Fault::Duplicate { eval_index, first: *first });
        match value.misfit(&manifest.run, &limits).or_else(again) {
            Some(fault) => loader.fault(T::FILE, Some(line), fault),
            None => {
                kept.insert(eval_index, (line, value));
            }
        }
    }
    kept
}

/// The usable timings of `records`, by rising evaluation: one that stands at another step than its
/// evaluation, or before the timing of the evaluation before it, is none. An ended run has one for every
/// evaluation.
pub(in crate::store) fn timings(
    loader: &mut Loader<'_>,
    manifest: &Manifest,
    records: &[Record],
    has_ended: bool,
) -> Vec<Timing> {
    let mut kept: Vec<Timing> = Vec::with_capacity(records.len());
    let mut found = by_index::<Timing>(loader, manifest);
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

/// How the student's learning stood beside `records`, as far as it can be used, by rising evaluation.
pub(in crate::store) fn learning(
    loader: &mut Loader<'_>,
    manifest: &Manifest,
    records: &[Record],
) -> Vec<Learning> {
    beside(loader, manifest, records, |line: &Learning| line.step)
}

/// The success at every goal of the pool beside `records`, as far as it can be used, by rising evaluation.
pub(in crate::store) fn frontier(
    loader: &mut Loader<'_>,
    manifest: &Manifest,
    records: &[Record],
) -> Vec<Frontier> {
    beside(loader, manifest, records, |line: &Frontier| line.step)
}

/// What the shadows did before `records`, as far as it can be used, by rising evaluation.
pub(in crate::store) fn shadowing(
    loader: &mut Loader<'_>,
    manifest: &Manifest,
    records: &[Record],
) -> Vec<Shadowing> {
    beside(loader, manifest, records, |line: &Shadowing| line.step)
}

/// What the teacher did before `records`, as far as it can be used, by rising evaluation.
pub(in crate::store) fn teaching(
    loader: &mut Loader<'_>,
    manifest: &Manifest,
    records: &[Record],
) -> Vec<Teaching> {
    beside(loader, manifest, records, |line: &Teaching| line.step)
}

/// The usable lines of the file of `T`, which tell of the same evaluations as `records`, at the same steps.
fn beside<T: OfEvaluation>(
    loader: &mut Loader<'_>,
    manifest: &Manifest,
    records: &[Record],
    step: impl Fn(&T) -> u64,
) -> Vec<T> {
    let recorded: BTreeMap<u64, u64> =
        records.iter().map(|record| (record.eval_index, record.step)).collect();
    let mut kept = Vec::new();
    for (line, value) in by_index::<T>(loader, manifest).into_values() {
        // Where the evaluation itself is not there, that is said of the records.
        let fits = recorded.get(&value.eval_index()).is_none_or(|&recorded| recorded == step(&value));
        match range("step", step(&value), "the step of the same evaluation") {
            Some(fault) if !fits => loader.fault(T::FILE, Some(line), fault),
            _ => kept.push(value),
        }
    }
    kept
}

/// The usable evaluations of the run of `manifest`, by rising index and step.
pub(in crate::store) fn records(loader: &mut Loader<'_>, manifest: &Manifest) -> Vec<Record> {
    let found = by_index::<Record>(loader, manifest);
    let limits = Limits::of(manifest);
    let first = limits::first_step(found.values().map(|(_, record)| record));
    let mut kept: Vec<Record> = Vec::with_capacity(found.len());
    let mut expected = 0;
    for (eval_index, (line, record)) in found {
        if eval_index > expected {
            loader.fault(layout::RECORDS, Some(line), Fault::Gap { from: expected, to: eval_index - 1 });
        }
        expected = eval_index.saturating_add(1);
        let order = |before: &Record| {
            let falls = before.step >= record.step;
            falls.then_some(Fault::Order { eval_index, step: record.step, previous: before.step })
        };
        match kept.last().and_then(order).or_else(|| beyond(&record, &limits, first)) {
            Some(fault) => loader.fault(layout::RECORDS, Some(line), fault),
            None => kept.push(record),
        }
    }
    kept
}

/// What `record` cannot be where training first led to an evaluation at step `first`.
fn beyond(record: &Record, limits: &Limits, first: Option<u64>) -> Option<Fault> {
    let first = first?;
    if record.mean_return < -(first as f64) {
        return range("mean_return", record.mean_return, "at least -1 for every step of an episode");
    }
    let beyond = limits.last_step(first).is_some_and(|last| record.step > last);
    if beyond { range("step", record.step, "a step within the budget") } else { None }
}

/// A number that is not what it must be.
fn range(field: &str, value: impl ToString, accepted: &'static str) -> Option<Fault> {
    Some(Fault::Range { field: field.to_owned(), value: value.to_string(), accepted })
}

impl OfEvaluation for Record {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, run: &RunKey, limits: &Limits) -> Option<Fault> {
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
        if limits.episodes.is_some_and(|episodes| episodes != self.episodes) {
            return range("episodes", self.episodes, "as many as the config says");
        }
        if limits.gradient_steps(self.step).is_some_and(|most| self.gradient_steps > most) {
            return range(
                "gradient_steps",
                self.gradient_steps,
                "no more than the config's updates per cycle",
            );
        }
        let rates = [("success_rate", Some(self.success_rate)), ("any_success_rate", self.any_success_rate)];
        for (field, rate) in rates.into_iter().filter_map(|(field, rate)| Some((field, rate?))) {
            if !(0.0..=1.0).contains(&rate) {
                return range(field, rate, "a number in [0, 1]");
            }
            // Within rounding: shares are written with all digits they have.
            let successes = rate * self.episodes as f64;
            if (successes - successes.round()).abs() > 1e-6 {
                let value = format!("{rate} of {}", counted_u64(self.episodes, "episode"));
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

    fn misfit(&self, _: &RunKey, _: &Limits) -> Option<Fault> {
        let Self { wall_s, evaluation_s, teacher_s, learning_s, shadow_s, .. } = *self;
        if !(wall_s.is_finite() && wall_s >= 0.0) {
            return range("wall_s", wall_s, "a number of at least 0");
        }
        let parts = [
            ("evaluation_s", Some(evaluation_s)),
            ("teacher_s", teacher_s),
            ("learning_s", learning_s),
            ("shadow_s", shadow_s),
        ];
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

    fn misfit(&self, _: &RunKey, _: &Limits) -> Option<Fault> {
        let Self { step, critic_loss, critic_gradient_norm, actor_gradient_norm, .. } = *self;
        let stored =
            [("replay_episodes", self.replay_episodes), ("replay_transitions", self.replay_transitions)];
        if let Some((field, value)) = stored.into_iter().find(|(_, value)| *value > step) {
            return range(field, value, "at most one for every training step");
        }
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

impl OfEvaluation for Frontier {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, _: &RunKey, limits: &Limits) -> Option<Fault> {
        let Self { episodes, ref successes, ref goals, ref weights, .. } = *self;
        if episodes == 0 {
            return range("episodes", 0, "at least 1");
        }
        if limits.frontier_episodes.is_some_and(|expected| expected != episodes) {
            return range("episodes", episodes, "as many as the config says");
        }
        let size = limits.goals.unwrap_or(successes.len() as u64);
        if successes.is_empty() || successes.len() as u64 != size {
            return range(
                "successes",
                format!("{} long", successes.len()),
                "an entry for every goal of the pool",
            );
        }
        if let Some(count) = successes.iter().find(|count| **count > episodes) {
            return range("successes", count, "at most as many as episodes");
        }
        let lengths = [("goals", goals.as_ref().map(Vec::len)), ("weights", weights.as_ref().map(Vec::len))];
        let mut given = lengths.into_iter().filter_map(|(field, length)| Some((field, length?)));
        if let Some((field, length)) = given.find(|(_, length)| *length != successes.len()) {
            return range(field, format!("{length} long"), "as many entries as successes");
        }
        if let Some(fault) = goals.as_deref().and_then(unsound_goal) {
            return Some(fault);
        }
        if let Some(weight) = weights.iter().flatten().find(|weight| !(0.0..=1.0).contains(*weight)) {
            return range("weights", weight, "numbers in [0, 1]");
        }
        let (field, value, accepted) = self.beliefs.as_ref().and_then(|own| beliefs::misfit(own, size))?;
        range(field, value, accepted)
    }
}

/// The first of `goals` that is none.
fn unsound_goal(goals: &[Vec<f32>]) -> Option<Fault> {
    let sound = |goal: &&Vec<f32>| goal.len() == goals[0].len() && goal.iter().all(|x| x.is_finite());
    let goal = goals.iter().find(|goal| !sound(goal))?;
    range("goals", format!("{goal:?}"), "goals of finite numbers, all of one length")
}

impl OfEvaluation for Teaching {
    fn eval_index(&self) -> u64 {
        self.eval_index
    }

    fn misfit(&self, _: &RunKey, _: &Limits) -> Option<Fault> {
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
        if let Some(fault) = unsound_goal(goals) {
            return Some(fault);
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

/// Why the run of `manifest` with these `records` cannot have ended as `outcome` says; `None` if it can.
pub(in crate::store) fn misfit(outcome: &Outcome, manifest: &Manifest, records: &[Record]) -> Option<String> {
    let limits = Limits::of(manifest);
    let last = records.last().map(|record| record.step);
    let most = limits::first_step(records.iter()).and_then(|first| limits.last_step(first));
    let told = match last {
        Some(last) => format!("the last evaluation is at step {last}"),
        None => "no evaluation is recorded".to_owned(),
    };
    match *outcome {
        Outcome::Finished { step } if last != Some(step) => {
            Some(format!("says that the run finished at step {step}, but {told}"))
        }
        Outcome::Finished { step } => limits.budget.filter(|&budget| step < budget).map(|budget| {
            format!(
                "says that the run finished at step {step}, but its budget is {}",
                counted_u64(budget, "step")
            )
        }),
        Outcome::Failed { step, .. } if last.is_some_and(|last| step < last) => {
            Some(format!("says that the run failed at step {step}, but {told}"))
        }
        Outcome::Failed { step, .. } => most
            .filter(|&most| step > most)
            .map(|_| format!("says that the run failed at step {step}, which is beyond its budget")),
    }
}
