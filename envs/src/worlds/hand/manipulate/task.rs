//! The seven manipulation tasks.

use std::f64::consts::PI;

use crate::draws::Draws;
use crate::env::Reward;
use crate::metric::distance;
use crate::rotation::{Quat, angle_between, euler_to_quat, from_angle_and_axis, product, quat_to_euler};

/// Angle within which a rotation counts as reached, radians.
pub(super) const ROTATION_THRESHOLD: f64 = 0.1;

/// What sets one manipulation task apart.
#[derive(Debug)]
pub(crate) struct Task {
    /// Model file.
    pub(super) file: &'static str,
    /// Whether goals ask for a position.
    pub(super) position: TargetPosition,
    /// How goals and, if `turned_at_start`, starts are rotated.
    pub(super) rotation: TargetRotation,
    /// Whether the object's start rotation is drawn.
    pub(super) turned_at_start: bool,
    /// Whether any rotation about z will do.
    pub(super) any_turn_about_z: bool,
    /// Distance within which a position counts as reached, metres.
    pub(super) distance_threshold: f64,
}

/// What goals say about the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum TargetPosition {
    /// Nothing: any position will do.
    Ignore,
    /// A place near where the object settled.
    Random,
}

/// The distribution of rotations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum TargetRotation {
    /// Uniform about the vertical axis.
    Z,
    /// That, times one of the 24 rotations of a cube.
    Parallel,
    /// A uniform angle about an axis drawn on a cube (not uniform over rotations).
    Xyz,
}

impl TargetRotation {
    /// Draws a rotation.
    pub(super) fn draw(self, parallel: &[Quat], draws: &mut Draws<'_>) -> Quat {
        let [angle] = draws.uniform([-PI], [PI]);
        let upright = from_angle_and_axis(angle, [0.0, 0.0, 1.0]);
        match self {
            Self::Z => upright,
            Self::Parallel => product(upright, parallel[draws.index(parallel.len())]),
            Self::Xyz => from_angle_and_axis(angle, draws.uniform([-1.0; 3], [1.0; 3])),
        }
    }
}

impl Reward for Task {
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        let (position, quat) = split(achieved);
        let (goal_position, goal_quat) = split(goal);
        let near = self.position == TargetPosition::Ignore
            || distance(position, goal_position) < self.distance_threshold;
        near && rotation_distance(quat, goal_quat, self.any_turn_about_z) < ROTATION_THRESHOLD
    }
}

/// Position and quaternion of a pose.
///
/// # Panics
/// If `pose` does not hold 7 numbers.
fn split(pose: &[f64]) -> (&[f64], Quat) {
    assert_eq!(pose.len(), 7, "a pose has 7 numbers");
    (&pose[..3], [pose[3], pose[4], pose[5], pose[6]])
}

/// Angle between two rotations, radians. With `any_turn_about_z` the achieved rotation first gets the goal's
/// last Euler angle. This holds for hindsight goals too: the reference's batched reward overwrites another
/// number there.
fn rotation_distance(achieved: Quat, goal: Quat, any_turn_about_z: bool) -> f64 {
    if !any_turn_about_z {
        return angle_between(achieved, goal);
    }
    let [x, y, _] = quat_to_euler(achieved);
    let [_, _, z] = quat_to_euler(goal);
    angle_between(euler_to_quat([x, y, z]), goal)
}

/// The block: position and any rotation.
pub(crate) const BLOCK: Task = Task {
    file: "hand/manipulate_block.xml",
    position: TargetPosition::Random,
    rotation: TargetRotation::Xyz,
    turned_at_start: true,
    any_turn_about_z: false,
    distance_threshold: 0.01,
};

/// The block: turn about the vertical axis, anywhere.
pub(crate) const BLOCK_ROTATE_Z: Task =
    Task { position: TargetPosition::Ignore, rotation: TargetRotation::Z, ..BLOCK };

/// The block: turn about the vertical axis with any face up, anywhere.
pub(crate) const BLOCK_ROTATE_PARALLEL: Task =
    Task { position: TargetPosition::Ignore, rotation: TargetRotation::Parallel, ..BLOCK };

/// The egg: position and any rotation.
pub(crate) const EGG: Task = Task { file: "hand/manipulate_egg.xml", ..BLOCK };

/// The egg: any rotation, anywhere.
pub(crate) const EGG_ROTATE: Task = Task { position: TargetPosition::Ignore, ..EGG };

/// The pen: position and direction. A turn about its own axis is not visible, so it does not count.
pub(crate) const PEN: Task = Task {
    file: "hand/manipulate_pen.xml",
    turned_at_start: false,
    any_turn_about_z: true,
    distance_threshold: 0.05,
    ..BLOCK
};

/// The pen: direction, anywhere.
pub(crate) const PEN_ROTATE: Task = Task { position: TargetPosition::Ignore, ..PEN };

#[cfg(test)]
mod tests {
    use super::rotation_distance;
    use crate::rotation::euler_to_quat;

    #[test]
    fn a_pen_turned_about_z_is_where_it_should_be() {
        let (achieved, goal) = (euler_to_quat([0.4, 0.2, -1.0]), euler_to_quat([0.4, 0.25, 2.0]));
        assert!((rotation_distance(achieved, goal, true) - 0.05).abs() < 1e-7);
        assert!(rotation_distance(achieved, goal, false) > 2.5);
    }
}
