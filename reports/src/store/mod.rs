//! Everything a results folder holds.
//!
//! [`Results`] finds the runs, [`RunFolder`] is the single way to a run's files, and [`layout`] has the table
//! of those. A [`Store`] holds all that a report needs. Nothing is dropped in silence: each line, file or
//! folder that cannot be used is named in [`Store::problems`]. Partial results, of runs in progress too, are
//! read as far as they go.

mod check;
pub mod checksums;
pub mod digest;
mod error;
pub mod layout;
mod lines;
mod load;
pub mod problem;
pub mod protocols;
mod results;
mod run_folder;
mod teaching;

use std::path::Path;

use rayon::prelude::*;

pub use error::StoreError;
pub use results::Results;
pub use run_folder::{JsonLine, RunFolder, read_json};
pub use teaching::teaching;

use crate::schema::{Manifest, Outcome, Record, RunKey, Timing};
use crate::store::problem::StoreProblem;

/// One run, as far as it got.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What the run is.
    pub manifest: Manifest,
    /// Its evaluations, by rising `eval_index` and `step`.
    pub records: Vec<Record>,
    /// Its timings, by rising `eval_index`.
    pub timings: Vec<Timing>,
    /// How it ended; `None` while it has not.
    pub outcome: Option<Outcome>,
}

impl Run {
    /// Which run this is.
    pub fn key(&self) -> &RunKey {
        &self.manifest.run
    }

    /// Whether it used up its budget.
    pub fn is_finished(&self) -> bool {
        matches!(self.outcome, Some(Outcome::Finished { .. }))
    }
}

/// The runs of a results folder, by rising [`RunKey`].
#[derive(Clone, Debug, PartialEq)]
pub struct Store {
    runs: Vec<Run>,
    problems: Vec<StoreProblem>,
}

impl Store {
    /// Reads all runs below `results/runs/`, in parallel; the answer does not depend on the order of reading.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] and [`StoreError::NotResults`] if `results` is no results folder. Anything
    /// below that is a [`StoreProblem`].
    pub fn read(results: &Path) -> Result<Self, StoreError> {
        if !results.is_dir() {
            return Err(StoreError::NotFound { path: results.to_owned() });
        }
        if !layout::runs_dir(results).is_dir() {
            return Err(StoreError::NotResults { path: results.to_owned() });
        }
        let folder = Results::new(results);
        let (folders, mut problems) = folder.survey();
        if folders.is_empty() && problems.is_empty() {
            return Err(StoreError::NotResults { path: results.to_owned() });
        }
        let load = |run: &RunFolder| {
            let mut loader = load::Loader::new(&folder, run);
            (loader.run(), loader.into_problems())
        };
        let loaded: Vec<_> = folders.par_iter().map(load).collect();
        let mut runs = Vec::new();
        for (run, faults) in loaded {
            runs.extend(run);
            problems.extend(faults);
        }
        runs.sort_by(|a, b| a.key().cmp(b.key()));
        problems.extend(check::configs(&runs));
        problems.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
        Ok(Self { runs, problems })
    }

    /// A store of `runs` that never were on disk, such as simulated ones.
    pub fn of(mut runs: Vec<Run>) -> Self {
        runs.sort_by(|a, b| a.key().cmp(b.key()));
        Self { runs, problems: Vec::new() }
    }

    /// All runs with a valid manifest, by rising key; some may hold no record yet.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// What is wrong with the folder, by path and line.
    pub fn problems(&self) -> &[StoreProblem] {
        &self.problems
    }

    /// Number of evaluations in all runs.
    pub fn len(&self) -> usize {
        self.runs.iter().map(|run| run.records.len()).sum()
    }

    /// Keeps the runs that `keep` accepts; what is wrong with the folder stays known.
    pub fn retain(&mut self, keep: impl Fn(&RunKey) -> bool) {
        self.runs.retain(|run| keep(run.key()));
    }

    /// Whether there is no evaluation at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
