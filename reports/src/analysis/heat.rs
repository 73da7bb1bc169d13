//! Where a teacher sent its student in a maze, and where the student succeeded, over time.

use std::path::Path;

use rayon::prelude::*;

use crate::analysis::catalogue::MazeInfo;
use crate::analysis::group::GroupKey;
use crate::analysis::groups::Groups;
use crate::analysis::parts::{budget, episode_end, third_of};
use crate::schema::Teaching;
use crate::store;
use crate::store::problem::StoreProblem;

/// Fewest episodes in a cell whose success rate is shown.
pub const FEWEST_EPISODES: u32 = 5;

/// Training episodes of one third of training, by cell of their goal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeatPhase {
    /// Episodes with a goal in each cell. Shape: `[side * side]`, row by row.
    pub episodes: Vec<u32>,
    /// Those of them that ended in success. Shape: `[side * side]`.
    pub successes: Vec<u32>,
}

/// The heat maps of one group of runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HeatMap {
    /// Which group.
    pub key: GroupKey,
    /// Its runs that tell what their teacher did, and all of them.
    pub runs: (usize, usize),
    /// The step that the one of its runs that has come furthest was evaluated at.
    pub reached: u64,
    /// The training steps whose thirds are shown: the largest budget of its runs.
    pub budget: u64,
    /// One per third of training.
    pub phases: [HeatPhase; 3],
}

impl HeatMap {
    /// Counts the episodes of a group's runs, each with its budget and its lines by rising step. An episode
    /// belongs to the third of its run in which it ended ([`episode_end`]). `None` if no goal is a position
    /// in the plane.
    pub fn of<'a>(
        key: &GroupKey,
        maze: &MazeInfo,
        runs: impl IntoIterator<Item = (u64, &'a [Teaching])>,
    ) -> Option<Self> {
        let cells = maze.side() * maze.side();
        let empty = || HeatPhase { episodes: vec![0; cells], successes: vec![0; cells] };
        let mut phases = [empty(), empty(), empty()];
        let (mut telling, mut all, mut reached, mut largest) = (0, 0, 0, 0);
        for (budget, lines) in runs {
            let (mut before, mut any) = (0, false);
            for line in lines {
                for (index, (goal, &success)) in line.goals.iter().zip(&line.successes).enumerate() {
                    let &[x, y] = goal.as_slice() else { continue };
                    let phase = &mut phases[third_of(episode_end(line, before, index), budget)];
                    let (row, column) = maze.cell_of([x, y]);
                    phase.episodes[row * maze.side() + column] += 1;
                    phase.successes[row * maze.side() + column] += u32::from(success);
                    any = true;
                }
                before = line.step;
            }
            (telling, all) = (telling + usize::from(any), all + 1);
            (reached, largest) = (before.max(reached), budget.max(largest));
        }
        let runs = (telling, all);
        (telling > 0).then(|| Self { key: key.clone(), runs, reached, budget: largest, phases })
    }
}

impl HeatPhase {
    /// Episodes in all cells.
    pub fn total(&self) -> u32 {
        self.episodes.iter().sum()
    }

    /// Share of the phase's episodes with a goal in each cell; all 0 without episodes. Shape: `[side *
    /// side]`.
    pub fn shares(&self) -> Vec<f64> {
        let total = self.total();
        self.episodes.iter().map(|&count| f64::from(count) / f64::from(total.max(1))).collect()
    }

    /// Success rate in each cell; `None` where there were fewer than [`FEWEST_EPISODES`]: a rate of so few
    /// would look as certain as any other. Shape: `[side * side]`.
    pub fn rates(&self) -> Vec<Option<f64>> {
        let rate = |(&successes, &episodes): (&u32, &u32)| {
            (episodes >= FEWEST_EPISODES).then(|| f64::from(successes) / f64::from(episodes))
        };
        self.successes.iter().zip(&self.episodes).map(rate).collect()
    }
}

