//! What a report is told about environments: it knows none itself.

use crate::error::ReportError;

/// The true dimensions of an environment, beside what the paper prints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnvironmentInfo {
    /// Environment id, as in records.
    pub id: String,
    /// S, dimension of the state.
    pub state: usize,
    /// G, dimension of the goal.
    pub goal: usize,
    /// A, dimension of the action.
    pub action: usize,
    /// H, steps per episode.
    pub horizon: usize,
    /// Dimension of the action in the paper's Table 1, where it is another one.
    pub paper_action: Option<usize>,
    /// Why the two differ, or nothing.
    pub note: String,
}

/// The walls of a maze whose goals are positions in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MazeInfo {
    /// Environment id, as in records.
    pub id: String,
    /// A square of `#` (wall), `.` (free) and `S` (free, the start), spread over [-1, 1]²: the row of a cell
    /// goes with the first coordinate of a goal, its column with the second.
    pub grid: Vec<String>,
}

impl MazeInfo {
    /// Cells along each side.
    pub fn side(&self) -> usize {
        self.grid.len()
    }

    /// What the cell at `row`, `column` is; a wall outside the grid.
    pub fn cell(&self, row: usize, column: usize) -> char {
        self.grid.get(row).and_then(|line| line.chars().nth(column)).unwrap_or('#')
    }

    /// Row and column of the cell that holds a goal `[2]`; goals beyond the border belong to the nearest
    /// cell.
    pub fn cell_of(&self, goal: [f32; 2]) -> (usize, usize) {
        let side = self.side();
        // A negative number becomes 0 in the cast.
        let index =
            |x: f32| (((f64::from(x) + 1.0) / 2.0 * side as f64) as usize).min(side.saturating_sub(1));
        (index(goal[0]), index(goal[1]))
    }

    /// # Errors
    /// [`ReportError::Option`] if the grid is no square of the signs above.
    pub(crate) fn check(&self) -> Result<(), ReportError> {
        let side = self.side();
        let fits = |line: &String| line.chars().count() == side && line.chars().all(|c| "#.S".contains(c));
        if side > 0 && self.grid.iter().all(fits) {
            return Ok(());
        }
        Err(ReportError::Option {
            option: "mazes",
            value: format!("{} of {:?}", self.id, self.grid),
            accepted: "a square of `#`, `.` and `S`",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maze(grid: &[&str]) -> MazeInfo {
        MazeInfo { id: "M".into(), grid: grid.iter().map(|&line| line.to_owned()).collect() }
    }

    #[test]
    fn cells_by_hand() {
        let maze = maze(&["###", "#S#", "###"]);
        assert_eq!(maze.cell_of([-1.0, 1.0]), (0, 2));
        assert_eq!(maze.cell_of([0.0, -0.34]), (1, 0));
        assert_eq!(maze.cell_of([-5.0, 5.0]), (0, 2));
        assert_eq!((maze.cell(1, 1), maze.cell(1, 2), maze.cell(9, 0)), ('S', '#', '#'));
    }

    #[test]
    fn grids_that_are_no_squares_are_named() {
        assert!(maze(&["#.", ".#"]).check().is_ok());
        for wrong in [&["#."][..], &[], &["ab", "cd"], &["#", "##"]] {
            let error = maze(wrong).check().unwrap_err().to_string();
            assert!(error.contains("expected a square of `#`, `.` and `S`"), "{error}");
        }
    }
}
