//! The protocols that a results folder was made by: copies of them lie in it.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::layout;
use super::problem::{Fault, StoreProblem};

/// What a copy of a protocol says of itself.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct ProtocolCopy {
    /// Its name.
    pub name: String,
    /// What it is for, in a line; may be empty.
    #[serde(default)]
    pub description: String,
}

/// No protocol is longer, in bytes.
const LONGEST: u64 = 16 << 20;

/// The protocols of the results folder `results`, by the names of their files; several copies of one, which
/// differ in what was asked for beside it, count once. Without copies, as in old results, there are none.
pub fn protocols(results: &Path) -> (Vec<ProtocolCopy>, Vec<StoreProblem>) {
    let folder = layout::protocols_dir(results);
    let (mut found, mut problems): (Vec<ProtocolCopy>, _) = (Vec::new(), Vec::new());
    let mut faulty = |path: &Path, fault| {
        let path = path.strip_prefix(results).unwrap_or(path).to_owned();
        problems.push(StoreProblem { path, line: None, fault });
    };
    let paths = guard::files::entries(&folder).unwrap_or_else(|error| {
        faulty(&folder, Fault::Unreadable { reason: error.to_string() });
        None
    });
    let is_copy = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "toml");
    for path in paths.into_iter().flatten().filter(is_copy) {
        match read(&path) {
            Ok(copy) if found.contains(&copy) => {}
            Ok(copy) => found.push(copy),
            Err(fault) => faulty(&path, *fault),
        }
    }
    (found, problems)
}

fn read(path: &Path) -> Result<ProtocolCopy, Box<Fault>> {
    let unreadable = |reason: String| Box::new(Fault::Unreadable { reason });
    let metadata = fs::metadata(path).map_err(|error| unreadable(error.to_string()))?;
    if !metadata.is_file() {
        return Err(unreadable("not a regular file".to_owned()));
    }
    if metadata.len() > LONGEST {
        return Err(unreadable(format!("longer than {LONGEST} bytes")));
    }
    let text = fs::read_to_string(path).map_err(|error| unreadable(error.to_string()))?;
    let malformed = |error: toml::de::Error| {
        let reason = error.message().trim().replace('\n', ", ");
        Box::new(Fault::Malformed { expected: "protocol", reason })
    };
    toml::from_str(&text).map_err(malformed)
}
