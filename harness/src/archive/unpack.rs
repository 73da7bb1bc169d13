//! From an archive to a results folder, trusting nothing.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use guard::files;
use guard::text::in_line;
use reports::store::{Store, layout};
use tar::{Entry, EntryType};

use super::member::{Member, TIDY, member};
use super::problem::ArchiveProblem;
use super::sums::{self, Summing, Sums};
use super::{CARD, MOST_BYTES, MOST_FILES, POLICIES, ROOT, SUMS};
use crate::error::HarnessError;
use crate::fresh_folder::{FolderKind, FreshFolder};

/// The results in an archive.
pub struct Unpacked {
    /// Its runs.
    pub store: Store,
    /// SHA-256 of the archive, in hex.
    pub sha256: String,
}

/// Bytes that an archive may unpack to for each of its own, and beside them: records shrink to a thirtieth.
const MOST_GROWTH: u64 = 500;
const ALWAYS_ALLOWED: u64 = 16 << 20;
/// What errors say was tried.
const USE: &str = "use this archive";
/// Most bytes of the list of checksums.
const MOST_OF_SUMS: u64 = 64 << 20;

/// What is unpacked, by which leftovers of killed processes are known.
const KIND: FolderKind = FolderKind {
    prefix: ".goalbench-unpack-",
    holds: &["runs", "protocols", POLICIES, layout::TUNING, CARD, SUMS, TIDY[0], TIDY[1]],
};

/// Which files of an archive are put into a folder. All are checked.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    /// Those that are read as part of a results folder.
    Results,
    All,
}

/// Reads the archive at `path`. Everything in it is checked before anything is used: the names and kinds of
/// its entries, their number and size, the checksum of each, and then the runs as those of any results
/// folder. It is unpacked into a temporary folder that is gone afterwards.
///
/// # Errors
/// [`HarnessError::Unusable`] with an [`ArchiveProblem`]; [`HarnessError::Io`] if no temporary folder can be
/// made for it.
pub fn unpack(path: &Path) -> Result<Unpacked, HarnessError> {
    let folder = FreshFolder::temporary(&KIND)?;
    checked(path, folder.path(), Wanted::Results)
}

/// Unpacks the archive at `path` into the new results folder `out`, which appears complete or not at all. It
/// is checked as [`unpack`] does.
///
/// # Errors
/// As [`unpack`]; [`HarnessError::Exists`] if something lies at `out`, [`HarnessError::Io`] if it cannot be
/// written.
pub fn unpack_to(path: &Path, out: &Path) -> Result<Unpacked, HarnessError> {
    let folder = FreshFolder::beside(out, &KIND)?;
    let unpacked = checked(path, folder.path(), Wanted::All)?;
    folder.put(out)?;
    Ok(unpacked)
}

/// Puts what is wanted of the archive at `path` into `folder`, and checks all of it.
fn checked(path: &Path, folder: &Path, wanted: Wanted) -> Result<Unpacked, HarnessError> {
    let refused = |problem: ArchiveProblem| match problem {
        ArchiveProblem::Unwritable { path, source } => HarnessError::io(path, "write this file")(source),
        problem => HarnessError::unusable(path.display(), USE)(problem),
    };
    let file = files::open(path).map_err(HarnessError::io(path, "read this file"))?;
    let sha256 = read(file, folder, wanted).map_err(refused)?;
    if !layout::runs_dir(folder).is_dir() {
        return Err(refused(ArchiveProblem::Empty));
    }
    let store = Store::read(folder).map_err(HarnessError::unusable(path.display(), USE))?;
    let (_, of_choice) = reports::store::tuning(folder);
    if let Some(problem) = store.damages().chain(&of_choice).next() {
        return Err(refused(ArchiveProblem::Damaged(problem.to_string())));
    }
    Ok(Unpacked { store, sha256 })
}

/// Puts what is wanted of `file` into `folder`. Gives the archive's checksum.
fn read(mut file: File, folder: &Path, wanted: Wanted) -> Result<String, ArchiveProblem> {
    let (sha256, size) = sums::of(&mut file)?;
    file.seek(SeekFrom::Start(0))?;
    let most = size.saturating_mul(MOST_GROWTH).saturating_add(ALWAYS_ALLOWED).min(MOST_BYTES);
    let mut limited = Limited { inner: zstd::Decoder::new(file)?, left: most };
    let outcome = entries(&mut limited, folder, wanted);
    // What a limit ends looks like damage to whoever reads.
    if limited.left == 0 {
        return Err(ArchiveProblem::TooLarge(most));
    }
    outcome.map(|()| sha256)
}

