//! The parts of playing traces back that all simulations share.

use serde_json::{Map, Value, json};

use super::assets::DISABLE_NATIVE_CCD;
use super::library::VERSION;
use super::sim::{SUBSTEPS, Sim, Snapshot};
use crate::playback::{PlaybackError, SimulationStart, Start};

impl Sim {
    /// The constants that every recording of a simulation holds, with the environment's `own` added.
    pub(crate) fn constants(&self, initial: &Snapshot, own: Value) -> Map<String, Value> {
        let model = self.model();
        let flags = model.opt().disableflags;
        let shared = json!({
            "mujoco": VERSION,
            "nativeccd_disabled": flags & DISABLE_NATIVE_CCD != 0,
            "disableflags": flags,
            "n_substeps": SUBSTEPS,
            "timestep": model.opt().timestep,
            "nq": model.nq(),
            "nv": model.nv(),
            "nu": model.nu(),
            "nmocap": model.nmocap(),
            "initial_time": initial.time,
            "initial_qpos": initial.qpos,
            "initial_qvel": initial.qvel,
            "eq_data": model.eq_data().concat(),
        });
        let objects = [shared, own].into_iter().filter_map(|value| match value {
            Value::Object(object) => Some(object),
            _ => None,
        });
        objects.flatten().collect()
    }

    /// Puts the simulation into a recorded state: `mj_resetData`, the state, `mj_forward`.
    pub(crate) fn begin(&mut self, start: &Start) -> Result<(), PlaybackError> {
        let start = match start {
            Start::Simulation(start) => start,
            Start::Position(_) => {
                let expected = self.data().qpos().len();
                return Err(PlaybackError::Start { field: "qpos", expected, got: 0 });
            }
        };
        self.check_lengths(start)?;
        let data = self.data_mut();
        data.reset();
        data.set_time(start.time);
        data.qpos_mut().copy_from_slice(&start.qpos);
        data.qvel_mut().copy_from_slice(&start.qvel);
        data.ctrl_mut().copy_from_slice(&start.ctrl);
        data.mocap_pos_mut().copy_from_slice(&start.mocap_pos);
        data.mocap_quat_mut().copy_from_slice(&start.mocap_quat);
        self.forward();
        Ok(self.check()?)
    }

    /// The state now.
    pub(crate) fn capture(&self) -> Start {
        let data = self.data();
        Start::Simulation(SimulationStart {
            time: data.time(),
            qpos: data.qpos().to_vec(),
            qvel: data.qvel().to_vec(),
            ctrl: data.ctrl().to_vec(),
            mocap_pos: data.mocap_pos().to_vec(),
            mocap_quat: data.mocap_quat().to_vec(),
        })
    }

    fn check_lengths(&self, start: &SimulationStart) -> Result<(), PlaybackError> {
        let data = self.data();
        let lengths = [
            ("qpos", data.qpos().len(), start.qpos.len()),
            ("qvel", data.qvel().len(), start.qvel.len()),
            ("ctrl", data.ctrl().len(), start.ctrl.len()),
            ("mocap_pos", data.mocap_pos().len(), start.mocap_pos.len()),
            ("mocap_quat", data.mocap_quat().len(), start.mocap_quat.len()),
        ];
        match lengths.into_iter().find(|(_, expected, got)| expected != got) {
            None => Ok(()),
            Some((field, expected, got)) => Err(PlaybackError::Start { field, expected, got }),
        }
    }
}
