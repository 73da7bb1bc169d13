//! How episodes ended, by goal or by region.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::error::CurriculumError;
use crate::snapshot;

/// Whether the last episodes of each of some goals (or regions of goals) were successful, at most `capacity`
/// of each.
///
/// ```
/// let mut history = curricula::History::new(2, 3);
/// for success in [true, true, false, true] {
///     history.push(0, success);
/// }
/// assert_eq!((history.tries(0), history.rate(0)), (3, Some(2.0 / 3.0)));
/// assert_eq!(history.rate(1), None);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    capacity: usize,
    outcomes: Vec<VecDeque<bool>>,
}

impl History {
    /// No episode yet of any of `n` goals.
    ///
    /// # Panics
    /// If `capacity` is 0.
    pub fn new(n: usize, capacity: usize) -> Self {
        assert!(capacity > 0, "a history holds at least one episode");
        Self { capacity, outcomes: vec![VecDeque::new(); n] }
    }

    /// Takes in one more episode of `goal`; the oldest one beyond the capacity is forgotten.
    pub fn push(&mut self, goal: usize, success: bool) {
        let outcomes = &mut self.outcomes[goal];
        if outcomes.len() == self.capacity {
            outcomes.pop_front();
        }
        outcomes.push_back(success);
    }

    /// How many episodes of `goal` it holds.
    pub fn tries(&self, goal: usize) -> usize {
        self.outcomes[goal].len()
    }

    /// Share of them that were successful; `None` without one.
    pub fn rate(&self, goal: usize) -> Option<f64> {
        (self.tries(goal) > 0).then(|| share(self.outcomes[goal].iter().copied()))
    }

    /// The absolute difference of the success rates of the newer and of the older half of the episodes that
    /// it holds of `goal`, in [0, 1]; of an odd number the oldest does not count. 0 for fewer than two.
    pub fn progress(&self, goal: usize) -> f64 {
        let outcomes = &self.outcomes[goal];
        let half = outcomes.len() / 2;
        if half == 0 {
            return 0.0;
        }
        let newest_first = || outcomes.iter().rev().copied();
        (share(newest_first().take(half)) - share(newest_first().skip(half).take(half))).abs()
    }

    /// Refuses a loaded history of other than `n` goals or another capacity.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if it is one.
    pub fn check(&self, n: usize, capacity: usize) -> Result<(), CurriculumError> {
        let fits = self.outcomes.iter().all(|outcomes| outcomes.len() <= capacity);
        if (self.outcomes.len(), self.capacity, fits) == (n, capacity, true) {
            return Ok(());
        }
        let (goals, held) = (self.outcomes.len(), self.capacity);
        let reason = format!(
            "a history of {goals} goals and {held} episodes each; its config says {n} and {capacity}"
        );
        Err(snapshot::refuse(reason))
    }
}

/// Share of `outcomes` that are true; there is at least one.
fn share(outcomes: impl Iterator<Item = bool>) -> f64 {
    let (n, successes) = outcomes.fold((0u32, 0u32), |(n, sum), success| (n + 1, sum + u32::from(success)));
    f64::from(successes) / f64::from(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(outcomes: &[u8]) -> History {
        let mut history = History::new(1, 8);
        outcomes.iter().for_each(|&outcome| history.push(0, outcome == 1));
        history
    }

    #[test]
    fn rates_and_progress_by_hand() {
        // Of the newer four 3 succeeded, of the older four 1.
        let rising = history(&[0, 0, 1, 0, 1, 1, 0, 1]);
        assert_eq!((rising.rate(0), rising.progress(0)), (Some(0.5), 0.5));
        // Forgetting is progress, too.
        assert_eq!(history(&[1, 1, 0, 0]).progress(0), 1.0);
        // Of three the oldest does not count: 1 against 0.
        assert_eq!(history(&[1, 0, 1]).progress(0), 1.0);
        assert_eq!([history(&[]).progress(0), history(&[1]).progress(0)], [0.0, 0.0]);
        assert_eq!(history(&[1, 0, 0, 1]).progress(0), 0.0, "1 of 2 then and now");
    }

    #[test]
    fn the_oldest_episodes_are_forgotten() {
        let full = history(&[0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
        assert_eq!((full.tries(0), full.rate(0), full.progress(0)), (8, Some(1.0), 0.0));
    }

    #[test]
    fn a_history_of_another_config_is_refused() {
        let other = history(&[1]).check(2, 8).unwrap_err().to_string();
        assert!(other.contains("1 goals and 8 episodes each; its config says 2 and 8"), "{other}");
        assert!(history(&[1]).check(1, 9).is_err() && history(&[1]).check(1, 8).is_ok());
    }
}
