//! Holding a folder: a results folder for one sweep, a run's folder for one worker.

use std::fs::{self, File, TryLockError};
use std::io::ErrorKind;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use guard::files;
use reports::store::layout::LOCK;

use crate::error::HarnessError;

/// Holds a folder for one process. Released when dropped or when the process ends, however it ends.
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Creates the folder if need be and takes it.
    ///
    /// # Errors
    /// [`HarnessError::Locked`] if another process has it, [`HarnessError::Io`] if it cannot be written.
    pub fn take(folder: &Path) -> Result<Self, HarnessError> {
        loop {
            fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
            let path = folder.join(LOCK);
            let unusable = || HarnessError::io(&path, "lock this file");
            let file = files::update(&path).map_err(unusable())?;
            match file.try_lock() {
                // Whoever had it may have removed it, folder and all: then this is nobody's file any more.
                Ok(()) if file.metadata().map_err(unusable())?.nlink() == 0 => {}
                Ok(()) => return Ok(Self { _file: file }),
                Err(TryLockError::WouldBlock) => {
                    return Err(HarnessError::Locked { folder: folder.to_owned() });
                }
                Err(TryLockError::Error(source)) => return Err(unusable()(source)),
            }
        }
    }
}

/// Whether some process holds `folder`. Looking takes a shared lock for a moment, so that two processes that
/// look at the same time do not take each other for a holder.
///
/// # Errors
/// [`HarnessError::Io`] if nobody can tell, as in a folder that may not be searched.
pub fn is_locked(folder: &Path) -> Result<bool, HarnessError> {
    let path = folder.join(LOCK);
    match files::open(&path) {
        Ok(file) => Ok(matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock))),
        // Whoever takes a lock makes a file of it, and takes nothing else for one.
        Err(error) if files::is_absent(&error) || error.kind() == ErrorKind::InvalidData => Ok(false),
        Err(error) => Err(HarnessError::io(&path, "look at this lock")(error)),
    }
}
