//! HandManipulate…: turn a block, an egg or a pen that lies on the palm, and for some tasks move it.

mod task;

use serde_json::{Map, Value, json};

use super::Hand;
use crate::draws::Draws;
use crate::env::{Observation, Reward};
use crate::error::EnvError;
use crate::mujoco::sim::Joint;
use crate::mujoco::{Physics, Site, Snapshot};
use crate::playback::{PlaybackError, RecordedWorld, Start};
use crate::rotation::{Quat, normalized, parallel_rotations, product};
use crate::scene::{GoalShape, Scene};
use crate::world::World;
use crate::writer::Writer;

pub(super) use task::{BLOCK, BLOCK_ROTATE_PARALLEL, BLOCK_ROTATE_Z, EGG, EGG_ROTATE, PEN, PEN_ROTATE, Task};
use task::{ROTATION_THRESHOLD, TargetPosition};

/// Standard deviation of the object's start position, metres.
const SPREAD: f64 = 0.005;
/// Environment steps in which the object settles in the hand.
const SETTLING: usize = 10;
/// An object whose centre lies no higher than this has fallen off the palm, metres.
const FLOOR: f64 = 0.04;
/// Starts that may be drawn until the object stays on the palm: it hardly ever falls. The reference tries
/// without limit.
const ATTEMPTS: usize = 100;
/// Goals with a position lie this far from where the object settled, metres.
const TARGET_RANGE: [(f64, f64); 3] = [(-0.04, 0.04), (-0.06, 0.02), (0.0, 0.06)];

/// Where the position is no part of the goal, pictures show the goal's rotation this far beside the hand,
/// metres.
const GHOST_ASIDE: f64 = 0.15;

/// An object's pose: position 3 (metres), quaternion 4.
type Pose = [f64; 7];

/// The world of a HandManipulate environment. Positions are metres, angles radians, velocities per second.
pub(super) struct Manipulate {
    id: &'static str,
    task: &'static Task,
    hand: Hand,
    /// The object's free joint.
    object: Joint,
    /// The free joint of its ghost, which nothing touches and pictures show at the goal.
    ghost: Joint,
    /// Its centre.
    centre: Site,
    initial: Snapshot,
    parallel: Vec<Quat>,
    /// Where the object lay when the episode started: goals depend on it.
    settled: [f64; 3],
}

impl Manipulate {
    pub(super) fn new(id: &'static str, task: &'static Task, physics: Physics) -> Result<Self, EnvError> {
        let mut hand = Hand::new(id, task.file, physics)?;
        let object = hand.sim.joint("object:joint")?;
        let ghost = hand.sim.joint("target:joint")?;
        let centre = hand.sim.site("object:center")?;
        hand.sim.forward();
        hand.sim.check()?;
        let initial = hand.sim.snapshot();
        let parallel = parallel_rotations();
        let mut world = Self { id, task, hand, object, ghost, centre, initial, parallel, settled: [0.0; 3] };
        world.remember_start();
        Ok(world)
    }

    fn pose(&self) -> Pose {
        let first = self.object.qpos;
        std::array::from_fn(|i| self.hand.sim.data().qpos()[first + i])
    }

    /// Back to the initial state. The reference does this without `mj_resetData`, so that controls and the
    /// solver's warm start stay from the episode before. Here nothing stays. The outcome is the same: MuJoCo
    /// starts its solver from the better of warm start and unconstrained acceleration, and a warm start left
    /// over from another state is never the better one (in 750 resets of the reference with and without it,
    /// no bit differed).
    fn back_to_start(&mut self) {
        let sim = &mut self.hand.sim;
        sim.data_mut().reset();
        sim.restore(&self.initial);
        sim.forward();
    }

    fn draw_start(&self, draws: &mut Draws<'_>) -> Pose {
        let [x, y, z, quat @ ..] = self.pose();
        let quat = if self.task.turned_at_start {
            product(quat, self.task.rotation.draw(&self.parallel, draws))
        } else {
            quat
        };
        let [dx, dy, dz] = draws.normal(SPREAD);
        joined([x + dx, y + dy, z + dz], normalized(quat))
    }

    /// Places the object and holds the hand in the middle of its ranges. Returns whether the object stays on
    /// the palm.
    fn settle(&mut self, pose: &Pose) -> Result<bool, EnvError> {
        let first = self.object.qpos;
        self.hand.sim.data_mut().qpos_mut()[first..first + 7].copy_from_slice(pose);
        for _ in 0..SETTLING {
            self.hand.act(&[0.0; 20]);
            self.hand.sim.advance()?;
        }
        self.hand.sim.forward();
        Ok(self.centre.position(self.hand.sim.data())[2] > FLOOR)
    }

