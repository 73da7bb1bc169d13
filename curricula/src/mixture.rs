//! Gaussian mixtures, fitted by expectation maximisation.
//!
//! Small and our own. `linfa-clustering` (0.8) has them too, but draws from another generation of `rand` than
//! every stream here, so that a teacher's stream could not be handed to it; it returns an error where the
//! last iteration has not converged, in place of the fit; and its tree of 70 crates has matrix products that
//! choose their instructions, and so their rounding, by the processor. What is here follows scikit-learn's
//! `GaussianMixture` step by step and is tested against it.

use std::f64::consts::TAU;

use envs::Rows;
use envs::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::kmeans::k_means;

/// Added to the variance of every coordinate, so that points on a plane are no division by 0.
pub const REGULARISATION: f64 = 1e-6;
/// An iteration that raises the mean log-likelihood of a point by less than this is the last one.
const TOLERANCE: f64 = 1e-3;
/// The most iterations.
const ITERATIONS: usize = 100;

/// A component of a [`Mixture`]: a normal distribution in d dimensions and its weight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gaussian {
    /// Share of the mixture.
    pub weight: f64,
    /// Shape `[d]`.
    pub mean: Vec<f64>,
    /// L with L Lᵀ = covariance, lower triangle, shape `[d, d]`.
    factor: Vec<f64>,
}

impl Gaussian {
    /// Coordinate (i, j) of the covariance.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        let d = self.mean.len();
        (0..=i.min(j)).map(|k| self.factor[i * d + k] * self.factor[j * d + k]).sum()
    }

    /// ln N at `point`. A point with fewer than d coordinates is judged by the marginal of the first ones.
    ///
    /// # Panics
    /// If it has more.
    pub fn log_at(&self, point: &[f64]) -> f64 {
        let (d, n) = (self.mean.len(), point.len());
        assert!(n <= d, "a point of another dimension");
        // L z = x − μ, row by row. The first n rows of L are the factor of the marginal.
        let mut z = Vec::with_capacity(n);
        let mut log_determinant = 0.0;
        for (i, x) in point.iter().enumerate() {
            let row = &self.factor[i * d..=i * d + i];
            let known: f64 = row.iter().zip(&z).map(|(l, z)| l * z).sum();
            z.push((x - self.mean[i] - known) / row[i]);
            log_determinant += row[i].ln();
        }
        let square: f64 = z.iter().map(|z| z * z).sum();
        -0.5 * (square + n as f64 * TAU.ln()) - log_determinant
    }
}

/// Σ_k weight_k N(x; μ_k, Σ_k) with full covariances.
///
/// ```
/// use curricula::Mixture;
/// use envs::Rows;
///
/// let mut points = Rows::new(1);
/// [-5.1, -5.0, -4.9, 4.9, 5.0, 5.1].iter().for_each(|x| points.push(&[*x]));
/// let (mixture, log_likelihood) = Mixture::from_assignment(&points, &[0, 0, 0, 1, 1, 1], 2).unwrap();
/// assert!((mixture.components[0].mean[0] + 5.0).abs() < 1e-9);
/// assert!(mixture.aic(log_likelihood) < 20.0);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mixture {
    /// Its components, at least one.
    pub components: Vec<Gaussian>,
}

impl Mixture {
    /// The mixture with `k` components for `points`, shape `[n, d]`, from clusters that k-means finds with
    /// numbers of `rng`, and the log-likelihood of the points under it. None if a covariance cannot be
    /// factorised, which takes coordinates of some ten thousand and more.
    ///
    /// # Panics
    /// If there are fewer than `k` points.
    pub fn fit(points: &Rows, k: usize, rng: &mut Rng) -> Option<(Self, f64)> {
        Self::from_assignment(points, &k_means(points, k, rng), k)
    }

    /// The same from a first cluster of every point, shape `[n]`, below `k`.
    pub fn from_assignment(points: &Rows, assignment: &[usize], k: usize) -> Option<(Self, f64)> {
        let mut shares = Rows::with_capacity(k, points.len());
        for &cluster in assignment {
            let row: Vec<f64> = (0..k).map(|i| if i == cluster { 1.0 } else { 0.0 }).collect();
            shares.push(&row);
        }
        let mut mixture = Self::maximise(points, &shares)?;
        let mut last = f64::NEG_INFINITY;
        for _ in 0..ITERATIONS {
            let log_likelihood = mixture.expect(points, &mut shares) / points.len() as f64;
            mixture = Self::maximise(points, &shares)?;
            if (log_likelihood - last).abs() < TOLERANCE {
                break;
            }
            last = log_likelihood;
        }
        let log_likelihood = mixture.expect(points, &mut shares);
        log_likelihood.is_finite().then_some((mixture, log_likelihood))
    }

    /// Akaike's criterion 2p − 2 ln L, with p free parameters: of two mixtures for the same points the lower
    /// one is better.
    pub fn aic(&self, log_likelihood: f64) -> f64 {
        let (k, d) = (self.components.len(), self.components[0].mean.len());
        2.0 * parameters(k, d) as f64 - 2.0 * log_likelihood
    }

    /// Whether it has a component, and all of them are of `d` dimensions.
    pub(crate) fn fits(&self, d: usize) -> bool {
        let of = |c: &Gaussian| c.mean.len() == d && c.factor.len() == d * d;
        !self.components.is_empty() && self.components.iter().all(of)
    }

