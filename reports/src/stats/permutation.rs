//! Two small samples compared by exchanging their values.

/// Values that differ by less are equal: sums of the same numbers in another order must count as ties.
const ROUNDING: f64 = 1e-9;

/// Exact p-values of the permutation test of `a` against `b` (Fisher 1935; Good 2005, "Permutation,
/// Parametric and Bootstrap Tests of Hypotheses").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permutation {
    /// Of "`a` is not lower than `b`": the share of all ways to call `a.len()` of the values `a` whose
    /// difference of means is at most the one found. At least one over their number.
    pub lower: f64,
    /// Of "`a` and `b` do not differ": the share whose difference is at least as large in size.
    pub either: f64,
}

/// The number of ways to choose `n` of `n + m` values: 1 / it is the lowest p-value that [`permutation`] can
/// give.
///
/// ```
/// assert_eq!(reports::stats::permutations(2, 2), 6.0);
/// ```
pub fn permutations(n: usize, m: usize) -> f64 {
    (1..=n).map(|i| (m + i) as f64 / i as f64).product::<f64>().round()
}

/// The permutation test of the difference of means, over all [`permutations`]: where both samples come from
/// one distribution, whatever it is, a p-value is at most x with a probability of at most x. Takes time in
/// proportion to their number. `None` if a sample is empty.
///
/// ```
/// use reports::stats::{Permutation, permutation};
///
/// // No other choice of two of the four values has a higher sum; the one with the lowest lies as far off.
/// let test = permutation(&[3.0, 4.0], &[1.0, 2.0]);
/// assert_eq!(test, Some(Permutation { lower: 1.0, either: 2.0 / 6.0 }));
/// ```
pub fn permutation(a: &[f64], b: &[f64]) -> Option<Permutation> {
    if a.is_empty() || b.is_empty() {
        return None;
    }
    let values: Vec<f64> = a.iter().chain(b).copied().collect();
    let found: f64 = a.iter().sum();
    // With the sum of all values fixed, the difference of means rises with the sum of those called `a`, and
    // is 0 where that sum is this one.
    let middle = values.iter().sum::<f64>() * a.len() as f64 / values.len() as f64;
    let (mut all, mut lower, mut either) = (0.0, 0.0, 0.0);
    for_each_sum(&values, a.len(), 0.0, &mut |sum| {
        all += 1.0;
        lower += f64::from(u8::from(sum <= found + ROUNDING));
        either += f64::from(u8::from((sum - middle).abs() >= (found - middle).abs() - ROUNDING));
    });
    Some(Permutation { lower: lower / all, either: either / all })
}

/// Calls `visit` with `sum` plus the sum of every choice of `n` of `values`.
fn for_each_sum(values: &[f64], n: usize, sum: f64, visit: &mut impl FnMut(f64)) {
    if n == 0 {
        return visit(sum);
    }
    for first in 0..=values.len() - n {
        for_each_sum(&values[first + 1..], n - 1, sum + values[first], visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutation_by_hand() {
        // The pairs of {1, 2, 3, 4} have sums 3, 4, 5, 5, 6, 7, around 5. One is at most 3; 3 and 7 lie as
        // far from 5.
        let p = permutation(&[1.0, 2.0], &[3.0, 4.0]).unwrap();
        assert_eq!((p.lower, p.either), (1.0 / 6.0, 2.0 / 6.0));
        // Five of six are at most 6; all but both fives lie as far from 5 as 6 does.
        let p = permutation(&[4.0, 2.0], &[3.0, 1.0]).unwrap();
        assert_eq!((p.lower, p.either), (5.0 / 6.0, 4.0 / 6.0));
    }

    #[test]
    fn ties_count_whatever_the_order_of_their_sum() {
        // 0.1 + 0.2 + 0.3 and its reverse differ in the last bit; equal values differ in nothing.
        assert_eq!(permutation(&[0.1, 0.2, 0.3], &[0.3, 0.2, 0.1]).unwrap().either, 1.0);
        assert_eq!(permutation(&[0.4; 3], &[0.4; 5]), Some(Permutation { lower: 1.0, either: 1.0 }));
        assert_eq!(permutation(&[], &[1.0]), None);
    }

    #[test]
    fn the_lowest_p_value_is_one_over_the_number_of_permutations() {
        assert_eq!(permutations(2, 2), 6.0);
        assert_eq!(permutations(5, 12), 6188.0);
        let p = permutation(&[0.0, 0.1], &[0.5, 0.6, 0.7]).unwrap();
        assert_eq!(p.lower, 1.0 / permutations(2, 3));
    }
}
