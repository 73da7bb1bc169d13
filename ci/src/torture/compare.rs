//! What two results folders must have in common, file by file.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;

use crate::error::{Result, doing};

/// How the files of one name must agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// In every byte.
    Bytes,
    /// In every byte but the clock's, which stand at the end, and the checksum over both.
    Checkpoint,
    /// In which evaluations they time, not in how long those took.
    Timings,
    /// Whole to the last record; times stand in it, too.
    Events,
    /// In the sums of files that must agree in every byte, and in which files they sum up.
    Sums,
    /// In nothing: one may have it, the other not.
    Free,
}

/// Names with a rule of their own; all others follow [`Rule::Bytes`].
const RULES: [(&str, Rule); 7] = [
    ("checkpoint.bin", Rule::Checkpoint),
    ("timing.jsonl", Rule::Timings),
    ("events.out.tfevents.goalbench", Rule::Events),
    ("checksums.json", Rule::Sums),
    (".lock", Rule::Free),
    // Only who was killed has these.
    ("crashes.jsonl", Rule::Free),
    ("worker.log", Rule::Free),
];

/// Bytes of a checkpoint's header before its checksum, and with it.
const HEADER: (usize, usize) = (8, 12);
/// The most bytes at a checkpoint's end that tell of the clock: four durations, and length and checksum of
/// the logs that hold times.
const CLOCK: usize = 96;

fn rule(path: &Path) -> Rule {
    // Copies of protocols tell of requests, and whoever was killed was asked more than once.
    if path.starts_with("protocols") {
        return Rule::Free;
    }
    let name = path.file_name().unwrap_or_default();
    RULES.iter().find(|(ruled, _)| name == *ruled).map_or(Rule::Bytes, |(_, rule)| *rule)
}

/// The folders four levels below `results/runs`, by path.
pub(crate) fn run_folders(results: &Path) -> Vec<PathBuf> {
    let mut folders = vec![results.join("runs")];
    for _ in 0..4 {
        let entries = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten();
        folders = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| path.is_dir()).collect();
    }
    folders.sort();
    folders
}

/// Every way in which the results in `found` are not those in `expected`.
pub(crate) fn differences(found: &Path, expected: &Path) -> Result<Vec<String>> {
    let (ours, theirs) = (files(found)?, files(expected)?);
    let mut faults = Vec::new();
    for path in ours.union(&theirs).filter(|path| rule(path) != Rule::Free) {
        let reason = match (ours.contains(path), theirs.contains(path)) {
            (true, false) => Some("left behind"),
            (false, true) => Some("missing"),
            _ => {
                let read = |folder: &Path| {
                    let path = folder.join(path);
                    fs::read(&path).map_err(doing("read", &path))
                };
                difference(rule(path), &read(found)?, &read(expected)?)
            }
        };
        faults.extend(reason.map(|reason| format!("{}: {reason}", found.join(path).display())));
    }
    Ok(faults)
}

/// All files below `folder`, relative to it.
fn files(folder: &Path) -> Result<BTreeSet<PathBuf>> {
    let (mut files, mut folders) = (BTreeSet::new(), vec![folder.to_owned()]);
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).map_err(doing("read", &next))? {
            let path = entry.map_err(doing("read", &next))?.path();
            if path.is_dir() {
                folders.push(path);
            } else if let Ok(relative) = path.strip_prefix(folder) {
                files.insert(relative.to_owned());
            }
        }
    }
    Ok(files)
}

fn difference(rule: Rule, found: &[u8], expected: &[u8]) -> Option<&'static str> {
    let (same, reason) = match rule {
        Rule::Bytes => (found == expected, "has other bytes"),
        Rule::Checkpoint => (is_same_state(found, expected), "holds another state"),
        Rule::Timings => (evaluations(found) == evaluations(expected), "times other evaluations"),
        Rule::Events => (is_whole(found), "is broken"),
        Rule::Sums => (sums(found).is_some() && sums(found) == sums(expected), "has other checksums"),
        Rule::Free => return None,
    };
    (!same).then_some(reason)
}

/// Whether two checkpoints hold the same student, teacher and streams: all in which the clock has no share.
fn is_same_state(found: &[u8], expected: &[u8]) -> bool {
    // Numbers of variable length make one clock a few bytes longer than another.
    let Some(end) = found.len().min(expected.len()).checked_sub(CLOCK) else { return false };
    let state = |bytes: &[u8]| Some([bytes.get(..HEADER.0)?.to_vec(), bytes.get(HEADER.1..end)?.to_vec()]);
    found.len().abs_diff(expected.len()) < CLOCK && state(found).is_some() && state(found) == state(expected)
}

