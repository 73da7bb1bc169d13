//! Where things lie in a results folder, and the table of the files in a run's folder.
//!
//! ```text
//! RESULTS/runs/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/FILE    for every FILE of the table FILES
//! RESULTS/protocols/NAME.toml
//! RESULTS/tuning/{runs/..., choice.json}    of a protocol with a search; a results folder by itself
//! RESULTS/report/{index.html, summary.md, *.csv, *.parquet, DATA.md, files.txt,
//!                 tables/*.tex, figures/*.{svg, png}}
//! ```

use std::path::{Path, PathBuf};

use crate::schema::RunKey;

/// A file, or a folder of files, in the folder of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunFile {
    /// Its name: one of the constants of this module, which say what it holds.
    pub name: &'static str,
    /// Whether it comes along when results of several machines are merged.
    pub merged: bool,
    /// Whether it comes along when results are packed for others: what was found and how, not what is needed
    /// to train on, nor what tells of the machine.
    pub packed: bool,
    /// Until when it is there.
    pub lives: Lives,
}

/// Until when a file of a run is there, once it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lives {
    /// As long as the run's folder.
    Always,
    /// Until the run's budget is used up and it is known that it will not be trained on.
    UntilDiscarded,
    /// From the end of the run until it is told to go on.
    UntilReopened,
}

/// [`Manifest`](crate::schema::Manifest).
pub const MANIFEST: &str = "manifest.json";
/// A [`Record`](crate::schema::Record) per line.
pub const RECORDS: &str = "records.jsonl";
/// A [`Teaching`](crate::schema::Teaching) per line.
pub const TEACHING: &str = "teaching.jsonl";
/// A [`Learning`](crate::schema::Learning) per line.
pub const STUDENT: &str = "student.jsonl";
/// A [`Frontier`](crate::schema::Frontier) per line; absent where none was asked for.
pub const FRONTIER: &str = "frontier.jsonl";
/// A [`Shadowing`](crate::schema::Shadowing) per line; absent where no shadow watched.
pub const SHADOW: &str = "shadow.jsonl";
/// A [`Timing`](crate::schema::Timing) per line.
pub const TIMING: &str = "timing.jsonl";
/// [`Outcome`](crate::schema::Outcome).
pub const OUTCOME: &str = "outcome.json";
/// Checksums of the files that hold what the run found and how long it took.
pub const CHECKSUMS: &str = "checksums.json";
/// A [`Crash`](crate::schema::Crash) per line; absent where no worker crashed.
pub const CRASHES: &str = "crashes.jsonl";
/// What the run's workers said on standard error; absent where they said nothing.
pub const WORKER_LOG: &str = "worker.log";
/// The state from which the run goes on, trained student included.
pub const CHECKPOINT: &str = "checkpoint.bin";
/// The folder of the replay buffer's log, which belongs to the checkpoint.
pub const REPLAY: &str = "replay";
/// TensorBoard's event file, on request; TensorBoard takes files whose names hold `tfevents`.
pub const EVENTS: &str = "events.out.tfevents.goalbench";
/// The file that whoever works on the folder holds a lock on.
pub const LOCK: &str = ".lock";

/// The folder of the trials of a search.
pub const TUNING: &str = "tuning";
/// What was chosen by them.
pub const CHOICE: &str = "choice.json";

/// Everything that lies in a run's folder. The outcome comes before the checksums: whoever removes both in
/// this order never leaves an ended run without them.
pub static FILES: &[RunFile] = &[
    RunFile { name: MANIFEST, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: RECORDS, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: TEACHING, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: STUDENT, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: FRONTIER, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: SHADOW, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: TIMING, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: OUTCOME, merged: true, packed: true, lives: Lives::UntilReopened },
    RunFile { name: CHECKSUMS, merged: true, packed: true, lives: Lives::UntilReopened },
    RunFile { name: CRASHES, merged: true, packed: true, lives: Lives::Always },
    RunFile { name: WORKER_LOG, merged: true, packed: false, lives: Lives::Always },
    RunFile { name: CHECKPOINT, merged: true, packed: false, lives: Lives::Always },
    RunFile { name: EVENTS, merged: true, packed: false, lives: Lives::Always },
    RunFile { name: REPLAY, merged: true, packed: false, lives: Lives::UntilDiscarded },
    RunFile { name: LOCK, merged: false, packed: false, lives: Lives::Always },
];

/// Folders from `runs/` to a run: environment, curriculum, variant, seed.
pub const DEPTH: usize = 4;

/// The folder of all runs of a results folder.
pub fn runs_dir(results: &Path) -> PathBuf {
    results.join("runs")
}

/// The folder of one run.
pub fn run_dir(results: &Path, run: &RunKey) -> PathBuf {
    runs_dir(results)
        .join(&run.environment)
        .join(&run.curriculum)
        .join(&run.variant)
        .join(format!("seed-{}", run.seed))
}

/// The run whose place `folder` is; `None` for a folder that can be no run's, such as `seed-0 (copy)`.
///
/// ```
/// use std::path::Path;
/// use reports::store::layout::{key_at, run_dir};
///
/// let key = key_at(Path::new("results/runs/MazeA/teach/default/seed-3")).expect("a run's place");
/// assert_eq!(key.to_string(), "MazeA/teach/default/seed-3");
/// assert_eq!(run_dir(Path::new("results"), &key), Path::new("results/runs/MazeA/teach/default/seed-3"));
/// assert_eq!(key_at(Path::new("results/runs/MazeA/teach/default/seed-3 (copy)")), None);
/// assert_eq!(key_at(Path::new("results/runs/MazeA/teach/default/seed-03")), None);
/// ```
pub fn key_at(folder: &Path) -> Option<RunKey> {
    let mut names = folder.iter().rev().map(|name| name.to_str());
    let last = names.next()??;
    let seed: u64 = last.strip_prefix("seed-")?.parse().ok()?;
    if last != format!("seed-{seed}") {
        return None;
    }
    let mut name = || Some(names.next()??.to_owned());
    let (variant, curriculum, environment) = (name()?, name()?, name()?);
    Some(RunKey { environment, curriculum, variant, seed })
}

/// The folder of the copies of the protocols that the results were made by.
pub fn protocols_dir(results: &Path) -> PathBuf {
    results.join("protocols")
}

/// The results folder of the trials of a search: a folder of its own, so that whoever reads results never
/// takes them for runs of the experiment.
pub fn tuning_dir(results: &Path) -> PathBuf {
    results.join(TUNING)
}

/// What the search of the results folder `results` chose: [`Tuning`](crate::schema::Tuning).
pub fn choice_file(results: &Path) -> PathBuf {
    tuning_dir(results).join(CHOICE)
}

/// The folder of the figures and tables.
pub fn report_dir(results: &Path) -> PathBuf {
    results.join("report")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_an_outcome_goes_before_its_checksums() {
        let place = |name: &str| FILES.iter().position(|file| file.name == name);
        for (index, file) in FILES.iter().enumerate() {
            assert_eq!(place(file.name), Some(index), "{} twice", file.name);
        }
        assert!(place(OUTCOME) < place(CHECKSUMS));
    }
}
