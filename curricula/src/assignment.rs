//! Pairs of least cost.

use envs::Rows;
use pathfinding::prelude::{Matrix, kuhn_munkres_min};

/// The largest cost becomes this whole number, and the others in proportion: a resolution of 1e-12.
const LARGEST: f64 = (1_u64 << 40) as f64;

/// One column for every row, each column at most once, so that the costs of the pairs, shape `[n, m]` with
/// n ≤ m, are least in sum: shape `[n]`.
///
/// The algorithm of Kuhn and Munkres from `pathfinding`, a maintained crate with a small tree that needs no
/// random numbers. Whole numbers in place of the costs keep it exact: with floating-point ones its search
/// for pairs without slack depends on rounding. Pairs of 50 rows and 1000 columns take 1 to 5 ms.
///
/// ```
/// use envs::Rows;
///
/// let mut costs = Rows::new(3);
/// costs.push(&[1.0, 2.0, 9.0]);
/// costs.push(&[1.0, 5.0, 9.0]);
/// // 2 + 1 is less than 1 + 5.
/// assert_eq!(curricula::assignment(&costs), [1, 0]);
/// ```
///
/// # Panics
/// If there are more rows than columns, or a cost is not finite.
pub fn assignment(costs: &Rows) -> Vec<usize> {
    assert!(costs.as_slice().iter().all(|cost| cost.is_finite()), "every cost is finite");
    let largest = costs.as_slice().iter().fold(0.0f64, |largest, cost| largest.max(cost.abs()));
    // Where all costs are 0 the quotient is NaN, which becomes 0.
    let whole = costs.as_slice().iter().map(|cost| (cost / largest * LARGEST).round() as i64).collect();
    let whole = Matrix::from_vec(costs.len(), costs.width(), whole).expect("n times m costs");
    kuhn_munkres_min(&whole).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_worked_pairs() {
        let mut costs = Rows::new(3);
        costs.push(&[4.0, 1.0, 3.0]);
        costs.push(&[2.0, 0.0, 5.0]);
        costs.push(&[3.0, 2.0, 2.0]);
        // 1 + 2 + 2 = 5; taking the 0 would cost 4 + 0 + 2 = 6 or 3 + 0 + 3 = 6.
        assert_eq!(assignment(&costs), [1, 0, 2]);
    }

    #[test]
    fn costs_of_any_size_and_sign_are_told_apart() {
        for scale in [1e-300, 1e-9, 1.0, 1e9, 1e300] {
            let mut costs = Rows::new(2);
            costs.push(&[-scale, -1.000_000_1 * scale]);
            assert_eq!(assignment(&costs), [1], "{scale}");
            costs.clear();
            costs.push(&[scale, -scale]);
            costs.push(&[0.0, -scale]);
            assert_eq!(assignment(&costs), [1, 0], "{scale}");
        }
        let mut none = Rows::new(2);
        none.push(&[0.0, 0.0]);
        assert!(assignment(&none)[0] < 2);
    }
}
