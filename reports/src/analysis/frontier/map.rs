//! Where in a maze the student succeeds, as measured, beside where its teacher looks.

use crate::analysis::catalogue::MazeInfo;
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::parts::{budget, third_of};
use crate::analysis::shadow::WatchedRun;
use crate::analysis::teachers::{Testimony, teachers};
use crate::analysis::whole::Analysis;
use crate::schema::Frontier;
use crate::store::Run;

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
    /// The training steps whose thirds are shown: the largest budget of its runs.
    pub budget: u64,
    /// One per third of training.
    pub phases: [FrontierPhase; 3],
    /// The same beside the weights of teachers that watched, by name.
    pub shadows: Vec<(String, [FrontierPhase; 3])>,
}

/// A run as maps see it.
#[derive(Clone, Copy, Debug)]
pub struct MappedRun<'a> {
    /// Its measures by rising evaluation.
    pub measures: &'a [Frontier],
    /// What was wanted then, where others watched.
    pub watched: Option<&'a WatchedRun>,
    /// Its budget of training steps.
    pub budget: u64,
}

/// The maps of one maze.
#[derive(Debug)]
pub struct MazeFrontier<'a> {
    /// The maze.
    pub maze: &'a MazeInfo,
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

    /// Adds a measure, whose goals lie in `cells` and have these `weights`.
    fn add(&mut self, measure: &Frontier, weights: Option<&[f32]>, cells: &[usize]) {
        for (&cell, &successes) in cells.iter().zip(&measure.successes) {
            self.successes[cell] += successes;
            self.episodes[cell] += measure.episodes;
        }
        self.measures += 1;
        if let Some(weights) = weights {
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
    /// The maps of a group's runs, which teachers of these names watched, if any. Of each run the last
    /// measure of every third counts. `None` if no run has measures with goals that are positions in the
    /// plane.
    pub fn of<'a>(
        key: &GroupKey,
        maze: &MazeInfo,
        shadows: impl IntoIterator<Item = String>,
        runs: impl IntoIterator<Item = MappedRun<'a>>,
    ) -> Option<Self> {
        let runs: Vec<MappedRun<'a>> = runs.into_iter().collect();
        let place = |run: &MappedRun<'a>| {
            Some((*run, run.measures.iter().find_map(|measure| cells(maze, measure.goals.as_deref()?))?))
        };
        let telling: Vec<(MappedRun<'a>, Vec<usize>)> = runs.iter().filter_map(place).collect();
        let map = |teacher: usize| [0, 1, 2].map(|index| phase(maze, &telling, index, teacher));
        (!telling.is_empty()).then(|| Self {
            key: key.clone(),
            runs: (telling.len(), runs.len()),
            budget: runs.iter().map(|run| run.budget).max().unwrap_or(0),
            phases: map(0),
            shadows: (1..).zip(shadows).map(|(teacher, name)| (name, map(teacher))).collect(),
        })
    }
}

/// The last measures of a third of all `runs`, with the cells of their goals, and the weights of the teacher
/// in this place.
fn phase(
    maze: &MazeInfo,
    runs: &[(MappedRun<'_>, Vec<usize>)],
    index: usize,
    teacher: usize,
) -> FrontierPhase {
    let mut sums = Sums::new(maze);
    for (MappedRun { measures, watched, budget }, cells) in runs {
        let last = measures.iter().rev().find(|measure| third_of(measure.step, *budget) == index);
        if let Some(measure) = last {
            sums.add(measure, Testimony::at(measure, *watched, teacher).weights, cells);
        }
    }
    sums.phase()
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
pub fn maps<'a>(analysis: &'a Analysis<'_>) -> Vec<MazeFrontier<'a>> {
    let of_maze = |maze: &'a MazeInfo| {
        let mut here = analysis.groups.compared_groups();
        here.retain(|group| group.key.environment == maze.id);
        let mapped = |run: &&'a Run| MappedRun {
            measures: analysis.frontier.of_run(run),
            watched: analysis.shadow.of_run(run),
            budget: budget(run),
        };
        let map = |group: &&'a Group<'_>| {
            let shadows = teachers(group, &analysis.shadow, analysis.catalogue()).into_iter().skip(1);
            let names = shadows.map(|shadow| shadow.title.clone());
            FrontierMap::of(&group.key, maze, names, group.runs.iter().map(mapped))
        };
        let maps: Vec<FrontierMap> = here.iter().filter_map(map).collect();
        (!maps.is_empty()).then_some(MazeFrontier { maze, maps })
    };
    analysis.catalogue().mazes.iter().filter_map(of_maze).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;
    use crate::analysis::shadow::Wanted;

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
            ..Frontier::default()
        };
        let (goals, weights) = (None, None);
        let later = |step, successes: [u64; 3]| Frontier {
            eval_index: 1,
            step,
            successes: successes.to_vec(),
            goals: goals.clone(),
            weights: weights.clone(),
            ..first.clone()
        };
        let lines = [first.clone(), later(70, [1, 1, 1]), later(90, [4, 4, 2])];
        let wanted = |weights: Option<Vec<f32>>| Wanted { weights, ..Wanted::default() };
        let watched = WatchedRun {
            teachers: ["nova", "wren"].map(String::from).to_vec(),
            measured: [(1, vec![wanted(None), wanted(Some(vec![0.0, 0.75, 0.25]))])].into(),
            ..WatchedRun::default()
        };
        let unwatched = |measures| MappedRun { measures, watched: None, budget: 90 };
        let runs = [MappedRun { measures: &lines[..], watched: Some(&watched), budget: 90 }, unwatched(&[])];
        let names = ["wren".to_owned()];
        let map = FrontierMap::of(&key, &maze, names, runs).expect("goals in the plane");
        assert_eq!((map.runs, map.budget), ((1, 2), 90));
        // Two goals share the second cell.
        assert_eq!(map.phases[0].success, [Some(0.0), Some(0.625), None, None]);
        assert_eq!(map.phases[0].weights, [Some(0.5), Some(0.5), None, None]);
        assert_eq!(map.phases[1], FrontierPhase::default());
        // The last measure of the third counts; its teacher told no weights.
        assert_eq!(map.phases[2].success, [Some(1.0), Some(0.75), None, None]);
        assert!(map.phases[2].weights.is_empty());
        // Nothing is known of the shadow at the untrained student's measure.
        let [(name, shadow)] = &map.shadows[..] else { panic!("one shadow: {:?}", map.shadows) };
        assert_eq!((name.as_str(), shadow[0].weights.len()), ("wren", 0));
        assert_eq!(shadow[2].weights, [Some(0.0), Some(1.0), None, None]);
        assert_eq!(shadow[2].success, map.phases[2].success);
        let mut elsewhere = lines;
        elsewhere[0].goals = Some(vec![vec![0.0; 3]; 3]);
        let nothing = FrontierMap::of(&key, &maze, [], [unwatched(&elsewhere[..])]);
        assert_eq!(nothing, None);
    }
}
