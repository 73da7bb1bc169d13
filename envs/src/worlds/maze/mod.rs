//! The point mazes of VDS (Zhang, Abbeel, Pinto 2020, "Automatic Curriculum Learning through Value
//! Disagreement").
//!
//! A point moves with the velocity it is told on [−1, 1]²; walls stop it. State = achieved goal = position,
//! in the units of the square.

mod grid;

use serde_json::Value;

use super::plane::{Ground, PointOn};
use crate::draws::Draws;
use crate::env::{Defaults, GoalEnv, Spec};
use crate::error::EnvError;
use crate::registry::{Constructor, Environment, Verification};
use crate::scene::Rectangle;
use crate::world::Env;

use grid::{A, B, C, Cell, Grid, Layout};

/// TEACH's budget for mazes (section 5.2).
const DEFAULTS: Defaults = Defaults { steps: 400_000, evaluate_every: 5_000, layers: 2 };

/// The three mazes.
#[rustfmt::skip]
pub(super) static ROWS: &[Environment] = &[
    row("MazeA", &A, |spec, _| maze(spec, &A), "Walk a point through the gaps of a maze"),
    row("MazeB", &B, |spec, _| maze(spec, &B), "Walk a point around and into an open chamber"),
    row("MazeC", &C, |spec, _| maze(spec, &C), "Walk a point around a closed chamber; goals inside it are out of reach"),
];

const fn row(
    id: &'static str,
    layout: &'static Layout,
    constructor: Constructor,
    title: &'static str,
) -> Environment {
    let spec = Spec { id, family: "maze", state: 2, goal: 2, action: 2, horizon: 50, defaults: DEFAULTS };
    let source = "Zhang et al., Automatic Curriculum Learning through Value Disagreement, NeurIPS 2020";
    Environment {
        walls: Some(layout.rows()),
        verification: Verification::EXACT,
        ..Environment::new(spec, title, source, constructor)
    }
}

fn maze(spec: Spec, layout: &Layout) -> Result<Box<dyn GoalEnv>, EnvError> {
    let grid = Grid::parse(layout);
    let start = grid.start().centre();
    Ok(Box::new(Env::new(spec, PointOn::new(grid, start))))
}

/// Seconds per step.
const DT: f64 = 0.1;
/// Equal parts a step is moved in; a wall ends the motion between two of them.
const SUBSTEPS: u32 = 10;

impl Ground for Grid {
    /// Episodes always start in the centre of the start cell.
    fn start(&self, _draws: &mut Draws<'_>) -> [f64; 2] {
        Grid::start(self).centre()
    }

    /// A uniform point in a uniformly drawn free cell.
    fn goal(&self, draws: &mut Draws<'_>) -> [f64; 2] {
        let free = Grid::free(self);
        let [low, high] = free[draws.index(free.len())];
        draws.uniform(low, high)
    }

    /// Ten sub-steps of the velocity `action` times 0.01, ended by the first that enters a wall.
    fn moved(&self, mut position: [f64; 2], action: [f64; 2]) -> [f64; 2] {
        let part = DT / f64::from(SUBSTEPS);
        for _ in 0..SUBSTEPS {
            let next = [position[0] + part * action[0], position[1] + part * action[1]];
            if self.is_wall(Cell::containing(next)) {
                break;
            }
            position = next;
        }
        position
    }

    fn free(&self) -> Option<&[Rectangle]> {
        Some(Grid::free(self))
    }

    fn constants(&self) -> Vec<(&'static str, Value)> {
        vec![("dt", DT.into()), ("substeps", SUBSTEPS.into())]
    }
}

#[cfg(test)]
mod tests {
    use super::{A, B, C, Cell, Grid, Ground};
    use crate::draws::Draws;
    use crate::rng::{Purpose, stream};

    #[test]
    fn goals_are_uniform_over_free_cells() {
        for (id, layout) in [("MazeA", &A), ("MazeB", &B), ("MazeC", &C)] {
            let grid = Grid::parse(layout);
            let mut rng = stream(0, Purpose::Pool);
            let mut counts = [[0_u32; 13]; 13];
            let per_cell = 100;
            for _ in 0..per_cell * Grid::free(&grid).len() {
                let cell = Cell::containing(grid.goal(&mut Draws::from(&mut rng)));
                counts[cell.row][cell.column] += 1;
            }
            for cell in (0..169).map(|i| Cell { row: i / 13, column: i % 13 }) {
                let count = f64::from(counts[cell.row][cell.column]);
                let expected = if grid.is_wall(cell) { 0.0 } else { per_cell as f64 };
                // The count of a free cell has standard deviation 10.
                assert!((count - expected).abs() <= 0.45 * expected, "{id} {cell:?}: {count}");
            }
        }
    }

    #[test]
    fn a_wall_ends_the_motion_at_the_last_free_substep() {
        // Cell (1, 1) of maze A ends at 2·2/13 − 1 = −0.6923 upwards of row 0; row 0 is wall, above x₀ = 2/13
        // − 1 = −0.84615. From the centre −0.76923 seven sub-steps of 0.01 fit, the eighth does not.
        let [x, y] = Grid::parse(&A).moved(Cell { row: 1, column: 1 }.centre(), [-1.0, 0.0]);
        assert!((x - (-10.0 / 13.0 - 0.07)).abs() < 1e-12, "{x}");
        assert_eq!(y, Cell { row: 1, column: 1 }.centre()[1]);
    }

    #[test]
    fn a_free_step_covers_a_tenth_of_the_velocity() {
        let [x, y] = Grid::parse(&A).moved(Cell { row: 5, column: 2 }.centre(), [0.5, 1.0]);
        let [x0, y0] = Cell { row: 5, column: 2 }.centre();
        assert!((x - x0 - 0.05).abs() < 1e-12 && (y - y0 - 0.1).abs() < 1e-12);
    }
}
