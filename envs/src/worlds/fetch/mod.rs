//! The Fetch arm: reach, push, slide, pick and place (Plappert et al. 2018, "Multi-Goal Reinforcement
//! Learning").
//!
//! Follows gymnasium-robotics 1.4.2's `-v4` environments. The arm is moved by a mocap body that its gripper
//! is welded to; an action moves the mocap body. Lengths are metres, angles radians; velocities in
//! observations are per environment step (0.04 s), as in the reference.

mod observe;
mod task;

use std::sync::{Arc, Mutex, PoisonError};

use mujoco_rs::wrappers::mj_model::{MjModel, MjtObj};
use serde_json::{Map, Value, json};

use crate::draws::Draws;
use crate::env::{GoalEnv, Observation, Reward, Spec};
use crate::error::EnvError;
use crate::metric::{WithinDistance, distance};
use crate::mujoco::{Physics, Sim, Snapshot};
use crate::playback::{PlaybackError, RecordedWorld, Start};
use crate::registry::{Constructor, EnvOptions, Environment, PaperRow, Verification};
use crate::scene::{GoalShape, Scene, SimulationScene, Sphere, Viewpoint};
use crate::world::{Env, World};

use super::ROBOTICS;
use observe::{Parts, write_observation};
use task::{PICK_AND_PLACE, PUSH, REACH, SLIDE, Task, WELD_TURN};

/// The four tasks; the number is S.
#[rustfmt::skip]
pub(super) static ROWS: &[Environment] = &[
    row("FetchReach", 10, OF_THREE, |spec, options| fetch(spec, options, &REACH), "Move the gripper to a place in the air"),
    row("FetchPush", 25, OF_THREE, |spec, options| fetch(spec, options, &PUSH), "Push a block to a place on the table"),
    row("FetchSlide", 25, OF_THREE, |spec, options| fetch(spec, options, &SLIDE), "Hit a puck so that it slides to a place out of reach"),
    row("FetchPickAndPlace", 25, None, |spec, options| fetch(spec, options, &PICK_AND_PLACE), "Carry a block to a place on or above the table"),
];

/// What Table 1 of the paper prints for all but FetchPickAndPlace.
const OF_THREE: Option<PaperRow> = Some(PaperRow {
    action: 3,
    note: "the environment takes 4 numbers; the last, for the fingers, changes nothing",
});

const fn row(
    id: &'static str,
    state: usize,
    paper: Option<PaperRow>,
    constructor: Constructor,
    title: &'static str,
) -> Environment {
    let spec = Spec { id, family: "fetch", state, goal: 3, action: 4, horizon: 50, defaults: ROBOTICS };
    Environment {
        paper,
        verification: Verification::EXACT,
        ..Environment::new(
            spec,
            title,
            "Plappert et al., Multi-Goal Reinforcement Learning, 2018",
            constructor,
        )
    }
}

fn fetch(spec: Spec, options: &EnvOptions, task: &'static Task) -> Result<Box<dyn GoalEnv>, EnvError> {
    let fetch = Fetch::new(spec.id, task, options.physics())?;
    Ok(Box::new(Env::new(spec, fetch)))
}

/// Distance within which a goal counts as reached.
const THRESHOLD: f64 = 0.05;
/// Distance that an action component of 1 moves the mocap body.
const STRIDE: f64 = 0.05;
/// An object never starts closer than this to the gripper.
const CLEARANCE: f64 = 0.1;

/// The reference's camera.
const VIEWPOINT: Viewpoint =
    Viewpoint { lookat: [1.3, 0.75, 0.55], distance: 2.5, azimuth: 132.0, elevation: -14.0 };
/// The site that the reference's renderer moves to the goal: its name, radius and colour.
const TARGET: (&str, f64, [f32; 4]) = ("target0", 0.02, [1.0, 0.0, 0.0, 1.0]);

/// The world of a Fetch environment.
struct Fetch {
    task: &'static Task,
    sim: Sim,
    parts: Parts,
    /// Body that the mocap body drags.
    gripper: usize,
    settled: Arc<Settled>,
}

/// The result of the set-up.
struct Settled {
    /// State at the end of the set-up, where every episode starts.
    initial: Snapshot,
    /// Gripper position at the end of the set-up.
    grip: [f64; 3],
    /// Height of the object's centre on the table; none without an object.
    height: Option<f64>,
}

