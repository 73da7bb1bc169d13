//! The Shadow Dexterous Hand: reaching with the fingertips, turning objects (Plappert et al. 2018,
//! "Multi-Goal Reinforcement Learning"). Follows gymnasium-robotics 1.4.2's `HandReach-v3` and
//! `HandManipulate…-v1`.

mod manipulate;
mod reach;

use super::ROBOTICS;
use crate::env::{Defaults, GoalEnv, Spec};
use crate::error::EnvError;
use crate::mujoco::sim::Joint;
use crate::mujoco::{Physics, Sim};
use crate::registry::{Constructor, EnvOptions, Environment, Verification};
use crate::scene::{GoalShape, Scene, SimulationScene, Viewpoint};
use crate::world::Env;
use crate::writer::Writer;

use manipulate::{
    BLOCK, BLOCK_ROTATE_PARALLEL, BLOCK_ROTATE_Z, EGG, EGG_ROTATE, Manipulate, PEN, PEN_ROTATE, Task,
};
use reach::HandReach;

/// The hand's tasks.
#[rustfmt::skip]
pub(super) static ROWS: &[Environment] = &[
    row("HandReach", [63, 15, 50], reach, "Bring thumb and one finger together", Verification::EXACT),
    turn("HandManipulateBlock", |spec, options| manipulate(spec, options, &BLOCK), "Turn and move a block in the hand"),
    turn("HandManipulateBlockRotateZ", |spec, options| manipulate(spec, options, &BLOCK_ROTATE_Z), "Turn a block about the vertical axis"),
    turn("HandManipulateBlockRotateParallel", |spec, options| manipulate(spec, options, &BLOCK_ROTATE_PARALLEL), "The same, with any face up"),
    turn("HandManipulatePen", |spec, options| manipulate(spec, options, &PEN), "Turn and move a pen in the hand"),
    turn("HandManipulatePenRotate", |spec, options| manipulate(spec, options, &PEN_ROTATE), "Turn a pen in the hand to any direction"),
    egg("HandManipulateEgg", |spec, options| manipulate(spec, options, &EGG), "Turn and move an egg in the hand"),
    egg("HandManipulateEggRotate", |spec, options| manipulate(spec, options, &EGG_ROTATE), "Turn an egg in the hand to any rotation"),
];

/// The numbers are S, G and H.
const fn row(
    id: &'static str,
    [state, goal, horizon]: [usize; 3],
    constructor: Constructor,
    title: &'static str,
    verification: Verification,
) -> Environment {
    // TEACH, section 5.2: deeper networks for the hand.
    let defaults = Defaults { layers: 3, ..ROBOTICS };
    let spec = Spec { id, family: "hand", state, goal, action: 20, horizon, defaults };
    let source = "Plappert et al., Multi-Goal Reinforcement Learning, 2018";
    Environment { verification, ..Environment::new(spec, title, source, constructor) }
}

const fn turn(id: &'static str, constructor: Constructor, title: &'static str) -> Environment {
    row(id, [61, 7, 100], constructor, title, Verification::EXACT)
}

/// The egg rolls on curved contacts: with native CCD its traces differ by up to 3e-4 between types of CPU,
/// where those of all other environments stay below 1e-11.
const fn egg(id: &'static str, constructor: Constructor, title: &'static str) -> Environment {
    let verification = Verification::Recorded { paper: Verification::ROUNDING, native_ccd: 1e-3 };
    row(id, [61, 7, 100], constructor, title, verification)
}

fn reach(spec: Spec, options: &EnvOptions) -> Result<Box<dyn GoalEnv>, EnvError> {
    let world = HandReach::new(spec.id, options.physics())?;
    Ok(Box::new(Env::new(spec, world)))
}

fn manipulate(spec: Spec, options: &EnvOptions, task: &'static Task) -> Result<Box<dyn GoalEnv>, EnvError> {
    let world = Manipulate::new(spec.id, task, options.physics())?;
    Ok(Box::new(Env::new(spec, world)))
}

/// Prefix of the hand's own joints.
const ROBOT: &str = "robot";

/// The reference's camera.
const VIEWPOINT: Viewpoint =
    Viewpoint { lookat: [1.0, 0.96, 0.14], distance: 0.5, azimuth: 55.0, elevation: -25.0 };

/// What all hand environments share: the simulation, the hand's joints, its control ranges.
struct Hand {
    sim: Sim,
    joints: Vec<Joint>,
    /// Centre and half-width of each actuator's control range.
    ranges: Vec<ControlRange>,
}

/// An actuator's control range, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ControlRange {
    low: f64,
    high: f64,
}

impl ControlRange {
    /// Centre + a·half-width, clipped to the range.
    fn control(self, action: f64) -> f64 {
        let centre = (self.high + self.low) / 2.0;
        let half = (self.high - self.low) / 2.0;
        (centre + action * half).max(self.low).min(self.high)
    }
}

impl Hand {
    fn new(env: &'static str, file: &'static str, physics: Physics) -> Result<Self, EnvError> {
        let sim = Sim::new(env, file, physics)?;
        let ranges = sim.model().actuator_ctrlrange().iter();
        let ranges = ranges.map(|&[low, high]| ControlRange { low, high }).collect();
        Ok(Self { joints: sim.joints(ROBOT), ranges, sim })
    }

    /// Tells every actuator, in model order, where in its range to go: `action` in [−1, 1], shape `[20]`.
    fn act(&mut self, action: &[f64]) {
        let controls = self.sim.data_mut().ctrl_mut();
        for ((control, range), &part) in controls.iter_mut().zip(&self.ranges).zip(action) {
            *control = range.control(part);
        }
    }

    /// Writes the hand's joint positions, then their velocities (rad/s), 24 each.
    fn write_joints(&self, state: &mut Writer<'_>) {
        let data = self.sim.data();
        for joint in &self.joints {
            state.put(&[data.qpos()[joint.qpos]]);
        }
        for joint in &self.joints {
            state.put(&[data.qvel()[joint.qvel]]);
        }
    }

    /// The hand now, without `hidden_sites` and with `goal` marked.
    fn scene(&self, hidden_sites: &'static [&'static str], goal: GoalShape) -> Scene<'_> {
        Scene::Simulation(SimulationScene { sim: &self.sim, viewpoint: &VIEWPOINT, hidden_sites, goal })
    }
}

#[cfg(test)]
mod tests {
    use super::ControlRange;

    #[test]
    fn an_action_spans_the_control_range() {
        let range = ControlRange { low: -0.5, high: 1.5 };
        assert_eq!([-1.0, 0.0, 0.5, 1.0].map(|action| range.control(action)), [-0.5, 0.5, 1.0, 1.5]);
    }
}
