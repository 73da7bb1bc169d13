//! A flat matrix of f64 rows: goals, states, actions.

use serde::{Deserialize, Serialize};

/// `len` rows of `width` numbers each, stored one after the other.
///
/// ```
/// let mut goals = envs::Goals::new(2);
/// goals.push(&[0.0, 1.0]);
/// goals.push(&[2.0, 3.0]);
/// assert_eq!((goals.len(), goals.row(1)), (2, &[2.0, 3.0][..]));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rows {
    width: usize,
    data: Vec<f64>,
}

/// Goals: one row per goal, shape `[n, goal dimension]`.
pub type Goals = Rows;

impl Rows {
    /// An empty matrix whose rows will hold `width` numbers.
    ///
    /// # Panics
    /// If `width` is 0.
    pub fn new(width: usize) -> Self {
        assert!(width > 0, "a row holds at least one number");
        Self { width, data: Vec::new() }
    }

    /// An empty matrix with room for `rows` rows.
    pub fn with_capacity(width: usize, rows: usize) -> Self {
        let mut empty = Self::new(width);
        empty.data.reserve(width * rows);
        empty
    }

    /// Numbers per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.data.len() / self.width
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    /// Row `index`, shape `[width]`.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, index: usize) -> &[f64] {
        &self.data[index * self.width..(index + 1) * self.width]
    }

    /// Appends one row.
    ///
    /// # Panics
    /// If `row` does not hold `width` numbers.
    pub fn push(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.width, "row of {} numbers pushed on rows of {}", row.len(), self.width);
        self.data.extend_from_slice(row);
    }

    /// Removes all rows and keeps the memory.
    pub fn clear(&mut self) {
        self.data.clear();
    }

    /// The rows in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.data.chunks_exact(self.width)
    }

    /// All numbers, row after row.
    pub fn as_slice(&self) -> &[f64] {
        &self.data
    }
}
