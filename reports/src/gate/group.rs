//! What is tested: single cells, and all cells of an environment, of a curriculum, of everything.
//!
//! A fault of the student shows in every cell a little. Averaged over a row or column of cells it stands out
//! from the noise of few seeds, where no single cell could tell it.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use super::cells::Cell;
use super::metric::Metric;

/// What the cells of a group have in common. Ordered as tables are: the widest first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// Nothing: all cells.
    All,
    /// The environment.
    Environment(String),
    /// The curriculum.
    Curriculum(String),
    /// Everything: one cell, by its id.
    Cell(String),
}

impl std::fmt::Display for Scope {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::All => write!(f, "all runs"),
            Self::Environment(id) => write!(f, "{id}, all curricula"),
            Self::Curriculum(id) => write!(f, "{id}, all environments"),
            Self::Cell(id) => write!(f, "{id}"),
        }
    }
}

impl Serialize for Scope {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Cells that are tested together.
#[derive(Clone, Debug, PartialEq)]
pub struct CellGroup {
    /// What they have in common.
    pub scope: Scope,
    /// Their indices; never empty.
    pub cells: Vec<usize>,
}

impl CellGroup {
    /// Whether `metric` can be averaged over these cells: numbers of goals only over those of one curriculum.
    pub fn takes(&self, metric: Metric) -> bool {
        metric.is_success() || matches!(self.scope, Scope::Cell(_) | Scope::Curriculum(_))
    }
}

/// All groups of `cells`, the widest first; none that holds the same cells as a narrower one.
pub fn groups(cells: &[Cell]) -> Vec<CellGroup> {
    let mut by_scope: BTreeMap<Scope, Vec<usize>> = BTreeMap::new();
    for (index, cell) in cells.iter().enumerate() {
        let scopes = [
            Scope::All,
            Scope::Environment(cell.environment.clone()),
            Scope::Curriculum(cell.curriculum.clone()),
            Scope::Cell(cell.id()),
        ];
        for scope in scopes {
            by_scope.entry(scope).or_default().push(index);
        }
    }
    let all: Vec<CellGroup> = by_scope.into_iter().map(|(scope, cells)| CellGroup { scope, cells }).collect();
    let is_new = |(index, group): &(usize, &CellGroup)| {
        all[index + 1..].iter().all(|other| other.cells != group.cells)
    };
    all.iter().enumerate().filter(is_new).map(|(_, group)| group.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gate::testing::cell;

    fn names(cells: &[(&str, &str)]) -> Vec<String> {
        let cells: Vec<Cell> = cells.iter().map(|(e, c)| cell(e, c, &[])).collect();
        groups(&cells).iter().map(|group| format!("{} {:?}", group.scope, group.cells)).collect()
    }

    #[test]
    fn cells_are_tested_alone_in_rows_in_columns_and_together() {
        assert_eq!(
            names(&[("A", "x"), ("A", "y"), ("B", "x"), ("B", "y")]),
            [
                "all runs [0, 1, 2, 3]",
                "A, all curricula [0, 1]",
                "B, all curricula [2, 3]",
                "x, all environments [0, 2]",
                "y, all environments [1, 3]",
                "A/x/default [0]",
                "A/y/default [1]",
                "B/x/default [2]",
                "B/y/default [3]"
            ]
        );
    }

    #[test]
    fn no_group_is_tested_twice() {
        assert_eq!(
            names(&[("A", "x"), ("A", "y")]),
            ["A, all curricula [0, 1]", "A/x/default [0]", "A/y/default [1]"]
        );
        assert_eq!(names(&[("A", "x")]), ["A/x/default [0]"]);
    }
}
