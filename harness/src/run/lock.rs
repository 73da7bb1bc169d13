//! Holding a folder: a results folder for one sweep, a run's folder for one worker.

use std::fs::{self, TryLockError};
use std::path::Path;

use crate::error::HarnessError;

/// Name of the file that a [`Lock`] is on.
const LOCK: &str = ".lock";

/// Holds a folder for one process. Released when dropped or when the process ends, however it ends.
pub struct Lock {
    _file: fs::File,
}

impl Lock {
    /// Creates the folder if need be and takes it.
    ///
    /// # Errors
    /// [`HarnessError::Locked`] if another process has it, [`HarnessError::Io`] if it cannot be written.
    pub fn take(folder: &Path) -> Result<Self, HarnessError> {
        fs::create_dir_all(folder).map_err(HarnessError::io(folder, "create this folder"))?;
        let path = folder.join(LOCK);
        let file = fs::File::create(&path).map_err(HarnessError::io(folder, "write in this folder"))?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => Err(HarnessError::Locked { folder: folder.to_owned() }),
            Err(TryLockError::Error(source)) => {
                Err(HarnessError::Io { path, action: "lock this file", source })
            }
        }
    }
}

/// Whether some process holds `folder`. Looking takes a shared lock for a moment, so that two processes that
/// look at the same time do not take each other for a holder.
pub fn is_locked(folder: &Path) -> bool {
    fs::File::open(folder.join(LOCK))
        .is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}
