//! Regions of the goal space: cells of a k-d tree over the pool.

use envs::Goals;

use crate::played::nearest_goal;

/// The pool, cut into regions of nearly as many goals each.
///
/// A cell is cut across the dimension in which its goals spread most, relative to the whole pool; goals that
/// are equal in it fall to the sides by their index.
///
/// ```
/// use curricula::Regions;
///
/// let mut pool = envs::Goals::new(1);
/// [0.1, 0.9, 0.2, 0.8, 0.3].into_iter().for_each(|x| pool.push(&[x]));
/// let regions = Regions::new(&pool, 2);
/// assert_eq!((regions.members(0), regions.members(1)), (&[0, 2][..], &[1, 3, 4][..]));
/// assert_eq!(regions.of(3), 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    /// The region of every goal, shape `[N]`.
    of: Vec<usize>,
    /// The goals of every region by rising index; none is empty.
    members: Vec<Vec<usize>>,
}

impl Regions {
    /// Cuts `pool` into `count` regions, or into as many as it has goals.
    ///
    /// # Panics
    /// If the pool is empty, or `count` is 0.
    pub fn new(pool: &Goals, count: usize) -> Self {
        assert!(!pool.is_empty() && count > 0, "regions need goals");
        let all: Vec<usize> = (0..pool.len()).collect();
        let whole: Vec<f64> = (0..pool.width()).map(|dimension| spread(pool, &all, dimension)).collect();
        let mut members = Vec::with_capacity(count);
        cut(pool, &whole, all, count.min(pool.len()), &mut members);
        let mut of = vec![0; pool.len()];
        for (region, goals) in members.iter().enumerate() {
            goals.iter().for_each(|&goal| of[goal] = region);
        }
        Self { of, members }
    }

    /// Number of regions.
    pub fn count(&self) -> usize {
        self.members.len()
    }

    /// The region of the goal with this index.
    pub fn of(&self, goal: usize) -> usize {
        self.of[goal]
    }

    /// The region that an episode towards `goal`, shape `[G]`, tells of: the `proposed` one if one of its
    /// goals is that, else the region of the goal of the pool that is nearest. `pool` is the one that was
    /// cut.
    pub(crate) fn told_of(&self, pool: &Goals, goal: &[f64], proposed: Option<usize>) -> usize {
        let holds_it = |region: &usize| self.members(*region).iter().any(|&member| pool.row(member) == goal);
        proposed.filter(holds_it).unwrap_or_else(|| self.of(nearest_goal(pool, goal)))
    }

    /// The goals of a region by rising index.
    pub fn members(&self, region: usize) -> &[usize] {
        &self.members[region]
    }
}

/// Largest less smallest number of `goals` in a dimension.
fn spread(pool: &Goals, goals: &[usize], dimension: usize) -> f64 {
    let numbers = || goals.iter().map(|&goal| pool.row(goal)[dimension]);
    numbers().fold(f64::NEG_INFINITY, f64::max) - numbers().fold(f64::INFINITY, f64::min)
}

/// Cuts `goals` into `count` regions, of which there are no more than goals, and appends them to `found`.
fn cut(pool: &Goals, whole: &[f64], mut goals: Vec<usize>, count: usize, found: &mut Vec<Vec<usize>>) {
    if count == 1 {
        goals.sort_unstable();
        found.push(goals);
        return;
    }
    // A dimension in which the whole pool is flat tells no goals apart.
    let relative = |&dimension: &usize| match whole[dimension] {
        flat if flat <= 0.0 => 0.0,
        range => spread(pool, &goals, dimension) / range,
    };
    // Of equal ones the first.
    let widest = (0..pool.width()).rev().max_by(|a, b| relative(a).total_cmp(&relative(b))).unwrap_or(0);
    goals.sort_by(|&a, &b| pool.row(a)[widest].total_cmp(&pool.row(b)[widest]).then(a.cmp(&b)));
    let below = count / 2;
    let above = goals.split_off(goals.len() * below / count);
    cut(pool, whole, goals, below, found);
    cut(pool, whole, above, count - below, found);
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pool(goals: &[[f64; 2]]) -> Goals {
        let mut pool = Goals::new(2);
        goals.iter().for_each(|goal| pool.push(goal));
        pool
    }

    #[test]
    fn a_square_is_cut_across_one_side_and_then_across_the_other() {
        // Two by four goals; the pool spreads by 3 in x and by 30 in y, which count alike.
        let goals = [0.0, 1.0, 2.0, 3.0].map(|x| [[x, 0.0], [x, 30.0]]).concat();
        let regions = Regions::new(&pool(&goals), 4);
        // x first, being the first dimension; then x spreads by 1/3 of the whole, and y by all of it.
        let members: Vec<&[usize]> = (0..4).map(|region| regions.members(region)).collect();
        assert_eq!(members, [&[0, 2], &[1, 3], &[4, 6], &[5, 7]]);
    }

    #[test]
    fn flat_dimensions_are_never_cut() {
        let goals = [[0.5, 3.0], [0.5, 1.0], [0.5, 2.0]];
        let regions = Regions::new(&pool(&goals), 3);
        assert_eq!([0, 1, 2].map(|goal| regions.of(goal)), [2, 0, 1]);
    }

    #[test]
    fn there_are_no_more_regions_than_goals() {
        assert_eq!(Regions::new(&pool(&[[0.0, 0.0]; 3]), 16).count(), 3, "equal goals by index");
        assert_eq!(Regions::new(&pool(&[[0.0, 0.0]]), 1).members(0), [0]);
    }

    proptest! {
        #[test]
        fn every_goal_has_one_region_and_regions_are_nearly_alike(
            goals in prop::collection::vec((0.0..1.0f64, 0.0..1.0f64), 1..80),
            count in 1..20usize,
        ) {
            let pool = pool(&goals.iter().map(|&(x, y)| [x, y]).collect::<Vec<_>>());
            let regions = Regions::new(&pool, count);
            prop_assert_eq!(regions.count(), count.min(pool.len()));
            let mut seen = vec![0; pool.len()];
            for region in 0..regions.count() {
                let members = regions.members(region);
                prop_assert!(members.iter().all(|&goal| regions.of(goal) == region));
                members.iter().for_each(|&goal| seen[goal] += 1);
                let even = pool.len() as f64 / regions.count() as f64;
                prop_assert!(!members.is_empty() && (members.len() as f64 - even).abs() < 2.0, "{members:?}");
            }
            prop_assert!(seen.iter().all(|&times| times == 1));
        }
    }
}
