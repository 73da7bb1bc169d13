//! The program as a process that tests signal and kill, and what it must leave all the same.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use reports::store::{Results, RunFolder, layout};
use rustix::process::{Pid, Signal, kill_process};

/// The bytes of these files of every run, by path.
pub(crate) fn files(folder: &Path, names: &[&str]) -> BTreeMap<PathBuf, Vec<u8>> {
    let runs = Results::new(folder).survey().expect("a results folder").runs;
    let paths = runs.iter().flat_map(|run| names.iter().map(|name| run.file(name)));
    paths
        .map(|path| {
            let bytes = std::fs::read(&path).expect("every run has ended");
            (path.strip_prefix(folder).expect("below it").to_owned(), bytes)
        })
        .collect()
}

/// What every run recorded, the clock apart, by path.
pub(crate) fn results(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    files(folder, &[layout::RECORDS, layout::TEACHING, layout::STUDENT, layout::OUTCOME])
}

/// Starts goalbench with `args`, and does not wait.
pub(crate) fn start(args: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_goalbench"));
    command.args(args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

/// Bytes in these files of a run; none of those that are not there yet.
fn recorded(run: &RunFolder, names: &[&str]) -> u64 {
    names.iter().map(|name| std::fs::metadata(run.file(name)).map_or(0, |file| file.len())).sum()
}

/// Starts goalbench with `args` some times, and kills it each time after the files `names` of `run` have
/// grown: at once, then each time later by `pause`.
pub(crate) fn kill_again_and_again(
    args: &[&str],
    (run, names): (&RunFolder, &[&str]),
    rounds: u32,
    pause: Duration,
) {
    for round in 0..rounds {
        let before = recorded(run, names);
        let mut parent = start(args);
        while recorded(run, names) == before && parent.try_wait().expect("it can be asked").is_none() {
            sleep(Duration::from_millis(1));
        }
        sleep(pause * round);
        parent.kill().expect("it can be killed");
        parent.wait().expect("it was started here");
    }
}

/// Sends a signal to the process with this id.
pub(crate) fn signal(process: u32, signal: Signal) {
    let pid = i32::try_from(process).ok().and_then(Pid::from_raw).expect("a process id");
    // It may have ended by itself.
    let _ = kill_process(pid, signal);
}

/// Worker processes of `parent`, read from the process table.
pub(crate) fn workers(parent: u32) -> Vec<u32> {
    let text =
        Command::new("ps").args(["-o", "pid=", "--ppid", &parent.to_string()]).output().expect("ps runs");
    String::from_utf8_lossy(&text.stdout).split_whitespace().filter_map(|pid| pid.parse().ok()).collect()
}