/// Which evaluations a log of timings tells of; `None` if it is broken.
fn evaluations(timings: &[u8]) -> Option<Vec<(Value, Value)>> {
    let text = std::str::from_utf8(timings).ok()?;
    let lines = text.lines().map(|line| {
        let timing: Value = serde_json::from_str(line).ok()?;
        Some((timing.get("eval_index")?.clone(), timing.get("step")?.clone()))
    });
    lines.collect()
}

/// Whether an event file is a row of whole records: length (8 bytes), its checksum (4), payload, its checksum
/// (4).
fn is_whole(events: &[u8]) -> bool {
    let mut rest = events;
    while let Some((length, _)) = rest.split_first_chunk::<8>() {
        let record =
            usize::try_from(u64::from_le_bytes(*length)).ok().and_then(|length| length.checked_add(16));
        match record.and_then(|record| rest.get(record..)) {
            Some(after) => rest = after,
            None => return false,
        }
    }
    rest.is_empty() && !events.is_empty()
}

/// Checksums by file, of those that must agree in every byte; `None` if the list is broken.
fn sums(text: &[u8]) -> Option<BTreeMap<String, Option<Value>>> {
    let value: Value = serde_json::from_slice(text).ok()?;
    let sums = value.get("sha256")?.as_object()?.iter();
    Some(
        sums.map(|(name, sum)| (name.clone(), (rule(Path::new(name)) == Rule::Bytes).then(|| sum.clone())))
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in files {
            let path = folder.path().join("runs/E/c/v/seed-0").join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
        folder
    }

    /// The names of files in which a folder of `found` differs from one of `expected`, with the reasons.
    fn told(found: &[(&str, &[u8])], expected: &[(&str, &[u8])]) -> Vec<String> {
        let (found, expected) = (folder(found), folder(expected));
        let faults = differences(found.path(), expected.path()).unwrap();
        faults.iter().map(|fault| fault.rsplit('/').next().unwrap().to_owned()).collect()
    }

    #[test]
    fn records_must_agree_in_every_byte_and_nothing_may_be_left_or_missing() {
        assert_eq!(told(&[("records.jsonl", b"a")], &[("records.jsonl", b"a")]), [""; 0]);
        assert_eq!(
            told(&[("records.jsonl", b"a")], &[("records.jsonl", b"b")]),
            ["records.jsonl: has other bytes"]
        );
        assert_eq!(told(&[(".tmp1", b"")], &[]), [".tmp1: left behind"]);
        assert_eq!(told(&[("crashes.jsonl", b"x")], &[("outcome.json", b"")]), ["outcome.json: missing"]);
    }

    #[test]
    fn clocks_may_differ_and_nothing_else() {
        let timings = [
            br#"{"eval_index":0,"step":0,"wall_s":1.5}"#.as_slice(),
            br#"{"eval_index":0,"step":0,"wall_s":2.5}"#,
            br#"{"eval_index":1,"step":0,"wall_s":1.5}"#,
            b"{",
        ];
        let same = |rule, a: &[u8], b: &[u8]| difference(rule, a, b).is_none();
        assert!(same(Rule::Timings, timings[0], timings[1]));
        assert!(!same(Rule::Timings, timings[0], timings[2]) && !same(Rule::Timings, timings[3], timings[0]));
        let sums = [
            br#"{"sha256":{"records.jsonl":"a","timing.jsonl":"b"}}"#.as_slice(),
            br#"{"sha256":{"records.jsonl":"a","timing.jsonl":"c"}}"#,
            br#"{"sha256":{"records.jsonl":"d","timing.jsonl":"b"}}"#,
            br#"{"sha256":{"records.jsonl":"a"}}"#,
        ];
        assert!(same(Rule::Sums, sums[0], sums[1]));
        assert!(!same(Rule::Sums, sums[0], sums[2]) && !same(Rule::Sums, sums[0], sums[3]));
    }

    #[test]
    fn checkpoints_must_agree_but_for_their_checksum_and_their_end() {
        let checkpoint: Vec<u8> = (0..200).collect();
        for (place, same) in [(0, false), (8, true), (11, true), (12, false), (80, false), (150, true)] {
            let mut other = checkpoint.clone();
            other[place] ^= 1;
            assert_eq!(difference(Rule::Checkpoint, &other, &checkpoint).is_none(), same, "byte {place}");
        }
    }

    #[test]
    fn event_files_must_end_with_a_whole_record() {
        let record: Vec<u8> = [2, 0, 0, 0, 0, 0, 0, 0].into_iter().chain([7; 10]).collect();
        let two = [record.clone(), record].concat();
        assert!(is_whole(&two));
        for end in [0, 1, 17, 19, 35] {
            assert!(!is_whole(&two[..end]), "{end} bytes");
        }
        assert!(!is_whole(&[255; 40]));
    }
}
