//! The file format: gzipped JSON, read strictly.

use std::io::BufReader;
use std::path::Path;

use flate2::read::MultiGzDecoder;
use serde::Deserialize;
use serde_json::{Map, Value};

use super::Problem;
use crate::draws::Draw;
use crate::mujoco::Physics;
use crate::playback::{SimulationStart, Start};

/// A trace file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Recording {
    pub(super) meta: Meta,
    pub(super) resets: Vec<Reset>,
    pub(super) traces: Vec<Trace>,
}

/// Id, and the constants that the environment is compared with.
#[derive(Debug, Deserialize)]
pub(super) struct Meta {
    pub(super) id: String,
    #[serde(flatten)]
    pub(super) constants: Map<String, Value>,
}

/// The draws of one reset and what they led to.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Reset {
    pub(super) draws: Vec<Draw>,
    pub(super) qpos: Option<Vec<f64>>,
    pub(super) qvel: Option<Vec<f64>>,
    pub(super) goal: Vec<f64>,
    pub(super) observation: Vec<f64>,
    pub(super) achieved_goal: Vec<f64>,
}

/// A start, a goal, actions, and what they led to; every list but the first five fields has one entry per
/// step.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Trace {
    pub(super) seed: String,
    #[serde(deserialize_with = "start")]
    pub(super) start: Start,
    pub(super) goal: Vec<f64>,
    pub(super) obs0: Vec<f64>,
    pub(super) ag0: Vec<f64>,
    pub(super) actions: Vec<Vec<f64>>,
    pub(super) observation: Vec<Vec<f64>>,
    pub(super) achieved_goal: Vec<Vec<f64>>,
    pub(super) reward: Vec<f64>,
    pub(super) is_success: Vec<f64>,
    pub(super) qpos: Option<Vec<Vec<f64>>>,
    pub(super) qvel: Option<Vec<Vec<f64>>>,
}

/// `start` as it stands in the file: a position, or the state of a simulation.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawStart {
    position: Option<Vec<f64>>,
    time: Option<f64>,
    qpos: Option<Vec<f64>>,
    qvel: Option<Vec<f64>>,
    ctrl: Option<Vec<f64>>,
    mocap_pos: Option<Vec<[f64; 3]>>,
    mocap_quat: Option<Vec<[f64; 4]>>,
}

fn start<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Start, D::Error> {
    let raw = RawStart::deserialize(deserializer)?;
    if let Some(position) = raw.position {
        return Ok(Start::Position(position));
    }
    let missing = <D::Error as serde::de::Error>::missing_field;
    Ok(Start::Simulation(SimulationStart {
        time: raw.time.ok_or_else(|| missing("time"))?,
        qpos: raw.qpos.ok_or_else(|| missing("qpos"))?,
        qvel: raw.qvel.ok_or_else(|| missing("qvel"))?,
        ctrl: raw.ctrl.ok_or_else(|| missing("ctrl"))?,
        mocap_pos: raw.mocap_pos.ok_or_else(|| missing("mocap_pos"))?,
        mocap_quat: raw.mocap_quat.ok_or_else(|| missing("mocap_quat"))?,
    }))
}

impl Meta {
    /// The physics it was recorded with; none for mazes, which have no simulation.
    pub(super) fn physics(&self) -> Option<Physics> {
        match self.constants.get("nativeccd_disabled")?.as_bool()? {
            true => Some(Physics::Paper),
            false => Some(Physics::NativeCcd),
        }
    }

    /// The registry id: the reference's without its version.
    pub(super) fn environment(&self) -> &str {
        match self.id.rsplit_once("-v") {
            Some((name, version)) if version.bytes().all(|b| b.is_ascii_digit()) => name,
            _ => &self.id,
        }
    }
}

/// The most bytes that a trace file may unpack to: a small file of zeros can hold any number of them.
const MOST_UNPACKED: u64 = 256 << 20;

/// Reads and parses a trace file.
pub(super) fn read(path: &Path) -> Result<Recording, Box<Problem>> {
    let file = guard::files::open(path).map_err(Problem::Read)?;
    let unpacked = MultiGzDecoder::new(BufReader::new(file));
    let text = guard::files::text_within(unpacked, MOST_UNPACKED).map_err(Problem::Read)?;
    let json = &mut serde_json::Deserializer::from_str(&text);
    serde_path_to_error::deserialize(json).map_err(|error| {
        Box::new(Problem::Parse { field: error.path().to_string(), source: error.into_inner() })
    })
}
