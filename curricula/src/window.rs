//! The last few evaluations of all goals.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::error::CurriculumError;
use crate::snapshot;
use crate::variance::population_variance;

/// A ring of the last `capacity` evaluations, each with one value per goal.
///
/// ```
/// let mut window = curricula::Window::new(2);
/// for values in [[-9.0, -9.0], [-1.0, -4.0], [-3.0, -4.0]] {
///     window.push(values.to_vec());
/// }
/// assert_eq!(window.len(), 2);
/// // The first goal's values are -1 and -3, the second one stands still.
/// assert_eq!(window.variance(), [1.0, 0.0]);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Window {
    capacity: usize,
    evaluations: VecDeque<Vec<f64>>,
}

impl Window {
    /// An empty window over `capacity` evaluations.
    ///
    /// # Panics
    /// If `capacity` is 0.
    pub fn new(capacity: usize) -> Self {
        assert!(capacity > 0, "a window holds at least one evaluation");
        Self { capacity, evaluations: VecDeque::new() }
    }

    /// How many evaluations it can hold.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// How many evaluations it holds.
    pub fn len(&self) -> usize {
        self.evaluations.len()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.evaluations.is_empty()
    }

    /// The evaluations, oldest first.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.evaluations.iter().map(Vec::as_slice)
    }

    /// The newest evaluation.
    pub fn last(&self) -> Option<&[f64]> {
        self.evaluations.back().map(Vec::as_slice)
    }

    /// Adds the values of all goals, shape `[N]`, and drops the oldest evaluation once there are `capacity`.
    ///
    /// # Panics
    /// If there are not as many values as in the last evaluation.
    pub fn push(&mut self, values: Vec<f64>) {
        if let Some(last) = self.last() {
            assert_eq!(values.len(), last.len(), "every evaluation has one value per goal");
        }
        if self.evaluations.len() == self.capacity {
            self.evaluations.pop_front();
        }
        self.evaluations.push_back(values);
    }

    /// Puts the values of all goals, shape `[N]`, in the place of the newest evaluation.
    ///
    /// # Panics
    /// If there is none, or it has another number of values.
    pub fn replace_last(&mut self, values: Vec<f64>) {
        let last = self.evaluations.back_mut().expect("an evaluation to replace");
        assert_eq!(values.len(), last.len(), "every evaluation has one value per goal");
        *last = values;
    }

    /// The evaluation before the newest.
    pub fn before_last(&self) -> Option<&[f64]> {
        self.evaluations.iter().nth_back(1).map(Vec::as_slice)
    }

    /// |C(g, t) − C(g, t−1)| of every goal, shape `[N]`: the simple difference that TEACH, section 4.3,
    /// argues against. All 0 with one evaluation, empty without any.
    pub fn difference(&self) -> Vec<f64> {
        let newest = self.last().unwrap_or_default();
        let before = self.before_last().unwrap_or(newest);
        newest.iter().zip(before).map(|(now, before)| (now - before).abs()).collect()
    }

    /// The largest size of a value in the newest evaluation; 0 without any.
    pub fn magnitude(&self) -> f64 {
        self.last().unwrap_or_default().iter().fold(0.0, |largest, value| value.abs().max(largest))
    }

    /// Refuses a loaded window of another length than `capacity`, or of other goals than `goals`.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if it is one.
    pub fn check(&self, goals: usize, capacity: usize) -> Result<(), CurriculumError> {
        for evaluation in self.iter() {
            snapshot::require_goals(evaluation.len(), goals)?;
            if let Some(value) = evaluation.iter().find(|value| !value.is_finite()) {
                return Err(snapshot::refuse(format!("a saved value is {value}")));
            }
        }
        if self.capacity != capacity || self.len() > capacity {
            let (held, written) = (self.len(), self.capacity);
            let reason = format!("{held} evaluations in a window of {written}; its config says {capacity}");
            return Err(snapshot::refuse(reason));
        }
        Ok(())
    }

    /// Population variance over time of every goal's value, shape `[N]` (TEACH, Eq. 8-9): over the
    /// evaluations there are, which may still be fewer than `capacity`. Empty if there is none.
    pub fn variance(&self) -> Vec<f64> {
        let goals = self.last().map_or(0, <[f64]>::len);
        (0..goals)
            .map(|goal| population_variance(self.evaluations.iter().map(|values| values[goal])))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_worked_variance_per_goal() {
        let mut window = Window::new(3);
        for values in [[-1.0, -4.0], [-3.0, -4.0], [-5.0, -4.0]] {
            window.push(values.to_vec());
        }
        // Goal 0: mean -3, deviations 2, 0, -2: 8/3. Goal 1 stands still.
        assert_eq!(window.variance(), [8.0 / 3.0, 0.0]);
        assert_eq!(window.difference(), [2.0, 0.0], "from -3 to -5");
        assert_eq!(window.magnitude(), 5.0);
    }

    #[test]
    fn fewer_than_two_evaluations_do_not_differ() {
        let mut window = Window::new(3);
        assert!(window.difference().is_empty() && window.magnitude() == 0.0);
        window.push(vec![-1.0, -4.0]);
        assert_eq!(window.difference(), [0.0, 0.0]);
    }

    #[test]
    fn the_newest_evaluation_can_be_made_anew() {
        let mut window = Window::new(2);
        [-50.0, -2.0].into_iter().for_each(|value| window.push(vec![value]));
        window.replace_last(vec![-4.0]);
        assert_eq!(
            (window.len(), window.before_last(), window.last()),
            (2, Some(&[-50.0][..]), Some(&[-4.0][..]))
        );
    }

    #[test]
    fn the_oldest_evaluation_is_forgotten() {
        let mut window = Window::new(2);
        for value in [-50.0, -2.0, -4.0] {
            window.push(vec![value]);
        }
        assert_eq!(window.len(), 2);
        // Mean -3, deviations 1 and -1: 1.
        assert_eq!(window.variance(), [1.0]);
    }
}
