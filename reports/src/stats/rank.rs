//! Whether two scores order the same things alike.

/// The order in which a score puts some things, made ready to be compared with many others.
#[derive(Clone, Debug, PartialEq)]
pub struct RankOrder {
    /// Ranks less their mean, `[n]`; equal values share the mean of theirs.
    ranks: Vec<f64>,
    /// How likely each thing is among the highest, `[n]`.
    highest: Vec<f64>,
    /// How many are.
    count: f64,
}

impl RankOrder {
    /// The order of `scores`, `[n]`, of which the highest are a `share`, rounded up. Where values are equal
    /// at the border, chance chooses among them.
    pub fn of(scores: &[f64], share: f64) -> Self {
        let n = scores.len() as f64;
        let middle = (n + 1.0) / 2.0;
        // 0.1 · 30 is a little more than 3.
        let count = (share * n - 1e-9).ceil().clamp(1.0, n.max(1.0));
        let ranks = ranks(scores).into_iter().map(|rank| rank - middle).collect();
        Self { ranks, highest: among_highest(scores, count), count }
    }

    /// How many things there are.
    #[expect(clippy::len_without_is_empty, reason = "nobody asks")]
    pub fn len(&self) -> usize {
        self.ranks.len()
    }

    /// See [`spearman`].
    ///
    /// # Panics
    /// If `other` is of another number of things.
    pub fn correlation(&self, other: &Self) -> Option<f64> {
        let [own, of_other] = [self, other].map(|order| product(&order.ranks, &order.ranks));
        (own > 0.0 && of_other > 0.0).then(|| product(&self.ranks, &other.ranks) / (own * of_other).sqrt())
    }

    /// See [`top_overlap`].
    ///
    /// # Panics
    /// If `other` is of another number of things.
    pub fn overlap(&self, other: &Self) -> Option<f64> {
        (!self.highest.is_empty()).then(|| product(&self.highest, &other.highest) / self.count)
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "a partner for every value");
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Spearman's rank correlation of two scores, both `[n]`, in [-1, 1]: Pearson's correlation of their ranks,
/// of which equal values share the mean. `None` where one of them makes no difference between the things, or
/// there are none.
///
/// ```
/// // Ranks 1, 2, 3, 4 and 2, 1, 4, 3: 1 - 6 · 4 / (4 · 15).
/// let correlation = reports::stats::spearman(&[0.1, 0.2, 0.3, 0.4], &[2.0, 1.0, 9.0, 8.0]);
/// assert!((correlation.expect("both vary") - 0.6).abs() < 1e-12);
/// ```
///
/// # Panics
/// If the slices differ in length.
pub fn spearman(a: &[f64], b: &[f64]) -> Option<f64> {
    RankOrder::of(a, 1.0).correlation(&RankOrder::of(b, 1.0))
}

/// What share of the highest `share` of `a` is among those of `b` as well, both `[n]`, in [0, 1]. Where
/// values are equal at the border, it is the expectation if chance chose among them, for each score by
/// itself: `share` for scores that make no difference. `None` of nothing.
///
/// ```
/// use reports::stats::top_overlap;
///
/// // The first two against the second and the third.
/// assert_eq!(top_overlap(&[4.0, 3.0, 2.0, 1.0], &[3.0, 4.0, 5.0, 1.0], 0.5), Some(0.5));
/// // The highest of one score is one of four in the other.
/// assert_eq!(top_overlap(&[4.0, 3.0, 2.0, 1.0], &[0.25; 4], 0.25), Some(0.25));
/// ```
///
/// # Panics
/// If the slices differ in length.
pub fn top_overlap(a: &[f64], b: &[f64], share: f64) -> Option<f64> {
    RankOrder::of(a, share).overlap(&RankOrder::of(b, share))
}

/// How likely each of `values` is among the `count` highest, in [0, 1].
fn among_highest(values: &[f64], count: f64) -> Vec<f64> {
    let mut likely = vec![0.0; values.len()];
    let mut left = count;
    for tied in ties(values).into_iter().rev() {
        let each = (left / tied.len() as f64).min(1.0);
        tied.iter().for_each(|&index| likely[index] = each);
        left = (left - tied.len() as f64).max(0.0);
    }
    likely
}

/// 1 for the lowest of `values`; equal ones share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut ranks = vec![0.0; values.len()];
    let mut below = 0;
    for tied in ties(values) {
        let mean = below as f64 + (tied.len() as f64 + 1.0) / 2.0;
        tied.iter().for_each(|&index| ranks[index] = mean);
        below += tied.len();
    }
    ranks
}

/// The indices of `values` by rising value, equal ones together.
fn ties(values: &[f64]) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    order.chunk_by(|&a, &b| values[a] == values[b]).map(<[usize]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_of_another_program() {
        let close = |found: Option<f64>, expected: f64| {
            assert!((found.expect("both vary") - expected).abs() < 1e-12, "{found:?} is not {expected}");
        };
        // scipy.stats.spearmanr, scipy 1.17.1.
        close(spearman(&[0.3, 0.1, 0.4, 0.1, 0.5], &[9.0, 2.0, 6.0, 5.0, 3.0]), 0.205_195_670_417_030_85);
        close(
            spearman(&[1.0, 2.0, 2.0, 3.0, 2.0, 0.0], &[0.5, 0.5, 0.25, 0.75, 0.0, 0.0]),
            0.562_774_859_532_650_2,
        );
        close(spearman(&[1.0, 2.0, 3.0], &[-1.0, -2.0, -8.0]), -1.0);
        assert_eq!([spearman(&[], &[]), spearman(&[1.0, 2.0], &[0.5, 0.5])], [None; 2]);
        // Minus zero is zero.
        assert_eq!(spearman(&[0.0, -0.0], &[1.0, 2.0]), None);
    }

    #[test]
    fn overlaps_by_hand() {
        let a = [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.0];
        let mut b = a;
        b.reverse();
        assert_eq!([top_overlap(&a, &a, 0.3), top_overlap(&a, &b, 0.3)], [Some(1.0), Some(0.0)]);
        // Three of ten, of which the last is one of two that are equal.
        let tied = [0.9, 0.8, 0.7, 0.7, 0.5, 0.4, 0.3, 0.2, 0.1, 0.0];
        assert_eq!(top_overlap(&a, &tied, 0.3), Some(2.5 / 3.0));
        assert_eq!(top_overlap(&tied, &tied, 0.3), Some(2.5 / 3.0));
        let even = top_overlap(&[0.1; 10], &[0.1; 10], 0.3).expect("ten values");
        assert!((even - 0.3).abs() < 1e-12);
        // 10 % of 15 are two.
        let many: Vec<f64> = (0..15).map(f64::from).collect();
        assert_eq!(top_overlap(&many, &many, 0.1), Some(1.0));
        assert_eq!(top_overlap(&[], &[], 0.1), None);
        assert_eq!(top_overlap(&[0.4], &[0.2], 0.1), Some(1.0));
    }
}
