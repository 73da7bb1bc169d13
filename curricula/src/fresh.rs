//! Goals that no curriculum has chosen yet.

use envs::rng::Rng;
use envs::{GoalSource, Goals};

/// `n` goals of `width` numbers that `source` draws one after the other, shape `[n, width]`.
///
/// ```
/// use curricula::sample_goals;
/// use curricula::testing::Class;
/// use envs::rng::{Purpose, stream};
///
/// let mut class = Class::new("her-iid", "", 1, |_goal, _steps| 0.0);
/// let mut rng = stream(0, Purpose::Teacher);
/// let fresh = sample_goals(&mut *class.env, 2, 3, &mut rng);
/// let again = sample_goals(&mut *class.env, 2, 1, &mut stream(0, Purpose::Teacher));
/// assert_eq!((fresh.len(), fresh.row(0)), (3, again.row(0)));
/// ```
///
/// # Panics
/// If goals of the environment do not have `width` numbers.
pub fn sample_goals<S: GoalSource + ?Sized>(source: &mut S, width: usize, n: usize, rng: &mut Rng) -> Goals {
    let (mut goals, mut goal) = (Goals::with_capacity(width, n), vec![0.0; width]);
    for _ in 0..n {
        source.sample_goal(rng, &mut goal);
        goals.push(&goal);
    }
    goals
}

#[cfg(test)]
mod tests {
    use envs::rng::{Purpose, stream};
    use rand::Rng as _;

    use super::*;

    /// On a line, each goal 10 further than the one before, and a random number beside it.
    struct Counting(f64);

    impl GoalSource for Counting {
        fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
            self.0 += 10.0;
            goal.copy_from_slice(&[self.0, rng.random()]);
        }
    }

    #[test]
    fn goals_are_drawn_in_order_and_nothing_else_is() {
        let [mut rng, mut same] = [(); 2].map(|()| stream(0, Purpose::Teacher));
        let goals = sample_goals(&mut Counting(0.0), 2, 3, &mut rng);
        let expected: Vec<f64> = [10.0, 20.0, 30.0].into_iter().flat_map(|x| [x, same.random()]).collect();
        assert_eq!(goals.as_slice(), expected);
        assert!(rng == same);
        assert!(sample_goals(&mut Counting(0.0), 2, 0, &mut rng).is_empty() && rng == same);
    }
}
