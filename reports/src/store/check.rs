//! Checks that a single line cannot show: ranges, keys, order, completeness.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::Run;
use crate::schema::{Outcome, Record, RunKey, Timing};
use crate::store::layout;
use crate::store::problem::{Fault, Problem};

/// The usable evaluations among the `(line, evaluation)` pairs of the file `path`, by rising index and step.
pub(super) fn records(
    lines: Vec<(usize, Record)>,
    run: &RunKey,
    path: &Path,
    problems: &mut Vec<Problem>,
) -> Vec<Record> {
    let mut fault = |line, fault| problems.push(Problem { path: path.to_owned(), line: Some(line), fault });
    let mut by_index: BTreeMap<u64, (usize, Record)> = BTreeMap::new();
    for (line, record) in lines {
        if let Some(wrong) = misfit(&record, run) {
            fault(line, wrong);
        } else if let Some((first, _)) = by_index.get(&record.eval_index) {
            fault(line, Fault::Duplicate { eval_index: record.eval_index, first: *first });
        } else {
            by_index.insert(record.eval_index, (line, record));
        }
    }
    let mut kept: Vec<Record> = Vec::with_capacity(by_index.len());
    let mut expected = 0;
    for (eval_index, (line, record)) in by_index {
        if eval_index > expected {
            fault(line, Fault::Gap { from: expected, to: eval_index - 1 });
        }
        expected = eval_index.saturating_add(1);
        match kept.last() {
            Some(before) if before.step >= record.step => {
                fault(line, Fault::Order { eval_index, step: record.step, previous: before.step });
            }
            _ => kept.push(record),
        }
    }
    kept
}

/// The first thing about a record that rules it out.
fn misfit(record: &Record, run: &RunKey) -> Option<Fault> {
    let range =
        |field: &str, value: String, accepted| Fault::Range { field: field.to_owned(), value, accepted };
    let found = RunKey {
        environment: record.environment.clone(),
        curriculum: record.curriculum.clone(),
        variant: record.variant.clone(),
        seed: record.seed,
    };
    if found != *run {
        return Some(Fault::Foreign { found, expected: run.clone() });
    }
    if record.episodes == 0 {
        return Some(range("episodes", "0".into(), "at least 1"));
    }
    let rates = [("success_rate", Some(record.success_rate)), ("any_success_rate", record.any_success_rate)];
    for (field, rate) in rates.into_iter().filter_map(|(field, rate)| Some((field, rate?))) {
        if !(0.0..=1.0).contains(&rate) {
            return Some(range(field, rate.to_string(), "a number in [0, 1]"));
        }
        // Within rounding: shares are written with all digits they have.
        let successes = rate * record.episodes as f64;
        if (successes - successes.round()).abs() > 1e-6 {
            let value = format!("{rate} of {} episodes", record.episodes);
            return Some(range(field, value, "a whole number of successes"));
        }
    }
    if let Some(any) = record.any_success_rate.filter(|any| *any < record.success_rate) {
        return Some(range("any_success_rate", any.to_string(), "at least success_rate"));
    }
    if !(record.mean_return.is_finite() && record.mean_return <= 0.0) {
        return Some(range("mean_return", record.mean_return.to_string(), "a number of at most 0"));
    }
    let (name, value) = record.teacher.iter().find(|(_, value)| !value.is_number() && !value.is_null())?;
    Some(range(&format!("teacher.{name}"), value.to_string(), "a number or null"))
}

/// The usable timings among the `(line, timing)` pairs of the file `path`, by rising index.
pub(super) fn timings(lines: Vec<(usize, Timing)>, path: &Path, problems: &mut Vec<Problem>) -> Vec<Timing> {
    let mut fault = |line, fault| problems.push(Problem { path: path.to_owned(), line: Some(line), fault });
    let mut by_index: BTreeMap<u64, (usize, Timing)> = BTreeMap::new();
    for (line, timing) in lines {
        let eval_index = timing.eval_index;
        if let Some(wrong) = impossible(&timing) {
            fault(line, wrong);
        } else if let Some((first, _)) = by_index.get(&eval_index) {
            fault(line, Fault::Duplicate { eval_index, first: *first });
        } else {
            by_index.insert(eval_index, (line, timing));
        }
    }
    by_index.into_values().map(|(_, timing)| timing).collect()
}

/// The first thing about a timing that rules it out.
fn impossible(timing: &Timing) -> Option<Fault> {
    let Timing { wall_s, evaluation_s, teacher_s, learning_s, .. } = *timing;
    let range = |field: &str, value: f64, accepted| {
        Some(Fault::Range { field: field.to_owned(), value: value.to_string(), accepted })
    };
    if !(wall_s.is_finite() && wall_s >= 0.0) {
        return range("wall_s", wall_s, "a number of at least 0");
    }
    let parts = [("evaluation_s", Some(evaluation_s)), ("teacher_s", teacher_s), ("learning_s", learning_s)];
    let (field, value) = parts
        .into_iter()
        .filter_map(|(field, value)| Some((field, value?)))
        .find(|(_, value)| !(0.0..=wall_s).contains(value))?;
    range(field, value, "a number in [0, wall_s]")
}

/// Names a failed run, and a run whose last evaluation lies behind its end.
pub(super) fn outcome(
    outcome: Option<&Outcome>,
    last_step: Option<u64>,
    path: &Path,
    problems: &mut Vec<Problem>,
) {
    let Some(outcome) = outcome else { return };
    let mut fault = |fault| problems.push(Problem { path: path.to_owned(), line: None, fault });
    let (Outcome::Finished { step: end } | Outcome::Failed { step: end, .. }) = *outcome;
    if let Some(step) = last_step.filter(|&step| step > end) {
        fault(Fault::AfterEnd { step, end });
    }
    if let Outcome::Failed { step, reason } = outcome {
        fault(Fault::Failed { step: *step, reason: reason.clone() });
    }
}

/// Names every run that is not configured like the first run of its curve (same environment, curriculum and
/// variant). `runs` come sorted by key.
pub(super) fn configs(runs: &[Run]) -> Vec<Problem> {
    let curve = |run: &Run| {
        let RunKey { environment, curriculum, variant, .. } = run.key().clone();
        (environment, curriculum, variant)
    };
    let mut problems = Vec::new();
    for group in runs.chunk_by(|a, b| curve(a) == curve(b)) {
        let first = &group[0];
        for run in &group[1..] {
            if let Some(pointer) = first_difference(&first.manifest.config, &run.manifest.config) {
                let path = layout::run_dir(Path::new(""), run.key()).join(layout::MANIFEST);
                let fault = Fault::Config { other: first.key().clone(), pointer };
                problems.push(Problem { path, line: None, fault });
            }
        }
    }
    problems
}

/// JSON pointer (RFC 6901) to the first place where `a` and `b` differ; fields of objects in the order of `a`.
fn first_difference(a: &Value, b: &Value) -> Option<String> {
    let escaped = |name: &str| name.replace('~', "~0").replace('/', "~1");
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            for (name, left) in a {
                let below = match b.get(name) {
                    Some(right) => first_difference(left, right),
                    None => Some(String::new()),
                };
                if let Some(below) = below {
                    return Some(format!("/{}{below}", escaped(name)));
                }
            }
            b.keys().find(|name| !a.contains_key(*name)).map(|name| format!("/{}", escaped(name)))
        }
        (a, b) => (a != b).then(String::new),
    }
}
