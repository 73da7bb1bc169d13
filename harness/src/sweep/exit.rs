//! What the program's exit code says.

/// Exit codes. Scripts, job arrays and sweeps that start workers rely on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ExitCode {
    /// All is well.
    Success = 0,
    /// The work was done and something in it failed: a run, a check, the records that a report read. Of a
    /// worker: the machine failed it, another attempt may go better.
    Failed = 1,
    /// The input is wrong; nothing was done.
    WrongInput = 2,
    /// A signal stopped it; the same command goes on.
    Stopped = 3,
    /// Of a worker: another process is carrying out its run.
    Taken = 4,
}
