//! What teachers read off the episodes that the student remembers.

use agents::{Critic, Trajectory};
use envs::Reward;

/// The last `n` episodes in the student's replay buffer, the oldest first; fewer if it holds no more.
pub(crate) fn newest(student: &dyn Critic, n: usize) -> impl Iterator<Item = Trajectory> + '_ {
    (0..n.min(student.replay_episodes())).rev().filter_map(|age| student.replay_trajectory(age))
}

/// The mean reward of a step towards the trajectory's own goal: 0 if it was at the goal all the time, −1 if
/// it never was.
pub(crate) fn mean_reward(trajectory: &Trajectory, reward: &dyn Reward) -> f64 {
    let after = trajectory.achieved.iter().skip(1);
    let steps = after.len() as f64;
    after.map(|achieved| reward.reward(achieved, &trajectory.goal)).sum::<f64>() / steps
}

/// Whether its own goal was reached after any of its steps.
pub(crate) fn reached(trajectory: &Trajectory, reward: &dyn Reward) -> bool {
    trajectory.achieved.iter().skip(1).any(|achieved| reward.success(achieved, &trajectory.goal))
}

/// Euclidean distance.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use envs::{Rows, WithinDistance};

    use super::*;

    /// On a line, through these places.
    fn walk(places: &[f64], goal: f64) -> Trajectory {
        let mut rows = Rows::new(1);
        places.iter().for_each(|x| rows.push(&[*x]));
        Trajectory { states: rows.clone(), achieved: rows.clone(), actions: rows, goal: vec![goal] }
    }

    #[test]
    fn the_start_is_no_step() {
        let task = WithinDistance(0.1);
        let away = walk(&[1.0, 0.5, 0.0, 0.0, 0.0], 1.0);
        assert_eq!((mean_reward(&away, &task), reached(&away, &task)), (-1.0, false));
        let there = walk(&[0.0, 0.5, 1.0, 1.05, 2.0], 1.0);
        assert_eq!((mean_reward(&there, &task), reached(&there, &task)), (-0.5, true));
    }
}