    /// The share of every component in every point, shape `[n, k]`; the log-likelihood of all points.
    fn expect(&self, points: &Rows, shares: &mut Rows) -> f64 {
        shares.clear();
        let mut sum = 0.0;
        for point in points.iter() {
            let log: Vec<f64> = self.components.iter().map(|c| c.weight.ln() + c.log_at(point)).collect();
            let largest = log.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let all: f64 = log.iter().map(|log| (log - largest).exp()).sum();
            let total = largest + all.ln();
            shares.push(&log.iter().map(|log| (log - total).exp()).collect::<Vec<f64>>());
            sum += total;
        }
        sum
    }

    /// The mixture that is most likely with these `shares` of components in points, shape `[n, k]`.
    fn maximise(points: &Rows, shares: &Rows) -> Option<Self> {
        let counts: Vec<f64> = (0..shares.width())
            // A component without any point keeps a trace of weight.
            .map(|k| shares.iter().map(|row| row[k]).sum::<f64>() + 10.0 * f64::EPSILON)
            .collect();
        let total: f64 = counts.iter().sum();
        let component = |(k, count): (usize, f64)| {
            let shares: Vec<f64> = shares.iter().map(|row| row[k]).collect();
            gaussian(points, &shares, count, count / total)
        };
        let components: Option<Vec<Gaussian>> = counts.into_iter().enumerate().map(component).collect();
        Some(Self { components: components? })
    }
}

/// Free parameters of `k` components in `d` dimensions: means, covariances, and weights that sum to 1.
///
/// ```
/// // Two components in the plane: 2 (2 + 3) + 1.
/// assert_eq!(curricula::parameters(2, 2), 11);
/// ```
pub fn parameters(k: usize, d: usize) -> usize {
    k * (d + d * (d + 1) / 2) + k - 1
}

/// The component with this `weight` whose `shares` in `points` sum to `count`.
fn gaussian(points: &Rows, shares: &[f64], count: f64, weight: f64) -> Option<Gaussian> {
    let d = points.width();
    let mut mean = vec![0.0; d];
    for (point, share) in points.iter().zip(shares) {
        mean.iter_mut().zip(point).for_each(|(sum, x)| *sum += share * x);
    }
    mean.iter_mut().for_each(|sum| *sum /= count);
    let mut covariance = vec![0.0; d * d];
    let mut off = vec![0.0; d];
    for (point, share) in points.iter().zip(shares) {
        off.iter_mut().zip(point).zip(&mean).for_each(|((off, x), mean)| *off = x - mean);
        for i in 0..d {
            let by = share * off[i];
            let row = &mut covariance[i * d..=i * d + i];
            row.iter_mut().zip(&off).for_each(|(sum, off)| *sum += by * off);
        }
    }
    for i in 0..d {
        covariance[i * d..=i * d + i].iter_mut().for_each(|sum| *sum /= count);
        covariance[i * d + i] += REGULARISATION;
    }
    Some(Gaussian { weight, mean, factor: cholesky(covariance, d)? })
}

/// L with L Lᵀ = `a`, whose lower triangle counts, shape `[d, d]` both; none if `a` is not positive definite.
fn cholesky(mut a: Vec<f64>, d: usize) -> Option<Vec<f64>> {
    for i in 0..d {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| a[i * d + k] * a[j * d + k]).sum();
            let rest = a[i * d + j] - known;
            a[i * d + j] = if i == j { rest.sqrt() } else { rest / a[j * d + j] };
        }
        // Written so that a NaN fails too.
        if !(a[i * d + i] > 0.0 && a[i * d + i].is_finite()) {
            return None;
        }
    }
    Some(a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_worked_factor() {
        // [4 2; 2 5] = [2 0; 1 2] [2 1; 0 2]; the upper triangle does not count.
        assert_eq!(cholesky(vec![4.0, 9.0, 2.0, 5.0], 2), Some(vec![2.0, 9.0, 1.0, 2.0]));
        assert_eq!(cholesky(vec![1.0, 0.0, 2.0, 1.0], 2), None, "not positive definite");
        assert_eq!(cholesky(vec![f64::NAN], 1), None);
    }

    #[test]
    fn hand_worked_density_and_marginal() {
        let gaussian = Gaussian { weight: 1.0, mean: vec![1.0, -1.0], factor: vec![2.0, 9.0, 1.0, 2.0] };
        assert_eq!([gaussian.covariance(0, 1), gaussian.covariance(1, 1)], [2.0, 5.0]);
        // x − μ = (2, 3): z = (1, (3 − 1)/2 = 1), so −(1 + 1)/2 − ln 2π − ln(2·2).
        let expected = -1.0 - TAU.ln() - 4f64.ln();
        assert!((gaussian.log_at(&[3.0, 2.0]) - expected).abs() < 1e-15);
        // The first coordinate alone has deviation 2.
        assert!((gaussian.log_at(&[3.0]) - (-0.5 - 0.5 * TAU.ln() - 2f64.ln())).abs() < 1e-15);
    }

    #[test]
    fn hand_worked_criterion() {
        let one = |mean: f64| Gaussian { weight: 0.5, mean: vec![mean], factor: vec![1.0] };
        let mixture = Mixture { components: vec![one(0.0), one(4.0)] };
        // Two means, two variances, one weight: 2 · 5 − 2 · (−7).
        assert_eq!(mixture.aic(-7.0), 24.0);
    }
}
