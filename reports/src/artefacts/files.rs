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

/// What every report has. A list without one of these is somebody else's, whatever its name.
const ALWAYS: [&str; 4] = [LIST, "index.html", "summary.md", "DATA.md"];

/// Writes all `files` into `folder`, then removes what the report before it listed and this one lacks. What a
/// report did not write itself is never touched. Gives the paths written.
///
/// # Errors
/// [`ReportError::InTheWay`], before anything is written, where something that no report listed has the name
/// of one of `files` or of a folder of theirs; [`ReportError::Io`].
pub(super) fn write_all(folder: &Path, files: Vec<File>) -> Result<Vec<PathBuf>, ReportError> {
    let before = listed(&folder.join(LIST))?;
    let mut now: BTreeSet<PathBuf> = files.iter().map(|(name, _)| name.clone()).collect();
    now.insert(LIST.into());
    let in_the_way = in_the_way(folder, &before, &now);
    if let Some(first) = in_the_way.first() {
        let others = in_the_way.len() - 1;
        return Err(ReportError::InTheWay { path: folder.join(first), others, list: LIST });
    }
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

/// What lies in `folder` where a file or a folder of the files `now` belongs, and is not among those that a
/// report `before` wrote.
fn in_the_way(folder: &Path, before: &BTreeSet<PathBuf>, now: &BTreeSet<PathBuf>) -> BTreeSet<PathBuf> {
    let is_there = |name: &Path| folder.join(name).symlink_metadata().is_ok();
    let files = now.iter().filter(|name| !before.contains(*name) && is_there(name)).cloned();
    let parents = now.iter().flat_map(|name| name.ancestors().skip(1));
    let parents = parents.filter(|name| is_there(name) && !folder.join(name).is_dir()).map(Path::to_owned);
    files.chain(parents).collect()
}

/// The files named in the list at `path`; none if there is no list of a report. Names that lead out of the
/// folder are no names of ours.
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
    let names: BTreeSet<PathBuf> = text.lines().map(PathBuf::from).filter(is_inside).collect();
    let is_a_report = ALWAYS.iter().all(|name| names.contains(Path::new(name)));
    Ok(if is_a_report { names } else { BTreeSet::new() })
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

    /// What every report has, and `others`.
    fn report(others: &[&str]) -> Vec<File> {
        let all = ALWAYS.iter().filter(|name| **name != LIST).chain(others);
        all.map(|name| (PathBuf::from(name), b"new".to_vec())).collect()
    }

    fn content(folder: &Path, name: &str) -> String {
        fs::read_to_string(folder.join(name)).unwrap()
    }

    #[test]
    fn what_no_report_wrote_is_not_replaced() {
        type Make = fn(&Path);
        let makes: [(&str, Make); 5] = [
            ("index.html", |path| fs::write(path, "mine").unwrap()),
            ("index.html", |path| fs::create_dir(path).unwrap()),
            ("index.html", |path| std::os::unix::fs::symlink("nowhere", path).unwrap()),
            ("figures", |path| fs::write(path, "mine").unwrap()),
            (LIST, |path| fs::write(path, "bread\nindex.html\nfiles.txt\nnotes.md\n").unwrap()),
        ];
        for (name, make) in makes {
            let place = tempfile::tempdir().unwrap();
            let folder = place.path();
            fs::write(folder.join("notes.md"), "mine").unwrap();
            make(&folder.join(name));
            let said = write_all(folder, report(&["figures/grid.svg"])).unwrap_err().to_string();
            assert!(said.starts_with(&format!("{}: ", folder.join(name).display())), "{said}");
            let mut left: Vec<_> =
                fs::read_dir(folder).unwrap().map(|item| item.unwrap().file_name()).collect();
            left.sort();
            let mut expected = [name, "notes.md"];
            expected.sort_unstable();
            assert_eq!(left, expected, "nothing is written");
            assert_eq!(content(folder, "notes.md"), "mine");
        }
    }

    #[test]
    fn a_report_without_its_list_is_not_replaced_and_counted() {
        let place = tempfile::tempdir().unwrap();
        write_all(place.path(), report(&["figures/grid.svg"])).unwrap();
        fs::remove_file(place.path().join(LIST)).unwrap();
        let said = write_all(place.path(), report(&["figures/grid.svg"])).unwrap_err().to_string();
        assert!(said.contains("DATA.md") && said.contains("3 more"), "{said}");
    }

    /// The list of both is written before anything else.
    #[test]
    fn a_report_that_was_broken_off_is_gone_on_with() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        write_all(folder, report(&["figures/old.svg"])).unwrap();
        let both = content(folder, LIST) + "figures/new.svg\n";
        fs::write(folder.join(LIST), both).unwrap();
        fs::write(folder.join("figures/new.svg"), "half").unwrap();
        write_all(folder, report(&["figures/new.svg"])).unwrap();
        assert_eq!(content(folder, "figures/new.svg"), "new");
        assert!(!folder.join("figures/old.svg").exists());
    }

    #[test]
    fn what_the_last_report_wrote_is_removed_and_nothing_else() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("report");
        write_all(&folder, report(&["figures/old.svg", "figures/gone.svg"])).unwrap();
        for own in [folder.join("figures/my.svg"), folder.join("notes.txt"), place.path().join("outside")] {
            fs::write(own, "mine").unwrap();
        }
        fs::remove_file(folder.join("figures/gone.svg")).unwrap();
        // A list that somebody wrote into.
        let list = content(&folder, LIST);
        let outside = place.path().join("outside");
        fs::write(folder.join(LIST), format!("{list}../outside\n{}\n\n", outside.display())).unwrap();
        let written = write_all(&folder, report(&["figures/new.svg"])).unwrap();
        let names = ["index.html", "summary.md", "DATA.md", "figures/new.svg", LIST];
        assert_eq!(written, names.map(|name| folder.join(name)));
        assert!(!folder.join("figures/old.svg").exists());
        for kept in ["figures/my.svg", "notes.txt", "../outside"] {
            assert_eq!(content(&folder, kept), "mine", "{kept}");
        }
        assert_eq!(content(&folder, LIST), "DATA.md\nfigures/new.svg\nfiles.txt\nindex.html\nsummary.md\n");
    }
}
