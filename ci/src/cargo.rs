//! Runs cargo and, through it, goalbench. Both print to the terminal themselves.

use std::{
    env,
    ffi::{OsStr, OsString},
    os::unix::process::ExitStatusExt,
    path::Path,
    process::Command,
};

use crate::{
    console::step,
    error::{Error, Result},
};

/// How a command ended: its exit code, 0 when all went well.
pub(crate) type Code = u8;

/// Builds the program and has it train and draw its small comparison, with `extra` arguments.
pub(crate) fn quickstart(project: &Path, extra: &[OsString]) -> Result<Code> {
    step("quickstart", "building goalbench (the first time takes some minutes)");
    let code = build(project)?;
    if code != 0 {
        return Ok(code);
    }
    let words: Vec<&OsStr> =
        std::iter::once(OsStr::new("quickstart")).chain(extra.iter().map(OsString::as_os_str)).collect();
    let shown: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
    step("quickstart", &format!("goalbench {}", shown.join(" ")));
    goalbench(project, &words)
}

/// Builds the program.
pub(crate) fn build(project: &Path) -> Result<Code> {
    cargo(project, ["build", "--release", "--package", "goalbench"])
}

/// Runs every test of the workspace, with `extra` arguments for `cargo test`.
pub(crate) fn selftest(project: &Path, extra: &[OsString]) -> Result<Code> {
    let all = ["test", "--release", "--workspace"].map(OsStr::new);
    cargo(project, all.into_iter().chain(extra.iter().map(OsString::as_os_str)))
}

/// Runs the program that `cargo build` has just built, wherever the user's target folder is.
fn goalbench(project: &Path, arguments: &[&OsStr]) -> Result<Code> {
    let run =
        ["run", "--quiet", "--release", "--package", "goalbench", "--bin", "goalbench", "--"].map(OsStr::new);
    cargo(project, run.into_iter().chain(arguments.iter().copied()))
}

/// Runs cargo in the project folder and waits for it. Started in there, cargo reads the project's
/// configuration.
fn cargo<I>(project: &Path, arguments: I) -> Result<Code>
where
    I: IntoIterator,
    I::Item: AsRef<OsStr>,
{
    let program = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(&program);
    command.args(arguments).current_dir(project);
    let status = command
        .status()
        .map_err(|source| Error::Start { command: program.to_string_lossy().into_owned(), source })?;
    Ok(match (status.code(), status.signal()) {
        (Some(code), _) => u8::try_from(code).unwrap_or(1),
        // As shells report a child that a signal ended.
        (None, signal) => 128 + signal.and_then(|number| u8::try_from(number).ok()).unwrap_or(0),
    })
}
