//! Where one teacher sent one student, slice by slice of its training: what moving pictures are drawn from.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;

use crate::analysis::catalogue::{Catalogue, MazeInfo};
use crate::analysis::frontier::FrontierFiles;
use crate::analysis::goal_map::{COORDINATES, Cube, GoalSpaces};
use crate::analysis::group::{Group, GroupKey};
use crate::analysis::groups::Groups;
use crate::analysis::parts::{episode_end, slice_of};
use crate::schema::{Frontier, Teaching};
use crate::store::{self, Run};

/// Slices of a film, at most: at five a second they last eight seconds.
pub const MOST_SLICES: usize = 40;

/// Episodes of a slice, on average, at least: fewer would flicker.
const FEWEST_EPISODES: usize = 5;

/// A goal that was trained on, and in how many episodes of a slice.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmPick {
    /// Where it lies, `[G]`.
    pub place: Vec<f32>,
    /// Its index in the pool; `None` for a goal from elsewhere.
    pub goal: Option<u32>,
    /// Episodes.
    pub times: u32,
}

/// A slice of training.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slice {
    /// The training steps after which it begins, and with which it ends.
    pub steps: (u64, u64),
    /// The goals that were trained on, by rising index in the pool.
    pub picks: Vec<FilmPick>,
    /// Success at every goal of the pool at the last measure until its end, `[N]`; `None` before the first.
    pub success: Option<Vec<f64>>,
}

impl Slice {
    /// Episodes in it.
    pub fn episodes(&self) -> u32 {
        self.picks.iter().map(|pick| pick.times).sum()
    }
}

/// One run, slice by slice.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Which group it stands for.
    pub key: GroupKey,
    /// Its seed.
    pub seed: u64,
    /// The goals of its pool as far as they are known, `[N][G]`: all where they were measured, otherwise
    /// those that were ever trained on.
    pub goals: Vec<Vec<f32>>,
    /// The slices, which are equally long.
    pub slices: Vec<Slice>,
    /// Its evaluations: training steps and success rate.
    pub curve: Vec<(u64, f64)>,
}

impl Film {
    /// Of the run with this `seed` of a group: what its teacher did, what was measured of its student, and
    /// its `curve`. Goals of other than `coordinates` numbers are left out; `None` if none is left.
    pub fn of(
        (key, seed): (&GroupKey, u64),
        coordinates: usize,
        lines: &[Teaching],
        measures: &[Frontier],
        curve: Vec<(u64, f64)>,
    ) -> Option<Self> {
        let end = lines.last()?.step;
        let fits = |goal: &Vec<f32>| goal.len() == coordinates;
        let episodes: usize =
            lines.iter().map(|line| line.goals.iter().filter(|goal| fits(goal)).count()).sum();
        let count = (episodes / FEWEST_EPISODES).clamp(1, MOST_SLICES);
        let mut picked: Vec<BTreeMap<Place, u32>> = vec![BTreeMap::new(); count];
        let mut known: BTreeMap<u32, Vec<f32>> = BTreeMap::new();
        let mut before = 0;
        for line in lines {
            for (index, goal) in line.goals.iter().enumerate().filter(|(_, goal)| fits(goal)) {
                let pick = line.picks.as_ref().and_then(|picks| *picks.get(index)?);
                let step = episode_end(line, before, index);
                *picked[slice_of(step, end, count)].entry(Place::of(pick, goal)).or_default() += 1;
                if let Some(pick) = pick {
                    known.entry(pick).or_insert_with(|| goal.clone());
                }
            }
            before = line.step;
        }
        let measured = measures.iter().find_map(|measure| measure.goals.clone());
        let measured = measured.filter(|goals| goals.iter().all(fits));
        let is_measured = measured.is_some();
        let slice = |(index, picks): (usize, BTreeMap<Place, u32>)| {
            let edge = |index: usize| (u128::from(end) * index as u128 / count as u128) as u64;
            let steps = (edge(index), edge(index + 1));
            let last = measures.iter().rev().find(|measure| measure.step <= steps.1);
            Slice {
                steps,
                picks: picks.into_iter().map(|(place, times)| place.picked(times)).collect(),
                success: last.filter(|_| is_measured).map(Frontier::rates),
            }
        };
        (episodes > 0).then(|| Self {
            key: key.clone(),
            seed,
            goals: measured.unwrap_or_else(|| known.into_values().collect()),
            slices: picked.into_iter().enumerate().map(slice).collect(),
            curve,
        })
    }

    /// The same in half as many slices, of which one may be left over.
    #[must_use]
    pub fn halved(&self) -> Self {
        let slices = self.slices.chunks(2).map(|pair| {
            let mut picks: BTreeMap<Place, u32> = BTreeMap::new();
            for pick in pair.iter().flat_map(|slice| &slice.picks) {
                *picks.entry(Place::of(pick.goal, &pick.place)).or_default() += pick.times;
            }
            let last = &pair[pair.len() - 1];
            Slice {
                steps: (pair[0].steps.0, last.steps.1),
                picks: picks.into_iter().map(|(place, times)| place.picked(times)).collect(),
                success: last.success.clone(),
            }
        });
        Self { slices: slices.collect(), ..self.clone() }
    }

    /// Training steps at its end.
    pub fn end(&self) -> u64 {
        self.slices.last().map_or(0, |slice| slice.steps.1)
    }
}

/// A goal, in an order: its index in the pool, and its coordinates bit by bit.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place(Option<u32>, Vec<u32>);

impl Place {
    fn of(pick: Option<u32>, goal: &[f32]) -> Self {
        Self(pick, goal.iter().map(|x| x.to_bits()).collect())
    }

