//! What the bands around learning curves show.

use crate::analysis::curves::{DDOF, Point};
use crate::stats;

/// The band around the mean of a learning curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Band {
    /// One standard deviation over seeds, up and down: how far seeds lie apart.
    #[default]
    Std,
    /// One standard error of the mean, up and down.
    Sem,
    /// Student's interval of the mean, with this coverage: how well the mean is known.
    Ci(f64),
}

impl Band {
    /// Its ends at `point`, not cut at 0 and 1; `None` for one seed.
    pub(super) fn at(self, point: &Point) -> Option<(f64, f64)> {
        let std = point.std?;
        let half = match self {
            Self::Std => std,
            Self::Sem => stats::standard_error(std, point.n),
            Self::Ci(confidence) => stats::mean_half_width(std, point.n, confidence)?,
        };
        Some((point.mean - half, point.mean + half))
    }

    /// Mean and band in words, with the bracket open: `mean ± std over 7 seeds (ddof = 1`.
    pub(super) fn over(self, seeds: &str) -> String {
        match self {
            Self::Std => format!("mean ± std over {seeds} seeds (ddof = {DDOF}"),
            Self::Sem => format!("mean ± standard error over {seeds} seeds (ddof = {DDOF}"),
            Self::Ci(confidence) => {
                format!(
                    "mean and its {} % interval over {seeds} seeds (Student's t",
                    stats::rounded(100.0 * confidence)
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_by_hand() {
        let point = Point { n: 4, mean: 0.5, std: Some(0.2), ..Point::default() };
        let ends = |band: Band| band.at(&point).unwrap();
        let close = |(low, high): (f64, f64), half: f64| {
            assert!((low - (0.5 - half)).abs() < 1e-6 && (high - (0.5 + half)).abs() < 1e-6, "{low} {high}");
        };
        close(ends(Band::Std), 0.2);
        close(ends(Band::Sem), 0.1);
        // t of 3 degrees of freedom at 0.975, from a printed table: 3.182446.
        close(ends(Band::Ci(0.95)), 0.318_244_6);
        for band in [Band::Std, Band::Sem, Band::Ci(0.95)] {
            assert_eq!(band.at(&Point { std: None, n: 1, ..point }), None);
        }
    }
}
