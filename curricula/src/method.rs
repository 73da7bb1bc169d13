//! What a teaching method is.

use agents::{Critic, Episode};
use envs::rng::Rng;
use envs::{GoalSource, Reward};
use looks::Look;
use schemars::Schema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::curriculum::{Lesson, Proposal, Setting, TeacherSummary};
use crate::error::CurriculumError;
use crate::judgement::Judgement;
use crate::rollouts::{RolloutRequest, Rollouts};
use crate::state::TeacherState;

/// A teaching method: what makes a row of the table, and a teacher in every run.
///
/// The value itself never changes: it holds the config, the pool and whatever else is fixed for a run. All
/// that changes lives in [`Method::State`], which is saved and loaded whole, so that a method cannot forget a
/// part of it. Functions that change something get the state, and only the state, to write to; a method is
/// `Sync`, so that it cannot hide a `Cell` either.
///
/// ```
/// use curricula::testing::contract;
/// use curricula::{CurriculumError, Entry, Lesson, Method, PlainState, Proposal, Setting};
/// use serde::{Deserialize, Serialize};
///
/// /// Every goal of the pool in turn.
/// struct InTurn {
///     pool: usize,
/// }
///
/// #[derive(Default, Serialize, Deserialize)]
/// struct InTurnConfig {}
///
/// #[derive(Serialize, Deserialize)]
/// struct InTurnState {
///     proposed: usize,
/// }
///
/// impl PlainState for InTurnState {
///     const VERSION: u32 = 1;
/// }
///
/// impl Method for InTurn {
///     type Config = InTurnConfig;
///     type State = InTurnState;
///     const ID: &'static str = "in-turn";
///     const TITLE: &'static str = "In turn";
///     const SOURCE: &'static str = "An example";
///     const VERSION: &'static str = "1";
///     const USES_POOL: bool = true;
///
///     fn build(_config: InTurnConfig, setting: &Setting) -> Result<Self, CurriculumError> {
///         Ok(Self { pool: setting.pool.len() })
///     }
///
///     fn begin(&self, _setting: &Setting) -> Result<InTurnState, CurriculumError> {
///         Ok(InTurnState { proposed: 0 })
///     }
///
///     fn propose(
///         &self,
///         state: &mut InTurnState,
///         _lesson: &mut Lesson<'_>,
///     ) -> Result<Proposal, CurriculumError> {
///         state.proposed += 1;
///         Ok(Proposal::pool(state.proposed % self.pool))
///     }
/// }
///
/// contract(&Entry::of::<InTurn>());
/// ```
pub trait Method: Sized + Send + Sync + 'static {
    /// Its options. Fields that users leave out have their defaults, and names that it does not have are
    /// refused, so no `#[serde(...)]` is needed for either. The config's own doc comments give each field's
    /// range and source.
    type Config: Serialize + DeserializeOwned + Default;
    /// All that changes while it teaches, `()` for nothing. Data in memory is a
    /// [`PlainState`](crate::PlainState).
    type State: TeacherState;
    /// Short name on the command line, in configs and in run folders: lower case with hyphens. In this
    /// workspace it is the name of the method's file with hyphens for underscores.
    const ID: &'static str;
    /// Name in lists, figures and tables.
    const TITLE: &'static str;
    /// The paper, in one line.
    const SOURCE: &'static str;
    /// Version of what it does, recorded with every run: another one whenever the same config teaches in
    /// another way. Runs of one version are neither carried on nor taken for its own by another. Where nobody
    /// counts, `env!("CARGO_PKG_VERSION")` gives the version of the method's package.
    const VERSION: &'static str;
    /// How its curves are drawn: unlike any other's. A method without a look of its own gets a free one in
    /// each report.
    const LOOK: Option<Look> = None;
    /// Whether it chooses from the pool. Such a method is never built on an empty pool.
    const USES_POOL: bool;

    /// The field without which it cannot teach and that has no default, such as a command. Its default stands
    /// for "not given", and a run that leaves it so is refused before anything is written.
    const NEEDS: Option<&'static str> = None;

    /// The version of what it does with `config`: [`Method::VERSION`], unless the config names something that
    /// has versions of its own, such as a program.
    fn version(_config: &Self::Config) -> String {
        Self::VERSION.to_owned()
    }

    /// What the fields of its config are: `Some(schema_of::<Self::Config>())` if that derives `JsonSchema`.
    /// `goalbench help config` then explains every field by its doc comment, and a value of a wrong type is
    /// answered with what is accepted. See [`schema_of`](crate::schema_of).
    fn schema() -> Option<Schema> {
        None
    }

    /// Checks the ranges of a config.
    ///
    /// # Errors
    /// [`CurriculumError::Config`], naming the field and what is accepted.
    fn check(_config: &Self::Config) -> Result<(), CurriculumError> {
        Ok(())
    }

    /// Makes the method from a checked config.
    ///
    /// # Errors
    /// [`CurriculumError`] if it cannot be built for this setting.
    fn build(config: Self::Config, setting: &Setting) -> Result<Self, CurriculumError>;

    /// The state before the first episode. It is made again where a saved one is loaded, so it must not
    /// depend on anything but `self` and `setting`, which is the one that the method was built with.
    ///
    /// # Errors
    /// [`CurriculumError`] if networks of its own cannot be made.
    fn begin(&self, setting: &Setting) -> Result<Self::State, CurriculumError>;

    /// Chooses the goal of the coming episode.
    ///
    /// # Errors
    /// [`CurriculumError`] if the student's values are unusable (NaN).
    fn propose(&self, state: &mut Self::State, lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError>;

    /// Hears of a finished training episode. Its goal is `episode.goal`, which another teacher may have
    /// chosen: one that looks on as a shadow hears of the episodes of the teacher that acts, whatever it
    /// proposed itself.
    ///
    /// # Errors
    /// [`CurriculumError`] if the episode is not of the teacher's task.
    fn observe(&self, _state: &mut Self::State, _episode: &Episode) -> Result<(), CurriculumError> {
        Ok(())
    }

    /// Learns after each of the student's learning cycles.
    ///
    /// # Errors
    /// [`CurriculumError`] if its own learning diverged.
    fn learn(
        &self,
        _state: &mut Self::State,
        _student: &mut dyn Critic,
        _reward: &dyn Reward,
        _rng: &mut Rng,
    ) -> Result<(), CurriculumError> {
        Ok(())
    }

    /// Asks for probe rollouts after a cycle. Their steps are the method's price: whether they are charged to
    /// the run's budget is best an option of its config, true by default.
    ///
    /// # Errors
    /// [`CurriculumError`] if its own numbers are unusable.
    fn request_rollouts(
        &self,
        _state: &mut Self::State,
        _goals: &mut dyn GoalSource,
        _rng: &mut Rng,
    ) -> Result<Option<RolloutRequest>, CurriculumError> {
        Ok(None)
    }

    /// Hears what the rollouts that it asked for came to.
    ///
    /// # Errors
    /// [`CurriculumError`] if they are not those that it asked for.
    fn hear_rollouts(&self, _state: &mut Self::State, _rollouts: &Rollouts) -> Result<(), CurriculumError> {
        Ok(())
    }

    /// What there is to record now. A method of the pool shows its weights here, and a loaded state whose
    /// weights are not as many as the pool's goals is refused.
    fn summary<'a>(&'a self, _state: &'a Self::State) -> TeacherSummary<'a> {
        TeacherSummary::default()
    }

    /// What it believes now of every goal of the pool, for those who measure what of it is true. It last
    /// proposed to `student`, which it cannot ask here: it tells what it went by. A method that tells nothing
    /// is not judged by it.
    fn judge(&self, _state: &Self::State, _student: &dyn Critic) -> Judgement {
        Judgement::default()
    }

    /// Refuses a loaded state that does not fit config or pool.
    ///
    /// # Errors
    /// [`CurriculumError::State`], best made by [`snapshot::refuse`](crate::snapshot::refuse).
    fn check_state(&self, _state: &Self::State) -> Result<(), CurriculumError> {
        Ok(())
    }
}
