//! The worlds, each with the rows of its environments. A new world is a file here and its rows in [`WORLDS`].

mod fetch;
mod hand;
mod maze;
mod plane;
mod point;

use crate::env::Defaults;
use crate::registry::Environment;

/// The rows of all worlds, in the order in which they are listed.
pub(crate) static WORLDS: &[&[Environment]] = &[point::ROWS, maze::ROWS, fetch::ROWS, hand::ROWS];

/// How TEACH trains its robotics tasks (section 5.2): for a million steps. Only the hand gets deeper
/// networks.
const ROBOTICS: Defaults = Defaults { steps: 1_000_000, evaluate_every: 10_000, layers: 2 };
