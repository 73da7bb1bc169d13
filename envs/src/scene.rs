//! What environments say about how they look. The public part of it stands in [`render`](crate::render).

use crate::mujoco::Sim;

/// What there is to draw of an environment now.
pub enum Scene<'a> {
    /// Something in the plane, seen from above.
    Plane(PlaneScene<'a>),
    /// A MuJoCo simulation, for worlds of this crate alone: see [`SimulationScene`].
    Simulation(SimulationScene<'a>),
}

/// A rectangle in the plane: its lowest and its highest coordinates.
pub type Rectangle = [[f64; 2]; 2];

/// Something that moves on the square [-1, 1]², and its goal. In pictures the first coordinate runs downwards
/// and the second to the right, like the rows and columns of a matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneScene<'a> {
    /// The parts without walls; nothing where all of the square is free.
    pub free: Option<&'a [Rectangle]>,
    /// The joints of a body, from its fixed end to the one at `position`; empty for a single point.
    pub body: Vec<[f64; 2]>,
    /// The point that has to reach the goal. Its path is drawn.
    pub position: [f64; 2],
    /// Where the point should be,
    pub goal: [f64; 2],
    /// within this distance.
    pub threshold: f64,
}

impl PlaneScene<'_> {
    /// A point on the empty square.
    pub fn point(position: [f64; 2], goal: [f64; 2], threshold: f64) -> Self {
        Self { free: None, body: Vec::new(), position, goal, threshold }
    }
}

/// A MuJoCo simulation.
///
/// There is no way to make one outside this crate. It refers to model and state in the types of the MuJoCo
/// binding, which are no part of this crate's interface: if they were, every program with a simulation of its
/// own would have to be built against exactly the binding and the libmujoco that this crate uses. A world
/// outside can show a [`PlaneScene`], or join this crate.
pub struct SimulationScene<'a> {
    /// The simulation.
    pub(crate) sim: &'a Sim,
    /// Where it is looked at from.
    pub(crate) viewpoint: &'static Viewpoint,
    /// Sites of the model that only the reference's own renderer moves into place; they are left out.
    pub(crate) hidden_sites: &'static [&'static str],
    /// How the goal is shown.
    pub(crate) goal: GoalShape,
}

/// How a goal is shown in a simulation.
pub(crate) enum GoalShape {
    /// Spheres where something should be.
    Spheres(Vec<Sphere>),
    /// The model's own ghost of the object, at this pose.
    Ghost {
        /// First index of the ghost's free joint in `qpos`.
        qpos: usize,
        /// Position and quaternion.
        pose: [f64; 7],
    },
}

/// A coloured sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    /// Metres.
    pub(crate) centre: [f64; 3],
    /// Metres.
    pub(crate) radius: f64,
    /// Red, green, blue, opacity.
    pub(crate) rgba: [f32; 4],
}

/// A free camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viewpoint {
    /// The point in the middle of the picture, metres.
    pub(crate) lookat: [f64; 3],
    /// Distance to it, metres.
    pub(crate) distance: f64,
    /// Degrees.
    pub(crate) azimuth: f64,
    /// Degrees.
    pub(crate) elevation: f64,
}
