//! The goals that an environment can ask for, told from its geometry.

use envs::rng::{Purpose, stream};
use envs::{EnvOptions, Observation};

/// Goals are recorded in single precision; metres and units of the maze are below 2.
const ROUNDING: f64 = 1e-6;
/// How far apart objects rest that were placed alike, metres.
const RESTING: f64 = 1e-3;
/// Fetch: goals lie within this of the gripper's first place along every axis,
const REACH: f64 = 0.15;
/// for the puck within this of a place this much further,
const SLIDE: f64 = 0.3;
const SLIDE_AHEAD: f64 = 0.4;
/// and for what can be lifted up to this above the table.
const LIFT: f64 = 0.45;
/// HandReach: thumb and finger stop 5 mm each before they meet.
const FINGERS_APART: f64 = 0.01;
/// Where the object of a HandManipulate task settles, around any other such place.
const PALM: f64 = 0.1;

/// An environment's goals, around one of its starts.
pub(crate) struct GoalSpace {
    id: &'static str,
    start: Observation,
}

impl GoalSpace {
    pub(crate) fn of(id: &'static str) -> Self {
        let mut env = envs::make(id, &EnvOptions::default()).expect("an environment");
        env.reset(&mut stream(1, Purpose::Environment)).expect("a start");
        Self { id, start: env.observation().clone() }
    }

    /// Whether the environment could ask for `goal`.
    pub(crate) fn contains(&self, goal: &[f32]) -> bool {
        let goal: Vec<f64> = goal.iter().map(|&x| f64::from(x)).collect();
        let Observation { state, achieved } = &self.start;
        // The state of all Fetch tasks begins with the gripper's position. An object rests at the height of
        // the table.
        let beside = |ahead: f64, reach: f64| {
            (goal[0] - state[0] - ahead).abs() <= reach + RESTING
                && (goal[1] - state[1]).abs() <= reach + RESTING
        };
        let above_table = goal.last().zip(achieved.last()).map(|(goal, table)| goal - table);
        let lifted = |most: f64| above_table.is_some_and(|z| (-RESTING..=most + RESTING).contains(&z));
        goal.len() == achieved.len()
            && match self.id {
                "FetchReach" => distances(&goal, achieved).all(|x| x <= REACH + ROUNDING),
                "FetchPush" => beside(0.0, REACH) && lifted(0.0),
                "FetchSlide" => beside(SLIDE_AHEAD, SLIDE) && lifted(0.0),
                "FetchPickAndPlace" => beside(0.0, REACH) && lifted(LIFT),
                "HandReach" => at_rest_or_meeting(&goal, achieved),
                "HandManipulateBlockRotateZ" => {
                    in_hand(&goal, achieved) && goal[4..6].iter().all(|x| x.abs() <= ROUNDING)
                }
                "HandManipulatePenRotate" | "HandManipulateEggRotate" => in_hand(&goal, achieved),
                maze => is_free(maze, &goal),
            }
    }

    /// Whether `goal` can be achieved, as far as geometry alone says: outside of walls, with a rotation where
    /// there is one.
    pub(crate) fn can_be_achieved(&self, goal: &[f32]) -> bool {
        let goal: Vec<f64> = goal.iter().map(|&x| f64::from(x)).collect();
        let is_complete = goal.len() == self.start.achieved.len() && goal.iter().all(|x| x.is_finite());
        is_complete
            && match self.id {
                "HandManipulateBlockRotateZ" | "HandManipulatePenRotate" | "HandManipulateEggRotate" => {
                    is_rotation(&goal[3..])
                }
                id if envs::find(id).expect("an environment").walls.is_some() => is_free(id, &goal),
                _ => true,
            }
    }
}

fn distances<'a>(a: &'a [f64], b: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    a.iter().zip(b).map(|(a, b)| (a - b).abs())
}

/// Five fingertips: all where they start, or the thumb (the last) and one finger close together and the
/// others there.
fn at_rest_or_meeting(goal: &[f64], start: &[f64]) -> bool {
    let tips: Vec<(&[f64], &[f64])> = goal.chunks(3).zip(start.chunks(3)).collect();
    let moved: Vec<usize> =
        (0..5).filter(|&tip| distances(tips[tip].0, tips[tip].1).any(|x| x > ROUNDING)).collect();
    match moved[..] {
        [] => true,
        [finger, 4] => {
            let apart = distances(tips[finger].0, tips[4].0).map(|x| x * x).sum::<f64>().sqrt();
            apart <= FINGERS_APART + ROUNDING
        }
        _ => false,
    }
}

/// A position in the hand, then a rotation as a unit quaternion.
fn in_hand(goal: &[f64], start: &[f64]) -> bool {
    distances(&goal[..3], &start[..3]).all(|x| x <= PALM) && is_rotation(&goal[3..])
}

/// A unit quaternion.
fn is_rotation(quaternion: &[f64]) -> bool {
    let norm: f64 = quaternion.iter().map(|x| x * x).sum();
    (norm - 1.0).abs() <= ROUNDING
}

/// The square [-1, 1]² in 13 × 13 cells; the row goes with the first coordinate.
fn is_free(maze: &str, goal: &[f64]) -> bool {
    let walls = envs::find(maze).expect("an environment").walls.expect("a maze");
    let cell = |x: f64| ((x + 1.0) / 2.0 * walls.len() as f64).floor();
    let (row, column) = (cell(goal[0]), cell(goal[1]));
    let inside = row >= 0.0 && column >= 0.0;
    let wall = walls.get(row as usize).and_then(|row| row.as_bytes().get(column as usize));
    inside && wall.is_some_and(|cell| *cell != b'#')
}
