//! How many runs go through their cycles in lockstep.

use std::process::Command;
use std::str::FromStr;

use agents::Device;
use reports::wording::counted;

use super::job::Job;
use crate::Registry;
use crate::error::HarnessError;
use crate::memory;

/// What a user says about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lanes {
    /// One on a CPU, where a core is busy with one run; on a GPU as many as fit its memory.
    Auto,
    /// So many, at most.
    Number(usize),
}

/// More lanes than this are a slip of the keyboard.
const MOST: usize = 1000;

impl FromStr for Lanes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        match text.parse() {
            Ok(number) if (1..=MOST).contains(&number) => Ok(Self::Number(number)),
            _ => Err(format!("`auto` or a whole number from 1 to {MOST} accepted")),
        }
    }
}

/// Lanes for the runs of a sweep, and what is to be said about them before they start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decided {
    /// Runs in lockstep, at most.
    pub lanes: usize,
    /// Whether any run needs a GPU.
    pub gpu: bool,
    /// A line about the GPU's memory.
    pub note: Option<String>,
}

impl Lanes {
    /// Decides for `open` runs, on this machine with so many threads or, where they are carried out
    /// `elsewhere`, for another.
    ///
    /// # Errors
    /// [`HarnessError::Argument`] if a number is needed that cannot be found out.
    pub fn decide<'a>(
        self,
        registry: &Registry,
        open: impl Iterator<Item = &'a Job>,
        elsewhere: bool,
        threads: usize,
    ) -> Result<Decided, HarnessError> {
        let on_gpu: Vec<&Job> = open.filter(|job| job.config.student.device == Device::Cuda).collect();
        let gpu = !on_gpu.is_empty();
        let decided = |lanes| Decided { lanes, gpu, note: None };
        match self {
            Self::Number(lanes) if !gpu || elsewhere => Ok(decided(lanes)),
            Self::Auto if !gpu => Ok(decided(1)),
            Self::Auto if elsewhere => {
                Err(refused("the memory of another machine's GPU cannot be seen here"))
            }
            _ => self.on_gpu(&sizes(registry, &on_gpu, threads), free_memory()),
        }
    }

    /// Decides for runs that take these numbers of bytes on the GPU and on the host, each the most of any.
    fn on_gpu(self, sizes: &Sizes, free: Result<u64, String>) -> Result<Decided, HarnessError> {
        let gigabytes = |bytes: u64| format!("{:.1} GB", bytes as f64 / 1e9);
        let fit = |room: u64, fixed: u64, each: u64| {
            usize::try_from(room.saturating_sub(fixed) / each.max(1)).unwrap_or(usize::MAX)
        };
        let takes = |lanes: usize| sizes.gpu_besides.saturating_add(sizes.gpu.saturating_mul(lanes as u64));
        let lanes = match (self, &free) {
            (Self::Number(lanes), _) => lanes,
            (Self::Auto, Err(reason)) => return Err(refused(reason)),
            (Self::Auto, Ok(free)) => {
                // A tenth stays free: libtorch keeps what it no longer needs for a while.
                let there = fit(free / 10 * 9, sizes.gpu_besides, sizes.gpu);
                let here = sizes.host_free.map_or(usize::MAX, |room| fit(room, 0, sizes.host));
                there.min(here).min(sizes.runs)
            }
        };
        if lanes == 0 {
            let free = free.map_or_else(|reason| reason, gigabytes);
            let needed = gigabytes(takes(1));
            return Err(refused(&format!(
                "not even one run fits: {needed} of the GPU's memory, {free} free"
            )));
        }
        let of = free.map_or_else(
            |reason| format!("the GPU's memory ({reason})"),
            |free| format!("the GPU's {} that are free", gigabytes(free)),
        );
        let note =
            format!("{} in lockstep take about {} of {of}", counted(lanes, "run"), gigabytes(takes(lanes)));
        Ok(Decided { lanes, gpu: true, note: Some(note) })
    }
}

impl Decided {
    /// Refuses `--overlap` where there is no cohort to halve.
    ///
    /// # Errors
    /// [`HarnessError::Argument`] for a single lane.
    pub fn check_overlap(&self) -> Result<(), HarnessError> {
        if self.lanes > 1 {
            return Ok(());
        }
        let reason =
            "two halves of a cohort take turns, and here every run goes alone; give --lanes 2 or more, too";
        Err(HarnessError::Argument { option: "--overlap", reason: reason.to_owned() })
    }
}

fn refused(reason: &str) -> HarnessError {
    HarnessError::Argument { option: "--lanes", reason: format!("give a number: {reason}") }
}

