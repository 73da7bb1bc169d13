//! The four Fetch tasks and how the arm gets to where their episodes start.

use crate::error::EnvError;
use crate::mujoco::Sim;

use super::observe::Parts;

/// Orientation that the reference gives the mocap body; never normalised.
pub(super) const WELD_TURN: [f64; 4] = [1.0, 0.0, 1.0, 0.0];
/// Environment steps until the gripper has come to its place.
const SETTLING: usize = 10;

/// What sets one Fetch task apart.
#[derive(Debug)]
pub(super) struct Task {
    /// Model file.
    pub(super) file: &'static str,
    /// Position of the base's slide joints.
    pub(super) base: [f64; 3],
    /// The object to move.
    pub(super) object: Option<Object>,
    /// Height of the gripper above the table's working height.
    pub(super) gripper_height: f64,
    /// Whether the fingers are kept closed; the last action component then does nothing.
    pub(super) fingers_blocked: bool,
    /// Whether goals may lie above the table.
    pub(super) target_in_the_air: bool,
    /// Goals are drawn on ± this around the gripper's place,
    pub(super) target_range: f64,
    /// shifted by this.
    pub(super) target_offset: [f64; 3],
}

/// The object of a Fetch task.
#[derive(Debug)]
pub(super) struct Object {
    /// Position before the set-up.
    pub(super) position: [f64; 3],
    /// It starts on ± this around the gripper's place.
    pub(super) range: f64,
}

/// FetchReach: no object, goals around the gripper.
pub(super) static REACH: Task = Task {
    file: "fetch/reach.xml",
    base: [0.4049, 0.48, 0.0],
    object: None,
    gripper_height: 0.2,
    fingers_blocked: true,
    target_in_the_air: true,
    target_range: 0.15,
    target_offset: [0.0; 3],
};

/// FetchPush: a block to push along the table.
pub(super) static PUSH: Task = Task {
    file: "fetch/push.xml",
    base: [0.405, 0.48, 0.0],
    object: Some(Object { position: [1.25, 0.53, 0.4], range: 0.15 }),
    gripper_height: 0.0,
    fingers_blocked: true,
    target_in_the_air: false,
    target_range: 0.15,
    target_offset: [0.0; 3],
};

/// FetchSlide: a puck to hit so that it slides to a place out of the arm's reach.
pub(super) static SLIDE: Task = Task {
    file: "fetch/slide.xml",
    base: [0.05, 0.48, 0.0],
    object: Some(Object { position: [1.7, 1.1, 0.41], range: 0.1 }),
    gripper_height: -0.02,
    fingers_blocked: true,
    target_in_the_air: false,
    target_range: 0.3,
    target_offset: [0.4, 0.0, 0.0],
};

/// FetchPickAndPlace: a block to carry, half of the time into the air.
pub(super) static PICK_AND_PLACE: Task = Task {
    file: "fetch/pick_and_place.xml",
    base: [0.405, 0.48, 0.0],
    object: Some(Object { position: [1.25, 0.53, 0.4], range: 0.15 }),
    gripper_height: 0.2,
    fingers_blocked: false,
    target_in_the_air: true,
    target_range: 0.15,
    target_offset: [0.0; 3],
};

impl Task {
    /// Half the side of the square the object starts on; the reference's default where there is none.
    pub(super) fn object_range(&self) -> f64 {
        self.object.as_ref().map_or(0.15, |object| object.range)
    }

    /// Places base and object, then lets the weld pull the gripper to its place.
    pub(super) fn set_up(&self, sim: &mut Sim, parts: &Parts) -> Result<(), EnvError> {
        let base = ["robot0:slide0", "robot0:slide1", "robot0:slide2"];
        for (name, value) in base.into_iter().zip(self.base) {
            let joint = sim.joint(name)?;
            sim.data_mut().qpos_mut()[joint.qpos] = value;
        }
        if let (Some(object), Some(found)) = (&self.object, &parts.object) {
            let [x, y, z] = object.position;
            let first = found.joint.qpos;
            sim.data_mut().qpos_mut()[first..first + 7].copy_from_slice(&[x, y, z, 1.0, 0.0, 0.0, 0.0]);
        }
        // Twice, as the reference does: the second one starts warm.
        sim.forward();
        sim.forward();
        let grip = parts.grip.position(sim.data());
        let shift = [-0.498, 0.005, -0.431 + self.gripper_height];
        let data = sim.data_mut();
        data.mocap_pos_mut()[0] = std::array::from_fn(|axis| shift[axis] + grip[axis]);
        data.mocap_quat_mut()[0] = WELD_TURN;
        (0..SETTLING).try_for_each(|_| sim.advance())
    }
}
