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
    /// Workers side by side.
    pub workers: usize,
    /// Runs that a worker carries out in lockstep, at most.
    pub lanes: usize,
    /// Threads of a worker.
    pub threads: usize,
    /// Whether the two halves of a cohort take turns between cores and device.
    pub overlap: bool,
    /// How often a run whose worker crashed is begun again from its checkpoint.
    pub retries: u32,
    /// Whether each run keeps a TensorBoard event file.
    pub tensorboard: bool,
    /// Whether each run's replay buffer is removed when it finishes; it cannot be trained on then.
    pub discard_replay: bool,
}

impl Conduct {
    /// Workers of `lanes` runs that share `cores` threads, each with no more than it can use at once.
    pub fn share(cores: usize, lanes: usize) -> Self {
        let threads = lanes.clamp(1, cores.max(1));
        let workers = (cores / threads).max(1);
        let (lanes, retries) = (lanes.max(1), 0);
        let (overlap, tensorboard, discard_replay) = (false, false, false);
        Self { workers, lanes, threads, overlap, retries, tensorboard, discard_replay }
    }

    /// Runs at a time, of `open` that are to be done.
    pub fn at_a_time(&self, open: usize) -> usize {
        self.workers.saturating_mul(self.lanes).min(open.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::Conduct;

    #[test]
    fn workers_share_the_cores() {
        let shared = |cores, lanes| {
            let Conduct { workers, lanes, threads, .. } = Conduct::share(cores, lanes);
            [workers, lanes, threads]
        };
        assert_eq!(shared(16, 1), [16, 1, 1]);
        assert_eq!(shared(16, 5), [3, 5, 5]);
        assert_eq!(shared(16, 35), [1, 35, 16]);
        assert_eq!(shared(1, 8), [1, 8, 1]);
        assert_eq!(Conduct::share(4, 2).at_a_time(3), 3);
        assert_eq!(Conduct::share(4, 2).at_a_time(9), 4);
    }
}
