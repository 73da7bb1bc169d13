//! What the bands around learning curves show.

use crate::analysis::curves::{DDOF, Point};
use crate::analysis::options::Bands;
use crate::stats;

/// The band around the mean of a learning curve, of every evaluation for itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// What it shows.
    pub kind: Bands,
    /// Coverage of Student's interval.
    pub confidence: f64,
}

impl Default for Band {
    /// One standard deviation.
    fn default() -> Self {
        Self { kind: Bands::default(), confidence: stats::Resampling::default().confidence }
    }
}

impl Band {
    /// Its ends at `point`, not cut at 0 and 1; `None` for one seed.
    pub(super) fn at(self, point: &Point) -> Option<(f64, f64)> {
        let std = point.std?;
        let half = match self.kind {
            Bands::Std => std,
            Bands::Sem => stats::standard_error(std, point.n),
            Bands::Ci => stats::t_interval_half_width(std, point.n, self.confidence)?,
        };
        Some((point.mean - half, point.mean + half))
    }

    /// Mean and band in words, and how they are computed: `mean ± std`, `ddof = 1`.
    pub(super) fn words(self) -> (String, String) {
        let ddof = format!("ddof = {DDOF}");
        match self.kind {
            Bands::Std => ("mean ± std".to_owned(), ddof),
            Bands::Sem => ("mean ± standard error".to_owned(), ddof),
            Bands::Ci => {
                let percent = stats::rounded(100.0 * self.confidence);
                (format!("mean and its {percent} % interval"), "Student's t".to_owned())
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
        let close = |kind: Bands, half: f64| {
            let band = Band { kind, ..Band::default() };
            let (low, high) = band.at(&point).unwrap();
            assert!((low - (0.5 - half)).abs() < 1e-6 && (high - (0.5 + half)).abs() < 1e-6, "{low} {high}");
            assert_eq!(band.at(&Point { std: None, n: 1, ..point }), None);
        };
        close(Bands::Std, 0.2);
        close(Bands::Sem, 0.1);
        // t of 3 degrees of freedom at 0.975, from a printed table: 3.182446.
        close(Bands::Ci, 0.318_244_6);
    }
}
