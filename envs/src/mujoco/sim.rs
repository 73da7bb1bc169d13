//! A simulation: one model, one state, stepped in units of an environment step.

use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::{MjData, MjtWarning};
use mujoco_rs::wrappers::mj_model::{MjModel, MjtObj};

use super::Site;
use super::assets::{self, Physics};
use crate::error::EnvError;

/// `mj_step` calls per environment step.
pub(crate) const SUBSTEPS: usize = 20;

/// Data of a shared model.
pub(crate) type Data = MjData<Arc<MjModel>>;

/// Warnings after which a state means nothing. MuJoCo resets itself after most of them, so that only its
/// warning counters show that something happened.
const FATAL: [(MjtWarning, &str); 7] = [
    (MjtWarning::mjWARN_INERTIA, "the inertia matrix is nearly singular"),
    (MjtWarning::mjWARN_CONTACTFULL, "there are more contacts than memory for them"),
    (MjtWarning::mjWARN_CNSTRFULL, "there are more constraints than memory for them"),
    (MjtWarning::mjWARN_BADQPOS, "a position is NaN, infinite or huge"),
    (MjtWarning::mjWARN_BADQVEL, "a velocity is NaN, infinite or huge"),
    (MjtWarning::mjWARN_BADQACC, "an acceleration is NaN, infinite or huge"),
    (MjtWarning::mjWARN_BADCTRL, "a control is NaN or infinite"),
];

/// Time, positions and velocities to go back to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    /// Seconds.
    pub(crate) time: f64,
    /// Generalised positions, shape `[nq]`.
    pub(crate) qpos: Vec<f64>,
    /// Generalised velocities, shape `[nv]`.
    pub(crate) qvel: Vec<f64>,
}

/// A MuJoCo simulation that knows which environment it belongs to and notices when it breaks down.
pub(crate) struct Sim {
    env: &'static str,
    file: &'static str,
    model: Arc<MjModel>,
    data: Data,
}

impl Sim {
    /// A fresh simulation of the model in `file` for the environment with id `env`.
    pub(crate) fn new(env: &'static str, file: &'static str, physics: Physics) -> Result<Self, EnvError> {
        let model = assets::model(file, physics)?;
        Ok(Self { env, file, data: Data::new(Arc::clone(&model)), model })
    }

    pub(crate) fn model(&self) -> &MjModel {
        &self.model
    }

    /// The model, which all simulations of the same file and physics share.
    pub(crate) fn shared_model(&self) -> Arc<MjModel> {
        Arc::clone(&self.model)
    }

    pub(crate) fn data(&self) -> &Data {
        &self.data
    }

    pub(crate) fn data_mut(&mut self) -> &mut Data {
        &mut self.data
    }

    /// Seconds of simulated time per environment step.
    pub(crate) fn dt(&self) -> f64 {
        SUBSTEPS as f64 * self.model().opt().timestep
    }

    /// Time, positions and velocities now.
    pub(crate) fn snapshot(&self) -> Snapshot {
        Snapshot { time: self.data.time(), qpos: self.data.qpos().to_vec(), qvel: self.data.qvel().to_vec() }
    }

    /// Goes back to `snapshot`; derived quantities and the solver's warm start stay as they are.
    pub(crate) fn restore(&mut self, snapshot: &Snapshot) {
        self.data.set_time(snapshot.time);
        self.data.qpos_mut().copy_from_slice(&snapshot.qpos);
        self.data.qvel_mut().copy_from_slice(&snapshot.qvel);
    }

    /// One environment step: [`SUBSTEPS`] times `mj_step`.
    ///
    /// # Errors
    /// [`EnvError::Unstable`].
    pub(crate) fn advance(&mut self) -> Result<(), EnvError> {
        for _ in 0..SUBSTEPS {
            self.data.step();
        }
        self.check()
    }

    /// `mj_forward`: everything that follows from positions and velocities.
    pub(crate) fn forward(&mut self) {
        self.data.forward();
    }

