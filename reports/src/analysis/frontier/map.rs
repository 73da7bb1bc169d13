//! Where in a maze the student succeeds, as measured, beside where its teacher looks.

use crate::analysis::catalogue::MazeInfo;
use crate::analysis::frontier::FrontierFiles;
use crate::analysis::group::GroupKey;
use crate::analysis::groups::Groups;
use crate::analysis::heat::third;
use crate::schema::Frontier;

/// The last measures of a third of training, by cell of the goals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrontierPhase {
    /// Success rate at the goals of each cell; `None` where none lies. Shape: `[side * side]`; empty without
    /// a measure.
    pub success: Vec<Option<f64>>,
    /// The teacher's probability of a goal in each cell, mean over runs; `None` where no goal lies. Shape:
    /// `[side * side]`; empty without a measure that has weights.
    pub weights: Vec<Option<f64>>,
}

/// The maps of one group of runs.
#[derive(Clone, Debug, PartialEq)]
pub struct FrontierMap {
    /// Which group.
    pub key: GroupKey,
    /// Its runs whose measures are shown, and all of them.
    pub runs: (usize, usize),
    /// One per third of training.
    pub phases: [FrontierPhase; 3],
}

/// The maps of one maze.
#[derive(Debug)]
pub struct MazeFrontier<'a> {
    /// The maze.
    pub maze: &'a MazeInfo,
    /// The training steps whose thirds are shown: those of the run that has come furthest.
    pub end: u64,
    /// One per group.
    pub maps: Vec<FrontierMap>,
}

/// Sums over the measures of one third.
struct Sums {
    /// Per cell.
    successes: Vec<u64>,
    episodes: Vec<u64>,
    weights: Vec<f64>,
    /// Measures, and those of them with weights.
    measures: u32,
    weighed: u32,
}

impl Sums {
    fn new(maze: &MazeInfo) -> Self {
        let cells = maze.side() * maze.side();
        Self {
            successes: vec![0; cells],
            episodes: vec![0; cells],
            weights: vec![0.0; cells],
            measures: 0,
            weighed: 0,
        }
    }

    /// Adds a measure, whose goals lie in `cells`.
    fn add(&mut self, measure: &Frontier, cells: &[usize]) {
        for (&cell, &successes) in cells.iter().zip(&measure.successes) {
            self.successes[cell] += successes;
            self.episodes[cell] += measure.episodes;
        }
        self.measures += 1;
        if let Some(weights) = &measure.weights {
            for (&cell, &weight) in cells.iter().zip(weights) {
                self.weights[cell] += f64::from(weight);
            }
            self.weighed += 1;
        }
    }

    fn phase(self) -> FrontierPhase {
        let Self { successes, episodes, weights, measures, weighed } = self;
        let rate = |(&episodes, &successes): (&u64, &u64)| {
            (episodes > 0).then(|| successes as f64 / episodes as f64)
        };
        let share = |(&episodes, &weight): (&u64, &f64)| (episodes > 0).then(|| weight / f64::from(weighed));
        let success = episodes.iter().zip(&successes).map(rate);
        let shares = episodes.iter().zip(&weights).map(share);
        FrontierPhase {
            success: if measures > 0 { success.collect() } else { Vec::new() },
            weights: if weighed > 0 { shares.collect() } else { Vec::new() },
        }
    }
}

impl FrontierMap {
    /// The maps of a group's runs, each with its measures by rising evaluation; `end` is the number of
    /// training steps that thirds are thirds of. Of each run the last measure of every third counts. `None`
    /// if no run has measures with goals that are positions in the plane.
    pub fn of<'a>(
        key: &GroupKey,
        maze: &MazeInfo,
        end: u64,
        runs: impl IntoIterator<Item = &'a [Frontier]>,
    ) -> Option<Self> {
        let mut sums = [Sums::new(maze), Sums::new(maze), Sums::new(maze)];
        let (mut telling, mut all) = (0, 0);
        for measures in runs {
            all += 1;
            let Some(cells) = measures.iter().find_map(|measure| cells(maze, measure.goals.as_deref()?))
            else {
                continue;
            };
            telling += 1;
            for (index, sums) in sums.iter_mut().enumerate() {
                let last = measures.iter().rev().find(|measure| third(measure.step, end) == index);
                if let Some(measure) = last {
                    sums.add(measure, &cells);
                }
            }
        }
        (telling > 0).then(|| Self { key: key.clone(), runs: (telling, all), phases: sums.map(Sums::phase) })
    }
}

/// The cell of every goal; `None` if one is no position in the plane.
fn cells(maze: &MazeInfo, goals: &[Vec<f32>]) -> Option<Vec<usize>> {
    let cell = |goal: &Vec<f32>| {
        let &[x, y] = goal.as_slice() else { return None };
        let (row, column) = maze.cell_of([x, y]);
        Some(row * maze.side() + column)
    };
    goals.iter().map(cell).collect()
}

/// The maps of the compared groups of every maze that has some.
pub fn maps<'a>(groups: &Groups<'_>, files: &FrontierFiles, mazes: &'a [MazeInfo]) -> Vec<MazeFrontier<'a>> {
    let of_maze = |maze: &'a MazeInfo| {
        let mut here = groups.compared_groups();
        here.retain(|group| group.key.environment == maze.id);
        let last = here.iter().flat_map(|group| &group.runs).filter_map(|run| run.records.last());
        let end = last.map(|record| record.step).max().unwrap_or(0);
        let map = |group: &&crate::analysis::group::Group<'_>| {
            FrontierMap::of(&group.key, maze, end, group.runs.iter().map(|run| files.of_run(run)))
        };
        let maps: Vec<FrontierMap> = here.iter().filter_map(map).collect();
        (!maps.is_empty()).then_some(MazeFrontier { maze, end, maps })
    };
    mazes.iter().filter_map(of_maze).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    #[test]
    fn maps_by_hand() {
        let maze = MazeInfo { id: "M".into(), grid: ["..", ".S"].map(String::from).to_vec() };
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let first = Frontier {
            eval_index: 0,
            step: 0,
            episodes: 4,
            successes: vec![0, 4, 1],
            goals: Some([[-0.5, -0.5], [-0.5, 0.5], [-0.1, 0.1]].map(Vec::from).to_vec()),
            weights: Some(vec![0.5, 0.25, 0.25]),
        };
        let (goals, weights) = (None, None);
        let later = |step, successes: [u64; 3]| Frontier {
            eval_index: 1,
            step,
            successes: successes.to_vec(),
            goals: goals.clone(),
            weights: weights.clone(),
            ..first
        };
        let lines = [first.clone(), later(70, [1, 1, 1]), later(90, [4, 4, 2])];
        let map = FrontierMap::of(&key, &maze, 90, [&lines[..], &[]]).expect("goals in the plane");
        assert_eq!(map.runs, (1, 2));
        // Two goals share the second cell.
        assert_eq!(map.phases[0].success, [Some(0.0), Some(0.625), None, None]);
        assert_eq!(map.phases[0].weights, [Some(0.5), Some(0.5), None, None]);
        assert_eq!(map.phases[1], FrontierPhase::default());
        // The last measure of the third counts; its teacher told no weights.
        assert_eq!(map.phases[2].success, [Some(1.0), Some(0.75), None, None]);
        assert!(map.phases[2].weights.is_empty());
        let mut elsewhere = lines;
        elsewhere[0].goals = Some(vec![vec![0.0; 3]; 3]);
        assert_eq!(FrontierMap::of(&key, &maze, 90, [&elsewhere[..]]), None);
    }
}
