//! Baselines of the regression gate.

use std::fs;

use reports::gate::Baseline;

use crate::damage::{damaged, damages};
use crate::target::{assert_names, fuzz};

const BASELINE: &[u8] = include_bytes!("../../baselines/gate.json");

#[test]
fn baselines() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("damaged.json");
    fuzz("baselines", 600, &damages(), |damages| {
        fs::write(&path, damaged(BASELINE, &damages)).expect("it can be written");
        match Baseline::read(&path) {
            Err(error) => assert_names(&error, &path),
            Ok(read) => {
                fs::write(&path, read.text()).expect("it can be written");
                assert_eq!(Baseline::read(&path).expect("what was written"), read);
            }
        }
    });
}
