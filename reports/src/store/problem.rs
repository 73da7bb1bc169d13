//! What is wrong with single files of a results folder.

use std::path::PathBuf;

use guard::text::in_line;

use crate::schema::RunKey;

/// Something wrong at one place of a results folder. The rest of the folder is used all the same.
#[derive(Clone, Debug, PartialEq)]
pub struct StoreProblem {
    /// The file or folder, relative to the results folder.
    pub path: PathBuf,
    /// The line, counted from 1, where it is about one line.
    pub line: Option<usize>,
    /// What is wrong.
    pub fault: Fault,
}

impl StoreProblem {
    /// Whether runs may lie behind it that nobody sees.
    pub fn hides_runs(&self) -> bool {
        matches!(self.fault, Fault::Unreadable { .. })
    }

    /// Whether it says how a run ended, which is a result: nothing is damaged.
    pub(super) fn is_an_ending(&self) -> bool {
        matches!(self.fault, Fault::Failed { .. })
    }
}

impl std::fmt::Display for StoreProblem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Names and words of files may hold anything; a problem is one line.
        write!(f, "{}", in_line(&self.path.display().to_string()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}", in_line(&self.fault.to_string()))
    }
}

/// What can be wrong. Each variant says what became of the data.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A file or folder that does not belong there.
    #[error("unexpected here, ignored; expected {expected}")]
    Stray {
        /// What belongs there.
        expected: &'static str,
    },
    /// The folder of a run without its manifest.
    #[error("its manifest.json is missing, run left out")]
    NoManifest,
    /// A file that cannot be read.
    #[error("cannot be read: {reason}")]
    Unreadable {
        /// What the system said.
        reason: String,
    },
    /// A manifest whose hash does not fit its config. What the run recorded is checked apart, so it stays.
    #[error(
        "its hash does not fit its config: it was altered after it was written, and the run may have had another config"
    )]
    OtherConfig,
    /// A file of an ended run that is not what it was.
    #[error("{reason}, run left out")]
    Altered {
        /// What is wrong with it.
        reason: String,
    },
    /// Timings of an ended run that are not what they were. What the run found holds without them.
    #[error("{reason}, times left out")]
    Untimed {
        /// What is wrong with them.
        reason: String,
    },
    /// Text that is not what the schema says.
    #[error("not a valid {expected}, ignored: {reason}")]
    Malformed {
        /// `manifest`, `outcome`, `evaluation`, `timing`.
        expected: &'static str,
        /// What the parser said.
        reason: String,
    },
    /// A last line without its newline: the run is being written, or was cut off.
    #[error("incomplete last line ({bytes} bytes without a newline), ignored")]
    Incomplete {
        /// Bytes in it.
        bytes: usize,
    },
    /// Another version of the record schema.
    #[error("schema {found}, run ignored; this version reads schema {expected}")]
    Schema {
        /// Version in the manifest.
        found: u32,
        /// Version understood.
        expected: u32,
    },
    /// A manifest in the folder of another run.
    #[error("manifest of {found}, run ignored; the folder of that run is elsewhere")]
    Misplaced {
        /// Run named by the manifest.
        found: RunKey,
    },
    /// A run whose name cannot be shown: no figure can hold control characters.
    #[error("its name has control characters, run left out")]
    Unprintable,
    /// A run of another version than the others of its cell.
    #[error(
        "versions.{name} is `{found}`, that of {other} is `{expected}`: a cell's runs should be made alike"
    )]
    Maker {
        /// What differs: the program or the curriculum.
        name: &'static str,
        /// Its version here.
        found: String,
        /// The run that it is compared with.
        other: RunKey,
        /// Its version there.
        expected: String,
    },
    /// An evaluation of another run.
    #[error("evaluation of {found}, ignored; the manifest here says {expected}")]
    Foreign {
        /// Run named by the evaluation.
        found: RunKey,
        /// Run named by the manifest.
        expected: RunKey,
    },
    /// A number outside its range.
    #[error("{field} is {value}, line ignored; expected {accepted}")]
    Range {
        /// Name of the field.
        field: String,
        /// The value found.
        value: String,
        /// What is accepted.
        accepted: &'static str,
    },
    /// The same evaluation twice.
    #[error("evaluation {eval_index} again, ignored; line {first} has it")]
    Duplicate {
        /// Index of the evaluation.
        eval_index: u64,
        /// Line of the one that is kept.
        first: usize,
    },
    /// Training steps that do not grow from one evaluation to the next.
    #[error(
        "evaluation {eval_index} at step {step}, ignored; the evaluation before it is at step {previous}"
    )]
    Order {
        /// Index of the evaluation.
        eval_index: u64,
        /// Its step.
        step: u64,
        /// Step of the evaluation before it.
        previous: u64,
    },
    /// Evaluations that are not there, though a later one is.
    #[error("{} missing", evaluations(*from, *to))]
    Gap {
        /// First one missing.
        from: u64,
        /// Last one missing.
        to: u64,
    },
    /// An outcome that cannot be that of the run.
    #[error("{reason}; the evaluations are kept")]
    Outcome {
        /// What does not fit.
        reason: String,
    },
    /// A run that is not configured as its cell is.
    #[error(
        "config differs from {other} at `{pointer}`, run left out: seeds of one cell differ in nothing else"
    )]
    Config {
        /// The first run of its cell that has the cell's config.
        other: RunKey,
        /// JSON pointer to the first difference.
        pointer: String,
    },
    /// A worker that went away; the run has not ended.
    #[error("worker crashed (attempt {attempt}), the evaluations so far are kept: {reason}")]
    Crashed {
        /// 0 for the first attempt.
        attempt: u32,
        /// What is known of it.
        reason: String,
    },
    /// A run that ended early.
    #[error("the run failed at step {step}, its evaluations are kept: {reason}")]
    Failed {
        /// Training steps taken.
        step: u64,
        /// Why, from its outcome.
        reason: String,
    },
}

impl Fault {
    /// What is wrong, for readers that use nothing of the run.
    pub(super) fn what(&self) -> String {
        match self {
            Self::Range { field, value, accepted } => format!("{field} is {value}; expected {accepted}"),
            fault => fault.to_string(),
        }
    }
}

/// `evaluation 2 is`, `evaluations 2 to 4 are`.
fn evaluations(from: u64, to: u64) -> String {
    if from == to { format!("evaluation {from} is") } else { format!("evaluations {from} to {to} are") }
}
