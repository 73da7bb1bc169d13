//! What a user can run into, worded for them.
//!
//! Input errors hold the place, the field and the reason; I/O errors the path and the action. An error's text
//! does not repeat its cause: that is its [`source`](std::error::Error::source), and [`chain`] joins them for
//! people.

use std::error::Error;
use std::fmt::Display;
use std::path::PathBuf;
use std::process::ExitStatus;

use guard::text::short;
use reports::gate::GateError;
use reports::schema::{RunKey, SCHEMA};
use reports::store::StoreError;

use crate::suggest::hint;

/// What caused an error, where several kinds of error can.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Errors of the harness. Each says what was wrong, where, and what is accepted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HarnessError {
    /// A name that no table knows.
    #[error("{place}unknown {kind} `{name}`{hint}")]
    Unknown {
        /// Where it stands, with a trailing `: `, or nothing.
        place: String,
        /// What it should be: `environment`, `curriculum`, `preset`.
        kind: &'static str,
        /// What was typed.
        name: String,
        /// Suggestion and accepted names.
        hint: String,
    },
    /// A config field that does not exist or does not take this value.
    #[error("{place}: {path}: {reason}")]
    Config {
        /// File and line, or the command-line option.
        place: String,
        /// Config path, as in `curriculum.teach.window`.
        path: String,
        /// What is wrong and what is accepted.
        reason: String,
    },
    /// A protocol that is not valid TOML or lacks something.
    #[error("{place}: {reason}")]
    Protocol {
        /// File and line.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// A command-line value that cannot be read.
    #[error("{option}: {reason}")]
    Argument {
        /// The option.
        option: &'static str,
        /// What is wrong and what is accepted.
        reason: String,
    },
    /// A run's folder was written with another config.
    #[error(
        "{folder}: this run was recorded with another config or by another program. The runs of one environment, \
         curriculum and variant differ in their seeds alone:\n{differences}\nNothing was changed. Choose another --out, or delete \
         that folder."
    )]
    OtherConfig {
        /// The run's folder.
        folder: PathBuf,
        /// The differing fields, one per line.
        differences: String,
    },
    /// A run's folder was written with a smaller budget and nobody asked to train it on.
    #[error(
        "{folder}: this run was recorded with a budget of {recorded} training steps, not {wanted}. Nothing was changed. \
         Add --extend to train it on, or choose another --out."
    )]
    Shorter {
        /// The run's folder.
        folder: PathBuf,
        /// Its budget.
        recorded: u64,
        /// The budget asked for.
        wanted: u64,
    },
    /// A run that was tried out cannot begin on this machine, or not go on.
    #[error("{reason}")]
    Trial {
        /// What the process said that tried it.
        reason: String,
    },
    /// A protocol that cannot be turned from one notation into another.
    #[error("{place}: cannot be written as {notation}")]
    Notation {
        /// Where the protocol stands.
        place: String,
        /// `JSON` or `TOML`.
        notation: &'static str,
        /// What has no such form.
        source: Cause,
    },
    /// A file of an earlier run that is not what was written.
    #[error("{path}: {reason}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The manifest of an earlier run that is not what was written.
    #[error("{path}")]
    Manifest {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: ManifestError,
    },
    /// A path that was given does not lead to what is looked for: runs, a task, a policy.
    #[error("{path}: {reason}")]
    Missing {
        /// The path.
        path: PathBuf,
        /// What is not there.
        reason: String,
    },
    /// A run or an environment that was given cannot be used on this machine, or broke down in use.
    #[error("{subject}: cannot {action}")]
    Unusable {
        /// The run's folder, or the environment's id.
        subject: String,
        /// What was tried, as in `evaluate this run`.
        action: &'static str,
        /// Why it failed.
        source: Cause,
    },
    /// Another process works on the folder.
    #[error("{folder}: another goalbench process is working on this folder; wait until it has ended")]
    Locked {
        /// The results folder.
        folder: PathBuf,
    },
    /// Results that cannot be merged.
    #[error("these runs conflict, nothing was written:\n  {runs}")]
    Conflict {
        /// The runs, a line each, with what conflicts.
        runs: String,
    },
    /// Runs that no source of a merge has whole.
    #[error("these runs are damaged and no source has them whole, nothing was written:\n  {runs}")]
    Unsound {
        /// What is wrong, a line each.
        runs: String,
    },
    /// A picture cannot be drawn.
    #[error(transparent)]
    Render(#[from] envs::render::RenderError),
    /// Slurm does not take the job.
    #[error("sbatch: {reason}")]
    Slurm {
        /// What it said.
        reason: String,
    },
    /// An earlier job array still has these runs.
    #[error(
        "job {job} of an earlier submission is still in the queue with these runs; wait for it or scancel it"
    )]
    Queued {
        /// Slurm's id of the job.
        job: String,
    },
    /// A path that no script can name.
    #[error("{path}: cannot stand in the script of a job array")]
    Script {
        /// The path.
        path: PathBuf,
        /// What a script cannot hold.
        source: Cause,
    },
    /// A file operation failed.
    #[error("{path}: cannot {action}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried, as in `create this folder`.
        action: &'static str,
        /// Why it failed.
        source: std::io::Error,
    },
    /// A file of a run that cannot be used.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Runs that the regression gate cannot compare.
    #[error(transparent)]
    Gate(#[from] GateError),
    /// The library refused what a flag asks for.
    #[error("{option}")]
    Flag {
        /// The flag, or several of them.
        option: &'static str,
        /// Why.
        source: Cause,
    },
    /// A folder that must be new is there already.
    #[error("{folder} exists already; name a new folder")]
    Exists {
        /// The folder.
        folder: PathBuf,
    },
    /// The device that runs ask for cannot be used on this machine.
    #[error("{reason}")]
    Device {
        /// What the process said that tried it.
        reason: String,
    },
    /// The system refused something that is not about a file.
    #[error("cannot {action}")]
    System {
        /// What was tried, as in `listen for signals`.
        action: &'static str,
        /// Why it failed.
        source: Cause,
    },
    /// The report could not be made.
    #[error(transparent)]
    Report(#[from] reports::ReportError),
    /// Traces could not be replayed.
    #[error(transparent)]
    Traces(envs::trace::TraceError),
    /// The machine failed a run, for want of memory for example; another attempt may succeed.
    #[error("{run}")]
    Machine {
        /// The run.
        run: RunKey,
        /// What it could not do.
        source: Cause,
    },
    /// A run cannot be carried out, here or with this config.
    #[error("{run}: cannot {action}")]
    Impossible {
        /// The run.
        run: RunKey,
        /// What was tried, as in `begin`.
        action: &'static str,
        /// What broke down.
        source: Cause,
    },
    /// A run did not end as something else needs it to.
    #[error("{run}: {reason}")]
    Run {
        /// The run.
        run: RunKey,
        /// Why.
        reason: String,
    },
    /// A process that was to print a profile did not. It has said why on standard error.
    #[error("{arguments}: this process printed no profile ({status})")]
    NoProfile {
        /// What it was started with.
        arguments: String,
        /// How it ended.
        status: ExitStatus,
    },
}

/// What is wrong with a manifest.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ManifestError {
    /// It is not there.
    #[error("there is no manifest")]
    Missing,
    /// Another version of the program wrote it.
    #[error("has schema {found}, this program writes schema {SCHEMA}")]
    Schema {
        /// The schema that it has.
        found: u32,
    },
    /// Its hash is that of another config.
    #[error("its hash does not fit its config: it was altered after it was written")]
    Altered,
    /// Its folder is another run's.
    #[error("belongs to the run {found}, not to {wanted}")]
    OtherRun {
        /// The run that it names.
        found: Box<RunKey>,
        /// The run whose folder it lies in.
        wanted: Box<RunKey>,
    },
    /// Its config does not fit this program.
    #[error("config.{field}")]
    Config {
        /// The first field that does not fit.
        field: String,
        /// Why.
        source: serde_json::Error,
    },
}

