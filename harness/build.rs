//! Lets this package's binaries, tests and benches find libmujoco and libtorch at run time, and tells the
//! program from which commit it was built.

use std::path::Path;
use std::process::Command;

#[path = "../ci/link.rs"]
mod link;

/// What a result depends on. The build script runs again when one of them changes, so that it never reports
/// an old commit.
const SOURCES: [&str; 8] = [
    "../Cargo.toml",
    "../Cargo.lock",
    "../envs",
    "../agents",
    "../curricula",
    "../reports",
    "Cargo.toml",
    "src",
];

fn main() {
    link::search_at_run_time("MUJOCO_DYNAMIC_LINK_DIR", "libmujoco.so");
    // Set by torch-sys, which this package depends on directly for the sake of this line.
    link::search_at_run_time("DEP_TCH_LIBTORCH_LIB", "libtorch_cpu.so");

    let commit = commit().unwrap_or_default();
    println!("cargo::rustc-env=GOALBENCH_COMMIT={commit}");
    let version = env!("CARGO_PKG_VERSION");
    let version = if commit.is_empty() { version.to_owned() } else { format!("{version} ({commit})") };
    println!("cargo::rustc-env=GOALBENCH_VERSION={version}");
}

/// The commit that the sources are at, as in `0123456789ab` or `0123456789ab, modified`; `None` where git
/// knows nothing of them: an unpacked archive, a copy inside another project.
fn commit() -> Option<String> {
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
    }
    let top = git(&["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != Path::new("..").canonicalize().ok()? {
        return None;
    }
    // Changes with every commit, checkout and reset.
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"])?;
    if Path::new(&log).exists() {
        println!("cargo::rerun-if-changed={log}");
    }
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed = git(&[&["status", "--porcelain", "--"][..], &SOURCES].concat())?;
    Some(if changed.is_empty() { commit } else { format!("{commit}, modified") })
}

/// What a git command prints, if it succeeds.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
