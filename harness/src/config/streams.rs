//! Random streams of a run, and seeds that fix single ones.

use agents::Auto;
use envs::rng::{Purpose, Rng, stream};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `seed`: the seed of each kind of random draws; `auto` is the run's own.
///
/// Hold one fixed while the run's seed varies, and its share of the spread over seeds is gone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[schemars(extend(
    "x-expecting" = "a table of seeds by kind, as in { pool = 3 }; the seeds of runs are `seeds`"
))]
pub struct StreamSeeds {
    /// Initial weights of the student.
    ///
    /// Unit: none. Range: at least 0. Auto: the run's own seed. Source: a choice.
    pub weights: Auto<u64>,
    /// Start states and native goals of training episodes.
    ///
    /// Unit: none. Range: at least 0. Auto: the run's own seed. Source: a choice.
    pub environment: Auto<u64>,
    /// Exploration noise.
    ///
    /// Unit: none. Range: at least 0. Auto: the run's own seed. Source: a choice.
    pub exploration: Auto<u64>,
    /// Batches and hindsight goals, also of the student's diagnoses.
    ///
    /// Unit: none. Range: at least 0. Auto: the run's own seed. Source: a choice.
    pub replay: Auto<u64>,
    /// What the teacher draws, the initial weights of its own networks, and its probe rollouts; the same of
    /// shadows.
    ///
    /// Unit: none. Range: at least 0. Auto: the run's own seed. Source: a choice.
    pub teacher: Auto<u64>,
    /// The pool of candidate goals.
    ///
    /// Unit: none. Range: at least 0. Auto: the run's own seed. Source: a choice.
    pub pool: Auto<u64>,
    /// Start states and goals of evaluations, and start states of the episodes that measure the frontier.
    ///
    /// Unit: none. Range: at least 0. Auto: the run's own seed. Source: a choice.
    pub evaluation: Auto<u64>,
}

/// Streams of the training side, one per purpose.
#[derive(Clone, Serialize, Deserialize)]
pub struct Streams {
    /// Start states and native goals.
    pub environment: Rng,
    /// Exploration noise.
    pub exploration: Rng,
    /// Batches and hindsight goals.
    pub replay: Rng,
    /// What the teacher draws.
    pub teacher: Rng,
}

impl Streams {
    /// Those of the run with seed `run`, at their beginning.
    pub fn new(seeds: &StreamSeeds, run: u64) -> Self {
        Self {
            environment: seeds.stream(run, Purpose::Environment),
            exploration: seeds.stream(run, Purpose::Exploration),
            replay: seeds.stream(run, Purpose::Replay),
            teacher: seeds.stream(run, Purpose::Teacher),
        }
    }
}

impl StreamSeeds {
    /// The seed of `purpose` in the run with seed `run`.
    pub fn of(&self, run: u64, purpose: Purpose) -> u64 {
        let given = match purpose {
            Purpose::Weights => self.weights,
            Purpose::Environment => self.environment,
            Purpose::Exploration => self.exploration,
            Purpose::Replay | Purpose::Diagnosis(_) => self.replay,
            Purpose::Teacher | Purpose::Rollout(_) | Purpose::Shadow(_) => self.teacher,
            Purpose::Pool => self.pool,
            Purpose::Evaluation(_) | Purpose::Frontier(_) => self.evaluation,
            // Come before and after training, with seeds of their own: those of a protocol's search and of
            // `goalbench evaluate`.
            Purpose::Trial(_) | Purpose::FinalEvaluation => Auto::Auto,
        };
        given.value_or(|| run)
    }

    /// The stream of `purpose` in the run with seed `run`.
    pub fn stream(&self, run: u64, purpose: Purpose) -> Rng {
        stream(self.of(run, purpose), purpose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_seed_can_be_held_while_the_others_follow_the_run() {
        let seeds = StreamSeeds { pool: Auto::Value(3), ..StreamSeeds::default() };
        for purpose in [
            Purpose::Weights,
            Purpose::Environment,
            Purpose::Exploration,
            Purpose::Replay,
            Purpose::Teacher,
            Purpose::Rollout(4),
            Purpose::Evaluation(4),
            Purpose::Diagnosis(4),
            Purpose::Frontier(4),
            Purpose::Shadow(4),
        ] {
            assert_eq!(seeds.stream(7, purpose), stream(7, purpose), "{purpose:?}");
        }
        assert_eq!(seeds.stream(7, Purpose::Pool), stream(3, Purpose::Pool));
    }
}
