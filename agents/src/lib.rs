//! The student: DDPG + HER on libtorch.
//!
//! [`Agent`] is the trait that the harness trains through, [`Critic`] its read-only side that teachers see.
//! [`make`] builds the agent that a [`StudentConfig`] names from the table [`registry::AGENTS`]. Teachers that learn values
//! of their own have [`Ensemble`].

mod agent;
mod auto;
mod batch;
mod config;
mod ddpg;
mod device;
mod ensemble;
mod error;
mod inputs;
mod losses;
mod networks;
mod noise;
mod normalizer;
mod products;
pub mod registry;
mod replay;
mod runtime;
mod seal;
mod value;

pub use agent::{Agent, Critic, Episode, Mode, Network};
pub use auto::Auto;
pub use batch::Batch;
pub use config::{PolyakEvery, Preset, StudentConfig};
pub use device::Device;
pub use ensemble::{Ensemble, EnsembleConfig};
pub use error::AgentError;

pub use noise::NoiseConfig;
pub use normalizer::{Moments, Normalizer, NormalizerConfig};
pub use products::Products;
pub use registry::make;
pub use replay::{HerStrategy, Hindsight, Replay, Source};
pub use runtime::{prepare_thread, versions};
pub use seal::Seal;
