//! What effect a comparison of so many seeds can find.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use statrs::function::gamma::ln_gamma;

use super::{Ddof, mean, std_dev};

/// Cohen's d between two samples: the difference of their means over the root mean square of their standard
/// deviations. `None` where a side has fewer than two values or neither varies.
///
/// ```
/// // Both standard deviations are 1.
/// assert_eq!(reports::stats::effect_size(&[2.0, 3.0, 4.0], &[0.0, 1.0, 2.0]), Some(2.0));
/// ```
pub fn effect_size(a: &[f64], b: &[f64]) -> Option<f64> {
    let difference = mean(a)? - mean(b)?;
    let variance = (std_dev(a, Ddof::Sample)?.powi(2) + std_dev(b, Ddof::Sample)?.powi(2)) / 2.0;
    (variance > 0.0).then(|| difference / variance.sqrt())
}

/// Power of the two-sided t-test at level `alpha` with `n` seeds on each side, when the true effect size is
/// `d`: the probability that the test finds it. `None` for n < 2 or an `alpha` outside (0, 1).
///
/// The test statistic follows a noncentral t distribution with 2n - 2 degrees of freedom and noncentrality
/// d sqrt(n / 2) (Cohen 1988, chapter 2).
///
/// ```
/// use reports::stats::power;
///
/// assert!(power(2.0, 7, 0.05).unwrap() > power(2.0, 5, 0.05).unwrap());
/// assert_eq!(power(2.0, 1, 0.05), None);
/// ```
pub fn power(d: f64, n: u64, alpha: f64) -> Option<f64> {
    if n < 2 || !(alpha > 0.0 && alpha < 1.0) {
        return None;
    }
    let df = (2 * n - 2) as f64;
    let critical = StudentsT::new(0.0, 1.0, df).ok()?.inverse_cdf(1.0 - alpha / 2.0);
    let noncentrality = d.abs() * (n as f64 / 2.0).sqrt();
    Some(noncentral_t_tails(critical, df, noncentrality))
}

/// Effects above this are no longer searched by [`detectable_effect`].
const LARGEST_EFFECT: f64 = 1e4;

/// The smallest effect size (Cohen's d) at which [`power`] with `n` seeds on each side is `target`: what a
/// design can find, whatever it has found. `None` where power is undefined, or stays lower at any effect up
/// to 10,000. A `target` below `alpha` is reached without an effect.
///
/// ```
/// use reports::stats::{detectable_effect, power};
///
/// let d = detectable_effect(7, 0.05, 0.8).unwrap();
/// assert!((power(d, 7, 0.05).unwrap() - 0.8).abs() < 1e-9);
/// ```
pub fn detectable_effect(n: u64, alpha: f64, target: f64) -> Option<f64> {
    let is_enough = |d: f64| power(d, n, alpha).map(|power| power >= target);
    let (mut low, mut high) = (0.0, 1.0);
    while !is_enough(high)? {
        (low, high) = (high, 2.0 * high);
        if high > LARGEST_EFFECT {
            return None;
        }
    }
    // Power grows with d; 60 halvings leave less than a rounding error.
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if is_enough(middle)? { high = middle } else { low = middle }
    }
    Some(high)
}

/// P(|T| > x) of a noncentral t variable T = (Z + noncentrality) / S, where S^2 is chi-squared over its
/// degrees of freedom: the normal tails given S, integrated over S by Simpson's rule.
fn noncentral_t_tails(x: f64, df: f64, noncentrality: f64) -> f64 {
    let tails = |s: f64| phi(noncentrality - x * s) + phi(-x * s - noncentrality);
    // Twelve standard deviations, of about 1 / sqrt(2 df), on both sides of 1.
    let reach = 12.0 / (2.0 * df).sqrt();
    simpson(|s| tails(s) * chi_density(s, df), (1.0 - reach).max(0.0), 1.0 + reach).clamp(0.0, 1.0)
}

/// Density of S = sqrt(chi-squared(df) / df) at s >= 0: 2 (df/2)^(df/2) / Gamma(df/2) s^(df-1) exp(-df s^2 /
/// 2).
fn chi_density(s: f64, df: f64) -> f64 {
    if s <= 0.0 {
        return 0.0;
    }
    let half = df / 2.0;
    (std::f64::consts::LN_2 + half * half.ln() - ln_gamma(half) + (df - 1.0) * s.ln() - half * s * s).exp()
}

/// The standard normal distribution function.
fn phi(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

/// Integral of `f` by Simpson's rule on 1,000 intervals.
fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const INTERVALS: usize = 1_000;
    let width = (to - from) / INTERVALS as f64;
    let weight = |index: usize| match index {
        0 | INTERVALS => 1.0,
        odd if odd % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=INTERVALS).map(|index| weight(index) * f(from + index as f64 * width)).sum::<f64>() * width / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effect_size_by_hand() {
        // Means 2 and 5, variances 1 and 4.
        let d = effect_size(&[1.0, 2.0, 3.0], &[3.0, 5.0, 7.0]).unwrap();
        assert!((d + 3.0 / 2.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(effect_size(&[1.0, 1.0], &[0.0, 0.0]), None);
    }

    #[test]
    fn without_an_effect_power_is_the_level() {
        for n in [2, 3, 7, 100] {
            assert!((power(0.0, n, 0.05).unwrap() - 0.05).abs() < 1e-9, "n = {n}");
        }
    }

    #[test]
    fn simpson_is_exact_for_cubics() {
        // Integral of x^3 from 0 to 2 is 4.
        assert!((simpson(|x| x.powi(3), 0.0, 2.0) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn the_detectable_effect_has_the_power_asked_for() {
        for (n, alpha) in [(2, 0.05), (7, 0.0125), (100, 0.05)] {
            let d = detectable_effect(n, alpha, 0.8).unwrap();
            assert!((power(d, n, alpha).unwrap() - 0.8).abs() < 1e-9, "n = {n}");
        }
        assert_eq!(detectable_effect(1, 0.05, 0.8), None);
        assert_eq!(power(1.0, 1, 0.05), None);
    }
}