    fn remember_start(&mut self) {
        let [x, y, z, ..] = self.pose();
        self.settled = [x, y, z];
    }
}

fn joined([x, y, z]: [f64; 3], [w, i, j, k]: Quat) -> Pose {
    [x, y, z, w, i, j, k]
}

impl World for Manipulate {
    /// A start where the object stays on the palm.
    fn start(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError> {
        for _ in 0..ATTEMPTS {
            self.back_to_start();
            let pose = self.draw_start(draws);
            if self.settle(&pose)? {
                self.remember_start();
                return Ok(());
            }
        }
        let reason = format!("the object fell off the palm in {ATTEMPTS} starts in a row");
        Err(EnvError::Unstable { env: self.id, reason })
    }

    fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]) {
        let mut position = self.settled;
        if self.task.position == TargetPosition::Random {
            let shift = draws.uniform(TARGET_RANGE.map(|(low, _)| low), TARGET_RANGE.map(|(_, high)| high));
            position = std::array::from_fn(|i| position[i] + shift[i]);
        }
        let quat = normalized(self.task.rotation.draw(&self.parallel, draws));
        goal.copy_from_slice(&joined(position, quat));
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.hand.act(action);
        self.hand.sim.advance()
    }

    /// Joint positions 24, joint velocities 24, object velocity 6, object pose 7.
    fn observe(&self, observation: &mut Observation) {
        let pose = self.pose();
        let mut state = Writer::new(&mut observation.state);
        self.hand.write_joints(&mut state);
        state.put(&self.hand.sim.data().qvel()[self.object.qvel..self.object.qvel + 6]);
        state.put(&pose);
        observation.achieved.copy_from_slice(&pose);
    }

    fn task(&self) -> &dyn Reward {
        self.task
    }

    fn scene(&self, goal: &[f64]) -> Option<Scene<'_>> {
        let mut pose: Pose = std::array::from_fn(|i| goal[i]);
        if self.task.position == TargetPosition::Ignore {
            pose[0] += GHOST_ASIDE;
        }
        Some(self.hand.scene(&[], GoalShape::Ghost { qpos: self.ghost.qpos, pose }))
    }

    fn recorded(&mut self) -> Option<&mut dyn RecordedWorld> {
        Some(self)
    }
}

impl RecordedWorld for Manipulate {
    fn constants(&self) -> Map<String, Value> {
        let own = json!({
            "reward_type": "sparse",
            "distance_threshold": self.task.distance_threshold,
            "rotation_threshold": ROTATION_THRESHOLD,
            "relative_control": false,
            "target_position": self.task.position,
            "target_rotation": self.task.rotation,
            "randomize_initial_position": true,
            "randomize_initial_rotation": self.task.turned_at_start,
            "ignore_z_target_rotation": self.task.any_turn_about_z,
            "target_position_range": TARGET_RANGE,
            "parallel_quats": self.parallel,
        });
        self.hand.sim.constants(&self.initial, own)
    }

    fn capture(&self) -> Start {
        self.hand.sim.capture()
    }

    fn restore(&mut self, state: &Start) -> Result<(), PlaybackError> {
        self.hand.sim.begin(state)?;
        self.remember_start();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Manipulate, Task};
    use crate::draws::Draws;
    use crate::mujoco::{Physics, Snapshot};
    use crate::rng::{Purpose, stream};
    use crate::world::World;

    /// Where the object comes to rest after an episode's worth of movement, if the state is restored
    /// `cleanly` (`mj_resetData` first) or as the reference does.
    fn settled(id: &'static str, task: &'static Task, cleanly: bool) -> Snapshot {
        let mut world = Manipulate::new(id, task, Physics::Paper).unwrap();
        let pose = world.draw_start(&mut Draws::from(&mut stream(3, Purpose::Environment)));
        for step in 0..10 {
            world.advance(&[(f64::from(step) * 0.7).sin(); 20]).unwrap();
        }
        if cleanly {
            world.back_to_start();
        } else {
            world.hand.sim.restore(&world.initial);
            world.hand.sim.forward();
        }
        assert!(world.settle(&pose).unwrap());
        world.hand.sim.snapshot()
    }

    #[test]
    fn a_clean_reset_leads_where_the_references_leads() {
        let tasks: [(&str, &Task); 3] = [
            ("HandManipulateBlock", &super::BLOCK),
            ("HandManipulateEgg", &super::EGG),
            ("HandManipulatePen", &super::PEN),
        ];
        for (id, task) in tasks {
            assert_eq!(settled(id, task, true), settled(id, task, false), "{id}");
        }
    }
}
