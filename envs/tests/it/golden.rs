//! Replays recordings of the original environments.
//!
//! `tests/golden` holds trimmed copies of full recordings. `GOALBENCH_TRACES=folder` replays another folder
//! instead.

use std::fs::File;
use std::path::{Path, PathBuf};

use envs::trace::verify_dir;
use envs::{Verification, environments};
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use serde_json::Value;

use crate::told;

fn kept() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

fn recordings() -> PathBuf {
    std::env::var_os("GOALBENCH_TRACES").map_or_else(kept, PathBuf::from)
}

#[test]
fn every_recording_is_reproduced() {
    for outcome in verify_dir(&recordings()).unwrap() {
        let report = outcome.unwrap_or_else(|error| panic!("{}", told(&error)));
        let failure = report.first_failure.as_ref().map(ToString::to_string);
        assert_eq!(failure, None, "{}", report.file.display());
    }
}

#[test]
fn every_environment_that_is_verified_by_a_recording_has_one() {
    for row in environments() {
        let recorded = row.verification != Verification::Analytic;
        assert_eq!(kept().join(format!("{}.json.gz", row.id())).exists(), recorded, "{}", row.id());
    }
}

/// Steps kept of a random trace.
const RANDOM_STEPS: usize = 20;
/// Steps kept of a scripted trace after its first success.
const STEPS_AFTER_SUCCESS: usize = 3;
/// Resets kept.
const RESETS: usize = 2;
/// What each step has an entry in.
const PER_STEP: [&str; 7] =
    ["actions", "observation", "achieved_goal", "reward", "is_success", "qpos", "qvel"];

/// Writes `tests/golden` anew from the full recordings in `GOALBENCH_TRACES`: one random and the scripted
/// trace of each, both shortened, and two resets. Mazes, which are small, stay whole.
#[test]
#[ignore = "rewrites tests/golden"]
fn trim_recordings() {
    let full = std::env::var_os("GOALBENCH_TRACES").expect("GOALBENCH_TRACES names the full recordings");
    for folder in ["", "native"] {
        let target = kept().join(folder);
        std::fs::create_dir_all(&target).unwrap();
        for entry in std::fs::read_dir(Path::new(&full).join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "gz") {
                let mut recording: Value =
                    serde_json::from_reader(GzDecoder::new(File::open(&path).unwrap())).unwrap();
                if !recording["meta"]["nq"].is_null() {
                    trim(&mut recording);
                }
                let file = File::create(target.join(path.file_name().unwrap())).unwrap();
                let mut packed = GzEncoder::new(file, Compression::best());
                serde_json::to_writer(&mut packed, &recording).unwrap();
                packed.finish().unwrap();
            }
        }
    }
}

fn trim(recording: &mut Value) {
    list(&mut recording["resets"]).truncate(RESETS);
    let traces = list(&mut recording["traces"]);
    let mut seen_random = false;
    traces.retain(|trace| trace["seed"] == "x" || !std::mem::replace(&mut seen_random, true));
    for trace in traces {
        let first_success = list(&mut trace["is_success"]).iter().position(|success| *success == 1.0);
        let steps = match first_success {
            Some(step) if trace["seed"] == "x" => step + 1 + STEPS_AFTER_SUCCESS,
            _ => RANDOM_STEPS,
        };
        for name in PER_STEP {
            list(&mut trace[name]).truncate(steps);
        }
    }
}

fn list(value: &mut Value) -> &mut Vec<Value> {
    value.as_array_mut().expect("a list")
}
