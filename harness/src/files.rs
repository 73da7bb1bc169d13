//! Files that appear whole or not at all.

use std::fs::File;
use std::path::Path;

pub(crate) use guard::fresh::file as new_file;
use guard::fresh::write_through;
use serde::Serialize;

/// Sees the file at `path` through to the disk.
///
/// # Errors
/// If the system cannot.
pub(crate) fn sync(path: &Path) -> std::io::Result<()> {
    File::open(path)?.sync_all()
}

/// Writes `value` as pretty JSON, whole or not at all.
///
/// # Errors
/// If it cannot be written.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> std::io::Result<()> {
    write_through(path, &json(value)?)
}

/// The bytes that [`write_json`] writes.
///
/// # Errors
/// If `value` has no form in JSON.
pub(crate) fn json(value: &impl Serialize) -> std::io::Result<Vec<u8>> {
    let mut text = serde_json::to_vec_pretty(value)?;
    text.push(b'\n');
    Ok(text)
}
