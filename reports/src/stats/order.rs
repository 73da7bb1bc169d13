//! Statistics of sorted values: quantiles, median, interquartile mean.

/// The `p`-quantile, p in [0, 1], interpolated linearly between the two nearest order statistics (type 7 of
/// Hyndman and Fan 1996, numpy's default); `None` for no values or a `p` outside its range.
///
/// ```
/// assert_eq!(reports::stats::quantile(&[4.0, 1.0, 3.0, 2.0], 0.5), Some(2.5));
/// ```
pub fn quantile(values: &[f64], p: f64) -> Option<f64> {
    if values.is_empty() || !(0.0..=1.0).contains(&p) {
        return None;
    }
    let sorted = sorted(values);
    let position = p * (sorted.len() - 1) as f64;
    let (below, above) = (position.floor() as usize, position.ceil() as usize);
    Some(sorted[below] + (sorted[above] - sorted[below]) * (position - position.floor()))
}

/// The middle value, or the mean of both middle values; `None` for no values.
///
/// ```
/// assert_eq!(reports::stats::median(&[5.0, 1.0, 2.0]), Some(2.0));
/// ```
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// Interquartile mean: the mean of what remains when floor(n / 4) values are cut off at each end (Agarwal et
/// al. 2021, "Deep RL at the Edge of the Statistical Precipice"; the same cut as their rliable). `None` for
/// no values.
///
/// ```
/// // One of four is cut off at each end.
/// assert_eq!(reports::stats::iqm(&[0.0, 0.25, 0.75, 9.0]), Some(0.5));
/// ```
pub fn iqm(values: &[f64]) -> Option<f64> {
    let sorted = sorted(values);
    let cut = sorted.len() / 4;
    super::mean(&sorted[cut..sorted.len() - cut])
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_by_hand() {
        // Positions 0, 1, 2, 3; p = 0.9 lies at 2.7.
        let values = [4.0, 1.0, 2.0, 8.0];
        assert_eq!(quantile(&values, 0.0), Some(1.0));
        assert!((quantile(&values, 0.9).unwrap() - 6.8).abs() < 1e-12);
        assert_eq!(quantile(&values, 1.0), Some(8.0));
        assert_eq!(quantile(&values, 1.1), None);
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn median_by_hand() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn interquartile_mean_by_hand() {
        // Of seven values one is cut off at each end: (1 + 2 + 3 + 4 + 5) / 5.
        assert_eq!(iqm(&[100.0, 1.0, 5.0, 3.0, 2.0, 4.0, -9.0]), Some(3.0));
        assert_eq!(iqm(&[1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(iqm(&[]), None);
    }
}