/// What the files of what teachers did say: they are read in mazes alone.
#[derive(Debug, Default)]
pub struct Heat<'a> {
    /// Mazes with at least one heat map.
    pub mazes: Vec<MazeHeat<'a>>,
    /// What is wrong with these files.
    pub problems: Vec<StoreProblem>,
}

/// Heat maps of one maze.
#[derive(Debug)]
pub struct MazeHeat<'a> {
    /// The maze.
    pub maze: &'a MazeInfo,
    /// One per group.
    pub maps: Vec<HeatMap>,
}

impl<'a> Heat<'a> {
    /// Heat maps of the compared groups of every maze. What teachers did is read here, run by run, and
    /// counted at once: all of it together would not be small.
    pub fn of(results: &Path, groups: &Groups<'_>, mazes: &'a [MazeInfo]) -> Self {
        let mut heat = Self::default();
        for maze in mazes {
            let mut maps = Vec::new();
            let mut here = groups.compared_groups();
            here.retain(|group| group.key.environment == maze.id && group.is_own());
            for group in here {
                let read: Vec<_> = group.runs.par_iter().map(|run| store::teaching(results, run)).collect();
                let budgets = group.runs.iter().map(|run| budget(run));
                let lines = read.iter().map(|(lines, _)| lines.as_slice());
                maps.extend(HeatMap::of(&group.key, maze, budgets.zip(lines)));
                heat.problems.extend(read.into_iter().flat_map(|(_, problems)| problems));
            }
            if !maps.is_empty() {
                heat.mazes.push(MazeHeat { maze, maps });
            }
        }
        heat
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    #[test]
    fn heat_by_hand() {
        let maze = MazeInfo { id: "M".into(), grid: ["..", ".S"].map(String::from).to_vec() };
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let line = Teaching {
            eval_index: 1,
            step: 150,
            goals: [[-0.5, -0.5], [-0.5, 0.5], [-0.1, 0.1]].map(Vec::from).to_vec(),
            successes: vec![true, true, false],
            ..Teaching::default()
        };
        let heat = HeatMap::of(&key, &maze, [(450, std::slice::from_ref(&line))]).unwrap();
        assert_eq!(heat.phases[0].shares(), [1.0 / 3.0, 2.0 / 3.0, 0.0, 0.0]);
        assert_eq!(
            (&heat.phases[0].episodes, &heat.phases[0].successes),
            (&vec![1, 2, 0, 0], &vec![1, 1, 0, 0])
        );
        let phase = HeatPhase { episodes: vec![4, 5, 0, 10], successes: vec![4, 5, 0, 3] };
        assert_eq!(phase.rates(), [None, Some(1.0), None, Some(0.3)]);
        assert_eq!(heat.phases[2].shares(), [0.0; 4]);
        assert_eq!((heat.reached, heat.budget), (150, 450));
        assert_eq!(HeatMap::of(&key, &maze, []), None);
    }

    #[test]
    fn episodes_of_one_line_belong_to_the_third_in_which_they_ended() {
        let maze = MazeInfo { id: "M".into(), grid: ["..", ".S"].map(String::from).to_vec() };
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let line = |eval_index: u64, step: u64, count: usize| Teaching {
            eval_index,
            step,
            goals: vec![vec![-0.5, -0.5]; count],
            successes: vec![true; count],
            ..Teaching::default()
        };
        let counts = |runs: &[&[Teaching]]| {
            let heat = HeatMap::of(&key, &maze, runs.iter().map(|&lines| (90, lines))).unwrap();
            heat.phases.map(|phase| phase.episodes[0])
        };
        // One evaluation at the end of training: nine episodes of 10 steps.
        assert_eq!(counts(&[&[line(1, 90, 9)]]), [3, 3, 3]);
        // The last of the first line ended at step 50; the second line begins there. Runs stand apart.
        let (first, second) = (line(1, 50, 5), line(2, 90, 4));
        assert_eq!(counts(&[&[first, second], &[line(1, 30, 3)]]), [6, 3, 3]);
    }
}
