//! Cells by hand, for tests.

use std::collections::BTreeMap;

use super::cells::{Cell, RunSummary};
use super::config::Fields;

/// A cell of two evaluations whose run of each seed has successes 0, then so many of 10.
pub(super) fn cell(environment: &str, curriculum: &str, last: &[u64]) -> Cell {
    let curve = |(seed, &successes): (u64, &u64)| {
        let curve = RunSummary {
            records: format!("{environment}-{curriculum}-{seed}-{successes}"),
            successes: vec![0, successes],
            effective_goals: None,
            effective_picks: None,
            pick_rank: None,
        };
        (seed, curve)
    };
    Cell {
        environment: environment.into(),
        curriculum: curriculum.into(),
        variant: "default".into(),
        config: Fields::new(),
        episodes: 10,
        steps: vec![0, 100],
        curves: (0..).zip(last).map(curve).collect::<BTreeMap<_, _>>(),
    }
}
