//! The loaded libmujoco: its version, and its habit of logging into the current folder.

use std::ffi::c_char;
use std::sync::Once;

use crate::error::EnvError;

/// The version on which the environments reproduce the reference bit for bit.
pub const VERSION: &str = "3.3.7";

/// Checks the library before its first use and silences its log file.
///
/// # Errors
/// [`EnvError::MujocoVersion`] if another version than [`VERSION`] is loaded.
pub(crate) fn prepare() -> Result<(), EnvError> {
    check_version(mujoco_rs::get_mujoco_version())?;
    static SILENCE: Once = Once::new();
    SILENCE.call_once(silence_warnings);
    Ok(())
}

fn check_version(loaded: &str) -> Result<(), EnvError> {
    if loaded == VERSION {
        return Ok(());
    }
    Err(EnvError::MujocoVersion { loaded: loaded.to_owned(), expected: VERSION })
}

/// Replaces MuJoCo's default warning handler, which appends to MUJOCO_LOG.TXT in the current folder. Nothing
/// is lost: each warning is also counted in the simulation's data, where [`super::Sim`] looks for it.
#[allow(unsafe_code, reason = "the handler is a mutable C global without a safe wrapper")]
fn silence_warnings() {
    unsafe extern "C" fn ignore(_message: *const c_char) {}
    // SAFETY: called once, before this crate's first call that can warn; the handler touches nothing.
    unsafe { mujoco_rs::mujoco_c::mju_user_warning = Some(ignore) };
}

#[cfg(test)]
mod tests {
    use super::{check_version, prepare};

    #[test]
    fn only_the_version_that_was_checked_is_accepted() {
        assert!(prepare().is_ok());
        let error = check_version("3.4.0").unwrap_err().to_string();
        assert_eq!(error, "libmujoco 3.4.0 is loaded, 3.3.7 is needed; `cargo setup` restores it");
    }
}