impl HarnessError {
    /// Whether the same command may succeed another time, because the machine or its disk failed. Damaged
    /// data stays damaged.
    pub fn is_transient(&self) -> bool {
        match self {
            Self::Io { source, .. } => source.kind() != std::io::ErrorKind::InvalidData,
            Self::Store(error) => error.is_transient(),
            Self::System { .. } | Self::Machine { .. } => true,
            _ => false,
        }
    }

    /// Whether files of a run are not what was written, or cannot be read.
    pub fn is_damage(&self) -> bool {
        matches!(self, Self::Damaged { .. } | Self::Manifest { .. } | Self::Store(_) | Self::Io { .. })
    }

    /// An unknown name, with suggestion.
    pub fn unknown<'a>(
        place: impl Into<String>,
        kind: &'static str,
        name: &str,
        accepted: impl IntoIterator<Item = &'a str> + Clone,
    ) -> Self {
        Self::Unknown { place: place.into(), kind, name: short(name), hint: hint(name, accepted) }
    }

    /// Wraps an I/O error: `.map_err(HarnessError::io(path, "write this file"))`.
    pub fn io(path: impl Into<PathBuf>, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, action, source }
    }

    /// Names the flag that asked for what is refused: `.map_err(HarnessError::flag("--device"))`.
    pub fn flag<E: Into<Cause>>(option: &'static str) -> impl FnOnce(E) -> Self {
        move |error| Self::Flag { option, source: error.into() }
    }

    /// Wraps what the system refused: `.map_err(HarnessError::system("listen for signals"))`.
    pub fn system<E: Into<Cause>>(action: &'static str) -> impl FnOnce(E) -> Self {
        move |error| Self::System { action, source: error.into() }
    }

    /// Wraps why something that was given cannot be used:
    /// `.map_err(HarnessError::unusable("MazeA", "make this environment"))`.
    pub fn unusable<E: Into<Cause>>(subject: impl Display, action: &'static str) -> impl FnOnce(E) -> Self {
        let subject = subject.to_string();
        move |error| Self::Unusable { subject, action, source: error.into() }
    }

    /// Wraps why a run cannot be carried out: `.map_err(HarnessError::impossible(&key, "begin"))`.
    pub fn impossible<E: Into<Cause>>(run: &RunKey, action: &'static str) -> impl FnOnce(E) -> Self {
        let run = run.clone();
        move |error| Self::Impossible { run, action, source: error.into() }
    }
}

/// An error with all that caused it, as in `records.jsonl: cannot write this file: No space left on device`.
///
/// Errors of this workspace do not repeat their cause, but those of some libraries do: a cause whose first
/// line the text already ends with is left out.
pub fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let told = error.to_string();
        if !text.ends_with(told.lines().next().unwrap_or_default()) {
            text += ": ";
            text += &told;
        }
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use std::io;

    use super::*;

    #[test]
    fn causes_are_told_once_each() {
        let full = || io::Error::new(io::ErrorKind::StorageFull, "no space");
        let file = HarnessError::io("a/b", "write this file")(full());
        assert_eq!(chain(&file), "a/b: cannot write this file: no space");
        let system = HarnessError::system("go on")(file);
        assert_eq!(chain(&system), "cannot go on: a/b: cannot write this file: no space");
        #[derive(Debug, thiserror::Error)]
        #[error("b: {0}")]
        struct Repeats(#[from] io::Error);
        assert_eq!(chain(&Repeats(full())), "b: no space");
    }
}
