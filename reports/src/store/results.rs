//! A results folder: which runs lie in it.

use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use super::error::StoreError;
use super::layout::{self, DEPTH};
use super::problem::{Fault, StoreProblem};
use super::run_folder::RunFolder;

const BELOW_RUNS: &str = "folders ENVIRONMENT/CURRICULUM/VARIANT/seed-N";

/// A results folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Results {
    path: PathBuf,
}

impl Results {
    /// The results folder at `path`.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// The folders of all runs that have begun, by path.
    ///
    /// # Errors
    /// [`StoreError::Io`] if a folder cannot be read.
    pub fn runs(&self) -> Result<Vec<RunFolder>, StoreError> {
        let mut runs = Vec::new();
        for entry in self.walk() {
            if let Place::Run(folder) = entry?
                && folder.has(layout::MANIFEST)
            {
                runs.push(folder);
            }
        }
        Ok(runs)
    }

    /// The same for readers that use what is sound: runs, and what else lies about under `runs/`.
    pub(super) fn survey(&self) -> (Vec<RunFolder>, Vec<StoreProblem>) {
        let (mut runs, mut problems) = (Vec::new(), Vec::new());
        for entry in self.walk() {
            let (path, fault) = match entry {
                Ok(Place::Run(folder)) if folder.has(layout::MANIFEST) => {
                    runs.push(folder);
                    continue;
                }
                Ok(Place::Run(folder)) => (folder.path().to_owned(), Fault::NoManifest),
                Ok(Place::Stray(path)) => (path, Fault::Stray { expected: BELOW_RUNS }),
                Err(StoreError::Io { path, source, .. }) => {
                    (path, Fault::Unreadable { reason: source.to_string() })
                }
                Err(error) => (error.path().to_owned(), Fault::Unreadable { reason: error.to_string() }),
            };
            problems.push(StoreProblem { path: self.relative(&path).to_owned(), line: None, fault });
        }
        (runs, problems)
    }

    /// What lies where a run belongs, and what belongs nowhere, by path. Hidden files (of editors and file
    /// managers) are passed over.
    fn walk(&self) -> impl Iterator<Item = Result<Place, StoreError>> {
        let runs = layout::runs_dir(&self.path);
        let entries =
            WalkDir::new(&runs).min_depth(1).max_depth(DEPTH).follow_links(true).sort_by_file_name();
        let visible = |entry: &walkdir::DirEntry| !entry.file_name().as_encoded_bytes().starts_with(b".");
        entries.into_iter().filter_entry(move |entry| entry.depth() == 0 || visible(entry)).filter_map(
            move |entry| match entry {
                Ok(entry) if !entry.file_type().is_dir() => Some(Ok(Place::Stray(entry.into_path()))),
                Ok(entry) if entry.depth() < DEPTH => None,
                Ok(entry) if layout::key_at(entry.path()).is_none() => {
                    Some(Ok(Place::Stray(entry.into_path())))
                }
                Ok(entry) => Some(Ok(Place::Run(RunFolder::new(entry.into_path())))),
                Err(error) => {
                    let path = error.path().unwrap_or(&runs).to_owned();
                    let looped = || std::io::Error::other("a link leads back to a folder above it");
                    let source = error.into_io_error().unwrap_or_else(looped);
                    Some(Err(StoreError::Io { path, action: "read this folder", source }))
                }
            },
        )
    }

    /// `path` as problems name it.
    pub(super) fn relative<'a>(&self, path: &'a Path) -> &'a Path {
        path.strip_prefix(&self.path).unwrap_or(path)
    }
}

/// What lies below `runs/`.
enum Place {
    /// A folder where a run belongs.
    Run(RunFolder),
    /// Something that belongs nowhere.
    Stray(PathBuf),
}
