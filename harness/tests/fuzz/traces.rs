//! Recordings that `goalbench verify` plays back.

use std::fs;
use std::io::{Read, Write};

use envs::trace::verify_file;
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use proptest::prelude::any;

use crate::damage::{damaged, damages};
use crate::target::{assert_names, fuzz};

const RECORDING: &[u8] = include_bytes!("../../../envs/tests/golden/MazeA.json.gz");

fn packed(text: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(text).and_then(|()| packed.finish()).expect("memory can be written")
}

#[test]
fn recordings() {
    let mut text = Vec::new();
    GzDecoder::new(RECORDING).read_to_end(&mut text).expect("a sound recording");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("damaged.json.gz");
    fuzz("traces", 150, &(damages(), any::<bool>()), |(damages, inside)| {
        let bytes = if inside { packed(&damaged(&text, &damages)) } else { damaged(RECORDING, &damages) };
        fs::write(&path, bytes).expect("it can be written");
        match verify_file(&path) {
            Err(error) => assert_names(&error, &path),
            Ok(report) => assert!(report.resets + report.traces > 0),
        }
    });
}
