//! The folder of one run: the single way to its files.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use guard::files;
use serde::de::DeserializeOwned;

use super::error::StoreError;
use super::layout::{self, Lives};
use super::{digest, lines};
use crate::schema::{
    Crash, Frontier, Learning, Manifest, Outcome, Record, RunKey, Shadowing, Teaching, Timing,
};

/// A value of which a file of a run's folder has one per line.
pub trait JsonLine: DeserializeOwned {
    /// Name of the file.
    const FILE: &'static str;
    /// What problems call such a value.
    const NAME: &'static str;
}

impl JsonLine for Record {
    const FILE: &'static str = layout::RECORDS;
    const NAME: &'static str = "evaluation";
}

impl JsonLine for Teaching {
    const FILE: &'static str = layout::TEACHING;
    const NAME: &'static str = "teaching";
}

impl JsonLine for Learning {
    const FILE: &'static str = layout::STUDENT;
    const NAME: &'static str = "diagnosis of the student";
}

impl JsonLine for Frontier {
    const FILE: &'static str = layout::FRONTIER;
    const NAME: &'static str = "measure of the frontier";
}

impl JsonLine for Shadowing {
    const FILE: &'static str = layout::SHADOW;
    const NAME: &'static str = "record of shadows";
}

impl JsonLine for Timing {
    const FILE: &'static str = layout::TIMING;
    const NAME: &'static str = "timing";
}

impl JsonLine for Crash {
    const FILE: &'static str = layout::CRASHES;
    const NAME: &'static str = "crash";
}

