//! A copy of the project to plant faults in, with a build folder of its own.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::error::{Error, Result, doing};

/// The folders below `target/release` in which a build of third-party crates lies.
const BUILT: [&str; 3] = [".fingerprint", "build", "deps"];

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
    /// linked from the project's build folder `built` into the copy's, so that only the workspace's own
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
        for name in BUILT {
            let from = built.join("release").join(name);
            if from.exists() {
                link_all(&from, &scratch.target.join("release").join(name))?;
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

/// Links every file below `from` to the same place below `to`. Compilers replace files rather than write into
/// them, so neither side sees what the other builds.
fn link_all(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).map_err(doing("create", to))?;
    for entry in fs::read_dir(from).map_err(doing("read", from))? {
        let entry = entry.map_err(doing("read", from))?;
        let (path, copy) = (entry.path(), to.join(entry.file_name()));
        if entry.file_type().map_err(doing("look at", &path))?.is_dir() {
            link_all(&path, &copy)?;
        } else {
            fs::hard_link(&path, &copy).map_err(doing("link", &path))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::tempdir;

    use super::{Scratch, link_all};

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
    fn linked_files_are_the_same_and_stay_when_one_side_is_replaced() {
        let home = tempdir().unwrap();
        let (from, to) = (home.path().join("from"), home.path().join("to"));
        fs::create_dir_all(from.join("deep")).unwrap();
        fs::write(from.join("deep/file"), "old").unwrap();
        link_all(&from, &to).unwrap();
        fs::write(to.join("new"), "new").unwrap();
        fs::rename(to.join("new"), to.join("deep/file")).unwrap();
        assert_eq!(fs::read_to_string(from.join("deep/file")).unwrap(), "old");
        assert_eq!(fs::read_to_string(to.join("deep/file")).unwrap(), "new");
    }
}
