//! The curves of a results folder, a cell per environment, curriculum and variant.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::config::Fields;
use super::error::GateError;
use crate::analysis::scores;
use crate::schema::{Outcome, Record, RunKey};
use crate::stats;
use crate::store::{RunFolder, layout};

/// Names of the numbers that [`RunSummary::effective_goals`], [`RunSummary::effective_picks`] and
/// [`RunSummary::pick_rank`] average.
const OF_TEACHERS: [&str; 3] = [names::EFFECTIVE_GOALS, names::EFFECTIVE_PICKS, names::PICK_RANK_MEAN];
/// Hex digits kept of a digest: 64 bits.
const DIGEST: usize = 16;

/// What one run recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSummary {
    /// The first 16 hex digits of the SHA-256 of its `records.jsonl`: equal where every byte is.
    pub records: String,
    /// Successful episodes of every evaluation, `[evaluations]`.
    pub successes: Vec<u64>,
    /// Mean over evaluations of the teacher's effective number of goals, to 4 digits; absent where it has
    /// none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_goals: Option<f64>,
    /// Mean over evaluations of the effective number of goals picked since the one before, to 4 digits;
    /// absent for teachers that do not choose from a pool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_picks: Option<f64>,
    /// Mean over evaluations of the picked goals' mean place in the teacher's set, in [0, 1], to 4 digits;
    /// absent for teachers that rank no set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pick_rank: Option<f64>,
}

impl RunSummary {
    /// What `records` come to, whose file has the SHA-256 `digest` in hex.
    fn of(records: &[Record], digest: &str) -> Self {
        let [effective_goals, effective_picks, pick_rank] =
            OF_TEACHERS.map(|name| mean_over_evaluations(records, name));
        Self {
            records: digest[..DIGEST].to_owned(),
            successes: records.iter().map(scores::successes).collect(),
            effective_goals,
            effective_picks,
            pick_rank,
        }
    }

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
    pub curves: BTreeMap<u64, RunSummary>,
}

impl Cell {
    /// `environment/curriculum/variant`.
    pub fn id(&self) -> String {
        format!("{}/{}/{}", self.environment, self.curriculum, self.variant)
    }

    /// A cell of `run` without any curve yet.
    fn of(run: &ExpectedRun) -> Self {
        let RunKey { environment, curriculum, variant, seed: _ } = run.key.clone();
        Self {
            environment,
            curriculum,
            variant,
            config: run.config.clone(),
            episodes: run.episodes,
            steps: Vec::new(),
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

/// A run that a protocol asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedRun {
    /// Which run.
    pub key: RunKey,
    /// Its complete config.
    pub config: Fields,
    /// Episodes of an evaluation.
    pub episodes: u64,
}

impl ExpectedRun {
    /// The id of its cell: `environment/curriculum/variant`.
    pub fn cell(&self) -> String {
        format!("{}/{}/{}", self.key.environment, self.key.curriculum, self.key.variant)
    }
}

/// What a results folder holds of the runs expected there.
#[derive(Clone, Debug, Default)]
pub struct FoundRuns {
    /// A cell per environment, curriculum and variant, in the order of the runs.
    pub cells: Vec<Cell>,
    /// Runs that failed. Their curves go on with 0 to the end.
    pub failures: Vec<Failure>,
}

/// Reads the curves of all `runs`, every one of which must have ended.
///
/// # Errors
/// [`GateError`] naming the file that is missing or damaged, or the cell no run of which came to its end.
pub fn read(results: &Path, runs: &[ExpectedRun]) -> Result<FoundRuns, GateError> {
    let mut found = FoundRuns::default();
    for run in runs {
        let cell = cell_of(&mut found.cells, run);
        let folder = RunFolder::of(results, &run.key);
        let records = folder.records()?;
        let outcome = folder.outcome()?.ok_or_else(|| GateError::NotEnded { run: run.key.clone() })?;
        match outcome {
            Outcome::Finished { .. } => {
                let steps: Vec<u64> = records.iter().map(|record| record.step).collect();
                if cell.steps.is_empty() {
                    cell.steps = steps;
                } else if cell.steps != steps {
                    return Err(GateError::Steps {
                        run: Box::new(run.key.clone()),
                        steps,
                        others: cell.steps.clone(),
                    });
                }
            }
            Outcome::Failed { step, reason } => {
                let reason = format!("failed at step {step}: {reason}");
                found.failures.push(Failure { run: run.key.to_string(), reason });
            }
        }
        cell.curves.insert(run.key.seed, RunSummary::of(&records, &folder.sha256(layout::RECORDS)?));
    }
    for cell in &mut found.cells {
        if cell.steps.len() < 2 {
            return Err(GateError::NoCurve { cell: cell.id() });
        }
        for curve in cell.curves.values_mut() {
            curve.successes.resize(cell.steps.len(), 0);
        }
    }
    Ok(found)
}

fn cell_of<'a>(cells: &'a mut Vec<Cell>, run: &ExpectedRun) -> &'a mut Cell {
    let index = cells.iter().position(|cell| cell.id() == run.cell()).unwrap_or_else(|| {
        cells.push(Cell::of(run));
        cells.len() - 1
    });
    &mut cells[index]
}

/// The teacher's number `name` over all evaluations that have one.
fn mean_over_evaluations(records: &[Record], name: &str) -> Option<f64> {
    let numbers: Vec<f64> = records.iter().filter_map(|record| record.teacher.get(name)?.as_f64()).collect();
    stats::mean(&numbers).map(four_digits)
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
