//! Shows that the regression gate works: plants known faults in a copy of the project, one at a time, and
//! checks each faulty program against the committed baseline.

mod scratch;
mod table;

use std::{
    collections::BTreeSet,
    env,
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
    process::{Command, ExitStatus, Stdio},
};

use crate::{
    cargo::Code,
    console::step,
    error::{Error, Result, doing},
};
use scratch::Scratch;
use table::{FAULTS, Fault};

/// The folder of the committed baselines.
const BASELINES: &str = "harness/baselines";

/// Exit code of a check that found something worse than before.
const FELL: i32 = 1;

/// What came of one check.
#[derive(Debug, PartialEq)]
enum Outcome {
    Passed,
    Caught,
}

/// Checks the program against the file `baseline` (each fault's own, if none is given), first without any
/// fault and then with each fault of `names` (all, if none are given); `extra` are further options for
/// `goalbench regress check`. The code is 0 if the sound program passes and every fault that shows at the
/// baseline's budget is caught, else 1.
pub(crate) fn faults(
    project: &Path,
    baseline: Option<&Path>,
    names: &[String],
    extra: &[OsString],
) -> Result<Code> {
    let chosen = choose(names)?;
    let own = |fault: &Fault| project.join(BASELINES).join(fault.baseline);
    let of = |fault: &Fault| baseline.map_or_else(|| own(fault), |baseline| project.join(baseline));
    let baselines: BTreeSet<PathBuf> = chosen.iter().map(|fault| of(fault)).collect();
    let built = env::var_os("CARGO_TARGET_DIR").map_or_else(|| project.join("target"), PathBuf::from);
    // On the same file system as the build folder, so that files can be linked.
    let home = tempfile::Builder::new()
        .prefix("faults-")
        .tempdir_in(&built)
        .map_err(doing("create a folder in", &built))?;
    step("faults", &format!("copying the project to {}", home.path().display()));
    let scratch = Scratch::make(project, &built, home.path())?;
    let reports = built.join("faults");
    let check = |name: &str, baseline: &Path| -> Result<Outcome> {
        build(project, &scratch)?;
        check(&scratch, project, baseline, &reports.join(name), extra)
    };

    step("faults", "the sound program, which must pass");
    let (mut lines, mut code) = (Vec::new(), Code::from(false));
    for baseline in &baselines {
        let outcome = check("none", baseline)?;
        code |= Code::from(outcome == Outcome::Caught);
        lines.push(("none", "the program as it is", outcome));
    }
    for fault in chosen {
        step("faults", &format!("{}: {}", fault.name, fault.title));
        let original = scratch.replace(fault.file, fault.original, fault.faulty)?;
        let outcome = check(fault.name, &of(fault))?;
        scratch.write(fault.file, &original)?;
        code |= Code::from(fault.shows && outcome == Outcome::Passed);
        lines.push((fault.name, fault.title, outcome));
    }
    for (name, title, outcome) in &lines {
        let found = if *outcome == Outcome::Caught { "caught" } else { "passed" };
        step("faults", &format!("{found:<7} {name:<18} {title}"));
    }
    step("faults", &format!("tables and figures are in {}", reports.display()));
    Ok(code)
}

fn choose(names: &[String]) -> Result<Vec<&'static Fault>> {
    if names.is_empty() {
        return Ok(FAULTS.iter().collect());
    }
    let find = |name: &String| {
        FAULTS.iter().find(|fault| fault.name == name).ok_or_else(|| Error::NoFault {
            name: name.clone(),
            known: FAULTS.iter().map(|fault| fault.name).collect(),
        })
    };
    names.iter().map(find).collect()
}

/// Builds the copy's program, with the native libraries of the project.
fn build(project: &Path, scratch: &Scratch) -> Result<()> {
    let native = project.join(".native");
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .args(["build", "--release", "--quiet", "--package", "goalbench"])
        .current_dir(&scratch.tree)
        .env("CARGO_TARGET_DIR", &scratch.target);
    for (variable, name) in
        [("LIBTORCH", "libtorch"), ("MUJOCO_DYNAMIC_LINK_DIR", "mujoco"), ("GOALBENCH_ASSETS", "assets")]
    {
        if env::var_os(variable).is_none() {
            cargo.env(variable, native.join(name));
        }
    }
    let status = run(&mut cargo)?;
    if status.success() { Ok(()) } else { Err(Error::Build { status }) }
}

/// Runs the copy's program against the baseline; its table goes to standard output.
fn check(
    scratch: &Scratch,
    project: &Path,
    baseline: &Path,
    report: &Path,
    extra: &[OsString],
) -> Result<Outcome> {
    fs::create_dir_all(report).map_err(doing("create", report))?;
    let mut goalbench = Command::new(scratch.target.join("release/goalbench"));
    goalbench.args(["regress", "check", "--baseline"]).arg(baseline).arg("--out").arg(report).args(extra);
    goalbench.current_dir(project).stderr(Stdio::null());
    if env::var_os("GOALBENCH_ASSETS").is_none() {
        goalbench.env("GOALBENCH_ASSETS", project.join(".native/assets"));
    }
    let status = run(&mut goalbench)?;
    match status.code() {
        Some(0) => Ok(Outcome::Passed),
        Some(FELL) => Ok(Outcome::Caught),
        _ => Err(Error::Check { status }),
    }
}

fn run(command: &mut Command) -> Result<ExitStatus> {
    let name = command.get_program().to_string_lossy().into_owned();
    command.status().map_err(|source| Error::Start { command: name, source })
}

#[cfg(test)]
mod tests {
    use super::{FAULTS, choose};

    #[test]
    fn faults_are_chosen_by_name() {
        assert_eq!(choose(&[]).unwrap().len(), FAULTS.len());
        assert_eq!(choose(&["her-off".to_owned()]).unwrap()[0].name, "her-off");
        let error = choose(&["her".to_owned()]).unwrap_err().to_string();
        assert!(error.contains("`her`") && error.contains("her-off, reward-sign"), "{error}");
    }
}
