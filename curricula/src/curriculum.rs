//! What a teacher is to the harness, and what passes between the two.

use std::sync::Arc;

use agents::{Critic, Episode, StudentConfig};
use envs::rng::Rng;
use envs::{GoalSource, Goals, Observation, Reward, Spec};

use crate::error::CurriculumError;
use crate::judgement::Judgement;
use crate::rollouts::{RolloutRequest, Rollouts};

/// The goal that a teacher asks for in the coming episode, and what it thought of that goal.
///
/// Scores and ranks are recorded beside how the episode ended. Scores that say nothing about success, or
/// places of a set that never come up, show a teacher that is not doing what it should.
///
/// ```
/// use curricula::{Proposal, ProposedGoal};
///
/// let proposal = Proposal::pool(3).scored(0.25);
/// assert_eq!(proposal.goal, ProposedGoal::Pool(3));
/// assert_eq!((proposal.score, proposal.rank), (Some(0.25), None));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// The goal.
    pub goal: ProposedGoal,
    /// How the method scored the goal: the larger, the more it wanted it. A score that is not finite is not
    /// recorded.
    pub score: Option<f64>,
    /// The goal's place, where a method trains on a ranked set.
    pub rank: Option<Rank>,
}

/// Where a proposed goal comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum ProposedGoal {
    /// The environment drew it itself at the reset.
    Native,
    /// It has this index in the pool.
    Pool(usize),
    /// It is any other goal, shape `[G]`.
    Other(Vec<f64>),
}

impl Proposal {
    /// The goal that the environment drew itself at the reset.
    pub fn native() -> Self {
        ProposedGoal::Native.into()
    }

    /// The goal with this index in the pool.
    pub fn pool(index: usize) -> Self {
        ProposedGoal::Pool(index).into()
    }

    /// Any goal, shape `[G]`.
    pub fn other(goal: Vec<f64>) -> Self {
        ProposedGoal::Other(goal).into()
    }

    /// The same with the method's score of the goal.
    #[must_use]
    pub fn scored(self, score: impl Into<Option<f64>>) -> Self {
        Self { score: score.into(), ..self }
    }

    /// The same with the goal's place in a ranked set.
    #[must_use]
    pub fn ranked(self, rank: Rank) -> Self {
        Self { rank: Some(rank), ..self }
    }
}

impl From<ProposedGoal> for Proposal {
    /// The goal without score and rank.
    fn from(goal: ProposedGoal) -> Self {
        Self { goal, score: None, rank: None }
    }
}

/// A place in a ranked set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rank {
    /// 0 for the goal that ranks first.
    pub place: usize,
    /// Goals in the set, at least 1.
    pub of: usize,
}

/// What a teacher may see when it chooses, all of it from training. Evaluation goals never come this way.
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
    /// N goals drawn once from the environment's own distribution, shared by all curricula of one seed. Empty
    /// for methods that do not use it ([`Method::USES_POOL`](crate::Method::USES_POOL)), such as `her-iid`
    /// and `vds`.
    pub pool: Arc<Goals>,
    /// Seed of the teacher's stream, for teachers with networks of their own. It is the run's unless
    /// `seed.teacher` says otherwise.
    pub seed: u64,
    /// The student's resolved hyper-parameters, for teachers whose networks are like the student's.
    pub student: StudentConfig,
}

/// Numbers about what a teacher is doing, recorded at every evaluation: (name, value), always the same names
/// in the same order. NaN stands for "not defined yet".
pub type Statistics<'a> = Vec<(&'a str, f64)>;

/// What is recorded about a teacher.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TeacherSummary<'a> {
    /// The current probability of every goal of the pool, shape `[N]`, for teachers that weigh the pool.
    pub weights: Option<&'a [f64]>,
    /// Further numbers.
    pub statistics: Statistics<'a>,
}

/// A curriculum at work: it chooses the goal of every training episode.
///
/// The harness sees teachers through this trait, and owns the loop and all logging. A method does not
/// implement it: it implements [`Method`](crate::Method), and a [`Teacher`](crate::Teacher) makes a
/// curriculum of that. The trait has no default methods, so that nothing gets lost in a decorator.
///
/// ```
/// use curricula::testing::Class;
///
/// // TEACH over a pool of three goals. The student's confidence in goal i moves by i per gradient step.
/// let config = "window = 2\nstates = \"initial\"";
/// let mut class = Class::new("teach", config, 3, |goal, steps| -((goal as u64 * steps) as f64));
/// class.cycles(2);
/// // The variances are 0, 1/4 and 1, and goals are drawn in proportion to them.
/// assert_eq!(class.teacher.summary().weights, Some(&[0.0, 0.2, 0.8][..]));
///
/// let bytes = class.teacher.save()?;
/// class.teacher.load(&bytes)?;
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
pub trait Curriculum: Send {
    /// Chooses the goal of the coming episode.
    ///
    /// # Errors
    /// [`CurriculumError`] if the student's values are unusable (NaN).
    fn propose(&mut self, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError>;

    /// Hears of a finished training episode. Its goal is `episode.goal`, which another teacher may have
    /// chosen: one that looks on as a shadow hears of the episodes of the teacher that acts, whatever it
    /// proposed itself.
    ///
    /// # Errors
    /// [`CurriculumError`] if the episode is not of the teacher's task.
    fn observe(&mut self, episode: &Episode) -> Result<(), CurriculumError>;

    /// Learns after each of the student's learning cycles.
    ///
    /// # Errors
    /// [`CurriculumError`] if its own learning diverged.
    fn learn(
        &mut self,
        student: &mut dyn Critic,
        reward: &dyn Reward,
        rng: &mut Rng,
    ) -> Result<(), CurriculumError>;

    /// Asks for probe rollouts, if it wants some. It is asked after each cycle, once student and teacher have
    /// learned, unless earlier rollouts are still to be played. `goals` gives fresh goals for the start of
    /// the last episode.
    ///
    /// # Errors
    /// [`CurriculumError`] if its own numbers are unusable.
    fn request_rollouts(
        &mut self,
        goals: &mut dyn GoalSource,
        rng: &mut Rng,
    ) -> Result<Option<RolloutRequest>, CurriculumError>;

    /// Hears what all the rollouts that it asked for came to. No episode of training lies between the first
    /// and the last of them, so they all tell of one student.
    ///
    /// # Errors
    /// [`CurriculumError`] if they are not those that it asked for.
    fn hear_rollouts(&mut self, rollouts: &Rollouts) -> Result<(), CurriculumError>;

    /// What there is to record of it now.
    fn summary(&self) -> TeacherSummary<'_>;

    /// What it believes now of every goal of the pool. It last proposed to `student`.
    fn judge(&self, student: &dyn Critic) -> Judgement;

    /// The teacher's whole state as bytes, so that a run can resume exactly. Stateless teachers have none.
    ///
    /// # Errors
    /// [`CurriculumError`] if networks of its own cannot be read.
    fn save(&self) -> Result<Vec<u8>, CurriculumError>;

    /// Takes back what [`Curriculum::save`] gave. A teacher that refuses the bytes stays as it was.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if the bytes are not this teacher's.
    fn load(&mut self, bytes: &[u8]) -> Result<(), CurriculumError>;
}
