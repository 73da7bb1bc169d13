//! A toy task for tests: a point on a square that moves where it is pushed.
//!
//! Cheap and easily solved, so that a learning test can tell a working student from a broken one within
//! seconds.

use serde_json::Value;

use super::plane::{Ground, PointOn};
use crate::draws::Draws;
use crate::env::{Defaults, Spec};
use crate::registry::Environment;
use crate::scene::Rectangle;
use crate::world::Env;

/// The toy task.
pub(super) static ROWS: &[Environment] = &[Environment::new(
    Spec { id: "Point", family: "toy", state: 2, goal: 2, action: 2, horizon: 20, defaults: Defaults::TOY },
    "Push a point to a place on an empty square (for tests)",
    "goalbench's own",
    |spec, _| Ok(Box::new(Env::new(spec, PointOn::new(Square, [0.0; 2])))),
)];

/// Half the side of the square.
const BOUND: f64 = 1.0;
/// Half the side of the square of start positions.
const START: f64 = 0.2;
/// Distance covered per step by an action component of 1.
const SPEED: f64 = 0.15;

/// The empty square: x' = clip(x + 0.15·a). Starts uniform on [−0.2, 0.2]², goals on all of it.
struct Square;

impl Ground for Square {
    fn start(&self, draws: &mut Draws<'_>) -> [f64; 2] {
        draws.uniform([-START; 2], [START; 2])
    }

    fn goal(&self, draws: &mut Draws<'_>) -> [f64; 2] {
        draws.uniform([-BOUND; 2], [BOUND; 2])
    }

    fn moved(&self, position: [f64; 2], action: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| (position[axis] + SPEED * action[axis]).clamp(-BOUND, BOUND))
    }

    fn free(&self) -> Option<&[Rectangle]> {
        None
    }

    fn constants(&self) -> Vec<(&'static str, Value)> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{Ground, Square};

    #[test]
    fn a_full_push_covers_the_speed_and_stops_at_the_border() {
        assert_eq!(Square.moved([0.5, 0.95], [-1.0, 1.0]), [0.35, 1.0]);
    }
}
