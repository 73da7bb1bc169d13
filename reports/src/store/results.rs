//! A results folder: which runs lie in it.

use std::fs;
use std::path::{Path, PathBuf};

use guard::files;
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

    /// Looks for everything that lies below `runs/`. A folder in which no run has begun yet is passed over.
    ///
    /// # Errors
    /// [`StoreError::Io`], [`StoreError::NotResults`] and [`StoreError::OnlyTrials`] if this is no results
    /// folder, or not yet one. What cannot be read below is named in the survey.
    pub fn survey(&self) -> Result<Survey, StoreError> {
        fs::metadata(&self.path).map_err(StoreError::io(&self.path, "find this folder"))?;
        let runs = layout::runs_dir(&self.path);
        match fs::metadata(&runs) {
            Ok(found) if found.is_dir() => {}
            Err(error) if !files::is_absent(&error) => {
                return Err(StoreError::io(runs, "find this folder")(error));
            }
            _ if layout::runs_dir(&layout::tuning_dir(&self.path)).is_dir() => {
                return Err(StoreError::OnlyTrials { path: self.path.clone() });
            }
            _ => return Err(StoreError::NotResults { path: self.path.clone() }),
        }
        let mut found = Survey::default();
        for entry in self.walk() {
            let (path, fault) = match entry {
                Ok(Place::Run(folder)) => {
                    match (folder.has(layout::MANIFEST), folder.leftover()) {
                        (Ok(false), Ok(None)) => {}
                        (Ok(false), Ok(Some(_))) => found.lost.push(folder),
                        // Whoever reads a run that nobody can look at says what is in the way.
                        (Ok(true) | Err(_), _) | (_, Err(_)) => found.runs.push(folder),
                    }
                    continue;
                }
                Ok(Place::Stray(path)) => (path, Fault::Stray { expected: BELOW_RUNS }),
                Err(StoreError::Io { path, source, .. }) => {
                    (path, Fault::Unreadable { reason: source.to_string() })
                }
                Err(error) => (error.path().to_owned(), Fault::Unreadable { reason: error.to_string() }),
            };
            let path = self.relative(&path).to_owned();
            found.strays.push(StoreProblem { path, line: None, fault });
        }
        Ok(found)
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

/// What a results folder holds, by path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// The folders of all runs that have begun.
    pub runs: Vec<RunFolder>,
    /// The folders of runs whose manifest is gone, though other files of theirs are there.
    pub lost: Vec<RunFolder>,
    /// What is no run, such as a copied folder `seed-0 (copy)`, or cannot be read.
    pub strays: Vec<StoreProblem>,
}

/// What lies below `runs/`.
enum Place {
    /// A folder where a run belongs.
    Run(RunFolder),
    /// Something that belongs nowhere.
    Stray(PathBuf),
}
