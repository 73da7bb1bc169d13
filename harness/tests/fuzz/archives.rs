//! Packed results of others.

use std::fs;

use goalbench::Registry;
use goalbench::archive::{Packing, PolicyChoice, pack, unpack};
use proptest::prelude::*;
use reports::ReportOptions;

use crate::damage::{damaged, damages};
use crate::fixture::finished;
use crate::target::{assert_names, fuzz};

/// Damage to the compressed file, and to what it unpacks to: refused, or of no consequence.
#[test]
fn archives() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("results.tar.zst");
    let packing = Packing {
        policies: PolicyChoice::None,
        without: Vec::new(),
        licence: "CC0-1.0".to_owned(),
        title: None,
    };
    pack(&Registry::builtin(), finished(), &path, &ReportOptions::default(), &packing)
        .expect("sound results");
    let packed = fs::read(&path).expect("an archive");
    let whole = zstd::decode_all(packed.as_slice()).expect("what was packed");
    let good = unpack(&path).expect("what was packed").store;
    fuzz("archives", 128, &(any::<bool>(), damages()), |(inside, damages)| {
        let bytes = if inside {
            zstd::encode_all(damaged(&whole, &damages).as_slice(), 1).expect("memory")
        } else {
            damaged(&packed, &damages)
        };
        fs::write(&path, bytes).expect("it can be written");
        match unpack(&path) {
            Err(error) => assert_names(&error, &path),
            Ok(unpacked) => assert_eq!(unpacked.store, good),
        }
    });
}
