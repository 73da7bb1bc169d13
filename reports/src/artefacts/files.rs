//! Names of the files of a report, and how they are written.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

use guard::fresh;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

use crate::error::ReportError;

/// A file of the report: its path within it and its content.
pub(super) type File = (PathBuf, Vec<u8>);

/// Longest name of a file, in bytes, before its prefix and extension: file systems allow 255.
const LONGEST_NAME: usize = 200;

/// What is written as `%XX` in names of files.
const IN_FILE_NAMES: &AsciiSet = &NON_ALPHANUMERIC.remove(b'.').remove(b'_').remove(b'-');

/// A name as part of a file name: bytes outside `A-Z a-z 0-9 . _ -` become `%XX`, so that different names
/// stay different. A name too long even so is cut and gets its `index` among all names.
pub(super) fn file_name(name: &str, index: usize) -> String {
    let mut encoded = utf8_percent_encode(name, IN_FILE_NAMES).to_string();
    if encoded.len() > LONGEST_NAME {
        encoded.truncate(LONGEST_NAME);
        encoded.push_str(&format!("~{index}"));
    }
    encoded
}

/// Name of the list of a report's files, by which the next report knows which of them it may remove.
const LIST: &str = "files.txt";

/// Writes all `files` into `folder`, then removes what the report before it listed and this one lacks. What a
/// report did not write itself is never touched. Gives the paths written.
///
/// # Errors
/// [`ReportError::NotOurs`], before anything is written, where a file that no report listed has the name of
/// one of `files`; [`ReportError::Io`].
pub(super) fn write_all(folder: &Path, files: Vec<File>) -> Result<Vec<PathBuf>, ReportError> {
    let before = listed(&folder.join(LIST))?;
    let mut now: BTreeSet<PathBuf> = files.iter().map(|(name, _)| name.clone()).collect();
    let is_foreign =
        |name: &&PathBuf| !before.contains(*name) && folder.join(name).symlink_metadata().is_ok();
    if let Some(name) = now.iter().find(is_foreign) {
        return Err(ReportError::NotOurs { path: folder.join(name), list: LIST });
    }
    now.insert(LIST.into());
    let folders: BTreeSet<&Path> = now.iter().filter_map(|name| name.parent()).collect();
    folders.iter().for_each(|name| fresh::sweep(&folder.join(name)));
    // A report that is broken off halfway leaves files of both.
    write_list(folder, before.union(&now))?;
    let mut written = Vec::with_capacity(now.len());
    for (name, bytes) in files {
        let path = folder.join(name);
        replace(&path, &bytes)?;
        written.push(path);
    }
    for stale in before.difference(&now) {
        let path = folder.join(stale);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(ReportError::io(&path, "remove this file")(error));
            }
            _ => {}
        }
    }
    write_list(folder, now.iter())?;
    written.push(folder.join(LIST));
    Ok(written)
}

/// The files named in the list at `path`; none if there is no list. Names that lead out of the folder are no
/// names of ours.
fn listed(path: &Path) -> Result<BTreeSet<PathBuf>, ReportError> {
    let text = match guard::files::read(path) {
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
        Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
        Err(error) => return Err(ReportError::io(path, "read this file")(error)),
    };
    let is_inside = |name: &PathBuf| {
        name.components().all(|component| matches!(component, Component::Normal(_)))
            && name.components().next().is_some()
    };
    Ok(text.lines().map(PathBuf::from).filter(is_inside).collect())
}

fn write_list<'a>(folder: &Path, names: impl Iterator<Item = &'a PathBuf>) -> Result<(), ReportError> {
    let lines: String = names.map(|name| format!("{}\n", name.display())).collect();
    replace(&folder.join(LIST), lines.as_bytes())
}

/// Writes `bytes`, readable as any new file is, to a new file beside `path`, then renames it: readers see the
/// old or the new file, never half.
fn replace(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(ReportError::io(folder, "create this folder"))?;
    fresh::write(path, bytes).map_err(ReportError::io(path, "write this file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn different_names_give_different_files() {
        assert_eq!(file_name("FetchReach-v4", 0), "FetchReach-v4");
        assert_eq!(file_name("a/b c", 0), "a%2Fb%20c");
        assert_eq!(file_name("é", 0), "%C3%A9");
        let (long, longer) = ("ü".repeat(100), "ü".repeat(101));
        assert_ne!(file_name(&long, 3), file_name(&longer, 4));
        assert!(file_name(&longer, 4).len() < 255 - "ablation-confidence-.svg".len());
    }

    #[test]
    fn a_file_that_no_report_wrote_is_not_replaced() {
        let place = tempfile::tempdir().unwrap();
        let file = |name: &str| (PathBuf::from(name), b"new".to_vec());
        let own = place.path().join("index.html");
        fs::write(&own, "mine").unwrap();
        let refused = write_all(place.path(), vec![file("grid.svg"), file("index.html")]).unwrap_err();
        let said = refused.to_string();
        assert!(said.starts_with(&own.display().to_string()) && said.contains("move it away"), "{said}");
        assert_eq!(fs::read_to_string(&own).unwrap(), "mine");
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1, "nothing is written");
    }

    #[test]
    fn what_the_last_report_wrote_is_removed_and_nothing_else() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("report");
        let file = |name: &str| (PathBuf::from(name), b"new".to_vec());
        write_all(&folder, vec![file("index.html"), file("figures/old.svg"), file("figures/gone.svg")])
            .unwrap();
        for own in [folder.join("figures/my.svg"), folder.join("notes.txt"), place.path().join("outside")] {
            fs::write(own, "mine").unwrap();
        }
        fs::remove_file(folder.join("figures/gone.svg")).unwrap();
        // A list that somebody wrote into.
        let list = fs::read_to_string(folder.join(LIST)).unwrap();
        let outside = place.path().join("outside");
        fs::write(folder.join(LIST), format!("{list}../outside\n{}\n\n", outside.display())).unwrap();
        let written = write_all(&folder, vec![file("index.html"), file("figures/new.svg")]).unwrap();
        assert_eq!(written, ["index.html", "figures/new.svg", LIST].map(|name| folder.join(name)));
        assert!(!folder.join("figures/old.svg").exists());
        for kept in ["figures/my.svg", "notes.txt", "../outside"] {
            assert_eq!(fs::read_to_string(folder.join(kept)).unwrap(), "mine", "{kept}");
        }
        assert_eq!(
            fs::read_to_string(folder.join(LIST)).unwrap(),
            "figures/new.svg\nfiles.txt\nindex.html\n"
        );
    }
}
