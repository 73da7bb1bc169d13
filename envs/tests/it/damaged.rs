//! Recordings that are wrong somewhere: each must be noticed, with the place.

use std::fs::File;
use std::path::{Path, PathBuf};

use envs::trace::{FileReport, Problem, TraceError, verify_dir, verify_file};
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

use crate::told;

fn golden(id: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{id}.json.gz"))
}

fn load(id: &str) -> Value {
    serde_json::from_reader(GzDecoder::new(File::open(golden(id)).unwrap())).unwrap()
}

/// Verifies `recording` as if it came from a file.
fn verify(recording: &Value) -> Result<FileReport, TraceError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("altered.json.gz");
    let mut packed = GzEncoder::new(File::create(&path).unwrap(), Compression::fast());
    serde_json::to_writer(&mut packed, recording).unwrap();
    packed.finish().unwrap();
    verify_file(&path)
}

/// Adds `shift` to the number at `pointer`.
fn nudge(recording: &mut Value, pointer: &str, shift: f64) {
    let number = recording.pointer_mut(pointer).unwrap_or_else(|| panic!("no {pointer}"));
    *number = json!(number.as_f64().unwrap() + shift);
}

/// Where the altered recording first differs, in words.
fn first_failure(recording: &Value) -> String {
    let report = verify(recording).unwrap_or_else(|error| panic!("{}", told(&error)));
    assert!(!report.passed());
    report.first_failure.unwrap().to_string()
}

fn error(recording: &Value) -> String {
    told(&verify(recording).expect_err("a damaged recording passed"))
}

#[test]
fn a_millionth_in_one_number_is_noticed_and_located() {
    let altered = [
        ("/traces/0/obs0/9", "trace 0 (seed 0), start: observation[9]"),
        ("/traces/0/ag0/2", "trace 0 (seed 0), start: achieved_goal[2]"),
        ("/traces/0/observation/6/4", "trace 0 (seed 0), step 7: observation[4]"),
        ("/traces/1/achieved_goal/0/0", "trace 1 (seed x), step 1: achieved_goal[0]"),
        ("/traces/0/qpos/19/21", "trace 0 (seed 0), step 20: qpos[21]"),
        ("/traces/0/qvel/2/0", "trace 0 (seed 0), step 3: qvel[0]"),
        ("/traces/0/reward/4", "trace 0 (seed 0), step 5: reward"),
        ("/traces/1/is_success/1", "trace 1 (seed x), step 2: is_success"),
        ("/resets/1/goal/1", "reset 1: goal[1]"),
        ("/resets/0/observation/24", "reset 0: observation[24]"),
        ("/resets/0/achieved_goal/0", "reset 0: achieved_goal[0]"),
        ("/resets/1/qpos/0", "reset 1: qpos[0]"),
        ("/resets/0/qvel/20", "reset 0: qvel[20]"),
        ("/meta/initial_qpos/5", "meta: initial_qpos[5]"),
        ("/meta/distance_threshold", "meta: distance_threshold"),
        ("/meta/timestep", "meta: timestep"),
        ("/meta/eq_data/6", "meta: eq_data[6]"),
        ("/meta/height_offset", "meta: height_offset"),
    ];
    let original = load("FetchPickAndPlace");
    for (pointer, place) in altered {
        let mut recording = original.clone();
        nudge(&mut recording, pointer, 1e-6);
        let failure = first_failure(&recording);
        assert!(failure.starts_with(place), "{pointer}: {failure}");
    }
}

#[test]
fn every_number_of_meta_counts() {
    for id in ["FetchSlide", "HandReach", "HandManipulateBlockRotateParallel", "MazeB"] {
        let mut original = load(id);
        original["resets"] = json!([]);
        original["traces"].as_array_mut().unwrap().truncate(1);
        for pointer in numbers(&original["meta"], "/meta") {
            let mut recording = original.clone();
            nudge(&mut recording, &pointer, 1e-6);
            let failure = first_failure(&recording);
            assert!(failure.starts_with("meta: "), "{id} {pointer}: {failure}");
        }
    }
}

/// Pointers to all numbers below `value`.
fn numbers(value: &Value, at: &str) -> Vec<String> {
    match value {
        Value::Number(_) => vec![at.to_owned()],
        Value::Array(items) => {
            items.iter().enumerate().flat_map(|(i, item)| numbers(item, &format!("{at}/{i}"))).collect()
        }
        Value::Object(fields) => {
            fields.iter().flat_map(|(name, item)| numbers(item, &format!("{at}/{name}"))).collect()
        }
        _ => Vec::new(),
    }
}

#[test]
fn flipped_outcomes_are_counted() {
    let mut recording = load("MazeA");
    nudge(&mut recording, "/traces/0/reward/3", 1.0);
    nudge(&mut recording, "/traces/2/reward/4", 1.0);
    nudge(&mut recording, "/traces/2/is_success/4", 1.0);
    let report = verify(&recording).unwrap();
    assert_eq!((report.reward_mismatches, report.success_mismatches), (2, 1));
    assert_eq!((report.traces, report.steps, report.resets), (7, 350, 0));
    assert!(report.deviations.observation <= 1e-12, "{:?}", report.deviations);
}