impl Settled {
    /// Simulates the set-up, or gives the result of an earlier simulation: a student that is evaluated on
    /// twenty instances would otherwise wait for seconds at every start of a run.
    fn of(sim: &mut Sim, task: &'static Task, parts: &Parts) -> Result<Arc<Self>, EnvError> {
        type Known = Mutex<Vec<(Arc<MjModel>, &'static Task, Arc<Settled>)>>;
        static KNOWN: Known = Mutex::new(Vec::new());
        // A poisoned lock only means that another thread died. Entries are inserted when they are complete.
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let model = sim.shared_model();
        let same = |(of, by, _): &&(Arc<MjModel>, &'static Task, Arc<Self>)| {
            Arc::ptr_eq(of, &model) && std::ptr::eq(*by, task)
        };
        if let Some((_, _, settled)) = known().iter().find(same) {
            return Ok(Arc::clone(settled));
        }
        let settled = Arc::new(Self::simulate(sim, task, parts)?);
        known().push((model, task, Arc::clone(&settled)));
        Ok(settled)
    }

    fn simulate(sim: &mut Sim, task: &Task, parts: &Parts) -> Result<Self, EnvError> {
        task.set_up(sim, parts)?;
        let grip = parts.grip.position(sim.data());
        let height = parts.object.as_ref().map(|object| object.site.position(sim.data())[2]);
        Ok(Self { initial: sim.snapshot(), grip, height })
    }
}

impl Fetch {
    fn new(id: &'static str, task: &'static Task, physics: Physics) -> Result<Self, EnvError> {
        let mut sim = Sim::new(id, task.file, physics)?;
        let parts = Parts::find(&sim, task)?;
        let settled = Settled::of(&mut sim, task, &parts)?;
        Self::with(task, sim, parts, settled)
    }

    fn with(task: &'static Task, sim: Sim, parts: Parts, settled: Arc<Settled>) -> Result<Self, EnvError> {
        let gripper = sim.id(MjtObj::mjOBJ_BODY, "robot0:gripper_link")?;
        let mut fetch = Self { task, sim, parts, gripper, settled };
        fetch.back_to_start();
        fetch.sim.forward();
        Ok(fetch)
    }

    /// Back to the end of the set-up, with no trace of what happened since.
    fn back_to_start(&mut self) {
        self.sim.data_mut().reset();
        self.sim.restore(&self.settled.initial);
    }

    /// Moves the mocap body: gripper position + 0.05·a for the first three numbers of the action, and the
    /// reference's (unnormalised) turn. Where the fingers are free, the fourth number shifts their position
    /// targets.
    fn act(&mut self, action: &[f64]) {
        let (fingers, gripper) = (self.parts.fingers, self.gripper);
        let position = self.sim.data().xpos()[gripper];
        let orientation = self.sim.data().xquat()[gripper];
        let data = self.sim.data_mut();
        for axis in 0..3 {
            data.mocap_pos_mut()[0][axis] = position[axis] + STRIDE * action[axis];
        }
        for (part, turn) in WELD_TURN.iter().enumerate() {
            data.mocap_quat_mut()[0][part] = orientation[part] + turn;
        }
        if !self.task.fingers_blocked {
            let [right, left] = fingers.map(|finger| data.qpos()[finger.qpos] + action[3]);
            data.ctrl_mut().copy_from_slice(&[left, right]);
        }
    }

    /// Closes blocked fingers, which leaves their velocity alone. Free fingers get no `mj_forward` either, so
    /// that site positions lag one substep behind, as in the reference.
    fn hold_fingers(&mut self) {
        if !self.task.fingers_blocked {
            return;
        }
        for finger in self.parts.fingers {
            self.sim.data_mut().qpos_mut()[finger.qpos] = 0.0;
        }
        self.sim.forward();
    }
}

/// A point at gripper + U(±range)², drawn again while it is too close to the gripper.
fn draw_object(grip: [f64; 2], range: f64, draws: &mut Draws<'_>) -> [f64; 2] {
    loop {
        let shift = draws.uniform([-range; 2], [range; 2]);
        let position = [grip[0] + shift[0], grip[1] + shift[1]];
        if distance(&position, &grip) >= CLEARANCE {
            return position;
        }
    }
}

impl World for Fetch {
    /// Only the object's position is drawn; there is no settling.
    fn start(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError> {
        self.back_to_start();
        if let Some(object) = &self.parts.object {
            let position =
                draw_object([self.settled.grip[0], self.settled.grip[1]], self.task.object_range(), draws);
            let first = object.joint.qpos;
            self.sim.data_mut().qpos_mut()[first..first + 2].copy_from_slice(&position);
        }
        self.sim.forward();
        self.sim.check()
    }

    /// Gripper position + U(±range)³ + offset; with an object at the object's height, in the air half of the
    /// time for the tasks that lift.
    fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]) {
        let range = self.task.target_range;
        let shift: [f64; 3] = draws.uniform([-range; 3], [range; 3]);
        let mut place = [0, 1, 2].map(|i| self.settled.grip[i] + shift[i] + self.task.target_offset[i]);
        if let Some(height) = self.settled.height {
            place[2] = height;
            if self.task.target_in_the_air && draws.uniform([0.0], [1.0])[0] < 0.5 {
                place[2] += draws.uniform([0.0], [0.45])[0];
            }
        }
        goal.copy_from_slice(&place);
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.act(action);
        self.sim.advance()?;
        self.hold_fingers();
        Ok(())
    }

