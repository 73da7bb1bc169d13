//! Positions and velocities of sites.

use mujoco_rs::wrappers::mj_model::MjModel;

use super::sim::Data;

/// A site of a model, with the degrees of freedom that move it.
#[derive(Clone, Debug)]
pub(crate) struct Site {
    id: usize,
    root: usize,
    dofs: Vec<usize>,
}

/// Velocity of a site in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Velocity {
    /// In m/s.
    pub(crate) linear: [f64; 3],
    /// In rad/s.
    pub(crate) angular: [f64; 3],
}

impl Site {
    pub(crate) fn new(model: &MjModel, id: usize) -> Self {
        let body = model.site_bodyid()[id] as usize;
        Self { id, root: model.body_rootid()[body] as usize, dofs: chain(model, body) }
    }

    /// Position in world coordinates, metres.
    pub(crate) fn position(&self, data: &Data) -> [f64; 3] {
        data.site_xpos()[self.id]
    }

    /// Rotation matrix, row after row.
    pub(crate) fn rotation(&self, data: &Data) -> [f64; 9] {
        data.site_xmat()[self.id]
    }

    /// The site's Jacobian times the current `qvel`, summed over the degrees of freedom that move it.
    ///
    /// What `mj_jacSite` gives, without its dense 6 × nv matrix: column j is the motion axis `cdof[j]`,
    /// carried from the root body's centre of mass to the site.
    pub(crate) fn velocity(&self, data: &Data) -> Velocity {
        let offset = sub(data.site_xpos()[self.id], data.subtree_com()[self.root]);
        let (axes, speeds) = (data.cdof(), data.qvel());
        let mut velocity = Velocity { linear: [0.0; 3], angular: [0.0; 3] };
        for &dof in &self.dofs {
            let [rx, ry, rz, tx, ty, tz] = axes[dof];
            let carried = cross([rx, ry, rz], offset);
            for (axis, (turn, shift)) in [(rx, tx), (ry, ty), (rz, tz)].into_iter().enumerate() {
                velocity.angular[axis] += speeds[dof] * turn;
                velocity.linear[axis] += speeds[dof] * (shift + carried[axis]);
            }
        }
        velocity
    }
}

/// Degrees of freedom between `body` and the world, in ascending order.
fn chain(model: &MjModel, mut body: usize) -> Vec<usize> {
    while body > 0 && model.body_dofnum()[body] == 0 {
        body = model.body_parentid()[body] as usize;
    }
    let last = model.body_dofadr()[body] + model.body_dofnum()[body] - 1;
    let parent = |&dof: &i32| Some(model.dof_parentid()[dof as usize]).filter(|&dof| dof >= 0);
    let mut dofs: Vec<usize> =
        std::iter::successors(Some(last).filter(|_| body > 0), parent).map(|dof| dof as usize).collect();
    dofs.reverse();
    dofs
}

/// a − b.
pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use crate::mujoco::{Physics, Sim};

    /// Jacobian times velocity, with MuJoCo's own dense Jacobian (`[3, nv]`, row after row).
    fn dense(jacobian: &[f64], speeds: &[f64]) -> [f64; 3] {
        let rows: Vec<f64> = jacobian
            .chunks(speeds.len())
            .map(|row| row.iter().zip(speeds).map(|(j, v)| j * v).sum())
            .collect();
        [rows[0], rows[1], rows[2]]
    }

    #[test]
    fn velocity_is_mujocos_jacobian_times_qvel() {
        let mut sim = Sim::new("FetchPush", "fetch/push.xml", Physics::Paper).unwrap();
        for (i, speed) in sim.data_mut().qvel_mut().iter_mut().enumerate() {
            *speed = 0.3 - 0.05 * i as f64;
        }
        sim.forward();
        // Bodies: fixed to the world, at the end of the arm, floating.
        for name in ["target0", "robot0:grip", "object0"] {
            let site = sim.site(name).unwrap();
            let (linear, angular) = sim.data().jac_site(true, true, site.id as i32);
            let ours = site.velocity(sim.data());
            for (ours, jacobian) in [(ours.linear, linear), (ours.angular, angular)] {
                let theirs = dense(&jacobian, sim.data().qvel());
                assert!(
                    ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 1e-14),
                    "{name}: {ours:?} {theirs:?}"
                );
            }
        }
        let moving = sim.site("robot0:grip").unwrap().velocity(sim.data()).linear;
        assert!(
            moving.iter().any(|v| v.abs() > 1e-3),
            "the arm must move for this to mean anything: {moving:?}"
        );
    }
}
