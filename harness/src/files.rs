//! Files that appear whole or not at all.

use std::path::Path;

pub(crate) use guard::fresh::file as new_file;
use guard::fresh::write_through;
use serde::Serialize;

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
