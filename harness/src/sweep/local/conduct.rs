//! How runs are carried out on this machine.

/// The program that this process was started from, even if another one has been built in its place since.
pub(super) const THIS_PROGRAM: &str = "/proc/self/exe";

/// How runs are carried out. None of it changes what they record.
#[derive(Clone, Copy, Debug)]
pub struct Conduct {
    /// Runs side by side.
    pub parallel: usize,
    /// How often a run whose worker crashed is begun again from its checkpoint.
    pub retries: u32,
    /// Whether each run keeps a TensorBoard event file.
    pub tensorboard: bool,
}
