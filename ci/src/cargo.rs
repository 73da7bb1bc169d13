//! Runs cargo and, through it, goalbench. Both print to the terminal themselves.

use std::{
    env,
    ffi::{OsStr, OsString},
    os::unix::process::ExitStatusExt,
    path::{Path, PathBuf},
    process::Command,
};

use crate::{
    console::step,
    error::{Error, Result},
};

/// How a command ended: its exit code, 0 when all went well.
pub(crate) type Code = u8;

/// Where quickstart's results go, relative to the project folder, unless `--out` says otherwise.
const QUICKSTART_RESULTS: &str = "results/quickstart";

/// Builds the program, runs the preset `quickstart` with `extra` arguments and draws its report.
pub(crate) fn quickstart(project: &Path, extra: &[OsString]) -> Result<Code> {
    let chosen = out_folder(extra);
    let results = chosen.clone().unwrap_or_else(|| PathBuf::from(QUICKSTART_RESULTS));
    let mut run: Vec<&OsStr> = ["run", "--preset", "quickstart"].map(OsStr::new).to_vec();
    if chosen.is_none() {
        run.extend([OsStr::new("--out"), results.as_os_str()]);
    }
    run.extend(extra.iter().map(OsString::as_os_str));

    step("quickstart", "building goalbench (the first time takes some minutes)");
    let mut code = build(project)?;
    for arguments in [run, vec![OsStr::new("report"), results.as_os_str()]] {
        if code != 0 {
            return Ok(code);
        }
        let words: Vec<_> = arguments.iter().map(|word| word.to_string_lossy()).collect();
        step("quickstart", &format!("goalbench {}", words.join(" ")));
        code = goalbench(project, &arguments)?;
    }
    if code == 0 {
        step(
            "quickstart",
            &format!("figures and tables are in {}", project.join(results).join("report").display()),
        );
    }
    Ok(code)
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

/// The value of `--out` among the arguments for `goalbench run`.
fn out_folder(arguments: &[OsString]) -> Option<PathBuf> {
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        if argument == "--out" {
            return rest.next().map(PathBuf::from);
        }
        if let Some(folder) = argument.to_str().and_then(|text| text.strip_prefix("--out=")) {
            return Some(PathBuf::from(folder));
        }
    }
    None
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_folder_of_the_results_is_read_from_the_passed_arguments() {
        let find = |words: &[&str]| out_folder(&words.iter().map(OsString::from).collect::<Vec<_>>());
        assert_eq!(find(&["--seeds", "2"]), None);
        assert_eq!(find(&["--seeds", "2", "--out", "here"]), Some(PathBuf::from("here")));
        assert_eq!(find(&["--out=there", "--jobs", "1"]), Some(PathBuf::from("there")));
    }
}
