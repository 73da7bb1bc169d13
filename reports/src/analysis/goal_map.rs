//! Where teachers sent their students in tasks whose goals are points in space, over time: seen from above
//! and from the side.

use std::path::Path;

use rayon::prelude::*;

use crate::analysis::catalogue::EnvironmentInfo;
use crate::analysis::group::GroupKey;
use crate::analysis::groups::Groups;
use crate::analysis::parts::{PHASES, budget, episode_end, third_of};
use crate::schema::Teaching;
use crate::store;
use crate::store::problem::StoreProblem;

/// Coordinates of a goal that is a point in space.
pub const COORDINATES: usize = 3;

/// Cells along each side of a map.
pub const CELLS: usize = 24;

/// Which coordinates a projection shows: to the right, and up.
pub const PROJECTIONS: [[usize; 2]; 2] = [[0, 1], [0, 2]];

/// Goals of one third of training in one projection, counted by cell: `[CELLS * CELLS]`, rows from the top.
pub type GoalCounts = Vec<u32>;

/// Goals of training episodes of one group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GoalMap {
    /// Which group.
    pub key: GroupKey,
    /// Counts by projection and third of training, as in [`PROJECTIONS`] and [`PHASES`].
    pub counts: [[GoalCounts; PHASES.len()]; PROJECTIONS.len()],
}

/// The part of space that maps show: a cube, so that all of them have one scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    /// The lowest corner.
    pub low: [f64; COORDINATES],
    /// Length of an edge; above 0.
    pub edge: f64,
}

impl Cube {
    /// The smallest cube around `points` that shares their middle; `None` without any.
    pub fn around<'a>(points: impl Iterator<Item = &'a [f32; COORDINATES]>) -> Option<Self> {
        let mut ends: Option<[(f64, f64); COORDINATES]> = None;
        for point in points {
            let ends = ends.get_or_insert_with(|| point.map(|x| (f64::from(x), f64::from(x))));
            for ((low, high), &x) in ends.iter_mut().zip(point) {
                (*low, *high) = (low.min(x.into()), high.max(x.into()));
            }
        }
        let ends = ends?;
        let longest = ends.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        // One goal alone has no extent.
        let edge = if longest > 0.0 { longest } else { 1.0 };
        Some(Self { low: ends.map(|(low, high)| (low + high - edge) / 2.0), edge })
    }

    /// The cell of `point` in a projection: column and row, rows from the top.
    fn cell(&self, point: &[f32; COORDINATES], [right, up]: [usize; 2]) -> (usize, usize) {
        // A negative number becomes 0 in the cast.
        let index = |axis: usize| {
            let share = (f64::from(point[axis]) - self.low[axis]) / self.edge;
            ((share * CELLS as f64) as usize).min(CELLS - 1)
        };
        (index(right), CELLS - 1 - index(up))
    }
}

/// The goal maps of one environment.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalMaps {
    /// Environment id.
    pub environment: String,
    /// What they show.
    pub cube: Cube,
    /// One per group with a recorded goal.
    pub maps: Vec<GoalMap>,
}

/// The goals of training episodes in every environment whose goals have three coordinates.
#[derive(Debug, Default)]
pub struct GoalSpaces {
    /// Environments with at least one map.
    pub environments: Vec<GoalMaps>,
    /// What is wrong with the files.
    pub problems: Vec<StoreProblem>,
}

/// A goal and the third of training in which its episode ended.
type Placed = (usize, [f32; COORDINATES]);