/// Bytes that a run takes, the most of any.
struct Sizes {
    gpu: u64,
    /// Bytes of the GPU that the process takes besides.
    gpu_besides: u64,
    host: u64,
    host_free: Option<u64>,
    runs: usize,
}

fn sizes(registry: &Registry, jobs: &[&Job], threads: usize) -> Sizes {
    let most = |of: &dyn Fn(&Job, &envs::Spec) -> u64| {
        let sizes =
            jobs.iter().filter_map(|job| Some(of(job, &registry.environment(&job.run().environment)?.spec)));
        sizes.max().unwrap_or(0)
    };
    Sizes {
        gpu: most(&|job, spec| memory::on_gpu(&job.config, spec)),
        gpu_besides: memory::on_gpu_besides(threads),
        host: most(&|job, spec| memory::of_run(&job.config, spec)),
        host_free: memory::available(),
        runs: jobs.len(),
    }
}

/// Free bytes of the first GPU, as its driver's own tool tells them; or why it does not.
fn free_memory() -> Result<u64, String> {
    let mut command = Command::new("nvidia-smi");
    command.args(["--query-gpu=memory.free", "--format=csv,noheader,nounits"]);
    // Students live on the first of those that this process may see.
    let visible = std::env::var("CUDA_VISIBLE_DEVICES").unwrap_or_default();
    let first = visible.split(',').next().map(str::trim).filter(|first| !first.is_empty());
    command.args(first.map(|first| format!("--id={first}")));
    let output = command.output().map_err(|error| format!("nvidia-smi cannot be asked: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    mebibytes(&text).ok_or_else(|| format!("nvidia-smi does not tell its memory ({})", output.status))
}

/// Bytes from the first line of nvidia-smi's answer.
fn mebibytes(text: &str) -> Option<u64> {
    text.lines().next()?.trim().parse::<u64>().ok()?.checked_mul(1 << 20)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_or_auto_is_read() {
        assert_eq!("auto".parse(), Ok(Lanes::Auto));
        assert_eq!("35".parse(), Ok(Lanes::Number(35)));
        for wrong in ["0", "-1", "many", "1001", ""] {
            assert!(wrong.parse::<Lanes>().is_err_and(|said| said.contains("accepted")), "{wrong}");
        }
    }

    fn sizes(gpu: u64, host: u64, host_free: Option<u64>) -> Sizes {
        Sizes { gpu, gpu_besides: 1_000_000_000, host, host_free, runs: 35 }
    }

    #[test]
    fn as_many_as_fit_both_memories() {
        let lanes = |gpu: u64, host: u64, free: u64| {
            let decided = Lanes::Auto.on_gpu(&sizes(gpu, host, Some(10_000_000_000)), Ok(free));
            decided.map(|decided| decided.lanes)
        };
        assert_eq!(lanes(100_000_000, 1, 80_000_000_000).ok(), Some(35), "no more than there are");
        assert_eq!(
            lanes(1_000_000_000, 1, 10_000_000_000).ok(),
            Some(8),
            "1 GB for the process, a tenth left free"
        );
        assert_eq!(lanes(100_000_000, 2_000_000_000, 80_000_000_000).ok(), Some(5), "the host's memory");
        let none = lanes(10_000_000_000, 1, 2_000_000_000).expect_err("too large").to_string();
        assert!(none.contains("not even one run fits: 11.0 GB"), "{none}");
    }

    #[test]
    fn what_is_decided_is_told_and_what_cannot_be_is_asked_for() {
        let some = &sizes(100_000_000, 1, None);
        let note = Lanes::Number(20).on_gpu(some, Ok(8_000_000_000)).expect("a number").note;
        let expected = "20 runs in lockstep take about 3.0 GB of the GPU's 8.0 GB that are free";
        assert_eq!(note.as_deref(), Some(expected));
        let silent = || Err("nvidia-smi cannot be asked".to_owned());
        assert!(Lanes::Number(20).on_gpu(some, silent()).is_ok());
        let asked = Lanes::Auto.on_gpu(some, silent()).expect_err("unknown").to_string();
        assert!(asked.contains("give a number"), "{asked}");
    }

    #[test]
    fn the_tools_answer_is_read() {
        assert_eq!(mebibytes("81038\n40000\n"), Some(81_038 << 20));
        assert_eq!(mebibytes("[N/A]\n"), None);
    }

    #[test]
    fn on_a_cpu_a_run_goes_alone_unless_told_otherwise() {
        let registry = Registry::builtin();
        let decide =
            |lanes: Lanes| lanes.decide(&registry, std::iter::empty(), false, 1).expect("no GPU").lanes;
        assert_eq!((decide(Lanes::Auto), decide(Lanes::Number(8))), (1, 8));
    }
}
