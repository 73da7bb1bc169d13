//! A copy of the project to plant faults in, with a build folder of its own.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::error::{Error, Result, doing};

/// The folders below `target/release` in which a build of third-party crates lies, and whether it is large.
/// Cargo writes into the files of the small ones, also into those of this workspace's crates, which it calls
/// the same in every folder; those are copied.
const BUILT: [(&str, bool); 3] = [(".fingerprint", false), ("build", false), ("deps", true)];

/// The copy. The project itself is never touched.
#[derive(Debug)]
pub(crate) struct Scratch {
    /// Its project folder.
    pub(crate) tree: PathBuf,
    /// Its build folder.
    pub(crate) target: PathBuf,
}

impl Scratch {
    /// Copies the files of `project` that git tracks, as they are now, into `folder`. Third-party crates are
    /// brought from the project's build folder `built` into the copy's, so that only the workspace's own
    /// crates are built again.
    pub(crate) fn make(project: &Path, built: &Path, folder: &Path) -> Result<Self> {
        let scratch = Self { tree: folder.join("tree"), target: folder.join("build") };
        for path in tracked(project)? {
            let from = project.join(&path);
            // Deleted and not committed yet.
            if from.exists() {
                let to = scratch.tree.join(&path);
                let parent = to.parent().unwrap_or(&scratch.tree);
                fs::create_dir_all(parent).map_err(doing("create", parent))?;
                fs::copy(&from, &to).map_err(doing("copy", &from))?;
            }
        }
        for (name, is_large) in BUILT {
            let from = built.join("release").join(name);
            if from.exists() {
                bring_all(&from, &scratch.target.join("release").join(name), is_large)?;
            }
        }
        Ok(scratch)
    }

    /// Replaces the text `from`, which must occur once in `file`, by `to`. Returns the file's former text.
    pub(crate) fn replace(&self, file: &str, from: &str, to: &str) -> Result<String> {
        let path = self.tree.join(file);
        let text = fs::read_to_string(&path).map_err(doing("read", &path))?;
        if text.matches(from).count() != 1 {
            return Err(Error::NoPlace { file: file.to_owned(), text: from.trim().to_owned() });
        }
        self.write(file, &text.replace(from, to))?;
        Ok(text)
    }

    /// Writes `text` into `file`.
    pub(crate) fn write(&self, file: &str, text: &str) -> Result<()> {
        let path = self.tree.join(file);
        fs::write(&path, text).map_err(doing("write", &path))
    }
}

/// The files that git tracks, and new ones that it does not ignore.
fn tracked(project: &Path) -> Result<Vec<PathBuf>> {
    let start = |source| Error::Start { command: "git".into(), source };
    let output = Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .current_dir(project)
        .output()
        .map_err(start)?;
    if !output.status.success() {
        let reason = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(Error::Git { folder: project.to_owned(), reason });
    }
    let names = output.stdout.split(|&byte| byte == 0).filter(|name| !name.is_empty());
    Ok(names.map(|name| PathBuf::from(String::from_utf8_lossy(name).into_owned())).collect())
}

/// Brings every file below `from` to the same place below `to`: as a link, where links are `allowed` and
/// compilers replace files rather than write into them, so that neither side sees what the other builds; else
/// as a copy with the same time of change.
fn bring_all(from: &Path, to: &Path, allowed: bool) -> Result<()> {
    fs::create_dir_all(to).map_err(doing("create", to))?;
    for entry in fs::read_dir(from).map_err(doing("read", from))? {
        let entry = entry.map_err(doing("read", from))?;
        let (path, copy) = (entry.path(), to.join(entry.file_name()));
        if entry.file_type().map_err(doing("look at", &path))?.is_dir() {
            bring_all(&path, &copy, allowed)?;
        } else if allowed && path.extension().is_none_or(|extension| extension != "d") {
            fs::hard_link(&path, &copy).map_err(doing("link", &path))?;
        } else {
            fs::copy(&path, &copy).map_err(doing("copy", &path))?;
            let changed = fs::metadata(&path).and_then(|metadata| metadata.modified());
            let changed = changed.map_err(doing("look at", &path))?;
            let file = fs::File::options().append(true).open(&copy);
            file.and_then(|file| file.set_modified(changed)).map_err(doing("write", &copy))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::tempdir;

    use super::{Scratch, bring_all};

    #[test]
    fn a_text_is_replaced_where_it_stands_once() {
        let home = tempdir().unwrap();
        let scratch = Scratch { tree: home.path().to_owned(), target: home.path().to_owned() };
        fs::write(home.path().join("a.rs"), "one two two").unwrap();
        assert_eq!(scratch.replace("a.rs", "one", "1").unwrap(), "one two two");
        assert_eq!(fs::read_to_string(home.path().join("a.rs")).unwrap(), "1 two two");
        let error = scratch.replace("a.rs", "two", "2").unwrap_err().to_string();
        assert!(error.contains("a.rs") && error.contains("two"), "{error}");
    }

    #[test]
    fn large_files_are_linked_and_what_cargo_writes_into_is_copied() {
        let home = tempdir().unwrap();
        let (from, to) = (home.path().join("from"), home.path().join("to"));
        fs::create_dir_all(from.join("deep")).unwrap();
        for name in ["deep/file", "deep/output", "deep/list.d"] {
            fs::write(from.join(name), "old").unwrap();
        }
        bring_all(&from, &to, true).unwrap();
        // Compilers replace their output, cargo writes into lists of dependencies.
        fs::write(to.join("new"), "new").unwrap();
        fs::rename(to.join("new"), to.join("deep/file")).unwrap();
        fs::write(to.join("deep/list.d"), "new").unwrap();
        let copies = home.path().join("copies");
        bring_all(&from, &copies, false).unwrap();
        let changed = |path: &std::path::Path| fs::metadata(path).unwrap().modified().unwrap();
        assert_eq!(changed(&copies.join("deep/output")), changed(&from.join("deep/output")));
        fs::write(copies.join("deep/output"), "new").unwrap();
        for name in ["deep/file", "deep/output", "deep/list.d"] {
            assert_eq!(fs::read_to_string(from.join(name)).unwrap(), "old", "{name}");
        }
    }
}
