//! The rows of all environments, and the suites made of them.
//!
//! Every world keeps its own rows; the list of worlds stands in `worlds/mod.rs`.

use crate::env::{GoalEnv, Spec};
use crate::error::EnvError;
use crate::mujoco::Physics;
use crate::worlds::WORLDS;

/// What a user may choose about an environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnvOptions {
    /// Simulate with MuJoCo's native CCD, as a plain install of the reference does. Off by default, because
    /// without it MuJoCo 3.3.7 agrees with the versions of the paper's time. It changes nothing where nothing
    /// is simulated.
    pub native_ccd: bool,
}

impl EnvOptions {
    pub(crate) fn physics(&self) -> Physics {
        if self.native_ccd { Physics::NativeCcd } else { Physics::Paper }
    }
}

/// An environment as the paper names it, where its Table 1 differs from what the environment has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaperRow {
    /// Action dimension that Table 1 prints.
    pub action: usize,
    /// Why it is not ours.
    pub note: &'static str,
}

/// How it is known that an environment is the task that it claims to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verification {
    /// Its world is a few formulas, which tests compare with numbers worked out by hand.
    Analytic,
    /// Traces recorded from the original are replayed. These are the largest absolute deviations that pass
    /// after a simulated step, in the units of each quantity.
    Recorded {
        /// With the physics of the paper's time.
        paper: f64,
        /// With native CCD.
        native_ccd: f64,
    },
}

impl Verification {
    /// Largest absolute deviation that passes where nothing is simulated over time, and in general after a
    /// simulated step: computers round differently.
    pub const ROUNDING: f64 = 1e-9;

    /// Replayed traces agree but for rounding.
    pub(crate) const EXACT: Self = Self::Recorded { paper: Self::ROUNDING, native_ccd: Self::ROUNDING };

    /// Largest absolute deviation that passes after a simulated step with `physics`.
    pub(crate) fn tolerance(self, physics: Option<Physics>) -> f64 {
        match (self, physics) {
            (Self::Analytic, _) => Self::ROUNDING,
            (Self::Recorded { native_ccd, .. }, Some(Physics::NativeCcd)) => native_ccd,
            (Self::Recorded { paper, .. }, _) => paper,
        }
    }
}

/// Builds an environment with these constants.
pub type Constructor = fn(Spec, &EnvOptions) -> Result<Box<dyn GoalEnv>, EnvError>;

/// A row of the list of environments: all that there is to know of one without building it.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Id, dimensions, and how it is trained by default.
    pub spec: Spec,
    /// What there is to do, in one line.
    pub title: &'static str,
    /// Where the task comes from.
    pub source: &'static str,
    /// The paper's Table 1, where it prints other dimensions.
    pub paper: Option<PaperRow>,
    /// The walls of a maze on the square [-1, 1]², for maps of it, a row of cells per string: `#` wall, `.`
    /// free, `S` the free start cell. The row of a cell goes with the first coordinate, its column with the
    /// second.
    pub walls: Option<&'static [&'static str]>,
    /// How it is verified.
    pub verification: Verification,
    /// What builds it.
    pub constructor: Constructor,
}

impl Environment {
    /// A row with nothing special about it: the paper has no other row, there are no walls, the world is
    /// analytic.
    ///
    /// See [`World`](crate::World) for how to write the world, and `harness/examples/own_environment.rs` for
    /// a program with an environment of its own.
    ///
    /// ```
    /// use envs::{Defaults, EnvOptions, Environment, Spec};
    ///
    /// let spec = Spec {
    ///     id: "Again", family: "toy", state: 2, goal: 2, action: 2, horizon: 20, defaults: Defaults::TOY,
    /// };
    /// let row = Environment::new(spec, "The toy task again", "An example", |spec, options| {
    ///     (envs::find("Point")?.constructor)(spec, options)
    /// });
    /// assert_eq!(row.make(&EnvOptions::default())?.spec().id, "Again");
    /// # Ok::<(), envs::EnvError>(())
    /// ```
    pub const fn new(
        spec: Spec,
        title: &'static str,
        source: &'static str,
        constructor: Constructor,
    ) -> Self {
        let verification = Verification::Analytic;
        Self { spec, title, source, paper: None, walls: None, verification, constructor }
    }

