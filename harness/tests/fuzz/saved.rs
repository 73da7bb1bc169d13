//! Checkpoints and the replay log, from which runs go on.

use std::fs;
use std::path::Path;

use goalbench::Registry;
use goalbench::run::checkpoint::{self, CHECKPOINT, Checkpoint, REPLAY};
use goalbench::run::folder::read_manifest;
use goalbench::run::train::Trainer;
use proptest::prelude::*;

use crate::damage::{Damage, damaged, damages};
use crate::fixture::{RUN, copy, stopped};
use crate::target::fuzz;

/// Bytes of a seal's header, which ends with the CRC-32 of what follows.
const HEADER: usize = 12;
/// Where that CRC-32 begins.
const CRC: usize = 8;

/// `bytes` with a checksum that fits, as of somebody who altered them on purpose.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.len() >= HEADER {
        let crc = crc32fast::hash(&bytes[HEADER..]);
        bytes[CRC..HEADER].copy_from_slice(&crc.to_le_bytes());
    }
    bytes
}

/// Where `part` lies in `whole`.
fn place(whole: &[u8], part: &[u8]) -> usize {
    whole.windows(part.len()).position(|window| window == part).expect("it lies in there")
}

/// The checkpoint `good` with damage to the student in it; lengths and checksums fit all the same.
fn other_student(good: &[u8], student: &[u8], damages: &[Damage]) -> Vec<u8> {
    let begin = place(good, student);
    let mut other = damaged(&student[HEADER..], damages);
    other.resize(student.len() - HEADER, 0);
    let other = sealed([&student[..HEADER], &other].concat());
    let mut bytes = good.to_vec();
    bytes[begin..begin + student.len()].copy_from_slice(&other);
    sealed(bytes)
}

fn go_on(run: &Path, checkpoint: &Checkpoint) {
    let (manifest, config) = read_manifest(run).expect("a sound manifest");
    let mut trainer = Trainer::new(&Registry::builtin(), manifest.run, config).expect("a sound config");
    if let Err(error) = trainer.resume(&checkpoint.trainer, &run.join(REPLAY)) {
        assert!(!error.to_string().is_empty());
    }
}

/// What is done to a checkpoint.
#[derive(Clone, Debug)]
enum Attack {
    Bytes(Vec<Damage>),
    Sealed(Vec<Damage>),
    Student(Vec<Damage>),
}

#[test]
fn checkpoints() {
    let folder = copy(stopped());
    let run = folder.path().join(RUN);
    let path = run.join(CHECKPOINT);
    let manifest = read_manifest(&run).expect("a manifest").0;
    let good = fs::read(&path).expect("a checkpoint");
    let sound = checkpoint::read(&run, &manifest).expect("a sound checkpoint").expect("it is there");
    let inputs = prop_oneof![
        damages().prop_map(Attack::Bytes),
        damages().prop_map(Attack::Sealed),
        damages().prop_map(Attack::Student),
    ];
    fuzz("checkpoints", 200, &inputs, |attack| {
        let bad = match &attack {
            Attack::Bytes(damages) => damaged(&good, damages),
            Attack::Sealed(damages) => sealed([&good[..HEADER], &damaged(&good[HEADER..], damages)].concat()),
            Attack::Student(damages) => other_student(&good, sound.trainer.student(), damages),
        };
        fs::write(&path, &bad).expect("it can be written");
        match checkpoint::read(&run, &manifest) {
            Err(error) => assert!(error.to_string().contains(CHECKPOINT), "{error}"),
            Ok(read) => {
                let read = read.expect("it is there");
                assert!(bad == good || !matches!(attack, Attack::Bytes(_)), "damage is noticed");
                go_on(&run, &read);
                checkpoint::write(&run, &read).expect("it can be written");
                let written = fs::read(&path).expect("it was written");
                let again =
                    checkpoint::read(&run, &manifest).expect("what was written").expect("it is there");
                checkpoint::write(&run, &again).expect("it can be written");
                assert_eq!(fs::read(&path).expect("it was written"), written);
            }
        }
    });
}

#[test]
fn replay_logs() {
    let folder = copy(stopped());
    let run = folder.path().join(RUN);
    let path = run.join(REPLAY).join("episodes-0.bin");
    let manifest = read_manifest(&run).expect("a manifest").0;
    let good = fs::read(&path).expect("a replay log");
    let sound = checkpoint::read(&run, &manifest).expect("a sound checkpoint").expect("it is there");
    fuzz("replay", 100, &damages(), |damages| {
        fs::write(&path, damaged(&good, &damages)).expect("it can be written");
        go_on(&run, &sound);
        fs::write(&path, &good).expect("it can be written");
    });
}
