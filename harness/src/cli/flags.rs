//! Flags that several commands take, for `#[command(flatten)]`.

use std::convert::Infallible;
use std::ops::{Bound, RangeBounds};
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::config::{count, seeds};
use crate::error::HarnessError;
use crate::protocol::presets;
use crate::sweep::reporter::Detail;

/// `--jobs`.
#[derive(clap::Args)]
pub(super) struct JobsFlag {
    /// Threads at work, one for each run at a time [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..))]
    jobs: Option<u16>,
}

impl JobsFlag {
    /// Whether the flag was given.
    pub(super) fn is_given(&self) -> bool {
        self.jobs.is_some()
    }

    /// How many of `runs` to carry out side by side: no more than there are, whatever number was asked for.
    pub(super) fn for_runs(&self, runs: usize) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        self.jobs.map_or_else(cores, usize::from).min(runs.max(1))
    }
}

/// Which protocol: a file or a preset.
#[derive(clap::Args)]
pub(super) struct ProtocolFlags {
    /// Protocol file (TOML); `goalbench protocol show quickstart` prints one to start from
    #[arg(conflicts_with = "preset")]
    protocol: Option<PathBuf>,
    /// The same as PROTOCOL
    #[arg(long = "protocol", value_name = "FILE", conflicts_with_all = ["protocol", "preset"])]
    file: Option<PathBuf>,
    /// Built-in protocol; `goalbench list presets` names them
    #[arg(long, value_name = "NAME")]
    pub(super) preset: Option<String>,
}

/// A protocol as it was written.
pub(super) struct ProtocolText {
    /// The flag that asks for it, as a user would type it.
    pub(super) flag: String,
    /// What errors call it.
    pub(super) name: String,
    /// TOML.
    pub(super) text: String,
}

impl ProtocolFlags {
    /// Whether a flag names one.
    pub(super) fn is_given(&self) -> bool {
        self.path().is_some() || self.preset.is_some()
    }

    /// The file that is read, if one is.
    pub(super) fn inputs(&self) -> Vec<&Path> {
        self.path().into_iter().collect()
    }

    fn path(&self) -> Option<&Path> {
        self.protocol.as_deref().or(self.file.as_deref())
    }

    /// The text of the protocol; `None` where no flag names one.
    ///
    /// # Errors
    /// [`HarnessError`] if the file cannot be read or there is no such preset.
    pub(super) fn text(&self) -> Result<Option<ProtocolText>, HarnessError> {
        match (self.path(), &self.preset) {
            (Some(path), _) => ProtocolText::of_file(path).map(Some),
            (None, Some(name)) => {
                let preset = presets::find(name)?;
                Ok(Some(ProtocolText {
                    flag: format!("--preset {}", preset.id),
                    name: format!("preset {}", preset.id),
                    text: preset.text.to_owned(),
                }))
            }
            (None, None) => Ok(None),
        }
    }
}

impl ProtocolText {
    /// Reads a protocol file.
    ///
    /// # Errors
    /// [`HarnessError::Io`] if it cannot be read.
    fn of_file(path: &Path) -> Result<Self, HarnessError> {
        let text =
            guard::files::read_to_string(path).map_err(HarnessError::io(path, "read this protocol"))?;
        let name = path.display().to_string();
        Ok(Self { flag: format!("--protocol {name}"), name, text })
    }
}

/// `--quiet` of a command without progress to tell of in detail.
#[derive(clap::Args)]
pub(super) struct QuietFlag {
    /// Say only what was asked for and what went wrong
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// `--quiet` and `--verbose` of commands that carry out runs.
#[derive(clap::Args)]
pub(super) struct DetailFlags {
    /// No progress: only what goes wrong, and the result
    #[arg(short, long)]
    quiet: bool,
    /// A line for every evaluation on terminals, too, where bars would be drawn
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
}

impl DetailFlags {
    /// How progress is shown.
    pub(super) fn detail(&self) -> Detail {
        match (self.quiet, self.verbose) {
            (true, _) => Detail::Quiet,
            (false, true) => Detail::Lines,
            (false, false) => Detail::Fitting,
        }
    }
}

/// `--seeds` of a command that takes a protocol.
#[derive(clap::Args)]
pub(super) struct SeedsFlag {
    /// Seeds instead of the protocol's: a range such as 0..7 (0 to 6), a list such as 0,3
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<String>,
}

impl SeedsFlag {
    /// The seeds given, or else `others`.
    ///
    /// # Errors
    /// [`HarnessError::Argument`] if they cannot be read.
    pub(super) fn or(&self, others: Vec<u64>) -> Result<Vec<u64>, HarnessError> {
        self.seeds.as_deref().map_or(Ok(others), |text| parse_seeds("--seeds", text))
    }
}

/// A whole number of type `T` within `range`, for `value_parser`: digits, or as in 1e5 and 100k.
pub(super) fn whole<T: TryFrom<u64>>(
    range: impl RangeBounds<u64> + Clone + Send + Sync + 'static,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    move |text| {
        let number = count::parse(text).filter(|number| range.contains(number));
        number.and_then(|number| T::try_from(number).ok()).ok_or_else(|| accepted::<T>(&range))
    }
}

/// What [`whole`] accepts.
fn accepted<T>(range: &impl RangeBounds<u64>) -> String {
    let least = match range.start_bound() {
        Bound::Included(least) => *least,
        Bound::Excluded(_) | Bound::Unbounded => 0,
    };
    let most = match range.end_bound() {
        Bound::Included(most) => *most,
        Bound::Excluded(_) | Bound::Unbounded => u64::MAX >> (u64::BITS as usize - 8 * size_of::<T>()),
    };
    match (least, most) {
        (0, u64::MAX) => format!("{} is accepted", count::ACCEPTED),
        _ => format!("a whole number from {least} to {most} is accepted"),
    }
}

/// A number, for `value_parser`.
pub(super) fn number(text: &str) -> Result<f64, &'static str> {
    text.trim().parse().map_err(|_| "a number is accepted")
}

/// The same above `least` and below 1.
pub(super) fn between(least: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        let number = number(text).ok().filter(|number| *number > least && *number < 1.0);
        number.ok_or_else(|| format!("a number above {least} and below 1 is accepted"))
    }
}

/// One of `all`, by its name in options, for `value_parser`.
pub(super) fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    all: [T; N],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let find = move |text: String| all.into_iter().find(|one| name(*one) == text);
    PossibleValuesParser::new(all.map(name)).try_map(move |text| find(text).ok_or("no such value"))
}

/// A name in a list, for `value_parser`: people put blanks after commas.
pub(super) fn name(text: &str) -> Result<String, Infallible> {
    Ok(text.trim().to_owned())
}

/// Seeds as `option` gives them.
///
/// # Errors
/// [`HarnessError::Argument`] if they cannot be read.
pub(super) fn parse_seeds(option: &'static str, text: &str) -> Result<Vec<u64>, HarnessError> {
    seeds::parse(text).map_err(|reason| HarnessError::Argument { option, reason })
}
