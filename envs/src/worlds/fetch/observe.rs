//! What a Fetch environment shows of its simulation.

use crate::env::Observation;
use crate::error::EnvError;
use crate::mujoco::sim::{Joint, Sim};
use crate::mujoco::{Site, sub};
use crate::rotation::matrix_to_euler;
use crate::writer::Writer;

use super::Task;

/// The parts of the model that the observation is made of.
#[derive(Debug)]
pub(super) struct Parts {
    /// Point between the fingers.
    pub(super) grip: Site,
    /// Right and left finger.
    pub(super) fingers: [Joint; 2],
    /// The object, for tasks that have one.
    pub(super) object: Option<Object>,
}

/// The object in the model.
#[derive(Debug)]
pub(super) struct Object {
    /// Its centre.
    pub(super) site: Site,
    /// Its free joint.
    pub(super) joint: Joint,
}

impl Parts {
    pub(super) fn find(sim: &Sim, task: &Task) -> Result<Self, EnvError> {
        let object = match task.object {
            None => None,
            Some(_) => Some(Object { site: sim.site("object0")?, joint: sim.joint("object0:joint")? }),
        };
        let right = sim.joint("robot0:r_gripper_finger_joint")?;
        let left = sim.joint("robot0:l_gripper_finger_joint")?;
        Ok(Self { grip: sim.site("robot0:grip")?, fingers: [right, left], object })
    }
}

/// Grip position 3, [object position 3, object − grip 3,] finger positions 2, [object Euler angles 3, object
/// velocity − grip velocity 3, object angular velocity 3,] grip velocity 3, finger velocities 2; the parts in
/// brackets only with an object. Achieved goal: position of the object, or of the gripper without one.
pub(super) fn write_observation(sim: &Sim, parts: &Parts, observation: &mut Observation) {
    let (data, dt) = (sim.data(), sim.dt());
    let grip = parts.grip.position(data);
    let grip_velocity = parts.grip.velocity(data).linear.map(|v| v * dt);
    let fingers = parts.fingers.map(|finger| data.qpos()[finger.qpos]);
    let finger_velocities = parts.fingers.map(|finger| data.qvel()[finger.qvel] * dt);
    let mut state = Writer::new(&mut observation.state);
    state.put(&grip);
    match &parts.object {
        None => {
            state.put(&fingers);
            observation.achieved.copy_from_slice(&grip);
        }
        Some(object) => {
            let position = object.site.position(data);
            let velocity = object.site.velocity(data);
            state.put(&position);
            state.put(&sub(position, grip));
            state.put(&fingers);
            state.put(&matrix_to_euler(&object.site.rotation(data)));
            state.put(&sub(velocity.linear.map(|v| v * dt), grip_velocity));
            state.put(&velocity.angular.map(|v| v * dt));
            observation.achieved.copy_from_slice(&position);
        }
    }
    state.put(&grip_velocity);
    state.put(&finger_velocities);
}
