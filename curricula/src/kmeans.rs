//! Clusters that a mixture is fitted from.

use envs::Rows;
use envs::rng::Rng;
use rand::Rng as _;
use rand::distr::Distribution as _;
use rand::distr::weighted::WeightedIndex;

/// The most rounds; in practice clusters stand still long before.
const ROUNDS: usize = 300;

/// The cluster of every one of `points`, shape `[n]`, below `k`: Lloyd's algorithm from centres that are
/// drawn as in k-means++ (Arthur and Vassilvitskii, 2007), each with a probability in proportion to its
/// squared distance from the nearest centre before it.
///
/// # Panics
/// If there are fewer than `k` points.
pub(crate) fn k_means(points: &Rows, k: usize, rng: &mut Rng) -> Vec<usize> {
    assert!(points.len() >= k && k > 0, "{} points for {k} clusters", points.len());
    let mut centres = first_centres(points, k, rng);
    let mut clusters = nearest(points, &centres);
    for _ in 0..ROUNDS {
        centres = means(points, &clusters, &centres);
        let next = nearest(points, &centres);
        if next == clusters {
            break;
        }
        clusters = next;
    }
    clusters
}

/// k-means++.
fn first_centres(points: &Rows, k: usize, rng: &mut Rng) -> Rows {
    let mut centres = Rows::with_capacity(points.width(), k);
    centres.push(points.row(rng.random_range(0..points.len())));
    let mut squares: Vec<f64> = vec![f64::INFINITY; points.len()];
    while centres.len() < k {
        let newest = centres.row(centres.len() - 1);
        for (least, point) in squares.iter_mut().zip(points.iter()) {
            *least = least.min(square(point, newest));
        }
        let drawn = match WeightedIndex::new(&squares) {
            Ok(weights) => weights.sample(rng),
            // Every point is a centre already: fewer different points than clusters.
            Err(_) => rng.random_range(0..points.len()),
        };
        centres.push(points.row(drawn));
    }
    centres
}

/// The nearest of `centres` for every point; the first among equals.
fn nearest(points: &Rows, centres: &Rows) -> Vec<usize> {
    let of = |point: &[f64]| {
        let squares = centres.iter().map(|centre| square(point, centre)).enumerate();
        squares.min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(cluster, _)| cluster)
    };
    points.iter().map(of).collect()
}

/// The mean of every cluster; one that is empty keeps its centre.
fn means(points: &Rows, clusters: &[usize], centres: &Rows) -> Rows {
    let mut means = Rows::with_capacity(points.width(), centres.len());
    for (cluster, centre) in centres.iter().enumerate() {
        let members = clusters.iter().zip(points.iter()).filter(|(of, _)| **of == cluster);
        let mut sum = vec![0.0; points.width()];
        let mut count = 0.0;
        for (_, point) in members {
            sum.iter_mut().zip(point).for_each(|(sum, x)| *sum += x);
            count += 1.0;
        }
        sum.iter_mut().for_each(|sum| *sum /= count);
        means.push(if count > 0.0 { &sum } else { centre });
    }
    means
}

/// Squared distance.
fn square(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use envs::rng::{Purpose, stream};

    use super::*;

    fn line(xs: &[f64]) -> Rows {
        let mut rows = Rows::new(1);
        xs.iter().for_each(|x| rows.push(&[*x]));
        rows
    }

    #[test]
    fn groups_far_apart_are_found_from_any_stream() {
        let points = line(&[0.0, 10.0, 20.0, 0.1, 10.1, 20.1, -0.1]);
        for seed in 0..20 {
            let clusters = k_means(&points, 3, &mut stream(seed, Purpose::Teacher));
            let same = |i: usize, j: usize| clusters[i] == clusters[j];
            assert!(same(0, 3) && same(0, 6) && same(1, 4) && same(2, 5), "{seed}: {clusters:?}");
            assert!(!same(0, 1) && !same(1, 2) && !same(0, 2), "{seed}: {clusters:?}");
        }
    }

    #[test]
    fn fewer_different_points_than_clusters_are_no_trouble() {
        let clusters = k_means(&line(&[1.0; 5]), 3, &mut stream(0, Purpose::Teacher));
        assert_eq!(clusters, [0; 5], "the first among equals");
    }
}
