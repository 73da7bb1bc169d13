//! OMEGA: MEGA that comes to the environment's own goals as soon as the student has achieved their kind
//! (Pitis, Chan, Zhao, Stadie and Ba, "Maximum Entropy Gain Exploration for Long Horizon Multi-goal
//! Reinforcement Learning", ICML 2020).
//!
//! With probability α = 1 / max(b + D, 1) the environment's own goal is kept ([`keep_probability`]),
//! otherwise [`mega`](super::mega) chooses. D is the divergence of the goals that the environment asks for
//! from those that the student has achieved ([`divergence`]): large as long as the former lie where the
//! student never comes, so that MEGA has it explore, and small in the end.
//!
//! # Deviations and choices
//! Those of [`mega`](super::mega), and, against the authors' code (`spitis/mrl`, commit 249d652,
//! `CuriosityAlphaMixtureModule` in `mrl/modules/curiosity.py`):
//!
//! - D is estimated from 1000 fresh goals of the environment, for the start at hand; theirs are from the
//!   replay buffer. As there, both densities have bandwidth 0.1 on the scale of achieved goals, and the
//!   desired goals' own is asked at the very points that it is made of, which makes D larger than it is: the
//!   more so, the more dimensions goals have.
//! - α is renewed every 10 episodes; theirs is after every 100 steps of optimisation. Until it is first
//!   known, before anything is achieved, all goals are the environment's own.
//! - In the authors' code the environment's own goal is kept only if its value, too, passes the cutoff. A
//!   teacher does not see that goal, and the paper does not ask for this.

use agents::{Critic, Episode};
use envs::Reward;
use envs::rng::Rng;
use looks::{Dash, Look, Marker};
use rand::Rng as _;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::mega::{MegaConfig, MegaState};
use crate::achieved::Achieved;
use crate::config::schema_of;
use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::density::divergence;
use crate::error::CurriculumError;
use crate::fresh::sample_goals;
use crate::method::Method;
use crate::state::PlainState;

/// OMEGA's options.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
pub struct OmegaConfig {
    /// b, added to the divergence: with −3 all goals are the environment's own up to a divergence of 4.
    ///
    /// Unit: nats. Range: -1000 to 1000. Source: the paper.
    pub b: f64,
    /// Episodes after which α is renewed.
    ///
    /// Unit: episodes. Range: 1 to 100,000. Source: a choice.
    pub renewal: u64,
    /// Fresh goals of the environment that the divergence is estimated from.
    ///
    /// Unit: goals. Range: 1 to 10,000. Source: the authors' code.
    pub desired: usize,
    /// MEGA's options.
    #[serde(flatten)]
    pub mega: MegaConfig,
}

impl Default for OmegaConfig {
    fn default() -> Self {
        Self { b: -3.0, renewal: 10, desired: 1000, mega: MegaConfig::default() }
    }
}

/// α = 1 / max(b + divergence, 1), in (0, 1].
///
/// ```
/// use curricula::methods::omega::keep_probability;
///
/// assert_eq!([2.0, 4.0, 5.0, 13.0].map(|d| keep_probability(-3.0, d)), [1.0, 1.0, 0.5, 0.1]);
/// ```
pub fn keep_probability(b: f64, divergence: f64) -> f64 {
    1.0 / (b + divergence).max(1.0)
}

/// The OMEGA teacher.
pub struct Omega(OmegaConfig);

/// Everything that changes while teaching.
#[derive(Serialize, Deserialize)]
pub struct OmegaState {
    mega: MegaState,
    /// α and the divergence that it follows from; none before anything is achieved.
    mixture: Option<(f64, f64)>,
    /// Proposals since α was renewed.
    since: u64,
}

impl PlainState for OmegaState {
    const VERSION: u32 = 1;
}

impl Omega {
    /// D of the goals that the environment asks for, at the start at hand, from the `achieved` ones.
    fn divergence(&self, achieved: &mut Achieved, lesson: &mut Lesson<'_>) -> f64 {
        let OmegaConfig { desired, ref mega, .. } = self.0;
        let width = lesson.student.spec().goal;
        let goals = sample_goals(lesson.goals, width, desired, lesson.rng);
        let wanted = achieved.beside(&goals, mega.bandwidth).log_densities(&goals);
        divergence(&wanted, &achieved.log_densities(&goals))
    }
}

impl Method for Omega {
    type Config = OmegaConfig;
    type State = OmegaState;
    const ID: &'static str = "omega";
    const TITLE: &'static str = "OMEGA";
    const LOOK: Option<Look> = Some(Look::new((95, 55, 10), Dash::Short, Marker::Square));
    const SOURCE: &'static str = "Pitis et al., Maximum Entropy Gain Exploration for Long Horizon Multi-goal \
                                  Reinforcement Learning, ICML 2020 (OMEGA)";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn schema() -> Option<Schema> {
        Some(schema_of::<OmegaConfig>())
    }

    fn check(config: &OmegaConfig) -> Result<(), CurriculumError> {
        let OmegaConfig { b, renewal, desired, ref mega } = *config;
        CurriculumError::require((-1000.0..=1000.0).contains(&b), "b", "in [-1000, 1000]", b)?;
        CurriculumError::require((1..=100_000).contains(&renewal), "renewal", "in 1..=100000", renewal)?;
        CurriculumError::require((1..=10_000).contains(&desired), "desired", "in 1..=10000", desired)?;
        mega.check()
    }

    fn build(config: OmegaConfig, _setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self(config))
    }

    fn begin(&self, _setting: &Setting) -> Result<OmegaState, CurriculumError> {
        Ok(OmegaState { mega: MegaState::new(&self.0.mega), mixture: None, since: 0 })
    }

    fn propose(&self, state: &mut OmegaState, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        let mega = &self.0.mega;
        let mut achieved = None;
        if state.mixture.is_none() || state.since >= self.0.renewal {
            achieved = Achieved::draw(mega.samples, mega.bandwidth, lesson);
            if let Some(achieved) = &mut achieved {
                let divergence = self.divergence(achieved, lesson);
                state.mixture = Some((keep_probability(self.0.b, divergence), divergence));
                state.since = 0;
            }
        }
        let Some((keep, _)) = state.mixture else { return Ok(Proposal::native()) };
        state.since += 1;
        if lesson.rng.random::<f64>() < keep {
            return Ok(Proposal::native());
        }
        match achieved.or_else(|| Achieved::draw(mega.samples, mega.bandwidth, lesson)) {
            Some(mut achieved) => state.mega.choose(mega, &mut achieved, lesson),
            None => Ok(Proposal::native()),
        }
    }

    fn observe(&self, state: &mut OmegaState, _episode: &Episode) -> Result<(), CurriculumError> {
        state.mega.observe();
        Ok(())
    }

    fn learn(
        &self,
        state: &mut OmegaState,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        _rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        state.mega.learn(&self.0.mega, student, reward);
        Ok(())
    }

    fn summary<'a>(&'a self, state: &'a OmegaState) -> TeacherSummary<'a> {
        let (keep, divergence) = state.mixture.unwrap_or((f64::NAN, f64::NAN));
        let mut statistics = vec![("keep_probability", keep), ("divergence", divergence)];
        statistics.extend(state.mega.statistics());
        TeacherSummary { weights: None, statistics }
    }

    fn check_state(&self, state: &OmegaState) -> Result<(), CurriculumError> {
        state.mega.check(&self.0.mega)
    }
}
