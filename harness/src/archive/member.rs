//! Which files an archive may hold.

use std::path::Path;

use reports::store::layout;

use super::{CARD, POLICIES, SUMS};
use crate::export::{ABOUT, NUMBERS};

/// What becomes of a file of an archive when it is unpacked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Member {
    /// It is the list of checksums.
    Sums,
    /// It is read as part of a results folder.
    Results,
    /// Its checksum is compared; nobody here reads it.
    Beside,
}

/// Names of the files of tidy data.
pub(super) const TIDY: [&str; 2] = ["records.parquet", "runs.parquet"];

/// What the file `name` is, a path below the archive's folder with `/` between its parts; `None` if no
/// archive has such a file.
pub(super) fn member(name: &str) -> Option<Member> {
    let parts: Vec<&str> = name.split('/').collect();
    let is_plain =
        |part: &&str| !part.is_empty() && !part.starts_with('.') && !part.chars().any(char::is_control);
    if !parts.iter().all(is_plain) {
        return None;
    }
    let is_run = |folders: &[&str]| layout::key_at(&folders.iter().collect::<std::path::PathBuf>()).is_some();
    match parts.as_slice() {
        [name] if *name == SUMS => Some(Member::Sums),
        [name] if *name == CARD || TIDY.contains(name) => Some(Member::Beside),
        ["protocols", name] if Path::new(name).extension().is_some_and(|end| end == "toml") => {
            Some(Member::Results)
        }
        [layout::TUNING, layout::CHOICE] => Some(Member::Results),
        ["runs", run @ .., file] if run.len() == layout::DEPTH && is_run(run) => {
            layout::FILES.iter().any(|row| row.packed && row.name == *file).then_some(Member::Results)
        }
        [POLICIES, run @ .., file] if run.len() == layout::DEPTH && is_run(run) => {
            [NUMBERS, ABOUT].contains(file).then_some(Member::Beside)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_results_belong_into_archives() {
        for name in
            ["runs/MazeA/teach/default/seed-0/records.jsonl", "protocols/a b.toml", "tuning/choice.json"]
        {
            assert_eq!(member(name), Some(Member::Results), "{name}");
        }
        for name in ["DATA.md", "runs.parquet", "policies/MazeA/teach/x=1/seed-3/policy.json"] {
            assert_eq!(member(name), Some(Member::Beside), "{name}");
        }
        assert_eq!(member("SHA256SUMS"), Some(Member::Sums));
        for name in [
            "",
            "/etc/passwd",
            "../DATA.md",
            "protocols/../DATA.md",
            "protocols/.hidden.toml",
            "protocols//a.toml",
            "runs/MazeA/teach/default/seed-0/checkpoint.bin",
            "runs/MazeA/teach/default/seed-00/records.jsonl",
            "runs/../teach/default/seed-0/records.jsonl",
            "runs/teach/default/seed-0/records.jsonl",
            "runs/MazeA/teach/default/seed-0/replay/records.jsonl",
            "runs/Maze\nA/teach/default/seed-0/records.jsonl",
            "policies/MazeA/teach/default/seed-0/records.jsonl",
            "records.csv",
            "protocols/a.sh",
            "tuning/runs/MazeA/teach/default/seed-0/records.jsonl",
            "choice.json",
        ] {
            assert_eq!(member(name), None, "{name:?}");
        }
    }
}
