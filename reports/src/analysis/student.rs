//! How students learned: their losses, values, gradients and replay buffers, of all runs.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;

use crate::analysis::groups::Groups;
use crate::analysis::numbers::{self, NumberPlots, Numbered};
use crate::schema::{Learning, RunKey};
use crate::store::problem::StoreProblem;
use crate::store::{self, Run, Store};

/// What the runs' files of their students say.
#[derive(Debug, Default)]
pub struct StudentFiles {
    /// The lines of every run, by rising evaluation; none for a run of an old version.
    pub lines: BTreeMap<RunKey, Vec<Learning>>,
    /// What is wrong with these files.
    pub problems: Vec<StoreProblem>,
}

impl StudentFiles {
    /// Those of all runs of `store` that lie in the folder `results`.
    pub fn of(results: &Path, store: &Store) -> Self {
        let read = |run: &Run| (run.key().clone(), store::learning(results, run));
        let own = store.runs().par_iter().filter(|run| store.is_own(run));
        let read: Vec<_> = own.map(read).collect();
        let mut files = Self::default();
        for (key, (lines, problems)) in read {
            files.lines.insert(key, lines);
            files.problems.extend(problems);
        }
        files
    }

    /// The lines of one run.
    pub fn of_run(&self, run: &Run) -> &[Learning] {
        self.lines.get(run.key()).map_or(&[], Vec::as_slice)
    }

    /// Their numbers over training.
    pub fn plots(&self, groups: &Groups<'_>) -> Vec<NumberPlots> {
        let numbered = |line: &Learning| Numbered {
            eval_index: line.eval_index,
            step: line.step,
            numbers: line
                .numbers()
                .into_iter()
                // Episodes are transitions over H.
                .filter(|(name, _)| *name != "replay_episodes")
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
        };
        numbers::plots(groups, |run| self.of_run(run).iter().map(numbered).collect())
    }
}
