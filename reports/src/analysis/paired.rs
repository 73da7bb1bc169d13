//! Two sides that share seeds.

use crate::analysis::options::ReportOptions;
use crate::stats::{self, SignFlip};

/// The values (here, there) of every seed that both sides have; each side holds its values by seed.
///
/// ```
/// use reports::analysis::paired::pairs;
///
/// let (here, there) = ([(0, 0.1), (2, 0.3), (5, 0.6)], [(1, 0.9), (2, 0.8), (5, 0.7)]);
/// assert_eq!(pairs(&here, &there), [(0.3, 0.8), (0.6, 0.7)]);
/// ```
pub fn pairs(here: &[(u64, f64)], there: &[(u64, f64)]) -> Vec<(f64, f64)> {
    let other = |seed: u64| there.iter().find(|(other, _)| *other == seed).map(|(_, value)| *value);
    here.iter().filter_map(|&(seed, value)| Some((value, other(seed)?))).collect()
}

/// The difference of two sides that share seeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairedDifference {
    /// Seeds that both have.
    pub pairs: usize,
    /// Mean over them.
    pub mean: f64,
    /// Its paired bootstrap interval; `None` for fewer than two pairs.
    pub interval: Option<(f64, f64)>,
    /// The sign-flip test of them.
    pub sign_flip: Option<SignFlip>,
}

impl PairedDifference {
    /// First less second of `pairs`; `None` of none.
    pub fn of(pairs: &[(f64, f64)], options: &ReportOptions) -> Option<Self> {
        let differences: Vec<f64> = pairs.iter().map(|(a, b)| a - b).collect();
        Some(Self {
            pairs: pairs.len(),
            mean: stats::mean(&differences)?,
            interval: stats::paired_interval(pairs, options.resampling),
            sign_flip: stats::sign_flip(&[&differences], options.resampling),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_by_hand() {
        let options = ReportOptions::default();
        let found = PairedDifference::of(&[(0.75, 0.5), (1.0, 0.5)], &options).unwrap();
        // (0.25 + 0.5) / 2; of four flips, the one found and its opposite are as far from 0.
        assert_eq!((found.pairs, found.mean, found.sign_flip.unwrap().p), (2, 0.375, 0.5));
        assert_eq!(PairedDifference::of(&[], &options), None);
    }
}
