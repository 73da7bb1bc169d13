//! What students could really do at every goal of their pools, and what follows from it: whether teachers
//! find the goals of intermediate success, what was ever solved and forgotten, how the hardest goals fare.

pub mod border;
pub mod coverage;
pub mod map;
pub mod sight;

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;

use crate::schema::{Frontier, RunKey};
use crate::store::problem::StoreProblem;
use crate::store::{self, Run, Store};
use border::Neighbours;

/// What the runs' measures of their frontiers say.
#[derive(Debug, Default)]
pub struct FrontierFiles {
    /// The measures of every run that has some, by rising evaluation.
    pub measures: BTreeMap<RunKey, Vec<Frontier>>,
    /// Which goals of these runs lie next to each other, where that is told.
    neighbours: BTreeMap<RunKey, Neighbours>,
    /// What is wrong with these files.
    pub problems: Vec<StoreProblem>,
}

impl FrontierFiles {
    /// Those of all runs of `store`, which lies in the folder `results`.
    pub fn of(results: &Path, store: &Store) -> Self {
        let read = |run: &Run| {
            let found = store::frontier(results, run);
            let goals = found.0.iter().find_map(|measure| measure.goals.as_deref());
            (run.key().clone(), goals.map(Neighbours::of), found)
        };
        let read: Vec<_> = store.runs().par_iter().map(read).collect();
        let mut files = Self::default();
        for (key, neighbours, (measures, problems)) in read {
            files.neighbours.extend(neighbours.map(|neighbours| (key.clone(), neighbours)));
            if !measures.is_empty() {
                files.measures.insert(key, measures);
            }
            files.problems.extend(problems);
        }
        files
    }

    /// Which goals of one run's pool lie next to each other.
    pub fn neighbours(&self, run: &Run) -> Option<&Neighbours> {
        self.neighbours.get(run.key())
    }

    /// The measures of one run.
    pub fn of_run(&self, run: &Run) -> &[Frontier] {
        self.measures.get(run.key()).map_or(&[], Vec::as_slice)
    }
}
