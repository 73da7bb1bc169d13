//! Whether the device that runs ask for can be used on this machine.

use std::process::{Command, Stdio};

use super::conduct::this_program;
use crate::error::{HarnessError, chain};
use crate::sweep::event::{Event, Told};
use crate::sweep::exit::ExitCode;
use crate::sweep::job::Job;

/// Refuses jobs for a device that is not usable here.
///
/// # Errors
/// [`HarnessError::Device`] saying what is missing.
pub(in crate::sweep) fn check<'a>(mut jobs: impl Iterator<Item = &'a Job>) -> Result<(), HarnessError> {
    if jobs.all(|job| job.config.student.device == agents::Device::Cpu) {
        return Ok(());
    }
    try_out()
}

/// Whether students can live on a GPU here.
///
/// A process of its own tries the device: a GPU's driver holds memory for every process that has ever used
/// it, and this one may live for days.
///
/// # Errors
/// [`HarnessError::Device`] saying what is missing.
pub fn try_out() -> Result<(), HarnessError> {
    let program = this_program()?;
    let output = Command::new(program)
        .arg("try-cuda")
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(HarnessError::io(program, "run this program"))?;
    if output.status.success() {
        return Ok(());
    }
    let refusal = output.stdout.split(|&byte| byte == b'\n').find_map(|line| {
        let Told { event: Event::Refused { reason }, .. } = serde_json::from_slice(line).ok()? else {
            return None;
        };
        Some(reason)
    });
    let ended = || format!("it was tried out and the program ended ({})", output.status);
    Err(HarnessError::Device { reason: refusal.unwrap_or_else(ended) })
}

/// What `goalbench try-cuda` does: opens the device, and says as an event why it cannot.
///
/// # Errors
/// [`HarnessError::System`] if nobody listens.
pub fn try_cuda() -> Result<ExitCode, HarnessError> {
    let Err(error) = agents::Device::Cuda.open() else { return Ok(ExitCode::Success) };
    let told = Told::of_all(Event::Refused { reason: chain(&error) });
    told.send().map_err(HarnessError::system("tell the sweep"))?;
    Ok(ExitCode::WrongInput)
}
