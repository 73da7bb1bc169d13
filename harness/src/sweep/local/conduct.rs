//! How runs are carried out on this machine.

use crate::error::HarnessError;

/// Where Linux keeps the program that a process was started from.
const THIS_PROGRAM: &str = "/proc/self/exe";

/// The program that this process was started from, even if another one has been built in its place since.
///
/// # Errors
/// [`HarnessError::Io`] where there is no `/proc`.
pub(in crate::sweep) fn this_program() -> Result<&'static str, HarnessError> {
    let action = "start this program a second time (goalbench needs /proc to be mounted)";
    std::fs::metadata(THIS_PROGRAM).map_err(HarnessError::io(THIS_PROGRAM, action))?;
    Ok(THIS_PROGRAM)
}

/// How runs are carried out. None of it changes what they record.
#[derive(Clone, Copy, Debug)]
pub struct Conduct {
    /// Runs side by side.
    pub parallel: usize,
    /// How often a run whose worker crashed is begun again from its checkpoint.
    pub retries: u32,
    /// Whether each run keeps a TensorBoard event file.
    pub tensorboard: bool,
    /// Whether each run's replay buffer is removed when it finishes; it cannot be trained on then.
    pub discard_replay: bool,
}
