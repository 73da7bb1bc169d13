//! Comparing two means whose variances differ, and correcting for many such comparisons.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::{Ddof, mean, std_dev};

/// The outcome of Welch's test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Welch {
    /// Difference of the means in standard errors.
    pub t: f64,
    /// Degrees of freedom by Welch and Satterthwaite; not a whole number.
    pub df: f64,
    /// Two-sided p-value.
    pub p: f64,
}

/// Welch's unequal variances t-test of `mean(a) = mean(b)` (Welch 1947). `None` where a side has fewer than
/// two values or neither side varies.
///
/// ```
/// let test = reports::stats::welch(&[0.9, 0.8, 0.85], &[0.2, 0.3, 0.1]).unwrap();
/// assert!(test.t > 0.0 && test.p < 0.01);
/// assert_eq!(reports::stats::welch(&[1.0, 1.0], &[0.0, 0.0]), None, "neither side varies");
/// ```
pub fn welch(a: &[f64], b: &[f64]) -> Option<Welch> {
    let difference = mean(a)? - mean(b)?;
    let squared_error = |values: &[f64]| Some(std_dev(values, Ddof::Sample)?.powi(2) / values.len() as f64);
    let (error_a, error_b) = (squared_error(a)?, squared_error(b)?);
    let error = error_a + error_b;
    if error == 0.0 {
        return None;
    }
    let t = difference / error.sqrt();
    let df =
        error.powi(2) / (error_a.powi(2) / (a.len() - 1) as f64 + error_b.powi(2) / (b.len() - 1) as f64);
    let distribution = StudentsT::new(0.0, 1.0, df).ok()?;
    Some(Welch { t, df, p: 2.0 * distribution.cdf(-t.abs()) })
}

/// Holm's step-down correction (Holm 1979): p-values, in their order, adjusted so that refusing those of at
/// most alpha is wrong about any true hypothesis with a probability of at most alpha.
///
/// ```
/// assert_eq!(reports::stats::holm(&[0.25, 0.125]), [0.25, 0.25]);
/// ```
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut highest: f64 = 0.0;
    for (rank, &index) in order.iter().enumerate() {
        let factor = (p_values.len() - rank) as f64;
        highest = highest.max((factor * p_values[index]).min(1.0));
        adjusted[index] = highest;
    }
    adjusted
}

/// Hochberg's step-up correction (Hochberg 1988): as [`holm`], but begun at the largest p-value, which makes
/// it sharper. It holds where the tests are independent of each other.
///
/// ```
/// assert_eq!(reports::stats::hochberg(&[0.03125, 0.03125, 0.03125]), [0.03125; 3]);
/// ```
pub fn hochberg(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[b].total_cmp(&p_values[a]));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut lowest: f64 = 1.0;
    for (rank, &index) in order.iter().enumerate() {
        lowest = lowest.min((rank + 1) as f64 * p_values[index]);
        adjusted[index] = lowest;
    }
    adjusted
}

/// Fisher's combination of independent tests (Fisher 1932): the p-value of "every null hypothesis is true".
/// It refuses where several tests are each a little too weak, and does not say which of them is false. 1 for
/// no tests; p-values of tests with few outcomes make it err to the safe side.
///
/// ```
/// assert!(reports::stats::fisher(&[0.0625, 0.0625, 0.0625]) < 0.02);
/// ```
pub fn fisher(p_values: &[f64]) -> f64 {
    // -2 times the sum of logarithms is chi-squared with twice as many degrees of freedom, whose upper tail
    // is a Poisson sum.
    let half: f64 = -p_values.iter().map(|p| p.ln()).sum::<f64>();
    let mut term = (-half).exp();
    let mut sum = 0.0;
    for index in 0..p_values.len() {
        sum += term;
        term *= half / (index + 1) as f64;
    }
    if p_values.is_empty() { 1.0 } else { sum.min(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn welch_by_hand() {
        // Means 2 and 5, variances 1 and 4, three values each: error^2 = 1/3 + 4/3 = 5/3, t = -3 / sqrt(5/3);
        // df = (25/9) / ((1/9 + 16/9) / 2) = 50/17.
        let test = welch(&[1.0, 2.0, 3.0], &[3.0, 5.0, 7.0]).unwrap();
        assert!((test.t + 3.0 / (5.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((test.df - 50.0 / 17.0).abs() < 1e-12);
    }

    #[test]
    fn no_test_without_variation() {
        assert_eq!(welch(&[1.0, 1.0], &[0.5, 0.5]), None);
        assert_eq!(welch(&[1.0], &[0.5, 0.6]), None);
    }

    #[test]
    fn holm_by_hand() {
        // Sorted: 0.01 * 4, 0.02 * 3, 0.03 * 2 (raised to 0.06 already there), 0.5 * 1.
        let adjusted = holm(&[0.03, 0.01, 0.5, 0.02]);
        for (got, expected) in adjusted.iter().zip([0.06, 0.04, 0.5, 0.06]) {
            assert!((got - expected).abs() < 1e-12, "{adjusted:?}");
        }
        assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
        assert_eq!(holm(&[]), [0.0; 0]);
    }

    #[test]
    fn hochberg_by_hand() {
        // From the largest: 0.5 * 1, 0.03 * 2, 0.02 * 3, 0.01 * 4.
        let adjusted = hochberg(&[0.03, 0.01, 0.5, 0.02]);
        for (got, expected) in adjusted.iter().zip([0.06, 0.04, 0.5, 0.06]) {
            assert!((got - expected).abs() < 1e-12, "{adjusted:?}");
        }
        // 0.04 * 1 is below 0.03 * 2, where Holm's correction has 0.06.
        assert_eq!(hochberg(&[0.03, 0.04]), [0.04, 0.04]);
        assert_eq!(hochberg(&[]), [0.0; 0]);
    }
}