#[test]
fn other_physics_than_recorded_are_noticed() {
    let mut recording = load("FetchSlide");
    recording["meta"]["nativeccd_disabled"] = json!(false);
    assert!(first_failure(&recording).starts_with("meta: disableflags"));
    recording["meta"]["nativeccd_disabled"] = json!("yes");
    assert!(first_failure(&recording).starts_with("meta: "));
}

#[test]
fn damaged_structure_is_an_error_that_names_the_field() {
    let cases: [(&str, Value, &str); 13] = [
        ("/meta/id", json!("FetchFly-v1"), "unknown environment `FetchFly`; there are Point, MazeA"),
        ("/meta/id", json!("Point"), "reset 0: draw 0 should be 2 of Uniform"),
        ("/traces/0/reward", Value::Null, "traces[0].reward"),
        ("/traces/0/start", json!({}), "traces[0].start: missing field `time`"),
        ("/traces/0/start/ctrl", json!([0.0]), "trace 0 (seed 0), start: start.ctrl should hold 0 numbers"),
        ("/traces/0/goal", json!([1.0]), "trace 0 (seed 0), start: goal holds 1 numbers, 3 are needed"),
        ("/traces/0/obs0", json!([]), "trace 0 (seed 0), start: observation holds 0 numbers, 10 are needed"),
        (
            "/traces/0/actions/2",
            json!([0.5]),
            "trace 0 (seed 0), step 3: actions holds 1 numbers, 4 are needed",
        ),
        ("/traces/0/qvel/0", json!([0.5]), "trace 0 (seed 0), step 1: qvel holds 1 numbers, 15 are needed"),
        ("/traces/0/is_success", json!([]), "trace 0 (seed 0), start: is_success holds 0 numbers, 20"),
        (
            "/traces/0/start/qvel/0",
            json!(1e300),
            "trace 0 (seed 0), step 1: FetchReach: the simulation became",
        ),
        ("/resets/0/draws/0/0", json!("poisson"), "resets[0].draws[0][0]: unknown variant `poisson`"),
        ("/resets/0/draws/0/0", json!("normal"), "reset 0: draw 0 should be 3 of Uniform"),
    ];
    let original = load("FetchReach");
    for (pointer, value, message) in cases {
        let mut recording = original.clone();
        *recording.pointer_mut(pointer).unwrap() = value;
        let error = error(&recording);
        assert!(error.contains("altered.json.gz: ") && error.contains(message), "{pointer}: {error}");
    }
}

#[test]
fn missing_unknown_and_left_over_entries_are_errors() {
    let original = load("FetchReach");
    let mut recording = original.clone();
    recording["traces"][1].as_object_mut().unwrap().remove("qpos");
    assert!(error(&recording).contains("step 1: qpos holds 0 numbers, 15 are needed"));
    let mut recording = original.clone();
    recording["traces"][1].as_object_mut().unwrap().remove("reward");
    assert!(error(&recording).contains("traces[1]: missing field `reward`"));
    let mut recording = original.clone();
    recording["meta"].as_object_mut().unwrap().remove("n_substeps");
    assert!(error(&recording).contains("meta.n_substeps is missing"));
    let mut recording = original.clone();
    recording["traces"][0]["rewards"] = json!([]);
    assert!(error(&recording).contains("traces[0].rewards: unknown field `rewards`"));
    let mut recording = original.clone();
    recording["resets"][1]["draws"] = json!([]);
    assert!(error(&recording).contains("reset 1: the reset asks for a draw number 0"));
    let mut recording = original.clone();
    recording["resets"][1]["draws"].as_array_mut().unwrap().push(json!(["uniform", [0.5]]));
    assert!(error(&recording).contains("reset 1: 1 of 2 recorded draws were asked for"));
    let mut recording = original;
    (recording["resets"], recording["traces"]) = (json!([]), json!([]));
    assert!(error(&recording).contains("holds neither resets nor traces"));
}

#[test]
fn unreadable_files_and_empty_folders_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let none = verify_dir(folder.path()).unwrap_err();
    assert!(told(&none).contains("no file ends with .json.gz"), "{none}");
    let absent = verify_dir(&folder.path().join("absent")).unwrap_err();
    assert!(matches!(*absent.problem, Problem::Read(_)), "{absent}");

    let whole = std::fs::read(golden("MazeA")).unwrap();
    std::fs::write(folder.path().join("a.json.gz"), &whole[..whole.len() / 2]).unwrap();
    std::fs::write(folder.path().join("b.json.gz"), b"{}").unwrap();
    std::fs::write(folder.path().join("c.json.gz"), [&whole[..], b"tail"].concat()).unwrap();
    std::fs::write(folder.path().join("d.json.gz"), &whole).unwrap();
    let outcomes = verify_dir(folder.path()).unwrap();
    for (outcome, name) in outcomes[..3].iter().zip(["a", "b", "c"]) {
        let error = outcome.as_ref().unwrap_err();
        let named = error.to_string().contains(&format!("{name}.json.gz"));
        assert!(matches!(*error.problem, Problem::Read(_)) && named, "{error}");
    }
    assert!(outcomes[3].as_ref().unwrap().passed(), "one damaged file must not spoil the others");
}
