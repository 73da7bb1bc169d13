//! Whether the device that a plan asks for can be used here: asked before anything is written.

use std::process::{Command, ExitCode, Stdio};

use crate::cli::Exit;
use crate::error::HarnessError;
use crate::executor::Job;
use crate::protocol::plan::Plan;
use crate::run::folder::State;

/// Refuses a plan with runs to be done on a device that is not usable on this machine.
///
/// Another process tries it out, because a GPU's driver keeps memory for every process that has asked it anything.
///
/// # Errors
/// [`HarnessError::Argument`] saying what is missing.
pub(super) fn check(plan: &Plan, jobs: &[Job]) -> Result<(), HarnessError> {
    let open = plan.runs.iter().zip(jobs).filter(|(_, job)| !matches!(job.state, State::Ended(_)));
    if open.into_iter().all(|(run, _)| run.config.student.device == agents::Device::Cpu) {
        return Ok(());
    }
    let program = std::env::current_exe().map_err(HarnessError::io("goalbench", "find this program"))?;
    let output = Command::new(&program)
        .arg("try-cuda")
        .stdin(Stdio::null())
        .output()
        .map_err(HarnessError::io(program, "run this program"))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    // The driver may have said something before.
    let last = said.trim().lines().last().unwrap_or("it was tried out and the program ended").to_owned();
    let reason = last.strip_prefix("goalbench: --device: ").unwrap_or(&last).to_owned();
    Err(HarnessError::Argument { option: "--device", reason })
}

/// `goalbench try-cuda`.
pub(in crate::cli) fn try_cuda() -> Exit {
    let unusable =
        |error: agents::AgentError| HarnessError::Argument { option: "--device", reason: error.to_string() };
    agents::Device::Cuda.open().map_err(unusable)?;
    Ok(ExitCode::SUCCESS)
}
