//! The wall grids of the mazes and the map between cells and coordinates.

use crate::scene::Rectangle;

/// Cells per side.
const SIDE: usize = 13;

/// Top to bottom: row index i goes with the first coordinate. `#` wall, `.` free, `S` the free start cell.
#[derive(Debug)]
pub(super) struct Layout([&'static str; SIDE]);

impl Layout {
    /// The rows, top to bottom.
    pub(super) const fn rows(&self) -> &[&'static str] {
        &self.0
    }
}

/// MazeA.
#[rustfmt::skip]
pub(super) static A: Layout = Layout([
    "#############",
    "#S.#........#",
    "#..#........#",
    "#..#..####..#",
    "#.....#.....#",
    "#.....#.....#",
    "#..#..#..#..#",
    "#..#.....#..#",
    "#..#.....#..#",
    "#..#..#..#..#",
    "#.....#.....#",
    "#.....#.....#",
    "#############",
]);

/// MazeB.
#[rustfmt::skip]
pub(super) static B: Layout = Layout([
    "#############",
    "#..........S#",
    "#...........#",
    "#..#######..#",
    "#........#..#",
    "#........#..#",
    "#..#.....#..#",
    "#..#.....#..#",
    "#..#.....#..#",
    "#..#######..#",
    "#...........#",
    "#...........#",
    "#############",
]);

/// MazeC.
#[rustfmt::skip]
pub(super) static C: Layout = Layout([
    "#############",
    "#...........#",
    "#...........#",
    "#..#######..#",
    "#..#.....#..#",
    "#..#.....#..#",
    "#..#.....#..#",
    "#..#.....#..#",
    "#..#.....#..#",
    "#..#######..#",
    "#...........#",
    "#S..........#",
    "#############",
]);

/// A cell: `row` counts along the first coordinate, `column` along the second, both from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    /// i, along x₀.
    pub(super) row: usize,
    /// j, along x₁.
    pub(super) column: usize,
}

impl Cell {
    /// The cell that holds `position`; beyond the border the nearest one.
    pub(super) fn containing(position: [f64; 2]) -> Self {
        // A float-to-integer cast saturates, so a negative index becomes 0.
        let index = |x: f64| (((x + 1.0) / 2.0 * SIDE as f64).floor() as usize).min(SIDE - 1);
        Self { row: index(position[0]), column: index(position[1]) }
    }

    /// Its centre ((i + 0.5)·2/13 − 1, (j + 0.5)·2/13 − 1).
    pub(super) fn centre(self) -> [f64; 2] {
        [self.row, self.column].map(|index| edge(index as f64 + 0.5))
    }

    /// Its lowest and highest coordinates, the latter excluded.
    pub(super) fn bounds(self) -> Rectangle {
        [0.0, 1.0].map(|offset| [self.row, self.column].map(|index| edge(index as f64 + offset)))
    }
}

/// Coordinate of a (fractional) cell index.
fn edge(index: f64) -> f64 {
    index * 2.0 / SIDE as f64 - 1.0
}

/// A parsed maze.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    walls: [[bool; SIDE]; SIDE],
    start: Cell,
    free: Vec<Rectangle>,
}

impl Grid {
    pub(super) fn parse(layout: &Layout) -> Self {
        let mut grid =
            Self { walls: [[true; SIDE]; SIDE], start: Cell { row: 0, column: 0 }, free: Vec::new() };
        for (row, line) in layout.0.iter().enumerate() {
            for (column, mark) in line.bytes().enumerate().filter(|&(_, mark)| mark != b'#') {
                let cell = Cell { row, column };
                grid.walls[row][column] = false;
                grid.free.push(cell.bounds());
                if mark == b'S' {
                    grid.start = cell;
                }
            }
        }
        grid
    }

    /// Whether `cell` is a wall.
    ///
    /// # Panics
    /// If the cell lies outside the grid.
    pub(super) fn is_wall(&self, cell: Cell) -> bool {
        self.walls[cell.row][cell.column]
    }

    /// The cell where every episode starts.
    pub(super) fn start(&self) -> Cell {
        self.start
    }

    /// Where all cells lie that are no walls, the start cell included, row by row.
    pub(super) fn free(&self) -> &[Rectangle] {
        &self.free
    }
}

#[cfg(test)]
mod tests {
    use super::{A, B, C, Cell, Grid, Layout};

    #[test]
    fn layouts_are_square_walled_in_and_have_one_start() {
        // Free cells counted by hand, row by row.
        let mazes: [(&Layout, Cell, usize); 3] = [
            (&A, Cell { row: 1, column: 1 }, 10 + 10 + 6 + 10 + 10 + 8 + 9 + 9 + 8 + 10 + 10),
            (&B, Cell { row: 1, column: 11 }, 11 + 11 + 4 + 10 + 10 + 9 + 9 + 9 + 4 + 11 + 11),
            (&C, Cell { row: 11, column: 1 }, 11 + 11 + 4 + 9 + 9 + 9 + 9 + 9 + 4 + 11 + 11),
        ];
        for (layout, start, free) in mazes {
            let marks = layout.0.concat();
            assert!(layout.0.iter().all(|line| line.len() == 13) && marks.chars().all(|c| "#.S".contains(c)));
            assert_eq!(marks.matches('S').count(), 1);
            let grid = Grid::parse(layout);
            assert_eq!(grid.start(), start);
            assert_eq!(grid.free().len(), free);
            let border = (0..13).flat_map(|i| [(0, i), (12, i), (i, 0), (i, 12)]);
            assert!(border.into_iter().all(|(row, column)| grid.is_wall(Cell { row, column })));
        }
    }

    #[test]
    fn cells_and_coordinates_agree() {
        assert_eq!(Cell { row: 6, column: 6 }.centre(), [0.0, 0.0]);
        assert_eq!(Cell::containing([-1.0, 0.999]), Cell { row: 0, column: 12 });
        assert_eq!(Cell::containing([7.0, -7.0]), Cell { row: 12, column: 0 });
        let [low, high] = Cell { row: 0, column: 12 }.bounds();
        assert_eq!((low[0], high[1]), (-1.0, 1.0));
    }
}
