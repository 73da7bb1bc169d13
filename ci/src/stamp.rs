//! The stamp of an unpacked part: what it was made from and every file in it, so that damage is found and
//! named.
//!
//! The stamp lies in the folder that it describes and is written last, before the folder is renamed into
//! place: a folder with a stamp is complete.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{self, ErrorKind, Write},
    path::Path,
};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::{
    error::{Result, doing},
    pins::Part,
};

/// Name of the stamp in the folder of a part.
pub(crate) const STAMP: &str = "stamp.json";

/// One file of a part.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FileRecord {
    pub(crate) bytes: u64,
    /// In lower-case hexadecimal.
    pub(crate) sha256: String,
}

/// What a part's folder holds. Paths are relative to that folder.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stamp {
    /// [`Part::recipe`] when it was made.
    pub(crate) recipe: Vec<String>,
    pub(crate) files: BTreeMap<String, FileRecord>,
    /// Symbolic links and their targets.
    pub(crate) links: BTreeMap<String, String>,
}

/// How closely a part is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Presence and size of every file.
    Sizes,
    /// The hash of every file as well.
    Hashes,
}

/// The state that a part was found in.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum State {
    Intact,
    Missing,
    /// Made from other pins than today's.
    Outdated,
    /// Says what is wrong.
    Damaged(String),
}

impl Stamp {
    /// Writes the stamp into the folder that it describes.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        let path = folder.join(STAMP);
        let text = serde_json::to_vec(self).map_err(|source| doing("write", &path)(source.into()))?;
        fs::write(&path, text).map_err(doing("write", &path))
    }

    /// Compares every file with its record; `None` when all is well, else the first difference.
    fn difference(&self, folder: &Path, depth: Depth) -> Option<String> {
        for (path, record) in &self.files {
            match fs::symlink_metadata(folder.join(path)) {
                Ok(found) if !found.is_file() => return Some(format!("{path} is no longer a file")),
                Ok(found) if found.len() != record.bytes => {
                    return Some(format!("{path} has {} bytes instead of {}", found.len(), record.bytes));
                }
                Ok(_) => (),
                Err(error) => return Some(trouble(path, &error)),
            }
            if depth == Depth::Hashes {
                match hash_file(&folder.join(path)) {
                    Ok(hash) if hash != record.sha256 => return Some(format!("{path} has changed")),
                    Ok(_) => (),
                    Err(error) => return Some(trouble(path, &error)),
                }
            }
        }
        self.links.iter().find_map(|(path, target)| match fs::read_link(folder.join(path)) {
            Ok(found) if found == Path::new(target) => None,
            Ok(found) => Some(format!("{path} links to {} instead of {target}", found.display())),
            Err(error) => Some(trouble(path, &error)),
        })
    }
}

/// Says why the system refused a path.
fn trouble(path: &str, error: &io::Error) -> String {
    if error.kind() == ErrorKind::NotFound {
        format!("{path} is missing")
    } else {
        format!("{path}: {error}")
    }
}

/// Looks at the folder of a part. Files that are not in the stamp do no harm and are left alone.
pub(crate) fn inspect(folder: &Path, part: &Part, depth: Depth) -> State {
    if !folder.exists() {
        return State::Missing;
    }
    let stamp: Stamp = match fs::read(folder.join(STAMP)).map(|text| serde_json::from_slice(&text)) {
        Ok(Ok(stamp)) => stamp,
        Ok(Err(error)) => return State::Damaged(format!("{STAMP}: {error}")),
        Err(error) => return State::Damaged(trouble(STAMP, &error)),
    };
    if stamp.recipe != part.recipe() {
        return State::Outdated;
    }
    stamp.difference(folder, depth).map_or(State::Intact, State::Damaged)
}

/// Passes on what is written, and hashes and counts it.
pub(crate) struct HashingWriter<W> {
    inner: W,
    hasher: Sha256,
    bytes: u64,
}

impl<W: Write> HashingWriter<W> {
    pub(crate) fn new(inner: W) -> Self {
        Self { inner, hasher: Sha256::new(), bytes: 0 }
    }

    /// The record of all that was written.
    pub(crate) fn finish(self) -> FileRecord {
        FileRecord { bytes: self.bytes, sha256: format!("{:x}", self.hasher.finalize()) }
    }
}

impl<W: Write> Write for HashingWriter<W> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(buffer)?;
        self.hasher.update(&buffer[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// The SHA-256 of a file, in lower-case hexadecimal.
pub(crate) fn hash_file(path: &Path) -> io::Result<String> {
    let mut writer = HashingWriter::new(io::sink());
    // A large buffer: the files are up to half a gigabyte.
    io::copy(&mut io::BufReader::with_capacity(1 << 20, File::open(path)?), &mut writer)?;
    Ok(writer.finish().sha256)
}