    /// Looks for signs that the simulation broke down since the last `mj_resetData`.
    ///
    /// # Errors
    /// [`EnvError::Unstable`] with the reason.
    pub(crate) fn check(&self) -> Result<(), EnvError> {
        let unstable = |reason: String| Err(EnvError::Unstable { env: self.env, reason });
        let counters = self.data.warning();
        if let Some((_, reason)) = FATAL.iter().find(|(kind, _)| counters[*kind as usize].number > 0) {
            return unstable((*reason).to_owned());
        }
        let state = [("qpos", self.data.qpos()), ("qvel", self.data.qvel())];
        for (name, values) in state {
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return unstable(format!("{name}[{index}] is {}", values[index]));
            }
        }
        Ok(())
    }

    /// Id of the object called `name`.
    ///
    /// # Errors
    /// [`EnvError::Asset`] if the model has none.
    pub(crate) fn id(&self, kind: MjtObj, name: &str) -> Result<usize, EnvError> {
        usize::try_from(self.model().name_to_id(kind, name)).map_err(|_| EnvError::Asset {
            path: assets::folder().join(self.file),
            reason: format!("the model has no {kind:?} `{name}`"),
            source: None,
        })
    }

    /// The site called `name`.
    pub(crate) fn site(&self, name: &str) -> Result<Site, EnvError> {
        Ok(Site::new(self.model(), self.id(MjtObj::mjOBJ_SITE, name)?))
    }

    /// Where the joint called `name` keeps its data.
    pub(crate) fn joint(&self, name: &str) -> Result<Joint, EnvError> {
        Ok(Joint::new(self.model(), self.id(MjtObj::mjOBJ_JOINT, name)?))
    }

    /// The joints whose name starts with `prefix`, in model order.
    pub(crate) fn joints(&self, prefix: &str) -> Vec<Joint> {
        let model = self.model();
        let named =
            |id: &i32| model.id_to_name(MjtObj::mjOBJ_JOINT, *id).is_some_and(|n| n.starts_with(prefix));
        (0..model.njnt()).filter(named).map(|id| Joint::new(model, id as usize)).collect()
    }
}

/// First indices of a joint's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Joint {
    /// In `qpos`.
    pub(crate) qpos: usize,
    /// In `qvel`.
    pub(crate) qvel: usize,
}

impl Joint {
    fn new(model: &MjModel, id: usize) -> Self {
        Self { qpos: model.jnt_qposadr()[id] as usize, qvel: model.jnt_dofadr()[id] as usize }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::Sim;
    use crate::error::EnvError;
    use crate::mujoco::Physics;

    fn reach() -> Sim {
        Sim::new("FetchReach", "fetch/reach.xml", Physics::Paper).unwrap()
    }

    #[test]
    fn a_simulation_that_blows_up_is_an_error_until_it_is_reset() {
        for break_it in [
            |sim: &mut Sim| sim.data_mut().qvel_mut()[3] = 1e12,
            |sim: &mut Sim| sim.data_mut().qpos_mut()[3] = f64::NAN,
            |sim: &mut Sim| sim.data_mut().qfrc_applied_mut()[12] = 1e300,
        ] {
            let mut sim = reach();
            break_it(&mut sim);
            // MuJoCo resets itself: without the counters the second step would look healthy.
            for _ in 0..2 {
                let error = sim.advance().unwrap_err();
                assert!(matches!(error, EnvError::Unstable { env: "FetchReach", .. }), "{error}");
            }
            sim.data_mut().reset();
            sim.advance().unwrap();
        }
        assert!(!Path::new("MUJOCO_LOG.TXT").exists(), "MuJoCo wrote its log into the current folder");
    }

    #[test]
    fn a_name_that_the_model_lacks_is_an_asset_error() {
        let error = reach().site("robot0:nose").unwrap_err().to_string();
        assert!(error.contains("fetch/reach.xml") && error.contains("`robot0:nose`"), "{error}");
    }

    #[test]
    fn a_snapshot_brings_back_time_positions_and_velocities() {
        let mut sim = reach();
        sim.advance().unwrap();
        let snapshot = sim.snapshot();
        assert!((snapshot.time - 0.04).abs() < 1e-12);
        sim.advance().unwrap();
        assert_ne!(sim.snapshot(), snapshot);
        sim.restore(&snapshot);
        assert_eq!(sim.snapshot(), snapshot);
    }
}