impl GoalSpaces {
    /// The goals of the groups that stand for their method. What teachers did is read here, run by run, and
    /// only the goals are kept.
    pub fn of(results: &Path, groups: &Groups<'_>, environments: &[EnvironmentInfo]) -> Self {
        let mut spaces = Self::default();
        for info in environments.iter().filter(|info| info.goal == COORDINATES) {
            let mut goals: Vec<(GroupKey, Vec<Placed>)> = Vec::new();
            for group in groups.compared_groups() {
                if group.key.environment != info.id || !group.is_own() {
                    continue;
                }
                let read: Vec<_> = group.runs.par_iter().map(|run| store::teaching(results, run)).collect();
                let runs = group.runs.iter().zip(&read);
                let placed = runs.flat_map(|(run, (lines, _))| placed(lines, budget(run))).collect();
                goals.push((group.key.clone(), placed));
                spaces.problems.extend(read.into_iter().flat_map(|(_, problems)| problems));
            }
            spaces.environments.extend(GoalMaps::of(&info.id, goals));
        }
        spaces
    }
}

/// The goals of a run's training episodes, each with the third of the run's `budget` in which its episode
/// ended ([`episode_end`]).
fn placed(lines: &[Teaching], budget: u64) -> Vec<Placed> {
    let mut placed = Vec::new();
    let mut before = 0;
    for line in lines {
        for (index, goal) in line.goals.iter().enumerate() {
            let &[x, y, z] = goal.as_slice() else { continue };
            placed.push((third_of(episode_end(line, before, index), budget), [x, y, z]));
        }
        before = line.step;
    }
    placed
}

impl GoalMaps {
    /// Counts the goals; `None` without any.
    fn of(environment: &str, goals: Vec<(GroupKey, Vec<Placed>)>) -> Option<Self> {
        let all = goals.iter().flat_map(|(_, placed)| placed).map(|(_, goal)| goal);
        let cube = Cube::around(all)?;
        let map = |(key, placed): (GroupKey, Vec<Placed>)| {
            let mut counts = PROJECTIONS.map(|_| PHASES.map(|_| vec![0_u32; CELLS * CELLS]));
            for (counts, axes) in counts.iter_mut().zip(PROJECTIONS) {
                for (third, goal) in &placed {
                    let (column, row) = cube.cell(goal, axes);
                    counts[*third][row * CELLS + column] += 1;
                }
            }
            (!placed.is_empty()).then_some(GoalMap { key, counts })
        };
        Some(Self {
            environment: environment.to_owned(),
            cube,
            maps: goals.into_iter().filter_map(map).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    #[test]
    fn maps_by_hand() {
        let key = GroupKey::new(&Catalogue::default(), "E", "nova", "default");
        let line = Teaching {
            eval_index: 1,
            step: 300,
            goals: [[0.0, 0.0, 0.0], [1.0, 0.5, 0.25], [0.5, 0.5, 0.5], [1.0, 2.0, 3.0]]
                .map(Vec::from)
                .to_vec(),
            ..Teaching::default()
        };
        // Episodes of 75 steps end at 75, 150, 225 and 300: in thirds 0, 1, 2 and 2 of 300.
        let goals = placed(std::slice::from_ref(&line), 300);
        assert_eq!(goals.iter().map(|(third, _)| *third).collect::<Vec<_>>(), [0, 1, 2, 2]);
        let maps = GoalMaps::of("E", vec![(key.clone(), goals)]).unwrap();
        // The longest extent is that of z, 3; the others lie in its middle.
        assert_eq!(maps.cube, Cube { low: [-1.0, -0.5, 0.0], edge: 3.0 });
        let places = |projection: usize, third: usize| -> Vec<(usize, usize)> {
            let counts = &maps.maps[0].counts[projection][third];
            let at = counts.iter().enumerate().filter(|(_, count)| **count > 0);
            at.map(|(index, _)| (index % CELLS, index / CELLS)).collect()
        };
        // x = 0 is a third along: column 8 of 24. y = 0 is a sixth up: row 23 − 4. z = 0: the lowest row.
        assert_eq!((places(0, 0), places(1, 0)), (vec![(8, 19)], vec![(8, 23)]));
        // The highest z is in the highest row.
        assert_eq!(places(1, 2).first(), Some(&(16, 0)));
        assert_eq!(GoalMaps::of("E", vec![(key, Vec::new())]), None);
    }
}
