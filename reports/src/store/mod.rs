//! Everything a results folder holds.
//!
//! [`Results`] finds the runs, [`RunFolder`] is the single way to a run's files, and [`layout`] has the table
//! of those. A [`Store`] holds all that a report needs. Nothing is dropped in silence: each line, file or
//! folder that cannot be used is named in [`Store::problems`]. Partial results, of runs in progress too, are
//! read as far as they go.

pub mod cells;
mod check;
pub mod checksums;
pub mod digest;
mod ended;
mod error;
mod frontier;
pub mod layout;
mod limits;
mod lines;
mod load;
mod makers;
pub mod problem;
pub mod protocols;
mod results;
mod run_folder;
mod shadow;
mod student;
mod teaching;
mod tuning;

use std::collections::BTreeSet;
use std::path::Path;

use rayon::prelude::*;

pub use ended::check_ended;
pub use error::StoreError;
pub use frontier::frontier;
pub use results::{Results, Survey};
pub use run_folder::{JsonLine, RunFolder, read_json};
pub use shadow::shadowing;
pub use student::learning;
pub use teaching::teaching;
pub use tuning::{has_trials, tuning};

use crate::schema::{Manifest, Outcome, Record, RunKey, Timing};
use crate::store::problem::{Fault, StoreProblem};
use cells::{CellMember, OddOne};

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
    /// Curriculum ids of runs that other results brought along.
    guests: BTreeSet<String>,
}

impl Store {
    /// Reads all runs below `results/runs/`, in parallel; the answer does not depend on the order of reading.
    ///
    /// # Errors
    /// [`StoreError::Io`] and [`StoreError::NotResults`] if `results` is no results folder. Anything
    /// below that is a [`StoreProblem`].
    pub fn read(results: &Path) -> Result<Self, StoreError> {
        let folder = Results::new(results);
        let Survey { runs: folders, lost, strays: mut problems } = folder.survey()?;
        problems.extend(lost.iter().map(|run| {
            let path = folder.relative(run.path()).to_owned();
            StoreProblem { path, line: None, fault: Fault::NoManifest }
        }));
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
        problems.extend(leave_out_odd_ones(&mut runs));
        problems.extend(makers::differing(&runs));
        problems.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
        Ok(Self { runs, problems, guests: BTreeSet::new() })
    }

    /// A store of `runs` that never were on disk, such as simulated ones.
    pub fn of(mut runs: Vec<Run>) -> Self {
        runs.sort_by(|a, b| a.key().cmp(b.key()));
        Self { runs, problems: Vec::new(), guests: BTreeSet::new() }
    }

    /// All runs with a valid manifest, by rising key; some may hold no record yet.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// All runs, to be had.
    pub(crate) fn into_runs(self) -> Vec<Run> {
        self.runs
    }

    /// Takes in runs of other results, whose curriculum ids no run here may have.
    ///
    /// # Errors
    /// The first id that one has; then nothing is taken in.
    pub(crate) fn add_guests(&mut self, runs: Vec<Run>) -> Result<(), String> {
        let ids: BTreeSet<String> = runs.iter().map(|run| run.key().curriculum.clone()).collect();
        if let Some(taken) = self.runs.iter().find(|run| ids.contains(&run.key().curriculum)) {
            return Err(taken.key().curriculum.clone());
        }
        self.guests.extend(ids);
        self.runs.extend(runs);
        self.runs.sort_by(|a, b| a.key().cmp(b.key()));
        Ok(())
    }

    /// Whether a run of this store lies in the results folder, and was not brought along by other results.
    pub fn is_own(&self, run: &Run) -> bool {
        !self.guests.contains(&run.key().curriculum)
    }

    /// What is wrong with the folder, by path and line.
    pub fn problems(&self) -> &[StoreProblem] {
        &self.problems
    }

    /// What of it is damaged or belongs nowhere: its [problems](Self::problems) but for runs that failed,
    /// which are results like any others.
    pub fn damages(&self) -> impl Iterator<Item = &StoreProblem> {
        self.problems.iter().filter(|problem| !problem.is_an_ending())
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

/// Removes every run that is not configured as its cell is, and names it.
fn leave_out_odd_ones(runs: &mut Vec<Run>) -> Vec<StoreProblem> {
    let members = runs.iter().map(|run| CellMember {
        run: run.key(),
        config: &run.manifest.config,
        has_begun: !run.records.is_empty() || run.outcome.is_some(),
    });
    let odd = cells::odd_ones(members);
    runs.retain(|run| odd.iter().all(|odd| odd.run != *run.key()));
    let problem = |OddOne { run, other, pointer }: OddOne| {
        let path = layout::run_dir(Path::new(""), &run).join(layout::MANIFEST);
        StoreProblem { path, line: None, fault: Fault::Config { other, pointer } }
    };
    odd.into_iter().map(problem).collect()
}
