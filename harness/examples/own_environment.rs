//! A program of your own: all of goalbench, with one more environment.
//!
//! `ArmReach` is a planar arm of two links whose hand shall come to a place. It is a *world* of some sixty
//! lines: where episodes start, what they ask for, how a step moves the arm, what there is to see. The rest
//! is the same for all.
//!
//! ```sh
//! cargo run --release -p goalbench --example own_environment -- list environments
//! cargo run --release -p goalbench --example own_environment -- render --env ArmReach --out arm.gif
//! cargo run --release -p goalbench --example own_environment -- run --env easy --curriculum teach,her-iid
//! ```

use std::f64::consts::PI;

use envs::render::{PlaneScene, Scene};
use envs::{Defaults, Draws, Env, EnvError, Environment, Observation, Reward, Spec, WithinDistance, World};
use goalbench::Registry;

fn main() {
    let registry = Registry::builtin().of_program(goalbench::program!()).with_environment(ARM);
    goalbench::cli::main(registry.with_suite("easy", &["ArmReach", "Point"]))
}

/// The row of the list of environments.
pub(crate) const ARM: Environment = Environment::new(
    Spec {
        id: "ArmReach",
        family: "arm",
        state: 6,
        goal: 2,
        action: 2,
        horizon: 25,
        defaults: Defaults { steps: 20_000, evaluate_every: 1_000, layers: 2 },
    },
    "Bring the hand of a planar arm to a place",
    "A two-link arm, as an example",
    |spec, _| Ok(Box::new(Env::new(spec, Arm::default()))),
);

/// Length of a link; the base is the middle of the square [-1, 1]².
const LINK: f64 = 0.45;
/// Turn of a joint in a step by an action component of 1, radians.
const SPEED: f64 = 0.2;
/// Distance of the hand within which a goal counts as reached.
const THRESHOLD: f64 = 0.1;

/// Two joints that turn as they are told, without weight.
#[derive(Default)]
struct Arm {
    /// Angle of the upper link, and of the lower one to it, radians.
    joints: [f64; 2],
}

/// Elbow and hand of an arm with these joint angles.
fn elbow_and_hand([upper, lower]: [f64; 2]) -> [[f64; 2]; 2] {
    let elbow = [LINK * upper.cos(), LINK * upper.sin()];
    let hand = [elbow[0] + LINK * (upper + lower).cos(), elbow[1] + LINK * (upper + lower).sin()];
    [elbow, hand]
}

impl World for Arm {
    /// Any pose of a half stretched arm.
    fn start(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError> {
        self.joints = draws.uniform([-PI, 0.5], [PI, 1.5]);
        Ok(())
    }

    /// Where the hand of another pose would be: every goal can be reached.
    fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]) {
        let [_, hand] = elbow_and_hand(draws.uniform([-PI; 2], [PI; 2]));
        goal.copy_from_slice(&hand);
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError> {
        for (joint, turn) in self.joints.iter_mut().zip(action) {
            *joint += SPEED * turn;
        }
        Ok(())
    }

    /// Cosine and sine of both angles, then the hand, which is what is achieved.
    fn observe(&self, observation: &mut Observation) {
        let ([upper, lower], [_, hand]) = (self.joints, elbow_and_hand(self.joints));
        let state = [upper.cos(), upper.sin(), lower.cos(), lower.sin(), hand[0], hand[1]];
        observation.state.copy_from_slice(&state);
        observation.achieved.copy_from_slice(&hand);
    }

    fn task(&self) -> &dyn Reward {
        &WithinDistance(THRESHOLD)
    }

    /// The two links from above, and the goal as wide as its threshold.
    fn scene(&self, goal: &[f64]) -> Option<Scene<'_>> {
        let [elbow, hand] = elbow_and_hand(self.joints);
        let point = PlaneScene::point(hand, [goal[0], goal[1]], THRESHOLD);
        Some(Scene::Plane(PlaneScene { body: vec![[0.0; 2], elbow, hand], ..point }))
    }
}
