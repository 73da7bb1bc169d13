//! The MuJoCo side that Fetch and Hand share: the library, the models, the simulation.

pub(crate) mod assets;
mod library;
mod playback;
pub(crate) mod sim;
mod site;

pub use assets::Physics;
pub use library::VERSION as MUJOCO_VERSION;
pub(crate) use sim::{Sim, Snapshot};
pub(crate) use site::{Site, sub};
