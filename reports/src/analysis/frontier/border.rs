//! The border of what a student can do, where no goal by itself has intermediate success: with a fixed start
//! a greedy student reaches a goal always or never. Goals that it reaches lie next to goals that it does not.

/// How many goals of the pool count together: a goal and those next to it.
pub const TOGETHER: usize = 10;

/// Which goals of a pool lie next to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Neighbours {
    /// For every goal itself and those next to it, by rising distance.
    goals: Vec<Vec<usize>>,
}

impl Neighbours {
    /// Of the pool `goals`, `[N][G]`, by Euclidean distance: [`TOGETHER`] for each, itself among them, or all
    /// there are.
    pub fn of(goals: &[Vec<f32>]) -> Self {
        Self { goals: (0..goals.len()).map(|goal| nearest(goals, goal, TOGETHER)).collect() }
    }

    /// The mean of the `rates` of every goal and those next to it, `[N]`; `None` for another number of goals.
    pub fn means(&self, rates: &[f64]) -> Option<Vec<f64>> {
        let mean = |near: &Vec<usize>| near.iter().map(|&goal| rates[goal]).sum::<f64>() / near.len() as f64;
        (rates.len() == self.goals.len()).then(|| self.goals.iter().map(mean).collect())
    }
}

/// The `count` goals that are nearest to this one, which comes first.
fn nearest(goals: &[Vec<f32>], goal: usize, count: usize) -> Vec<usize> {
    let apart =
        |other: usize| -> f32 { goals[goal].iter().zip(&goals[other]).map(|(a, b)| (a - b) * (a - b)).sum() };
    let mut order: Vec<(f32, bool, usize)> =
        (0..goals.len()).map(|other| (apart(other), other != goal, other)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    order.into_iter().take(count).map(|(.., other)| other).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_by_hand() {
        let goals: Vec<Vec<f32>> = [0.0, 4.0, 1.0, 3.0, 1.0].map(|x| vec![x]).to_vec();
        assert_eq!(nearest(&goals, 0, 3), [0, 2, 4]);
        assert_eq!(nearest(&goals, 4, 2), [4, 2], "itself before one at the same place");
        // Fewer goals than count together: all of them.
        let means = Neighbours::of(&goals).means(&[1.0, 0.0, 1.0, 0.0, 0.0]).expect("five goals");
        assert_eq!(means, [0.4; 5]);
        // A line of twenty, of which the first half is reached.
        let goals: Vec<Vec<f32>> = (0..20u8).map(|x| vec![f32::from(x)]).collect();
        let rates: Vec<f64> = (0..20).map(|x| f64::from(u8::from(x < 10))).collect();
        let means = Neighbours::of(&goals).means(&rates).expect("twenty goals");
        assert_eq!((means[0], means[19]), (1.0, 0.0));
        assert!(means.windows(2).all(|pair| pair[1] <= pair[0]), "{means:?}");
        assert_eq!(Neighbours::of(&goals).means(&[1.0]), None);
    }
}
