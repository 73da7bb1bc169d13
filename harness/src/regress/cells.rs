//! The curves of a results folder, a cell per environment, curriculum and variant.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use reports::schema::{Outcome, Record};
use reports::store::layout;
use serde::{Deserialize, Serialize};

use super::config::{self, Fields};
use crate::error::HarnessError;
use crate::protocol::plan::{Plan, PlannedRun};
use crate::run::folder::read_json;
use crate::sha256;

/// Names of the numbers that [`Curve::effective_goals`], [`Curve::effective_picks`] and [`Curve::pick_rank`] average.
const OF_TEACHERS: [&str; 3] = ["effective_goals", "effective_picks", "pick_rank_mean"];
/// Hex digits kept of a digest: 64 bits.
const DIGEST: usize = 16;

/// What one run recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// The first 16 hex digits of the SHA-256 of its `records.jsonl`: equal where every byte is.
    pub records: String,
    /// Successful episodes of every evaluation, `[evaluations]`.
    pub successes: Vec<u64>,
    /// Mean over evaluations of the teacher's effective number of goals, to 4 digits; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_goals: Option<f64>,
    /// Mean over evaluations of the effective number of goals picked since the one before, to 4 digits; absent for teachers that
    /// do not choose from a pool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_picks: Option<f64>,
    /// Mean over evaluations of the picked goals' mean place in the teacher's set, in [0, 1], to 4 digits; absent for teachers that
    /// rank no set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pick_rank: Option<f64>,
}

impl Curve {
    /// Success rates in [0, 1], `[evaluations]`, where each evaluation had so many episodes.
    pub fn rates(&self, episodes: u64) -> Vec<f64> {
        self.successes.iter().map(|&successes| successes as f64 / episodes as f64).collect()
    }
}

/// The runs of one environment, curriculum and variant.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Environment id.
    pub environment: String,
    /// Curriculum id.
    pub curriculum: String,
    /// Variant label.
    pub variant: String,
    /// The complete config of its runs.
    pub config: Fields,
    /// Episodes of an evaluation.
    pub episodes: u64,
    /// Training steps at every evaluation, `[evaluations]`, at least two and rising.
    pub steps: Vec<u64>,
    /// Curves by seed.
    pub curves: BTreeMap<u64, Curve>,
}

impl Cell {
    /// `environment/curriculum/variant`.
    pub fn id(&self) -> String {
        format!("{}/{}/{}", self.environment, self.curriculum, self.variant)
    }

    #[cfg(test)]
    pub(super) fn empty(environment: &str, curriculum: &str) -> Self {
        Self {
            environment: environment.into(),
            curriculum: curriculum.into(),
            variant: "default".into(),
            config: Fields::new(),
            episodes: 10,
            steps: vec![0, 100],
            curves: BTreeMap::new(),
        }
    }
}

/// A run that ended before its budget was used up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// Which run.
    pub run: String,
    /// Why it ended.
    pub reason: String,
}

/// What a results folder holds of a plan.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// A cell per environment, curriculum and variant of the plan, in its order.
    pub cells: Vec<Cell>,
    /// Runs that failed. Their curves go on with 0 to the end.
    pub failures: Vec<Failure>,
}

/// Reads the curves of every run of `plan`, all of which must have ended.
///
/// # Errors
/// [`HarnessError`] naming the file that is missing or damaged, or the cell no run of which came to its end.
pub fn read(results: &Path, plan: &Plan) -> Result<Found, HarnessError> {
    let mut found = Found::default();
    for run in &plan.runs {
        let cell = cell_of(&mut found.cells, run);
        let (records, curve) = recorded(results, run)?;
        match outcome(results, run)? {
            Outcome::Finished { .. } => {
                let steps: Vec<u64> = records.iter().map(|record| record.step).collect();
                if cell.steps.is_empty() {
                    cell.steps = steps;
                } else if cell.steps != steps {
                    let reason = format!("evaluated at steps {steps:?}, other seeds at {:?}", cell.steps);
                    return Err(HarnessError::Run { run: run.key.to_string(), reason });
                }
            }
            Outcome::Failed { step, reason } => {
                let reason = format!("failed at step {step}: {reason}");
                found.failures.push(Failure { run: run.key.to_string(), reason });
            }
        }
        cell.curves.insert(run.key.seed, curve);
    }
    for cell in &mut found.cells {
        if cell.steps.len() < 2 {
            let reason = "no seed came to its end with two evaluations or more".to_owned();
            return Err(HarnessError::Run { run: cell.id(), reason });
        }
        for curve in cell.curves.values_mut() {
            curve.successes.resize(cell.steps.len(), 0);
        }
    }
    Ok(found)
}

fn cell_of<'a>(cells: &'a mut Vec<Cell>, run: &PlannedRun) -> &'a mut Cell {
    let key = &run.key;
    let same = |cell: &Cell| {
        (&cell.environment, &cell.curriculum, &cell.variant)
            == (&key.environment, &key.curriculum, &key.variant)
    };
    let index = cells.iter().position(same).unwrap_or_else(|| {
        cells.push(Cell {
            environment: key.environment.clone(),
            curriculum: key.curriculum.clone(),
            variant: key.variant.clone(),
            config: config::fields(run),
            episodes: run.config.evaluation.episodes,
            steps: Vec::new(),
            curves: BTreeMap::new(),
        });
        cells.len() - 1
    });
    &mut cells[index]
}

fn outcome(results: &Path, run: &PlannedRun) -> Result<Outcome, HarnessError> {
    let path = layout::run_dir(results, &run.key).join(layout::OUTCOME);
    let missing = || HarnessError::Run { run: run.key.to_string(), reason: "has not ended".into() };
    read_json(&path)?.ok_or_else(missing)
}

/// What the run recorded, line by line and in short.
fn recorded(results: &Path, run: &PlannedRun) -> Result<(Vec<Record>, Curve), HarnessError> {
    let path = layout::run_dir(results, &run.key).join(layout::RECORDS);
    let text = fs::read_to_string(&path).map_err(HarnessError::io(&path, "read this file"))?;
    let line = |(index, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|error| HarnessError::Damaged {
            path: path.clone(),
            reason: format!("line {}: {error}", index + 1),
        })
    };
    let records: Vec<Record> = text.lines().enumerate().map(line).collect::<Result<_, _>>()?;
    let successes =
        records.iter().map(|record| (record.success_rate * record.episodes as f64).round() as u64).collect();
    let digest = sha256::hex(text.as_bytes())[..DIGEST].to_owned();
    let [effective_goals, effective_picks, pick_rank] =
        OF_TEACHERS.map(|name| mean_over_evaluations(&records, name));
    let curve = Curve { records: digest, successes, effective_goals, effective_picks, pick_rank };
    Ok((records, curve))
}

/// The teacher's number `name` over all evaluations that have one.
fn mean_over_evaluations(records: &[Record], name: &str) -> Option<f64> {
    let numbers: Vec<f64> = records.iter().filter_map(|record| record.teacher.get(name)?.as_f64()).collect();
    reports::stats::mean(&numbers).map(four_digits)
}

/// `x` rounded to four significant digits, so that a baseline is short.
fn four_digits(x: f64) -> f64 {
    format!("{x:.3e}").parse().expect("a number that was just written")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_are_kept() {
        assert_eq!(four_digits(123.456), 123.5);
        assert_eq!([1000.0, 0.0].map(four_digits), [1000.0, 0.0]);
    }
}