    fn observe(&self, observation: &mut Observation) {
        write_observation(&self.sim, &self.parts, observation);
    }

    fn task(&self) -> &dyn Reward {
        &WithinDistance(THRESHOLD)
    }

    fn scene(&self, goal: &[f64]) -> Option<Scene<'_>> {
        let (_, radius, rgba) = TARGET;
        let sphere = Sphere { centre: [goal[0], goal[1], goal[2]], radius, rgba };
        Some(Scene::Simulation(SimulationScene {
            sim: &self.sim,
            viewpoint: &VIEWPOINT,
            hidden_sites: &[TARGET.0],
            goal: GoalShape::Spheres(vec![sphere]),
        }))
    }

    fn recorded(&mut self) -> Option<&mut dyn RecordedWorld> {
        Some(self)
    }
}

impl RecordedWorld for Fetch {
    fn constants(&self) -> Map<String, Value> {
        let task = self.task;
        let own = json!({
            "reward_type": "sparse",
            "distance_threshold": THRESHOLD,
            "rotation_threshold": null,
            "gripper_extra_height": task.gripper_height,
            "block_gripper": task.fingers_blocked,
            "has_object": task.object.is_some(),
            "target_in_the_air": task.target_in_the_air,
            "obj_range": task.object_range(),
            "target_range": task.target_range,
            // Recordings hold a plain 0 where nothing is shifted.
            "target_offset": if task.target_offset == [0.0; 3] { json!(0.0) } else { json!(task.target_offset) },
            "initial_gripper_xpos": self.settled.grip,
        });
        let mut constants = self.sim.constants(&self.settled.initial, own);
        if let Some(height) = self.settled.height {
            constants.insert("height_offset".to_owned(), height.into());
        }
        constants
    }

    fn capture(&self) -> Start {
        self.sim.capture()
    }

    fn restore(&mut self, state: &Start) -> Result<(), PlaybackError> {
        self.sim.begin(state)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{Fetch, PICK_AND_PLACE, Parts, REACH, SLIDE, Settled, Task};
    use crate::draws::Draws;
    use crate::mujoco::{Physics, Sim, Snapshot};
    use crate::rng::{Purpose, stream};
    use crate::world::World;

    /// The end of an episode.
    fn played(mut fetch: Fetch) -> Snapshot {
        let mut rng = stream(0, Purpose::Environment);
        fetch.start(&mut Draws::from(&mut rng)).unwrap();
        (0..20).for_each(|_| fetch.advance(&[0.5, -0.2, -0.9, 0.7]).unwrap());
        fetch.sim.snapshot()
    }

    #[test]
    fn an_instance_that_was_spared_the_set_up_is_like_one_that_simulated_it() {
        for (id, task) in [("FetchReach", &REACH), ("FetchPickAndPlace", &PICK_AND_PLACE)] {
            let spared = |task: &'static Task| Fetch::new(id, task, Physics::Paper).unwrap();
            spared(task);
            let mut sim = Sim::new(id, task.file, Physics::Paper).unwrap();
            let parts = Parts::find(&sim, task).unwrap();
            let settled = Arc::new(Settled::simulate(&mut sim, task, &parts).unwrap());
            let simulated = Fetch::with(task, sim, parts, settled).unwrap();
            let spared = spared(task);
            assert!(!Arc::ptr_eq(&spared.settled, &simulated.settled));
            assert_eq!(spared.settled.initial, simulated.settled.initial);
            assert_eq!(played(spared), played(simulated), "{id}");
        }
    }

    #[test]
    fn other_physics_settle_elsewhere() {
        let [paper, native] = [Physics::Paper, Physics::NativeCcd]
            .map(|physics| Fetch::new("FetchSlide", &SLIDE, physics).unwrap().settled.height);
        // Of the puck's centre, in metres.
        assert!((paper.unwrap() - 0.41402).abs() < 1e-5, "{paper:?}");
        assert!((native.unwrap() - 0.41354).abs() < 1e-5, "{native:?}");
    }
}
