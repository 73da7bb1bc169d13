//! Paired differences tested by flipping their signs.

use rand::Rng;
use rayon::prelude::*;

use super::Resampling;
use super::bootstrap::stream;
use super::moments::rounded;

/// Most differences whose sign flips are all enumerated; of more, flips are drawn.
pub const MOST_ENUMERATED: usize = 16;

/// The sign-flip test of paired differences, and the confidence interval that it gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignFlip {
    /// Two-sided p-value of "the differences lie symmetrically around 0".
    pub p: f64,
    /// The values around which the test at level 1 - confidence takes the differences to lie: those between
    /// these two. `None` where the test can refuse no value at that level, because there are too few
    /// differences.
    pub interval: Option<(f64, f64)>,
}

/// The sign-flip test (Fisher 1935; Good 2005, "Permutation, Parametric and Bootstrap Tests of Hypotheses")
/// of the mean over strata of the mean difference, where every difference has its sign flipped or not. Its
/// null is that the two sides of a pair are exchangeable, as they are where both come from one distribution,
/// whatever it is: then p is at most x with a probability of at most x. Sides that have equal means and are
/// not exchangeable, such as one that rarely collapses, may be refused more often. The test of the
/// differences' signs alone, -1, 0 and 1, is the companion that a few large differences cannot decide.
///
/// Flips are enumerated up to [`MOST_ENUMERATED`] differences; of more, `resampling.resamples` are drawn, and
/// the differences as they are count as one more (Phipson and Smyth 2010), so that the level holds all the
/// same.
///
/// The interval inverts the test: with the weight w of each difference in the mean, flipping a set S of
/// differences gives a mean at least as far above θ as the one found exactly where the mean of S, weighted by
/// w, is at most θ. So the k-th lowest and highest of these means bound the θ that are not refused, k =
/// floor(total (1 - confidence) / 2) (Hartigan 1969, "Using subsample values as typical values").
///
/// `strata` hold the differences of each environment. `None` if there is none, or one is empty.
///
/// ```
/// use reports::stats::{Resampling, sign_flip};
///
/// // Of 2^5 flips, the one found and its opposite are as far from 0.
/// let test = sign_flip(&[&[0.1, 0.2, 0.3, 0.1, 0.2]], Resampling::default()).unwrap();
/// assert_eq!(test.p, 0.0625);
/// ```
pub fn sign_flip(strata: &[&[f64]], resampling: Resampling) -> Option<SignFlip> {
    if strata.is_empty() || strata.iter().any(|stratum| stratum.is_empty()) {
        return None;
    }
    let weighted = strata.iter().flat_map(|stratum| {
        let weight = 1.0 / (strata.len() * stratum.len()) as f64;
        stratum.iter().map(move |difference| (weight, weight * difference))
    });
    let weighted: Vec<(f64, f64)> = weighted.collect();
    let flips = if weighted.len() <= MOST_ENUMERATED {
        all_means(&weighted)
    } else {
        drawn_means(&weighted, resampling)
    };
    Some(flips.test(1.0 - resampling.confidence))
}

/// The lowest p-value that [`sign_flip`] can give for `n` differences.
///
/// ```
/// use reports::stats::{Resampling, lowest_sign_flip_p};
///
/// assert_eq!(lowest_sign_flip_p(7, Resampling::default()), 0.015625);
/// ```
pub fn lowest_sign_flip_p(n: usize, resampling: Resampling) -> f64 {
    let total = if n <= MOST_ENUMERATED { 2_f64.powi(n as i32) } else { resampling.resamples as f64 + 1.0 };
    (2.0 / total).min(1.0)
}

/// The means of flipped sets.
struct Flips {
    /// Rising; of sets with a member.
    means: Vec<f64>,
    /// Flips of no difference, that found included: at least as far from everything as that found.
    none: usize,
}

impl Flips {
    fn new(means: impl Iterator<Item = Option<f64>>) -> Self {
        let (mut some, mut none) = (Vec::new(), 0);
        for mean in means {
            match mean {
                Some(mean) => some.push(mean),
                None => none += 1,
            }
        }
        some.sort_by(f64::total_cmp);
        Self { means: some, none }
    }

    fn test(&self, alpha: f64) -> SignFlip {
        let total = (self.means.len() + self.none) as f64;
        let count = |is: fn(f64) -> bool| self.means.iter().filter(|mean| is(**mean)).count();
        let fewer = count(|mean| mean <= 0.0).min(count(|mean| mean >= 0.0));
        // The guard is against a level such as 1 - 0.9375 that is a rounding error below what it stands for.
        let k = (total * alpha / 2.0 + 1e-9).floor() as usize;
        let rank = (k + 1).checked_sub(self.none).filter(|rank| (1..=self.means.len()).contains(rank));
        SignFlip {
            p: (2.0 * (fewer + self.none) as f64 / total).min(1.0),
            interval: rank.map(|rank| (self.means[rank - 1], self.means[self.means.len() - rank])),
        }
    }
}

