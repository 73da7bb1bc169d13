//! A method at work.

use agents::{Critic, Episode};
use envs::rng::Rng;
use envs::{GoalSource, Reward};

use crate::curriculum::{Curriculum, Lesson, Proposal, Setting, TeacherSummary};
use crate::error::CurriculumError;
use crate::judgement::Judgement;
use crate::method::Method;
use crate::rollouts::{RolloutRequest, Rollouts};
use crate::snapshot;
use crate::state::TeacherState;

/// The [`Curriculum`] that a [`Method`] makes with its state. It owns saving and loading.
pub struct Teacher<M: Method> {
    method: M,
    setting: Setting,
    state: M::State,
}

impl<M: Method> Teacher<M> {
    /// The method of a checked `config`, before its first episode.
    ///
    /// # Errors
    /// [`CurriculumError::Config`] if the method needs a pool and `setting` has an empty one; otherwise what
    /// the method itself says.
    pub fn new(config: M::Config, setting: &Setting) -> Result<Self, CurriculumError> {
        if M::USES_POOL {
            let goals = setting.pool.len();
            CurriculumError::require(goals > 0, "pool.size", "at least 1", goals)?;
        }
        let method = M::build(config, setting)?;
        let state = method.begin(setting)?;
        Ok(Self { method, setting: setting.clone(), state })
    }

    /// Refuses a loaded state that does not fit pool or config.
    fn check(&self, state: &M::State) -> Result<(), CurriculumError> {
        self.method.check_state(state)?;
        if M::USES_POOL
            && let Some(weights) = self.method.summary(state).weights
        {
            snapshot::require_goals(weights.len(), self.setting.pool.len())?;
        }
        Ok(())
    }
}

impl<M: Method> Curriculum for Teacher<M> {
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        self.method.propose(&mut self.state, lesson)
    }

    fn observe(&mut self, episode: &Episode) -> Result<(), CurriculumError> {
        self.method.observe(&mut self.state, episode)
    }

    fn learn(
        &mut self,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        self.method.learn(&mut self.state, student, reward, rng)
    }

    fn request_rollouts(
        &mut self,
        goals: &mut dyn GoalSource,
        rng: &mut Rng,
    ) -> Result<Option<RolloutRequest>, CurriculumError> {
        self.method.request_rollouts(&mut self.state, goals, rng)
    }

    fn hear_rollouts(&mut self, rollouts: &Rollouts) -> Result<(), CurriculumError> {
        self.method.hear_rollouts(&mut self.state, rollouts)
    }

    fn summary(&self) -> TeacherSummary<'_> {
        self.method.summary(&self.state)
    }

    fn judge(&self, student: &dyn Critic) -> Judgement {
        self.method.judge(&self.state, student)
    }

    fn save(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(snapshot::seal(M::ID, M::State::VERSION, self.state.write()?))
    }

    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        let mut state = self.method.begin(&self.setting)?;
        state.read(snapshot::open(M::ID, M::State::VERSION, bytes)?)?;
        self.check(&state)?;
        self.state = state;
        Ok(())
    }
}
