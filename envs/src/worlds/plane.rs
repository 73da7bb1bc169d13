//! What Point and the mazes share: a point on the square [−1, 1]² that has to come close to a goal.

use serde_json::{Map, Value};

use crate::draws::Draws;
use crate::env::{Observation, Reward};
use crate::error::EnvError;
use crate::metric::WithinDistance;
use crate::playback::{PlaybackError, RecordedWorld, Start};
use crate::scene::{PlaneScene, Rectangle, Scene};
use crate::world::World;

/// Distance within which a goal counts as reached.
const THRESHOLD: f64 = 0.1;

/// Where a point starts, which goals it gets, and how it moves.
pub(super) trait Ground: Send + Sync {
    /// Draws a start.
    fn start(&self, draws: &mut Draws<'_>) -> [f64; 2];

    /// Draws a goal.
    fn goal(&self, draws: &mut Draws<'_>) -> [f64; 2];

    /// Where `action` takes a point at `position`.
    fn moved(&self, position: [f64; 2], action: [f64; 2]) -> [f64; 2];

    /// The parts without walls; nothing where all of the square is free.
    fn free(&self) -> Option<&[Rectangle]>;

    /// Constants under the names that recordings use, apart from the threshold.
    fn constants(&self) -> Vec<(&'static str, Value)>;
}

/// A point on some ground. State = achieved goal = position.
#[derive(Clone, Debug)]
pub(super) struct PointOn<G> {
    ground: G,
    position: [f64; 2],
}

impl<G: Ground> PointOn<G> {
    /// A point at `position`.
    pub(super) fn new(ground: G, position: [f64; 2]) -> Self {
        Self { ground, position }
    }
}

impl<G: Ground> World for PointOn<G> {
    fn start(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError> {
        self.position = self.ground.start(draws);
        Ok(())
    }

    fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]) {
        goal.copy_from_slice(&self.ground.goal(draws));
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.position = self.ground.moved(self.position, [action[0], action[1]]);
        Ok(())
    }

    fn observe(&self, observation: &mut Observation) {
        observation.state.copy_from_slice(&self.position);
        observation.achieved.copy_from_slice(&self.position);
    }

    fn task(&self) -> &dyn Reward {
        &WithinDistance(THRESHOLD)
    }

    fn scene(&self, goal: &[f64]) -> Option<Scene<'_>> {
        Some(Scene::Plane(PlaneScene {
            free: self.ground.free(),
            ..PlaneScene::point(self.position, [goal[0], goal[1]], THRESHOLD)
        }))
    }

    fn recorded(&mut self) -> Option<&mut dyn RecordedWorld> {
        Some(self)
    }
}

impl<G: Ground> RecordedWorld for PointOn<G> {
    fn constants(&self) -> Map<String, Value> {
        let own = self.ground.constants();
        let all = std::iter::once(("distance_threshold", THRESHOLD.into())).chain(own);
        all.map(|(name, value)| (name.to_owned(), value)).collect()
    }

    fn capture(&self) -> Start {
        Start::Position(self.position.to_vec())
    }

    fn restore(&mut self, state: &Start) -> Result<(), PlaybackError> {
        self.position = state.position()?;
        Ok(())
    }
}