    fn picked(self, times: u32) -> FilmPick {
        let Self(goal, bits) = self;
        FilmPick { place: bits.into_iter().map(f32::from_bits).collect(), goal, times }
    }
}

/// The world in which goals lie.
#[derive(Clone, Copy, Debug)]
pub enum GoalWorld<'a> {
    /// Positions in a maze.
    Maze(&'a MazeInfo),
    /// Points in space, within this cube.
    Space(Cube),
}

/// The films of all environments.
#[derive(Debug, Default)]
pub struct Films<'a> {
    /// One of each group, with its world.
    pub films: Vec<(GoalWorld<'a>, Film)>,
}

impl<'a> Films<'a> {
    /// A film of each group that stands for its method, in mazes and where goals are points in space: of its
    /// run with the lowest seed that tells what its teacher did. What is wrong with the files is said where
    /// they are counted.
    pub fn of(
        results: &Path,
        groups: &Groups<'_>,
        catalogue: &'a Catalogue,
        (spaces, frontier): (&GoalSpaces, &FrontierFiles),
    ) -> Self {
        let world = |group: &&Group<'_>| {
            let id = &group.key.environment;
            let maze = catalogue.mazes.iter().find(|maze| maze.id == *id);
            let space = || spaces.environments.iter().find(|space| space.environment == *id);
            maze.map(GoalWorld::Maze).or_else(|| Some(GoalWorld::Space(space()?.cube)))
        };
        let chosen = groups.compared_groups().into_iter().filter(|group| group.is_own());
        let placed: Vec<(GoalWorld<'a>, &Group<'_>)> =
            chosen.filter_map(|group| Some((world(&group)?, group))).collect();
        let shot = |(world, group): &(GoalWorld<'a>, &Group<'_>)| {
            let coordinates = match world {
                GoalWorld::Maze(_) => 2,
                GoalWorld::Space(_) => COORDINATES,
            };
            let of_run = |run: &&Run| {
                let (lines, _) = store::teaching(results, run);
                let curve = run.records.iter().map(|record| (record.step, record.success_rate)).collect();
                let measures = frontier.of_run(run);
                Film::of((&group.key, run.key().seed), coordinates, &lines, measures, curve)
            };
            Some((*world, group.runs.iter().find_map(of_run)?))
        };
        Self { films: placed.par_iter().filter_map(shot).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_by_hand() {
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let [a, b, c] = [[0.5, 0.5], [-0.5, 0.0], [0.1, 0.2]].map(Vec::from);
        let line = |eval_index, step, goals: &[&Vec<f32>], picks: &[Option<u32>]| Teaching {
            eval_index,
            step,
            goals: goals.iter().map(|&goal| goal.clone()).collect(),
            successes: vec![false; goals.len()],
            picks: Some(picks.to_vec()),
            ..Teaching::default()
        };
        // Ten episodes of 10 steps: two slices of 50. The third goal is from elsewhere.
        let first = line(1, 40, &[&a, &b, &a, &a], &[Some(7), Some(2), Some(7), Some(7)]);
        let second =
            line(2, 100, &[&c, &a, &b, &b, &b, &b], &[None, Some(7), Some(2), Some(2), Some(2), Some(2)]);
        let measure = |step, successes: [u64; 2]| Frontier {
            step,
            episodes: 2,
            successes: successes.to_vec(),
            goals: (step == 0).then(|| vec![b.clone(), a.clone()]),
            ..Frontier::default()
        };
        let lines = [first, second];
        let measures = [measure(0, [0, 0]), measure(60, [1, 2])];
        let film =
            |measures: &[Frontier]| Film::of((&key, 3), 2, &lines, measures, Vec::new()).expect("goals");
        let told = film(&measures);
        let pick = |place: &Vec<f32>, goal, times| FilmPick { place: place.clone(), goal, times };
        assert_eq!(told.slices.len(), 2);
        assert_eq!((told.slices[0].steps, told.slices[1].steps, told.end()), ((0, 50), (50, 100), 100));
        assert_eq!(told.slices[0].picks, [pick(&c, None, 1), pick(&b, Some(2), 1), pick(&a, Some(7), 3)]);
        assert_eq!(told.slices[1].picks, [pick(&b, Some(2), 4), pick(&a, Some(7), 1)]);
        assert_eq!(told.slices[0].success, Some(vec![0.0, 0.0]));
        assert_eq!(told.slices[1].success, Some(vec![0.5, 1.0]));
        assert_eq!(told.goals, [b.clone(), a.clone()]);
        // Without a measure the pool is what was trained on.
        let untold = film(&[]);
        assert_eq!((untold.goals, &untold.slices[1].success), (vec![b.clone(), a.clone()], &None));
        let half = told.halved();
        assert_eq!((half.slices.len(), half.slices[0].steps, half.slices[0].episodes()), (1, (0, 100), 10));
        assert_eq!(half.slices[0].picks[1], pick(&b, Some(2), 5));
        assert_eq!(half.slices[0].success, told.slices[1].success);
        assert_eq!(Film::of((&key, 3), 3, &lines, &measures, Vec::new()), None, "goals of two numbers");
        assert_eq!(Film::of((&key, 3), 2, &[], &measures, Vec::new()), None);
    }

    #[test]
    fn long_runs_have_no_more_slices() {
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let line =
            Teaching { eval_index: 1, step: 5_000, goals: vec![vec![0.0, 0.0]; 500], ..Teaching::default() };
        let film = Film::of((&key, 0), 2, &[line], &[], Vec::new()).expect("goals");
        assert_eq!(film.slices.len(), MOST_SLICES);
        assert!(film.slices.iter().all(|slice| slice.episodes() >= 12), "{:?}", film.slices);
        assert!(film.goals.is_empty(), "nobody says that they are of the pool");
    }
}