fn entries(reader: &mut impl Read, folder: &Path, wanted: Wanted) -> Result<(), ArchiveProblem> {
    let mut archive = tar::Archive::new(&mut *reader);
    let mut listed: Option<Sums> = None;
    let mut seen = BTreeSet::new();
    // Raw: names and sizes of extension headers would come from the archive without a limit.
    for entry in archive.entries()?.raw(true) {
        let mut entry = entry?;
        let (name, kind) = name_of(&entry)?;
        let wrong = |reason| ArchiveProblem::Entry { name: name.clone(), reason };
        if !seen.insert(name.clone()) {
            return Err(wrong("is there twice"));
        }
        if seen.len() > MOST_FILES {
            return Err(ArchiveProblem::TooMany(MOST_FILES));
        }
        let Some(sums) = &listed else {
            if kind != Member::Sums {
                return Err(wrong("stands where the list of checksums belongs"));
            }
            let text = list(&mut entry)?;
            if wanted == Wanted::All {
                place(&mut text.as_bytes(), &folder.join(&name))?;
            }
            listed = Some(sums::parse(&text)?);
            continue;
        };
        let expected = sums.get(&name).ok_or_else(|| wrong("is not in the list of checksums"))?;
        let sum = if kind == Member::Results || wanted == Wanted::All {
            place(&mut entry, &folder.join(&name))?
        } else {
            sums::of(&mut entry)?.0
        };
        if sum != *expected {
            return Err(ArchiveProblem::Checksum { name });
        }
    }
    padding(reader)?;
    let sums = listed.ok_or_else(|| ArchiveProblem::Lacking(SUMS.to_owned()))?;
    match sums.keys().find(|name| !seen.contains(*name)) {
        Some(name) => Err(ArchiveProblem::Lacking(in_line(name).into_owned())),
        None => Ok(()),
    }
}

/// Reads what follows the last entry, to the end, where zstd has a checksum of its own.
fn padding(reader: &mut impl Read) -> Result<(), ArchiveProblem> {
    let mut bytes = [0; 8192];
    loop {
        match reader.read(&mut bytes)? {
            0 => return Ok(()),
            count if bytes[..count].iter().all(|&byte| byte == 0) => {}
            _ => return Err(ArchiveProblem::After),
        }
    }
}

/// The name of an entry below the archive's folder, and what it is.
fn name_of(entry: &Entry<'_, impl Read>) -> Result<(String, Member), ArchiveProblem> {
    let path = entry.path_bytes();
    let told = in_line(&String::from_utf8_lossy(&path)).into_owned();
    let wrong = |reason| ArchiveProblem::Entry { name: told.clone(), reason };
    if entry.header().entry_type() != EntryType::Regular {
        return Err(wrong("is no regular file, and no archive of results has anything else"));
    }
    let name = std::str::from_utf8(&path).ok().and_then(|path| path.strip_prefix(ROOT)?.strip_prefix('/'));
    let found = name.and_then(|name| Some((name.to_owned(), member(name)?)));
    found.ok_or_else(|| wrong("is none of the files that archives of results have"))
}

/// The text of the list of checksums.
fn list(entry: &mut impl Read) -> io::Result<String> {
    let mut text = String::new();
    entry.take(MOST_OF_SUMS).read_to_string(&mut text)?;
    Ok(text)
}

/// Writes a file where nothing lies yet. Gives its checksum.
fn place(entry: &mut impl Read, path: &Path) -> Result<String, ArchiveProblem> {
    let unwritable = |source| ArchiveProblem::Unwritable { path: path.to_owned(), source };
    fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).map_err(unwritable)?;
    let mut file = Summing::new(File::create_new(path).map_err(unwritable)?);
    // Not `io::copy`, whose error does not tell a damaged archive from a full disk.
    let mut bytes = [0; 1 << 16];
    loop {
        match entry.read(&mut bytes)? {
            0 => break,
            count => file.write_all(&bytes[..count]).map_err(unwritable)?,
        }
    }
    file.flush().map_err(unwritable)?;
    Ok(file.sum())
}

/// Gives no more than `left` bytes, as if the end had come.
struct Limited<R> {
    inner: R,
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let most = usize::try_from(self.left).unwrap_or(usize::MAX).min(bytes.len());
        let count = self.inner.read(&mut bytes[..most])?;
        self.left -= count as u64;
        Ok(count)
    }
}
