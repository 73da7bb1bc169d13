//! Which goal of a pool an episode tells of. A teacher that hears of an episode need not have chosen its
//! goal: another one may act while it looks on.

use envs::Goals;

use crate::replayed::distance;

/// The goal of `pool`, shape `[N, G]`, that is nearest to `goal`, shape `[G]`, in Euclidean distance; the
/// first of several.
///
/// ```
/// let mut pool = envs::Goals::new(1);
/// [0.0, 5.0, 2.0, 5.0].iter().for_each(|x| pool.push(&[*x]));
/// assert_eq!([5.0, 3.0, -9.0].map(|x| curricula::nearest_goal(&pool, &[x])), [1, 2, 0]);
/// ```
///
/// # Panics
/// If the pool is empty.
pub fn nearest_goal(pool: &Goals, goal: &[f64]) -> usize {
    let apart = pool.iter().map(|other| distance(other, goal)).enumerate();
    apart.min_by(|(_, a), (_, b)| a.total_cmp(b)).expect("a pool has goals").0
}

/// The goal of `pool` that an episode towards `goal` tells of: the `proposed` one if it is that, else the
/// nearest one, which is `goal` itself if the pool holds it.
///
/// # Panics
/// If the pool is empty, or `proposed` is none of its goals.
pub(crate) fn told_of(pool: &Goals, goal: &[f64], proposed: Option<usize>) -> usize {
    proposed.filter(|&index| pool.row(index) == goal).unwrap_or_else(|| nearest_goal(pool, goal))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_equal_goals_the_proposed_one_is_told_of() {
        let mut pool = Goals::new(2);
        [[0.0, 1.0], [3.0, 0.0], [0.0, 1.0]].iter().for_each(|goal| pool.push(goal));
        assert_eq!(told_of(&pool, &[0.0, 1.0], Some(2)), 2);
        assert_eq!(told_of(&pool, &[0.0, 1.0], Some(1)), 0, "somebody else's goal");
        assert_eq!(told_of(&pool, &[0.0, 1.0], None), 0);
        assert_eq!(told_of(&pool, &[2.0, 0.5], Some(0)), 1, "a goal from elsewhere counts for the nearest");
    }
}
