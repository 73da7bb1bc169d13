//! Shares of successes.

use statrs::distribution::{ContinuousCDF, Normal};

/// Wilson's score interval of a success probability (Wilson 1927), without continuity correction. Unlike
/// p ± z sqrt(p (1 - p) / n), it stays in [0, 1] and has a width at 0 and n successes.
///
/// `None` for no trials, more successes than trials, or a `confidence` outside (0, 1).
///
/// ```
/// let (low, high) = reports::stats::wilson_interval(20, 20, 0.95).unwrap();
/// assert!(low > 0.8 && high == 1.0, "20 of 20 do not prove that it never fails");
/// ```
pub fn wilson_interval(successes: u64, trials: u64, confidence: f64) -> Option<(f64, f64)> {
    if trials == 0 || successes > trials || !(confidence > 0.0 && confidence < 1.0) {
        return None;
    }
    let z = Normal::standard().inverse_cdf(0.5 + confidence / 2.0);
    let n = trials as f64;
    let p = successes as f64 / n;
    let scale = 1.0 + z * z / n;
    let centre = (p + z * z / (2.0 * n)) / scale;
    let half = z / scale * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    // The interval touches 0 and 1 exactly there; rounding must not carry it across.
    let low = if successes == 0 { 0.0 } else { centre - half };
    let high = if successes == trials { 1.0 } else { centre + half };
    Some((low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_success_by_hand() {
        // With p = 0 the bounds are 0 and z^2 / (n + z^2).
        let (low, high) = wilson_interval(0, 20, 0.95).unwrap();
        let z_squared = 1.959_963_984_540_054_f64.powi(2);
        assert_eq!(low, 0.0);
        assert!((high - z_squared / (20.0 + z_squared)).abs() < 1e-9);
    }

    #[test]
    fn impossible_counts_have_no_interval() {
        assert_eq!(wilson_interval(0, 0, 0.95), None);
        assert_eq!(wilson_interval(3, 2, 0.95), None);
        assert_eq!(wilson_interval(1, 2, 1.0), None);
    }
}