    /// Id of the environment.
    pub const fn id(&self) -> &'static str {
        self.spec.id
    }

    /// Builds the environment.
    ///
    /// # Errors
    /// For simulated ones [`EnvError::Asset`] or [`EnvError::MujocoVersion`].
    pub fn make(&self, options: &EnvOptions) -> Result<Box<dyn GoalEnv>, EnvError> {
        (self.constructor)(self.spec.clone(), options)
    }
}

/// Every environment of this crate, world by world.
///
/// ```
/// let ids: Vec<&str> = envs::environments().map(|row| row.id()).collect();
/// assert!(ids.contains(&"MazeA") && ids.contains(&"FetchPush"));
/// ```
pub fn environments() -> impl Iterator<Item = &'static Environment> + Clone {
    WORLDS.iter().copied().flatten()
}

/// The row of the environment called `id`.
///
/// ```
/// let row = envs::find("MazeC")?;
/// assert_eq!((row.spec.horizon, row.walls.map(<[_]>::len)), (50, Some(13)));
/// # Ok::<(), envs::EnvError>(())
/// ```
///
/// # Errors
/// [`EnvError::Unknown`], with the ids there are.
pub fn find(id: &str) -> Result<&'static Environment, EnvError> {
    environments().find(|row| row.id() == id).ok_or_else(|| EnvError::Unknown {
        id: id.to_owned(),
        known: environments().map(Environment::id).collect(),
    })
}

/// Builds the environment called `id`.
///
/// ```
/// let env = envs::make("Point", &envs::EnvOptions::default())?;
/// assert_eq!((env.spec().action, env.spec().horizon), (2, 20));
/// assert!(envs::make("Pint", &envs::EnvOptions::default()).is_err());
/// # Ok::<(), envs::EnvError>(())
/// ```
///
/// # Errors
/// Those of [`find`] and [`Environment::make`].
pub fn make(id: &str, options: &EnvOptions) -> Result<Box<dyn GoalEnv>, EnvError> {
    find(id)?.make(options)
}

/// A named list of environments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suite {
    /// Its name.
    pub id: &'static str,
    /// Ids of its environments, in order.
    pub environments: &'static [&'static str],
}

/// The suites of this crate.
///
/// The paper names HandManipulateBlock, -Pen and -Egg, but its appendix B describes "rotate about z" and
/// "rotate in all axes" without a position goal. `paper` follows the appendix, `paper-ids` the names.
pub static SUITES: &[Suite] = &[
    Suite {
        id: "paper",
        environments: &[
            "FetchReach",
            "FetchPush",
            "FetchSlide",
            "FetchPickAndPlace",
            "HandReach",
            "HandManipulateBlockRotateZ",
            "HandManipulatePenRotate",
            "HandManipulateEggRotate",
            "MazeA",
            "MazeB",
            "MazeC",
        ],
    },
    Suite {
        id: "paper-ids",
        environments: &[
            "FetchReach",
            "FetchPush",
            "FetchSlide",
            "FetchPickAndPlace",
            "HandReach",
            "HandManipulateBlock",
            "HandManipulatePen",
            "HandManipulateEgg",
            "MazeA",
            "MazeB",
            "MazeC",
        ],
    },
];

/// The environments of the suite called `name`.
///
/// ```
/// assert_eq!(envs::suite("paper")?.len(), 11);
/// # Ok::<(), envs::EnvError>(())
/// ```
///
/// # Errors
/// [`EnvError::UnknownSuite`], with the names there are.
pub fn suite(name: &str) -> Result<&'static [&'static str], EnvError> {
    SUITES.iter().find(|suite| suite.id == name).map(|suite| suite.environments).ok_or_else(|| {
        EnvError::UnknownSuite { name: name.to_owned(), known: SUITES.iter().map(|suite| suite.id).collect() }
    })
}
