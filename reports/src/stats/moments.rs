//! Mean and standard deviation.

/// Delta degrees of freedom: what is taken from n in the denominator of a variance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ddof {
    /// Divide by n: the values are the whole population.
    Population,
    /// Divide by n - 1 (Bessel's correction): the values are a sample, as seeds are.
    Sample,
}

impl Ddof {
    /// 0 or 1.
    pub const fn as_usize(self) -> usize {
        match self {
            Self::Population => 0,
            Self::Sample => 1,
        }
    }
}

impl std::fmt::Display for Ddof {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.as_usize())
    }
}

/// `1/n sum x_i`; `None` for no values.
///
/// ```
/// assert_eq!(reports::stats::mean(&[1.0, 2.0, 6.0]), Some(3.0));
/// ```
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// `x` to 12 decimals, so that sums in another order are equal numbers, and tie.
///
/// ```
/// use reports::stats::rounded;
///
/// assert_ne!(0.1 + 0.2 + 0.3, 0.3 + 0.2 + 0.1);
/// assert_eq!(rounded(0.1 + 0.2 + 0.3), rounded(0.3 + 0.2 + 0.1));
/// assert_eq!(rounded(-1e-13).to_bits(), 0.0_f64.to_bits());
/// ```
pub fn rounded(x: f64) -> f64 {
    // Adding 0 takes the sign from a rounded zero.
    (x * 1e12).round() / 1e12 + 0.0
}

/// `sqrt(sum (x_i - mean)^2 / (n - ddof))`; `None` where the denominator is not positive. Values that differ
/// from their mean by rounding errors alone have a deviation of exactly 0.
///
/// ```
/// use reports::stats::{Ddof, std_dev};
///
/// assert_eq!(std_dev(&[1.0, 3.0], Ddof::Sample), Some(2_f64.sqrt()));
/// assert_eq!(std_dev(&[1.0], Ddof::Sample), None);
/// ```
pub fn std_dev(values: &[f64], ddof: Ddof) -> Option<f64> {
    let denominator = values.len().checked_sub(ddof.as_usize()).filter(|&n| n > 0)?;
    let mean = mean(values)?;
    let rounding = 10.0 * f64::EPSILON * mean.abs();
    if values.iter().all(|value| (value - mean).abs() <= rounding) {
        return Some(0.0);
    }
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some((squares / denominator as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_by_hand() {
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(mean(&[]), None);
    }

    #[test]
    fn standard_deviation_by_hand() {
        // Mean 5; squared distances 9 + 1 + 1 + 1 + 0 + 0 + 4 + 16 = 32.
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        assert_eq!(std_dev(&values, Ddof::Population), Some(2.0));
        assert_eq!(std_dev(&values, Ddof::Sample), Some((32.0_f64 / 7.0).sqrt()));
    }

    #[test]
    fn equal_values_do_not_deviate() {
        // The floating-point mean of three times 0.4 is not 0.4.
        assert_eq!(std_dev(&[0.4, 0.4, 0.4], Ddof::Sample), Some(0.0));
        assert_eq!(std_dev(&[0.0, 0.0], Ddof::Sample), Some(0.0));
    }

    #[test]
    fn one_value_has_no_sample_deviation() {
        assert_eq!(std_dev(&[0.3], Ddof::Sample), None);
        assert_eq!(std_dev(&[0.3], Ddof::Population), Some(0.0));
        assert_eq!(std_dev(&[], Ddof::Population), None);
    }
}
