//! A program of your own: all of goalbench, with one more curriculum.
//!
//! `nearest` starts with the pool goals that are nearest to where the episode starts, and widens its circle
//! whenever the student succeeds often enough. Many papers use such a distance curriculum as a baseline; it
//! does not look at the student's networks.
//!
//! ```sh
//! cargo run --release -p goalbench --example own_curriculum -- list curricula
//! cargo run --release -p goalbench --example own_curriculum -- \
//!     run --env MazeA --curriculum nearest,her-iid --steps 20000
//! ```

use std::sync::Arc;

use agents::Episode;
use curricula::{
    CurriculumError, Distribution, Entry, Lesson, Method, PlainState, Proposal, Setting, TeacherSummary,
};
use envs::Goals;
use goalbench::Registry;
use serde::{Deserialize, Serialize};

fn main() {
    let registry = Registry::builtin().of_program(goalbench::program!());
    goalbench::cli::main(registry.with_curriculum(Entry::of::<Nearest>()))
}

/// Options, as in `--set curriculum.nearest.growth=0.02`.
#[derive(Serialize, Deserialize)]
struct NearestConfig {
    /// Share of the pool to begin with, in (0, 1].
    share: f64,
    /// What is added to the share when the student does well, 0 or more.
    growth: f64,
    /// Success rate over the last `episodes` training episodes that counts as doing well, in [0, 1].
    threshold: f64,
    /// Training episodes looked back on, at least 1.
    episodes: usize,
}

impl Default for NearestConfig {
    fn default() -> Self {
        Self { share: 0.1, growth: 0.05, threshold: 0.5, episodes: 20 }
    }
}

/// Uniform over the nearest goals of the pool. It does not change during a run: what does is in
/// [`NearestState`].
struct Nearest {
    config: NearestConfig,
    pool: Arc<Goals>,
}

/// All that changes during a run, and so all that a resumed run needs.
#[derive(Serialize, Deserialize)]
struct NearestState {
    /// Share of the pool in use.
    share: f64,
    /// Outcomes since the share last grew, at most `episodes` of them.
    recent: Vec<bool>,
    /// The last episode's choice, a probability for every goal of the pool.
    curriculum: Distribution,
}

impl PlainState for NearestState {
    /// Raised when the type changes, so that an old state is never read as a new one.
    const VERSION: u32 = 1;
}

impl Method for Nearest {
    type Config = NearestConfig;
    type State = NearestState;
    const ID: &'static str = "nearest";
    const TITLE: &'static str = "Nearest first";
    const SOURCE: &'static str = "A distance curriculum, as an example";
    /// Raised when it teaches in another way, so that its runs are never taken for those of an older one.
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn check(config: &NearestConfig) -> Result<(), CurriculumError> {
        let NearestConfig { share, growth, threshold, episodes } = *config;
        CurriculumError::require(share > 0.0 && share <= 1.0, "share", "a number in (0, 1]", share)?;
        CurriculumError::require(growth >= 0.0, "growth", "0 or more", growth)?;
        let ok = (0.0..=1.0).contains(&threshold);
        CurriculumError::require(ok, "threshold", "a number in [0, 1]", threshold)?;
        CurriculumError::require(episodes > 0, "episodes", "at least 1", episodes)
    }

    fn build(config: NearestConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { config, pool: Arc::clone(&setting.pool) })
    }

    fn begin(&self, _setting: &Setting) -> Result<NearestState, CurriculumError> {
        let curriculum = Distribution::uniform(self.pool.len());
        Ok(NearestState { share: self.config.share, recent: Vec::new(), curriculum })
    }

    fn propose(
        &self,
        state: &mut NearestState,
        lesson: &mut Lesson<'_>,
    ) -> Result<Proposal, CurriculumError> {
        let from_start = |goal: usize| distance(self.pool.row(goal), &lesson.start.achieved);
        let mut order: Vec<usize> = (0..self.pool.len()).collect();
        order.sort_by(|&a, &b| from_start(a).total_cmp(&from_start(b)));
        let within = ((state.share * order.len() as f64).round() as usize).clamp(1, order.len());
        state.curriculum = Distribution::uniform_over(&order[..within], order.len());
        Ok(Proposal::pool(state.curriculum.draw(lesson.rng)))
    }

    fn observe(&self, state: &mut NearestState, episode: &Episode) -> Result<(), CurriculumError> {
        let NearestState { share, recent, .. } = state;
        recent.push(episode.success);
        if recent.len() > self.config.episodes {
            recent.remove(0);
        }
        let successes = recent.iter().filter(|success| **success).count();
        let enough = successes as f64 >= self.config.threshold * self.config.episodes as f64;
        if recent.len() == self.config.episodes && enough {
            *share = (*share + self.config.growth).min(1.0);
            recent.clear();
        }
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a NearestState) -> TeacherSummary<'a> {
        let mut summary = state.curriculum.summary();
        summary.statistics.push(("share", state.share));
        summary
    }
}

/// Euclidean distance.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use curricula::testing;

    use super::*;

    /// What the harness asks of every curriculum: among other things, that a loaded state goes on where it
    /// was saved.
    #[test]
    fn it_keeps_the_contract() {
        testing::contract(&Entry::of::<Nearest>());
        testing::contract_with(&Entry::of::<Nearest>(), "share = 0.5\nthreshold = 0\nepisodes = 3");
    }
}
