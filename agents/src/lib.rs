//! The student: DDPG + HER on libtorch.
//!
//! [`Agent`] is the trait that the harness trains through, [`Critic`] its read-only side that teachers see.
//! [`make`] builds the agent that a [`StudentConfig`] names from the table [`registry::AGENTS`]. Teachers
//! that learn values of their own have [`Ensemble`]. Students of one shape can learn in lockstep: [`Cohort`].
//!
//! One cycle of training, as the harness does it:
//!
//! ```
//! use agents::{Episode, Mode, StudentConfig};
//! use envs::Rows;
//! use envs::rng::{Purpose, stream};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! agents::prepare_thread();
//! let mut env = envs::make("Point", &envs::EnvOptions::default())?;
//! let spec = env.spec().clone();
//! let config = StudentConfig { width: 16, updates_per_cycle: 2, ..StudentConfig::default() };
//! let mut student = agents::make(&config, &spec, 0)?;
//!
//! let (mut starts, mut exploration) = (stream(0, Purpose::Environment), stream(0, Purpose::Exploration));
//! let mut replay = stream(0, Purpose::Replay);
//! for _ in 0..student.episodes_per_cycle() {
//!     env.reset(&mut starts)?;
//!     student.begin_episode();
//!     let [mut states, mut achieved, mut actions] = [spec.state, spec.goal, spec.action].map(Rows::new);
//!     let (mut action, mut total_reward) = (vec![0.0; spec.action], 0.0);
//!     for _ in 0..spec.horizon {
//!         states.push(&env.observation().state);
//!         achieved.push(&env.observation().achieved);
//!         let mode = Mode::Explore(&mut exploration);
//!         student.act(env.observation(), env.goal(), mode, &mut action)?;
//!         env.step(&action)?;
//!         actions.push(&action);
//!         total_reward += env.reward(&env.observation().achieved, env.goal());
//!     }
//!     states.push(&env.observation().state);
//!     achieved.push(&env.observation().achieved);
//!     let success = env.success(&env.observation().achieved, env.goal());
//!     let episode = Episode { states, achieved, actions, goal: env.goal().to_vec(), total_reward, success };
//!     student.observe(&episode, env.as_ref(), &mut replay)?;
//! }
//! student.learn(env.as_ref(), &mut replay)?;
//! assert_eq!(student.gradient_steps(), 2);
//! # Ok(())
//! # }
//! ```

mod actor;
mod agent;
mod auto;
mod batch;
mod checks;
mod cohort;
mod config;
mod ddpg;
mod device;
mod diagnosis;
mod draw;
mod ensemble;
mod episode;
mod error;
mod inputs;
mod losses;
mod networks;
mod noise;
mod normalizer;
mod pool;
mod precision;
mod products;
pub mod registry;
mod replay;
mod runtime;
mod seal;
mod tf32;
mod value;

pub use actor::{DenseLayer, InputScaling, PolicyWeights};
pub use agent::{Agent, Critic, Mode, Network};
pub use auto::Auto;
pub use batch::Batch;
pub use cohort::{Cohort, CohortLane};
pub use config::{PolyakEvery, Preset, StudentConfig};
pub use ddpg::ROWS_ASKED_AFAR;
pub use device::Device;
pub use diagnosis::{Diagnosis, DryStep};
pub use draw::{HerStrategy, Hindsight};
pub use ensemble::{Ensemble, EnsembleConfig};
pub use episode::{Episode, Trajectory};
pub use error::{AgentError, DeviceProblem, LogProblem, StateProblem, SwitchProblem, TorchError};
pub use noise::NoiseConfig;
pub use normalizer::{Moments, Normalizer, NormalizerConfig};
pub use pool::side_by_side;
pub use precision::Precision;
pub use products::{ProductRates, Products};
pub use registry::{check_replay, make, make_cohort};
pub use replay::{Replay, Source};
pub use runtime::{prepare_thread, versions};
pub use seal::{Seal, SealError};
