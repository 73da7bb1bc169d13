//! The Rust files of the workspace.

use std::{fs, path::Path};

/// The folders that hold Rust code.
const FOLDERS: [&str; 6] = ["agents", "ci", "curricula", "envs", "harness", "reports"];

/// A Rust file.
#[derive(Debug)]
pub(crate) struct Source {
    /// From the project folder, with `/`.
    pub(crate) file: String,
    pub(crate) text: String,
}

impl Source {
    /// Its lines with their numbers, from 1.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text.lines().enumerate().map(|(index, line)| (index + 1, line))
    }

    /// The name of the crate that it is a part of, as `use` has it, if it is not a test, bench or example.
    pub(crate) fn krate(&self) -> Option<&str> {
        let (folder, _) = self.file.split_once("/src/")?;
        Some(match folder.rsplit('/').next()? {
            "harness" => "goalbench",
            name => name,
        })
    }
}

/// All Rust files below `project`, in order of their names.
pub(crate) fn sources(project: &Path) -> Vec<Source> {
    let mut found = Vec::new();
    for folder in FOLDERS {
        collect(project, folder, &mut found);
    }
    found.sort_by(|a, b| a.file.cmp(&b.file));
    assert!(!found.is_empty(), "no Rust file below {}", project.display());
    found
}

fn collect(project: &Path, folder: &str, found: &mut Vec<Source>) {
    let entries = fs::read_dir(project.join(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    for entry in entries {
        let entry = entry.unwrap_or_else(|error| panic!("{folder}: {error}"));
        let file = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(project, &file, found);
        } else if file.ends_with(".rs") {
            let text = fs::read_to_string(entry.path()).unwrap_or_else(|error| panic!("{file}: {error}"));
            found.push(Source { file, text });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::project, Source, sources};

    #[test]
    fn this_file_is_among_them_and_belongs_to_its_crate() {
        let all = sources(&project());
        let this = all.iter().find(|source| source.file == "ci/src/house/sources.rs").unwrap();
        assert_eq!(this.krate(), Some("ci"));
    }

    #[test]
    fn crates_are_named_as_code_names_them() {
        let krate = |file: &str| Source { file: file.into(), text: String::new() }.krate().map(str::to_owned);
        assert_eq!(krate("harness/src/run/mod.rs").as_deref(), Some("goalbench"));
        assert_eq!(krate("reports/looks/src/lib.rs").as_deref(), Some("looks"));
        assert_eq!(krate("harness/tests/merge.rs"), None);
    }
}
