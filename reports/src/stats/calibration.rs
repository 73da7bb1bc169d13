//! How far estimates of a probability hold.

/// Estimates that lie close together, and what came of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReliabilityBin {
    /// How many estimates lie here.
    pub count: u64,
    /// Their sum.
    pub estimates: f64,
    /// The sum of what was found for them.
    pub outcomes: f64,
}

impl ReliabilityBin {
    /// Mean of the estimates; `None` without any.
    pub fn estimate(&self) -> Option<f64> {
        (self.count > 0).then(|| self.estimates / self.count as f64)
    }

    /// Mean of what was found; `None` without any.
    pub fn outcome(&self) -> Option<f64> {
        (self.count > 0).then(|| self.outcomes / self.count as f64)
    }

    /// The bin that holds what this one and `other` hold.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            estimates: self.estimates + other.estimates,
            outcomes: self.outcomes + other.outcomes,
        }
    }
}

/// `estimates` in [0, 1] and the shares in [0, 1] that were found for them, both `[n]`, in `bins` of equal
/// width; an estimate on a border belongs to the upper bin, 1 to the last one (DeGroot and Fienberg, "The
/// Comparison and Evaluation of Forecasters", The Statistician 1983).
///
/// ```
/// let bins = reports::stats::reliability(&[0.1, 0.5, 1.0], &[0.0, 1.0, 0.5], 2);
/// assert_eq!((bins[0].count, bins[1].count), (1, 2));
/// assert_eq!((bins[1].estimate(), bins[1].outcome()), (Some(0.75), Some(0.75)));
/// ```
///
/// # Panics
/// If the slices differ in length, or there are no bins.
pub fn reliability(estimates: &[f64], outcomes: &[f64], bins: usize) -> Vec<ReliabilityBin> {
    assert_eq!(estimates.len(), outcomes.len(), "an outcome for every estimate");
    let mut found = vec![ReliabilityBin::default(); bins];
    for (&estimate, &outcome) in estimates.iter().zip(outcomes) {
        // In single precision, as estimates are recorded: the single next to 0.7 is below it, and yet meant
        // to lie on the border. A negative number becomes 0 in the cast.
        let index = ((estimate as f32 * bins as f32) as usize).min(bins - 1);
        found[index] =
            found[index].with(&ReliabilityBin { count: 1, estimates: estimate, outcomes: outcome });
    }
    found
}

/// The expected calibration error, in [0, 1]: Σ n_b / n · |mean estimate − mean outcome| over the bins b
/// (Naeini, Cooper and Hauskrecht, "Obtaining Well Calibrated Probabilities Using Bayesian Binning", AAAI
/// 2015). `None` without an estimate.
///
/// ```
/// use reports::stats::{calibration_error, reliability};
///
/// // Two estimates of 0.2 of which none comes true, one of 0.9 that does: (2 · 0.2 + 0.1) / 3.
/// let error = calibration_error(&reliability(&[0.2, 0.2, 0.9], &[0.0, 0.0, 1.0], 10));
/// assert!((error.expect("three estimates") - 0.5 / 3.0).abs() < 1e-12);
/// ```
pub fn calibration_error(bins: &[ReliabilityBin]) -> Option<f64> {
    let all: u64 = bins.iter().map(|bin| bin.count).sum();
    // n_b · |mean estimate − mean outcome| is |Σ estimates − Σ outcomes|.
    let gaps: f64 = bins.iter().map(|bin| (bin.estimates - bin.outcomes).abs()).sum();
    (all > 0).then(|| gaps / all as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_and_error_by_hand() {
        // Borders go up, 1 stays inside.
        let counts = |estimates: &[f64]| -> Vec<u64> {
            let bins = reliability(estimates, &vec![0.0; estimates.len()], 4);
            bins.iter().map(|bin| bin.count).collect()
        };
        assert_eq!(counts(&[0.0, 0.25, 0.49, 0.5, 0.75, 1.0]), [1, 2, 1, 2]);
        // Estimates that were recorded in single precision: each border of ten bins belongs to the upper one.
        let borders: Vec<f64> = (0..10u8).map(|border| f64::from(f32::from(border) / 10.0)).collect();
        let bins = reliability(&borders, &[0.0; 10], 10);
        assert!(bins.iter().all(|bin| bin.count == 1), "{bins:?}");
        let bins = reliability(&[0.1, 0.2, 0.6, 0.8, 0.9], &[0.0, 0.5, 0.2, 0.8, 0.9], 2);
        // 0.3 against 0.5 in the first bin of two, 2.3 against 1.9 in the second of three: (0.2 + 0.4) / 5.
        assert!((calibration_error(&bins).expect("five estimates") - 0.12).abs() < 1e-12);
        assert_eq!((bins[0].estimate(), bins[0].outcome()), (Some(0.15000000000000002), Some(0.25)));
        // Errors of both signs in one bin cancel, in two they do not.
        let (estimates, outcomes) = ([0.3, 0.7], [0.7, 0.3]);
        let error = |bins| calibration_error(&reliability(&estimates, &outcomes, bins)).expect("two");
        assert!(error(1).abs() < 1e-12 && (error(2) - 0.4).abs() < 1e-12);
        assert_eq!(calibration_error(&reliability(&[], &[], 10)), None);
        assert_eq!(reliability(&[], &[], 1)[0].outcome(), None);
    }
}
