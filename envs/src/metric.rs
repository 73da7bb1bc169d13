//! Distances, and rewards made of them.

use crate::env::Reward;

/// Success within this Euclidean distance of the goal: the task of all environments that ask for positions.
///
/// As in the originals a goal at exactly this distance is no success and yet costs nothing.
///
/// ```
/// use envs::{Reward, WithinDistance};
///
/// let task = WithinDistance(0.1);
/// assert!(task.success(&[0.0, 0.0], &[0.0, 0.05]));
/// assert_eq!(task.reward(&[0.0, 0.0], &[0.0, 0.2]), -1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithinDistance(pub f64);

impl Reward for WithinDistance {
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        distance(achieved, goal) < self.0
    }

    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        if distance(achieved, goal) > self.0 { -1.0 } else { 0.0 }
    }
}

/// Euclidean distance ‖a − b‖₂.
///
/// # Panics
/// If the lengths differ.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "distance between points of different dimension");
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Length of `v`, with products and sums fused as numpy's `linalg.norm` does for a single vector. Objects
/// settle over 200 simulation steps with contacts, which turn a difference in the last bit into a visible
/// one.
pub(crate) fn norm(v: &[f64]) -> f64 {
    v.iter().fold(0.0_f64, |sum, part| part.mul_add(*part, sum)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{WithinDistance, distance, norm};
    use crate::env::Reward;

    #[test]
    fn distance_is_euclidean() {
        assert_eq!(distance(&[1.0, 2.0, 3.0], &[1.0, 5.0, 7.0]), 5.0);
    }

    #[test]
    fn norm_is_the_length() {
        assert_eq!(norm(&[2.0, 3.0, 6.0]), 7.0);
    }

    #[test]
    fn reward_at_the_threshold_itself_is_zero() {
        let task = WithinDistance(0.05);
        assert_eq!(task.reward(&[0.05], &[0.0]), 0.0);
        assert!(!task.success(&[0.05], &[0.0]));
        assert_eq!(task.reward(&[0.050_001], &[0.0]), -1.0);
    }
}
