//! The files of a results folder as readers see them, and merges of such folders.

use std::fs;

use goalbench::merge::merge;
use goalbench::status::{Activity, status};
use proptest::sample::select;
use reports::store::{JsonLine, RunFolder, Store, layout};
use serde::Serialize;

use crate::damage::{damaged, damages};
use crate::fixture::{RUN, copy, finished};
use crate::target::{assert_names, fuzz};

/// The files of a finished run that hold lines or values.
fn written() -> Vec<&'static str> {
    let text = |name: &&str| name.ends_with(".json") || name.ends_with(".jsonl");
    let there = |name: &&str| finished().join(RUN).join(name).exists();
    layout::FILES.iter().map(|file| file.name).filter(text).filter(there).collect()
}

/// Those that hold what the run found: whoever reads an ended run notices every change of these. Times are
/// summed up too, but what was found holds without them.
fn found() -> Vec<String> {
    let text = fs::read(finished().join(RUN).join(layout::CHECKSUMS)).expect("checksums");
    let sums: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    let names = sums["sha256"].as_object().expect("sums by file").keys();
    let found: Vec<String> = names.filter(|name| *name != layout::TIMING).cloned().collect();
    assert!(found.len() >= 2, "{found:?}");
    found
}

/// Files that are read line by line, and are the same after they were written again.
fn assert_lines<T: JsonLine + Serialize + PartialEq + std::fmt::Debug>(
    folder: &RunFolder,
    read: impl Fn(&RunFolder) -> Result<Vec<T>, reports::store::StoreError>,
) {
    let path = folder.file(T::FILE);
    let kept = fs::read(&path).expect("it is there");
    match read(folder) {
        Err(error) => assert_names(&error, &path),
        Ok(lines) => {
            let text: String =
                lines.iter().map(|line| serde_json::to_string(line).expect("plain data") + "\n").collect();
            fs::write(&path, text).expect("it can be written");
            assert_eq!(read(folder).expect("what was written"), lines);
            fs::write(&path, kept).expect("it can be written");
        }
    }
}

#[test]
fn files_of_a_run() {
    let folder = copy(finished());
    let run = RunFolder::new(folder.path().join(RUN));
    let (inputs, found) = ((select(written()), damages()), found());
    let is_found = |name: &str| found.iter().any(|other| other == name);
    fuzz("files", 600, &inputs, |(name, damages)| {
        let path = run.file(name);
        let good = fs::read(&path).expect(name);
        let bad = damaged(&good, &damages);
        fs::write(&path, &bad).expect(name);
        assert_lines(&run, RunFolder::records);
        assert_lines(&run, RunFolder::teaching);
        assert_lines(&run, RunFolder::timings);
        assert_lines(&run, RunFolder::frontier);
        assert_lines(&run, RunFolder::shadowing);
        if let Err(error) = run.manifest() {
            assert_names(&error, &path);
        }
        if let Err(error) = run.outcome() {
            assert_names(&error, &path);
        }
        let store = Store::read(folder.path()).expect("a results folder");
        for run in store.runs() {
            drop(reports::store::teaching(folder.path(), run));
            drop(reports::store::frontier(folder.path(), run));
            drop(reports::store::shadowing(folder.path(), run));
        }
        let states = status(folder.path()).expect("a results folder").runs;
        if bad != good && is_found(name) {
            let told = |text: &str| text.contains(name);
            let noticed = store.problems().iter().any(|problem| told(&problem.to_string()));
            assert!(noticed, "{name}: {:?}", store.problems());
            let damaged = states.iter().find(|state| state.activity == Activity::Damaged);
            let reason = damaged.and_then(|state| state.reason.as_deref());
            assert!(reason.is_some_and(told), "{name}: {reason:?}");
        }
        fs::write(&path, good).expect(name);
    });
}

#[test]
fn merges() {
    let folder = copy(finished());
    let home = tempfile::tempdir().expect("a temporary folder");
    let out = home.path().join("merged");
    let (inputs, found) = ((select(written()), damages()), found());
    let is_found = |name: &str| found.iter().any(|other| other == name);
    fuzz("merges", 100, &inputs, |(name, damages)| {
        let path = folder.path().join(RUN).join(name);
        let good = fs::read(&path).expect(name);
        let bad = damaged(&good, &damages);
        fs::write(&path, &bad).expect(name);
        let sources = [folder.path().to_owned(), finished().to_owned()];
        // Alone it is refused; beside a sound copy of the run, that may be taken in its place.
        for sources in [&sources[..1], &sources[..]] {
            match merge(sources, &out) {
                Err(error) => assert!(!out.exists() && !error.to_string().is_empty()),
                Ok(_) => {
                    assert!(bad == good || !is_found(name) || sources.len() > 1, "{name}");
                    if is_found(name) {
                        let store = Store::read(&out).expect("a results folder");
                        assert_eq!(store.problems(), [], "{name}");
                    }
                    fs::remove_dir_all(&out).expect("a folder");
                }
            }
            assert_eq!(fs::read_dir(home.path()).expect("a folder").count(), 0, "nothing is left behind");
        }
        fs::write(&path, good).expect(name);
    });
}
