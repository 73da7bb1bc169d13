//! A program of your own: all of goalbench, with one more curriculum.
//!
//! `nearest` starts with the pool goals that are nearest to where the episode starts and widens its circle whenever the
//! student succeeds often enough. Many papers use such a distance curriculum as a baseline; it needs no look at the
//! student's networks.
//!
//! ```sh
//! cargo run --release -p goalbench --example own_curriculum -- list curricula
//! cargo run --release -p goalbench --example own_curriculum -- run --env MazeA --curriculum nearest,her-iid --steps 20000
//! ```

use std::process::ExitCode;
use std::sync::Arc;

use agents::Episode;
use curricula::{
    Curriculum, CurriculumError, Distribution, Entry, Lesson, Method, Proposal, Setting, Statistics, snapshot,
};
use envs::Goals;
use goalbench::Registry;
use serde::{Deserialize, Serialize};

fn main() -> ExitCode {
    goalbench::cli::main(Registry::builtin().with_curriculum(Entry::of::<Nearest>()))
}

/// Options, as in `--set curriculum.nearest.growth=0.02`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
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

/// Uniform over the nearest goals of the pool.
struct Nearest {
    config: NearestConfig,
    pool: Arc<Goals>,
    state: State,
}

/// Raised when [`State`] changes, so that an old state is never read as a new one.
const STATE_VERSION: u32 = 1;

/// What a resumed run needs.
#[derive(Debug, Serialize, Deserialize)]
struct State {
    /// Share of the pool in use.
    share: f64,
    /// Outcomes since the share last grew, at most `episodes` of them.
    recent: Vec<bool>,
    /// The last episode's choice, a probability for every goal of the pool.
    curriculum: Distribution,
}

impl Method for Nearest {
    type Config = NearestConfig;
    const ID: &'static str = "nearest";
    const TITLE: &'static str = "Nearest first";
    const SOURCE: &'static str = "A distance curriculum, as an example";
    const USES_POOL: bool = true;

    fn check(config: &NearestConfig) -> Result<(), CurriculumError> {
        let NearestConfig { share, growth, threshold, episodes } = *config;
        CurriculumError::require(share > 0.0 && share <= 1.0, "share", "a number in (0, 1]", share)?;
        CurriculumError::require(growth >= 0.0, "growth", "0 or more", growth)?;
        CurriculumError::require(
            (0.0..=1.0).contains(&threshold),
            "threshold",
            "a number in [0, 1]",
            threshold,
        )?;
        CurriculumError::require(episodes > 0, "episodes", "at least 1", episodes)
    }

    fn build(config: NearestConfig, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError> {
        let curriculum = Distribution::uniform(setting.pool.len());
        let state = State { share: config.share, recent: Vec::new(), curriculum };
        Ok(Box::new(Self { config, pool: Arc::clone(&setting.pool), state }))
    }
}

impl Curriculum for Nearest {
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let start = &lesson.start.achieved;
        let mut order: Vec<usize> = (0..self.pool.len()).collect();
        order.sort_by(|&a, &b| {
            distance(self.pool.row(a), start).total_cmp(&distance(self.pool.row(b), start))
        });
        let within = ((self.state.share * order.len() as f64).round() as usize).clamp(1, order.len());
        self.state.curriculum = Distribution::uniform_over(&order[..within], order.len());
        Ok(Proposal::Pool(self.state.curriculum.draw(lesson.rng)))
    }

    fn observe(&mut self, episode: &Episode) -> Result<(), CurriculumError> {
        let State { share, recent, .. } = &mut self.state;
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

    fn weights(&self) -> Option<&[f64]> {
        Some(self.state.curriculum.probabilities())
    }

    fn statistics(&self) -> Statistics {
        let mut statistics = self.state.curriculum.statistics().to_vec();
        statistics.push(("share", self.state.share));
        statistics
    }

    fn save(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(snapshot::save(Self::ID, STATE_VERSION, &self.state))
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        let state: State = snapshot::load(Self::ID, STATE_VERSION, bytes)?;
        snapshot::require_goals(state.curriculum.probabilities().len(), self.pool.len())?;
        self.state = state;
        Ok(())
    }
}

/// Euclidean distance.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
