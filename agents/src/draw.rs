//! Which transition of an episode, and which goal: HER's strategies.

use envs::rng::Rng;
use rand::Rng as _;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which achieved goals of its episode a transition can be relabelled with (Andrychowicz et al. 2017, section
/// 4.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HerStrategy {
    /// Uniformly one of those achieved after the step it starts from.
    #[default]
    Future,
    /// The one achieved at the end of the episode.
    Final,
    /// Uniformly one of those achieved after any of the episode's H transitions.
    Episode,
}

impl HerStrategy {
    /// Index in [1, H] of the achieved goal for the transition at `step`, from u in [0, 1).
    fn index(self, step: usize, horizon: usize, u: f64) -> usize {
        match self {
            Self::Future => future_index(step, horizon, u),
            Self::Final => final_index(horizon),
            Self::Episode => episode_index(horizon, u),
        }
    }
}

/// How transitions are relabelled with goals achieved in their episodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hindsight {
    /// Hindsight goals per real goal k: a transition is relabelled with probability k/(k + 1).
    pub k: u32,
    /// Where they come from.
    pub strategy: HerStrategy,
}

impl Hindsight {
    /// Every transition keeps the goal that was asked for.
    pub const NONE: Self = Self { k: 0, strategy: HerStrategy::Future };
}

/// A transition of the buffer and where its goal comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Draw {
    /// Index of the episode's record.
    pub(crate) record: usize,
    /// t in [0, H).
    pub(crate) step: usize,
    /// Index in [1, H] of the achieved goal to relabel with; none keeps the goal that was asked for.
    pub(crate) relabel: Option<usize>,
}

impl Draw {
    /// Draws t uniformly and, with probability k/(k + 1), the index of an achieved goal. All strategies take
    /// the same number of random numbers, so that the choice of strategy changes goals but not which
    /// transitions are drawn.
    pub(crate) fn new(record: usize, horizon: usize, hindsight: Hindsight, rng: &mut Rng) -> Self {
        let step = rng.random_range(0..horizon);
        let relabel = rng.random::<f64>() < relabel_probability(hindsight.k);
        let relabel = relabel.then(|| hindsight.strategy.index(step, horizon, rng.random()));
        Self { record, step, relabel }
    }
}

/// k/(k + 1): k hindsight goals for every real one (HER, section 4.5).
fn relabel_probability(her_k: u32) -> f64 {
    let k = f64::from(her_k);
    k / (k + 1.0)
}

/// t + 1 + ⌊u·(H − t)⌋ for u in [0, 1): uniform over the indices after t (Baselines' `her_sampler`).
fn future_index(step: usize, horizon: usize, u: f64) -> usize {
    let left = horizon - step;
    step + 1 + ((u * left as f64) as usize).min(left - 1)
}

/// H: what the last transition achieved (HER, section 4.5, "final").
fn final_index(horizon: usize) -> usize {
    horizon
}

/// 1 + ⌊u·H⌋ for u in [0, 1): uniform over what the episode's transitions achieved (HER, section 4.5,
/// "episode").
fn episode_index(horizon: usize, u: f64) -> usize {
    1 + ((u * horizon as f64) as usize).min(horizon - 1)
}

#[cfg(test)]
mod tests {
    use envs::rng::{Purpose, Rng, stream};

    use super::{
        Draw, HerStrategy, Hindsight, episode_index, final_index, future_index, relabel_probability,
    };

    #[test]
    fn relabels_four_of_five_at_the_default_k() {
        assert_eq!(relabel_probability(4), 0.8);
        assert_eq!(relabel_probability(0), 0.0);
    }

    #[test]
    fn future_index_by_hand() {
        // H = 10, t = 7: indices 8, 9, 10.
        assert_eq!(future_index(7, 10, 0.0), 8);
        assert_eq!(future_index(7, 10, 0.34), 9);
        assert_eq!(future_index(7, 10, 1.0 - f64::EPSILON / 2.0), 10);
        assert_eq!(future_index(9, 10, 0.99), 10);
    }

    #[test]
    fn final_index_by_hand() {
        assert_eq!(final_index(10), 10);
        assert_eq!(final_index(1), 1);
    }

    #[test]
    fn episode_index_by_hand() {
        // H = 4: indices 1, 2, 3, 4, a quarter each.
        assert_eq!([0.0, 0.24, 0.25, 0.5, 0.76].map(|u| episode_index(4, u)), [1, 1, 2, 3, 4]);
        assert_eq!(episode_index(4, 1.0 - f64::EPSILON / 2.0), 4);
        assert_eq!(episode_index(1, 0.99), 1);
    }

    #[test]
    fn strategies_change_goals_alone() {
        let [mut future, mut last, mut episode] = [(); 3].map(|()| stream(0, Purpose::Replay));
        for _ in 0..100 {
            let draw = |strategy, rng: &mut Rng| Draw::new(3, 10, Hindsight { k: 4, strategy }, rng);
            let expected = draw(HerStrategy::Future, &mut future);
            for (strategy, rng) in [(HerStrategy::Final, &mut last), (HerStrategy::Episode, &mut episode)] {
                let got = draw(strategy, rng);
                assert_eq!((got.record, got.step), (expected.record, expected.step));
                assert_eq!(got.relabel.is_some(), expected.relabel.is_some());
                assert_eq!(*rng, future);
                assert!(strategy == HerStrategy::Episode || got.relabel.is_none_or(|index| index == 10));
            }
        }
    }
}
