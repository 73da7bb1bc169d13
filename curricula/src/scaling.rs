//! Goals on one scale, whatever their units.

use envs::Rows;
use serde::{Deserialize, Serialize};

/// Added to every standard deviation, so that a component that never varies is no division by 0.
const LEAST: f64 = 1e-4;

/// Mean and standard deviation of every component of some rows: what brings them to mean 0 and deviation 1.
///
/// A component that never varies becomes 0. As in the code of MEGA (`mrl/modules/density.py` of
/// `spitis/mrl`), 1e-4 is added to every deviation.
///
/// ```
/// use curricula::Scaling;
/// use envs::Rows;
///
/// let mut goals = Rows::new(2);
/// goals.push(&[1.0, 5.0]);
/// goals.push(&[3.0, 5.0]);
/// let scaled = Scaling::of(&goals).rows(&goals);
/// assert!((scaled.row(0)[0] + 1.0).abs() < 1e-3);
/// assert_eq!(scaled.row(0)[1], 0.0);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    mean: Vec<f64>,
    /// With [`LEAST`] added.
    deviation: Vec<f64>,
}

impl Scaling {
    /// That of `rows`, shape `[n, d]`; the deviation is the population's.
    ///
    /// # Panics
    /// If there is no row.
    pub fn of(rows: &Rows) -> Self {
        assert!(!rows.is_empty(), "no row to scale by");
        let n = rows.len() as f64;
        let mut mean = vec![0.0; rows.width()];
        for row in rows.iter() {
            mean.iter_mut().zip(row).for_each(|(sum, x)| *sum += x / n);
        }
        let mut variance = vec![0.0; rows.width()];
        for row in rows.iter() {
            for ((sum, x), mean) in variance.iter_mut().zip(row).zip(&mean) {
                *sum += (x - mean) * (x - mean) / n;
            }
        }
        Self { mean, deviation: variance.into_iter().map(|variance| variance.sqrt() + LEAST).collect() }
    }

    /// Components of a row.
    pub fn width(&self) -> usize {
        self.mean.len()
    }

    /// `row`, shape `[d]`, on this scale.
    ///
    /// # Panics
    /// If `row` has another width, here and in [`Scaling::rows`].
    pub fn row(&self, row: &[f64]) -> Vec<f64> {
        self.scaled(row).collect()
    }

    /// All of `rows`, shape `[n, d]`, on this scale.
    pub fn rows(&self, rows: &Rows) -> Rows {
        let mut all = Rows::with_capacity(rows.width(), rows.len());
        let mut scaled = vec![0.0; self.width()];
        for row in rows.iter() {
            scaled.iter_mut().zip(self.scaled(row)).for_each(|(place, x)| *place = x);
            all.push(&scaled);
        }
        all
    }

    fn scaled(&self, row: &[f64]) -> impl Iterator<Item = f64> {
        assert_eq!(row.len(), self.width(), "a row of another width");
        row.iter().zip(&self.mean).zip(&self.deviation).map(|((x, mean), by)| (x - mean) / by)
    }
}
