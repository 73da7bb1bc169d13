//! The variance that TEACH takes over time and VDS over an ensemble.

/// Standard deviation of a goal's values that says nothing about the goal: their rounding.
///
/// Values of a trained critic are single-precision numbers in [−1/(1−γ), 0], which is [−100, 0] for the
/// longest horizon of the paper. Neighbouring numbers there are up to 2⁻¹⁷ = 7.6e-6 apart, and rounding to
/// them has a standard deviation of 7.6e-6 / √12 = 2.2e-6.
pub const ROUNDING: f64 = 3e-6;

/// From here down to twice this, the spacing of single-precision numbers is the one behind [`ROUNDING`].
const BINADE: f64 = -64.0;

/// [`ROUNDING`] of a student whose values reach down to `lowest`, −1/(1−γ). Constant for values above −128;
/// doubles at −128, −256, …, where the spacing of single-precision numbers doubles.
///
/// ```
/// assert_eq!(curricula::rounding(-50.0), curricula::ROUNDING);
/// assert_eq!(curricula::rounding(-200.0), 2.0 * curricula::ROUNDING);
/// ```
pub fn rounding(lowest: f64) -> f64 {
    // No less for shorter horizons: a difference of 3e-6 in value is nothing there, either.
    ROUNDING * (lowest / BINADE).log2().floor().exp2().max(1.0)
}

/// Population variance, (1/n) Σ (x − mean)², of `values`; 0 for fewer than two.
///
/// Deviations are taken from the first value, so that equal values give exactly 0 and a common offset costs
/// no precision.
///
/// ```
/// // The mean is 3, the deviations are -2, 0 and 2.
/// assert_eq!(curricula::population_variance([1.0, 3.0, 5.0]), 8.0 / 3.0);
/// ```
pub fn population_variance(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values = values.into_iter();
    let Some(first) = values.next() else { return 0.0 };
    let (mut n, mut sum, mut squares) = (1.0, 0.0, 0.0);
    for value in values {
        let deviation = value - first;
        n += 1.0;
        sum += deviation;
        squares += deviation * deviation;
    }
    let variance = (squares - sum * sum / n) / n;
    // Rounding can leave a difference of equal numbers slightly below 0. (`max` would also hide a NaN.)
    if variance < 0.0 { 0.0 } else { variance }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn hand_worked_values() {
        // Mean 3, deviations -2, 0, 2: (4 + 0 + 4) / 3.
        assert_eq!(population_variance([1.0, 3.0, 5.0]), 8.0 / 3.0);
        assert_eq!(population_variance([-7.5]), 0.0);
        assert_eq!(population_variance([]), 0.0);
    }

    #[test]
    fn rounding_grows_with_values_beyond_the_papers() {
        assert_eq!([-1.0, -50.0, -100.0].map(rounding), [3e-6; 3]);
        // Numbers near -200 are twice and those near -400 four times as far apart as those near -100.
        assert_eq!([-200.0, -400.0].map(rounding), [6e-6, 1.2e-5]);
        // Rounding to numbers so far apart has a standard deviation of their spacing over √12.
        for lowest in [1.0f32, 50.0, 100.0, 127.0, 129.0, 255.0, 257.0, 1000.0] {
            let spacing = f64::from(lowest.next_up() - lowest);
            assert!(rounding(f64::from(-lowest)) > spacing / 12f64.sqrt(), "{lowest}");
        }
    }

    #[test]
    fn equal_values_give_exactly_zero() {
        // The mean of ten times 0.1 is not 0.1 in binary; the variance must be 0 all the same.
        assert_eq!(population_variance([0.1; 10]), 0.0);
    }

    #[test]
    fn nan_stays_visible() {
        assert!(population_variance([0.0, f64::NAN]).is_nan());
    }

    proptest! {
        #[test]
        fn matches_the_two_pass_definition(values in prop::collection::vec(-50.0..0.0f64, 1..30)) {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let expected = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
            prop_assert!((population_variance(values) - expected).abs() < 1e-10);
        }

        #[test]
        fn does_not_depend_on_the_order(mut values in prop::collection::vec(-50.0..0.0f64, 1..30)) {
            let forward = population_variance(values.clone());
            values.reverse();
            prop_assert!((population_variance(values) - forward).abs() < 1e-10);
        }
    }
}
