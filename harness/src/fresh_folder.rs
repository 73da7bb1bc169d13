//! Folders that appear complete or not at all.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use reports::store::layout;
use tempfile::TempDir;

use crate::error::HarnessError;
use crate::outputs;
use crate::run::lock::Lock;

/// What such a folder holds, by which leftovers of killed processes are known.
pub(crate) struct FolderKind {
    /// What its name begins with until it is complete.
    pub(crate) prefix: &'static str,
    /// The names that lie in it.
    pub(crate) holds: &'static [&'static str],
}

/// Characters after the prefix, which no two folders share.
const RANDOM: usize = 12;

/// A folder beside the place where it belongs. Dropped without [`FreshFolder::put`], it is removed.
pub(crate) struct FreshFolder {
    folder: TempDir,
    /// Held as a sweep holds its results, so that nobody takes it for abandoned.
    _lock: Lock,
    /// Dropped after the folder, which lies in them.
    above: MadeFolders,
}

/// Folders that were made for one below them, the deepest first. Dropped, those that are empty are removed.
struct MadeFolders(Vec<PathBuf>);

impl MadeFolders {
    /// Makes `folder` and those above it that are not there.
    fn make(folder: &Path) -> Result<Self, HarnessError> {
        let missing = folder.ancestors().take_while(|above| !above.as_os_str().is_empty() && !above.exists());
        let made = Self(missing.map(Path::to_owned).collect());
        fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
        Ok(made)
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        // One that somebody else has put something into stays.
        self.0.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

impl FreshFolder {
    /// A new folder that will belong at `out`; the folders above are made, to be removed again if it does not
    /// come to lie there, and what killed processes left of
    /// others of its kind is removed.
    ///
    /// # Errors
    /// [`HarnessError::Exists`] if something lies at `out`, [`HarnessError::Io`] if it cannot be made.
    pub(crate) fn beside(out: &Path, kind: &FolderKind) -> Result<Self, HarnessError> {
        refuse_existing(out)?;
        let parent = outputs::folder_of(out);
        let above = MadeFolders::make(parent)?;
        sweep(parent, kind);
        Self::within(parent, kind, 0o777, above)
    }

    /// A new folder for the time being among the system's temporary ones, from which what killed processes
    /// left of others of its kind is removed.
    ///
    /// # Errors
    /// [`HarnessError::Io`] if it cannot be made.
    pub(crate) fn temporary(kind: &FolderKind) -> Result<Self, HarnessError> {
        let parent = std::env::temp_dir();
        sweep(&parent, kind);
        Self::within(&parent, kind, 0o700, MadeFolders(Vec::new()))
    }

    fn within(parent: &Path, kind: &FolderKind, mode: u32, above: MadeFolders) -> Result<Self, HarnessError> {
        let folder = tempfile::Builder::new()
            .prefix(kind.prefix)
            .rand_bytes(RANDOM)
            .permissions(Permissions::from_mode(mode))
            .tempdir_in(parent)
            .map_err(HarnessError::io(parent, "write in this folder"))?;
        Ok(Self { _lock: Lock::take(folder.path())?, folder, above })
    }

    /// Where it lies until it is complete.
    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Renames the complete folder to `out`.
    ///
    /// # Errors
    /// [`HarnessError::Exists`] if something has come to lie there, [`HarnessError::Io`].
    pub(crate) fn put(mut self, out: &Path) -> Result<(), HarnessError> {
        refuse_existing(out)?;
        fs::rename(self.path(), out).map_err(HarnessError::io(out, "create this folder"))?;
        self.above.0.clear();
        // Renamed away: there is nothing left for the guard to remove.
        let _ = self.folder.keep();
        Ok(())
    }
}

/// # Errors
/// [`HarnessError::Exists`] if anything lies at `out`, a broken link included.
pub(crate) fn refuse_existing(out: &Path) -> Result<(), HarnessError> {
    match out.symlink_metadata() {
        Ok(_) => Err(HarnessError::Exists { folder: out.to_owned() }),
        Err(_) => Ok(()),
    }
}

/// Removes from `parent` what killed processes left behind: folders with the name and content of `kind` that
/// nobody holds. What cannot be removed stays; it does no harm.
fn sweep(parent: &Path, kind: &FolderKind) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(kind.prefix)).unwrap_or_default();
        let is_named = random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric());
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_named
            && is_folder
            && holds_nothing_else(&entry.path(), kind)
            && let Ok(_lock) = Lock::take(&entry.path())
        {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

fn holds_nothing_else(folder: &Path, kind: &FolderKind) -> bool {
    let is_ours = |name: &str| name == layout::LOCK || kind.holds.contains(&name);
    fs::read_dir(folder).is_ok_and(|mut entries| {
        entries.all(|entry| entry.is_ok_and(|entry| entry.file_name().to_str().is_some_and(is_ours)))
    })
}