/// Weighted mean from the sums of weights and of weighted differences, [`rounded`]: 0.3 - 0.1 - 0.2 is a tie
/// with 0. `None` of no difference.
fn set_mean((weight, sum): (f64, f64)) -> Option<f64> {
    (weight > 0.0).then(|| rounded(sum / weight))
}

fn add(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 + b.0, a.1 + b.1)
}

/// The means of all sets, the empty one included: that is the flip found.
fn all_means(weighted: &[(f64, f64)]) -> Flips {
    let mut sums = Vec::with_capacity(1 << weighted.len());
    sums.push((0.0, 0.0));
    for &one in weighted {
        for index in 0..sums.len() {
            sums.push(add(sums[index], one));
        }
    }
    Flips::new(sums.into_iter().map(set_mean))
}

/// The means of sets drawn at random, each from a stream of its own, and the flip found.
fn drawn_means(weighted: &[(f64, f64)], resampling: Resampling) -> Flips {
    let draw = |index: usize| {
        let mut rng = stream(resampling.seed, index);
        set_mean(weighted.iter().filter(|_| rng.random_bool(0.5)).copied().fold((0.0, 0.0), add))
    };
    let mut means: Vec<Option<f64>> = (0..resampling.resamples).into_par_iter().map(draw).collect();
    means.push(None);
    Flips::new(means.into_iter())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(confidence: f64) -> Resampling {
        Resampling { confidence, ..Resampling::default() }
    }

    #[test]
    fn sign_flip_by_hand() {
        // Flips of 1, 2, 3 have sums ±6, ±4, ±2, 0, 0: two of eight are as far from 0 as 6. Means of sets: 1,
        // 3/2, 2, 2, 2, 5/2, 3; at level 2/4 (k = 2) the second from both ends, at 2/8 the first, at less
        // none.
        let test = sign_flip(&[&[1.0, 2.0, 3.0]], at(0.5)).unwrap();
        assert_eq!(test, SignFlip { p: 0.25, interval: Some((1.5, 2.5)) });
        assert_eq!(sign_flip(&[&[1.0, 2.0, 3.0]], at(0.75)).unwrap().interval, Some((1.0, 3.0)));
        assert_eq!(sign_flip(&[&[1.0, 2.0, 3.0]], at(0.76)).unwrap().interval, None);
    }

    #[test]
    fn strata_count_alike_by_hand() {
        // (4 + (-1 - 3) / 2) / 2 = 1. In flips, 4 stands for ±2 and the others for ±1/4 and ±3/4: of eight
        // sums four are at least 1 (2 - 1, 2 - 1/2, 2 + 1/2, 2 + 1).
        let test = sign_flip(&[&[4.0], &[-1.0, -3.0]], at(0.95)).unwrap();
        assert_eq!(test.p, 1.0);
        let test = sign_flip(&[&[4.0], &[-1.0, 3.0]], at(0.95)).unwrap();
        // 2 + 1/2: two of eight are at least that, 2 + 1 and itself.
        assert_eq!(test.p, 0.5);
    }

    #[test]
    fn ties_count_whatever_the_order_of_their_sum() {
        assert_ne!(0.3 - 0.1 - 0.2, 0.0);
        assert_eq!(sign_flip(&[&[0.3, -0.1, -0.2]], at(0.95)).unwrap().p, 1.0);
        assert_eq!(
            sign_flip(&[&[0.0; 5]], at(0.5)).unwrap(),
            SignFlip { p: 1.0, interval: Some((0.0, 0.0)) }
        );
        assert_eq!(sign_flip(&[], at(0.95)), None);
        assert_eq!(sign_flip(&[&[0.1], &[]], at(0.95)), None);
    }

    #[test]
    fn the_lowest_p_value_is_that_of_one_sign() {
        for n in [1, 5, 16, 17, 40] {
            let test = sign_flip(&[&vec![0.5; n]], at(0.95)).unwrap();
            let lowest = lowest_sign_flip_p(n, at(0.95));
            assert!(test.p >= lowest && test.p < lowest + 1e-3, "n = {n}: {test:?}, {lowest}");
            assert_eq!(test.interval.is_some(), lowest <= 0.05, "n = {n}");
        }
        assert_eq!(lowest_sign_flip_p(5, at(0.95)), 0.0625);
    }
}
