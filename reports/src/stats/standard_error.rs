//! How well a mean is known.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// `s / sqrt(n)`: the standard error of the mean of `n` values with the sample standard deviation `s`.
///
/// ```
/// assert_eq!(reports::stats::standard_error(0.5, 4), 0.25);
/// ```
pub fn standard_error(std_dev: f64, n: usize) -> f64 {
    std_dev / (n as f64).sqrt()
}

/// `t s / sqrt(n)`: half the width of Student's interval of that mean, where `t` is the quantile of
/// `n - 1` degrees of freedom that leaves half of what `confidence` lacks for 1 above it. `None` for fewer
/// than two values, and for a confidence outside (0, 1).
///
/// ```
/// // The quantile of 9 degrees of freedom at 0.975 is 2.262157.
/// let half = reports::stats::t_interval_half_width(1.0, 10, 0.95).unwrap();
/// assert!((half - 2.262157 / 10_f64.sqrt()).abs() < 1e-6);
/// ```
pub fn t_interval_half_width(std_dev: f64, n: usize, confidence: f64) -> Option<f64> {
    if n < 2 || !(confidence > 0.0 && confidence < 1.0) {
        return None;
    }
    let t = StudentsT::new(0.0, 1.0, (n - 1) as f64).ok()?.inverse_cdf(0.5 + confidence / 2.0);
    Some(t * standard_error(std_dev, n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_need_two_values_and_a_confidence() {
        assert_eq!(t_interval_half_width(1.0, 1, 0.95), None);
        assert_eq!(t_interval_half_width(1.0, 2, 1.0), None);
        assert_eq!(t_interval_half_width(1.0, 2, 0.0), None);
        // One degree of freedom: the Cauchy distribution, tan(0.45 pi) = 6.313752.
        let half = t_interval_half_width(1.0, 2, 0.9).unwrap();
        assert!((half - 6.313_752 / 2_f64.sqrt()).abs() < 1e-5, "{half}");
    }
}