/// The folder of one run. What lies in it is said by [`layout::FILES`].
///
/// Its methods are strict: they give all of a file or say what is wrong with it. [`Store`](super::Store)
/// reads leniently, as far as files are sound.
///
/// ```
/// use reports::schema::RunKey;
/// use reports::store::RunFolder;
///
/// let results = tempfile::tempdir().expect("a temporary folder");
/// let [environment, curriculum, variant] = ["MazeA", "teach", "default"].map(String::from);
/// let folder = RunFolder::of(results.path(), &RunKey { environment, curriculum, variant, seed: 0 });
/// std::fs::create_dir_all(folder.path()).expect("it can be created");
/// assert_eq!(folder.manifest().expect("it can be read"), None, "nothing has begun");
/// folder.note_crash(0, "killed by signal 9").expect("it can be written");
/// assert_eq!(folder.crashes().expect("sound lines")[0].reason, "killed by signal 9");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// The folder at `path`, wherever that is.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// The place of `run` in a results folder.
    pub fn of(results: &Path, run: &RunKey) -> Self {
        Self::new(layout::run_dir(results, run))
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of one of its files.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Whether one of its files is there, be it a link that leads nowhere.
    ///
    /// # Errors
    /// [`StoreError::Io`] if nobody can tell, as in a folder that may not be searched.
    pub fn has(&self, name: &str) -> Result<bool, StoreError> {
        let path = self.file(name);
        files::is_there(&path).map_err(StoreError::io(path, "look for this file"))
    }

    /// Whether one of its files is there and not empty.
    ///
    /// # Errors
    /// As [`RunFolder::has`].
    pub fn has_content(&self, name: &str) -> Result<bool, StoreError> {
        // What cannot be looked into counts as content: nobody knows that there is none.
        Ok(self.has(name)? && fs::metadata(self.file(name)).map_or(true, |file| file.len() > 0))
    }

    /// One of the files that a run leaves beside its manifest; `None` in a folder in which no run has begun.
    ///
    /// # Errors
    /// As [`RunFolder::has`].
    pub fn leftover(&self) -> Result<Option<&'static str>, StoreError> {
        for name in layout::FILES.iter().map(|row| row.name) {
            if ![layout::MANIFEST, layout::LOCK].contains(&name) && self.has(name)? {
                return Ok(Some(name));
            }
        }
        Ok(None)
    }

    /// The run whose place in a results folder this is; `None` if it lies elsewhere.
    pub fn key(&self) -> Option<RunKey> {
        layout::key_at(&self.path)
    }

    /// What the run is; `None` if it has not begun.
    ///
    /// # Errors
    /// [`StoreError`] if the file is not what was written.
    pub fn manifest(&self) -> Result<Option<Manifest>, StoreError> {
        read_json(&self.file(layout::MANIFEST))
    }

    /// How the run ended; `None` if it has not.
    ///
    /// # Errors
    /// [`StoreError`] if the file is not what was written.
    pub fn outcome(&self) -> Result<Option<Outcome>, StoreError> {
        read_json(&self.file(layout::OUTCOME))
    }

    /// Its evaluations, `[evaluations]`.
    ///
    /// # Errors
    /// [`StoreError`] naming the first line that is no evaluation.
    pub fn records(&self) -> Result<Vec<Record>, StoreError> {
        self.lines()
    }

    /// What its teacher did, `[evaluations]`.
    ///
    /// # Errors
    /// [`StoreError`] naming the first line that is not what the schema says.
    pub fn teaching(&self) -> Result<Vec<Teaching>, StoreError> {
        self.lines()
    }

    /// How its student's learning stood, `[evaluations]`.
    ///
    /// # Errors
    /// [`StoreError`] naming the first line that is not what the schema says.
    pub fn learning(&self) -> Result<Vec<Learning>, StoreError> {
        self.lines()
    }

    /// Its student's success at every goal of the pool, `[measures]`; none where none was asked for.
    ///
    /// # Errors
    /// [`StoreError`] naming the first line that is not what the schema says.
    pub fn frontier(&self) -> Result<Vec<Frontier>, StoreError> {
        self.lines()
    }

    /// What its shadows would have done, `[evaluations]`; none where no shadow watched.
    ///
    /// # Errors
    /// [`StoreError`] naming the first line that is not what the schema says.
    pub fn shadowing(&self) -> Result<Vec<Shadowing>, StoreError> {
        self.lines()
    }

    /// The time it took, `[evaluations]`.
    ///
    /// # Errors
    /// [`StoreError`] naming the first line that is not what the schema says.
    pub fn timings(&self) -> Result<Vec<Timing>, StoreError> {
        self.lines()
    }

    /// The workers that went away, in order.
    ///
    /// # Errors
    /// [`StoreError`] naming the first line that is not what the schema says.
    pub fn crashes(&self) -> Result<Vec<Crash>, StoreError> {
        self.lines()
    }

    /// Every line of the file of `T`; none where there is no such file.
    fn lines<T: JsonLine>(&self) -> Result<Vec<T>, StoreError> {
        let bytes = self.bytes(T::FILE)?.unwrap_or_default();
        let path = self.file(T::FILE);
        lines::parse(&bytes)
            .map(|(line, value)| value.map_err(|bad| bad.error(&path, line, T::NAME)))
            .collect()
    }

    /// The last complete line of the file of `T`, for onlookers: a line that is being written does not count
    /// yet. `None` if there is none, or it cannot be read.
    pub fn last<T: JsonLine>(&self) -> Option<T> {
        let bytes = files::read(&self.file(T::FILE)).ok()?;
        let complete = &bytes[..bytes.iter().rposition(|&byte| byte == b'\n')?];
        serde_json::from_slice(complete.rsplit(|&byte| byte == b'\n').next()?).ok()
    }

    /// The last crash, if no evaluation beyond it was recorded since; an old file does not tell, and counts.
    pub fn last_crash(&self) -> Option<Crash> {
        let crash: Crash = self.last()?;
        let recorded = self.last::<Record>().map(|record| record.step);
        crash.step.is_none_or(|step| recorded.is_none_or(|recorded| recorded <= step)).then_some(crash)
    }

    /// Notes that a worker went away, and after which training step: that of the last evaluation.
    ///
    /// # Errors
    /// [`StoreError`] if the file cannot be written.
    pub fn note_crash(&self, attempt: u32, reason: &str) -> Result<(), StoreError> {
        let step = self.last::<Record>().map_or(0, |record| record.step);
        let crash = Crash { attempt, step: Some(step), reason: reason.to_owned() };
        let mut line = serde_json::to_vec(&crash).expect("a crash is plain data");
        line.push(b'\n');
        let path = self.file(layout::CRASHES);
        let file = files::append(&path);
        file.and_then(|mut file| file.write_all(&line)).map_err(StoreError::io(path, "write this file"))
    }

    /// The bytes of one of its files; `None` if it is not there.
    ///
    /// # Errors
    /// [`StoreError::Io`] if it cannot be read.
    pub fn bytes(&self, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
        read_optional(&self.file(name))
    }

    /// SHA-256 of one of its files, in hex.
    ///
    /// # Errors
    /// [`StoreError::Io`] if it cannot be read, or is not there.
    pub fn sha256(&self, name: &str) -> Result<String, StoreError> {
        let path = self.file(name);
        let bytes = files::read(&path).map_err(StoreError::io(path, "read this file"))?;
        Ok(digest::sha256(&bytes))
    }

    /// Checks that this is the place of the run that `manifest`, read here, names.
    ///
    /// # Errors
    /// [`StoreError::Misplaced`].
    pub fn check_place(&self, manifest: &Manifest) -> Result<(), StoreError> {
        if self.key().as_ref() == Some(&manifest.run) {
            return Ok(());
        }
        Err(StoreError::Misplaced { path: self.file(layout::MANIFEST), found: manifest.run.clone() })
    }

    /// Removes every file that `lives` no longer, in the order of [`layout::FILES`].
    ///
    /// # Errors
    /// [`StoreError::Io`] if one of them cannot be removed.
    pub fn remove(&self, lives: Lives) -> Result<(), StoreError> {
        for row in layout::FILES.iter().filter(|row| row.lives == lives) {
            let path = self.file(row.name);
            let removed = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
            match removed {
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                removed => removed.map_err(StoreError::io(path, "remove this file"))?,
            }
        }
        Ok(())
    }

    /// Copies every file that a merge takes along to the new folder `to`.
    ///
    /// # Errors
    /// [`StoreError::Io`] naming the file or folder.
    pub fn copy_to(&self, to: &Path) -> Result<(), StoreError> {
        fs::create_dir_all(to).map_err(StoreError::io(to, "create this folder"))?;
        for row in layout::FILES.iter().filter(|row| row.merged) {
            if self.has(row.name)? {
                let from = self.file(row.name);
                copy(&from, &to.join(row.name)).map_err(StoreError::io(from, "copy this file"))?;
            }
        }
        Ok(())
    }
}

/// Copies a file, or a folder of files.
fn copy(from: &Path, to: &Path) -> io::Result<()> {
    if !from.is_dir() {
        return files::copy(from, to);
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        files::copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

/// Reads a JSON file; `None` if there is none.
///
/// # Errors
/// [`StoreError`] if it is something else than expected.
pub fn read_json<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, StoreError> {
    let Some(bytes) = read_optional(path)? else { return Ok(None) };
    let damaged = |source| StoreError::Json { path: path.to_owned(), source };
    serde_json::from_slice(&bytes).map(Some).map_err(damaged)
}

/// Reads a file that is written later or not at all.
fn read_optional(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match files::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        // A path that leads through a file is told when the folder is to be created.
        Err(error) if files::is_absent(&error) => Ok(None),
        Err(source) => Err(StoreError::Io { path: path.to_owned(), action: "read this file", source }),
    }
}
