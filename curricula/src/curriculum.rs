//! What a teacher is.

use std::sync::Arc;

use agents::{Critic, Episode, StudentConfig};
use envs::rng::Rng;
use envs::{GoalSource, Goals, Observation, Reward, Spec};

use crate::error::CurriculumError;

/// The goal a teacher asks for in the coming episode.
#[derive(Clone, Debug, PartialEq)]
pub enum Proposal {
    /// The goal that the environment drew itself at the reset.
    Native,
    /// The goal with this index in the pool.
    Pool(usize),
    /// Any other goal, shape `[G]`.
    Goal(Vec<f64>),
}

/// What a teacher may see when it chooses: all of it training-side. Evaluation goals never come this way.
pub struct Lesson<'a> {
    /// The student, read-only.
    pub student: &'a mut dyn Critic,
    /// The start of the coming episode.
    pub start: &'a Observation,
    /// Fresh goals for that start. A teacher cannot step the environment.
    pub goals: &'a mut dyn GoalSource,
    /// The teacher's own stream.
    pub rng: &'a mut Rng,
}

/// What every teacher is built from, besides its own config.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Dimensions of the task.
    pub spec: Spec,
    /// N goals drawn once from the environment's own distribution, shared by all curricula of one seed. Empty for
    /// methods that do not use it ([`Method::USES_POOL`](crate::Method::USES_POOL)): `her-iid` and `vds`.
    pub pool: Arc<Goals>,
    /// Seed of the teacher's stream (the run's, unless `seed.teacher` says otherwise), for teachers with networks of their own.
    pub seed: u64,
    /// The student's resolved hyper-parameters, for teachers whose networks are like the student's.
    pub student: StudentConfig,
}

/// What a teacher thought of a goal when it chose it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// How the method scored the goal: the larger, the more it wanted it. What is not finite is recorded as none.
    pub score: f64,
    /// Where a method trains on a ranked set: the goal's place in it.
    pub rank: Option<Rank>,
}

/// A place in a ranked set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rank {
    /// 0 for the goal that ranks first.
    pub place: usize,
    /// Goals in the set, at least 1.
    pub of: usize,
}

/// Numbers about what a teacher is doing, recorded at every evaluation: (name, value), always the same names in the
/// same order. NaN stands for "not defined yet".
pub type Statistics = Vec<(&'static str, f64)>;

/// A curriculum: chooses the goal of every training episode.
///
/// Only [`Curriculum::propose`] is required. The harness owns the loop and all logging.
pub trait Curriculum: Send {
    /// Chooses the goal of the coming episode.
    ///
    /// # Errors
    /// [`CurriculumError`] if the student's values are unusable (NaN).
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError>;

    /// Hears of a finished training episode.
    ///
    /// # Errors
    /// [`CurriculumError`] if the episode is not of the teacher's task.
    fn observe(&mut self, _episode: &Episode) -> Result<(), CurriculumError> {
        Ok(())
    }

    /// Learns after each of the student's learning cycles.
    ///
    /// # Errors
    /// [`CurriculumError`] if its own learning diverged.
    fn learn(
        &mut self,
        _student: &mut dyn Critic,
        _reward: &dyn Reward,
        _rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        Ok(())
    }

    /// What the teacher thought of the goal that it proposed last, for methods that score goals. Recorded beside how the episode
    /// ended: a score that says nothing about success, or ranks of which some never come up, show a teacher that is not
    /// doing what it should.
    fn choice(&self) -> Option<Choice> {
        None
    }

    /// The current probability of every pool goal, shape `[N]`, for teachers that hold one.
    fn weights(&self) -> Option<&[f64]> {
        None
    }

    /// Further numbers to record.
    fn statistics(&self) -> Statistics {
        Statistics::new()
    }

    /// The teacher's whole state as bytes, so that a run can resume exactly. Stateless teachers have none.
    ///
    /// # Errors
    /// [`CurriculumError`] if networks of its own cannot be read.
    fn save(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(Vec::new())
    }

    /// Takes back what [`Curriculum::save`] gave.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if the bytes are not this teacher's.
    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        if bytes.is_empty() {
            Ok(())
        } else {
            Err(CurriculumError::State { reason: "a stateless teacher was given state".into() })
        }
    }
}
