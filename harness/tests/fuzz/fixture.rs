//! Valid results to damage: two finished runs and one that was stopped, made once.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::support::{toy, toy_args};

/// The run that damage comes to, in a results folder.
pub(crate) const RUN: &str = "runs/Point/teach/default/seed-0";

/// A results folder whose runs have finished. Tests copy it.
pub(crate) fn finished() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER
        .get_or_init(|| {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let settings = ["frontier.every=2", "frontier.episodes=1"].map(|set| ["--set", set]).concat();
            toy(folder.path(), &[&["--seeds", "0", "--shadow", "plr,vds"], &settings[..]].concat());
            folder
        })
        .path()
}

/// A results folder whose run was stopped after a checkpoint, by a signal.
pub(crate) fn stopped() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER
        .get_or_init(|| {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let args =
                toy_args(folder.path(), &["--seeds", "0", "--curriculum", "teach", "--steps", "1000000"]);
            let mut sweep = Command::new(env!("CARGO_BIN_EXE_goalbench"));
            let mut sweep =
                sweep.args(args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
            let begun = Instant::now();
            while !folder.path().join(RUN).join("checkpoint.bin").exists() {
                assert!(begun.elapsed() < Duration::from_secs(60), "no checkpoint within a minute");
                std::thread::sleep(Duration::from_millis(5));
            }
            let pid = i32::try_from(sweep.id()).ok().and_then(Pid::from_raw).expect("a process id");
            kill_process(pid, Signal::TERM).expect("it runs");
            assert_eq!(sweep.wait().expect("it was started here").code(), Some(3));
            folder
        })
        .path()
}

/// A copy of `results`.
pub(crate) fn copy(results: &Path) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy_into(results, folder.path());
    folder
}

fn copy_into(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let copy: PathBuf = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_into(&path, &copy);
        } else {
            fs::copy(&path, &copy).expect("a file");
        }
    }
}
