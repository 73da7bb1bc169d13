//! What the subcommands of `goalbench regress` have in common.

use std::path::{Path, PathBuf};

use reports::gate::compare::Settings;

use crate::cli::complain;
use crate::error::HarnessError;
use crate::executor::signals::Stopper;
use crate::protocol::plan::Plan;
use crate::regress::runs::{self, Progress};

/// When a check fails.
#[derive(clap::Args)]
#[command(next_help_heading = "When a check fails")]
pub(super) struct SettingsArgs {
    /// Highest share of checks of unchanged code that may fail: corrected p-values up to it count [default: 0.02, or
    /// the baseline's]
    #[arg(long, value_name = "P")]
    alpha: Option<f64>,
    /// Smallest fall of a success rate that matters [default: 0.05, or the baseline's]
    #[arg(long, value_name = "RATE")]
    smallest_effect: Option<f64>,
    /// Evaluations that the final success is averaged over [default: 3, or the baseline's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    window: Option<u16>,
}

impl SettingsArgs {
    /// `defaults` where no option says otherwise.
    pub(super) fn over(&self, defaults: Settings) -> Result<Settings, HarnessError> {
        let settings = Settings {
            alpha: self.alpha.unwrap_or(defaults.alpha),
            smallest_effect: self.smallest_effect.unwrap_or(defaults.smallest_effect),
            window: self.window.map_or(defaults.window, usize::from),
        };
        let wrong = |option, value, accepted| {
            let reason = format!("{value} given, {accepted} accepted");
            Err(HarnessError::Argument { option, reason })
        };
        if !(settings.alpha > 0.0 && settings.alpha < 1.0) {
            return wrong("--alpha", settings.alpha, "a number above 0 and below 1");
        }
        if !(0.0..=1.0).contains(&settings.smallest_effect) {
            return wrong("--smallest-effect", settings.smallest_effect, "a number from 0 to 1");
        }
        Ok(settings)
    }
}

/// Where the runs come from.
#[derive(clap::Args)]
#[command(next_help_heading = "Runs")]
pub(super) struct RunsArgs {
    /// Runs side by side, one thread each [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), conflicts_with = "results")]
    jobs: Option<u16>,
    /// Take the runs from this results folder and carry out none
    #[arg(long, value_name = "DIR", conflicts_with = "keep")]
    results: Option<PathBuf>,
    /// Keep the runs in this new results folder, for `goalbench report` [default: they are removed]
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
}

/// A results folder in which all runs have ended.
pub(super) enum Results {
    /// One that stays.
    Kept(PathBuf),
    /// One that is removed when dropped.
    Temporary(tempfile::TempDir),
}

impl Results {
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Kept(path) => path,
            Self::Temporary(folder) => folder.path(),
        }
    }
}

impl RunsArgs {
    /// The runs of `plan`, carried out or found; `None` if a signal stopped them.
    ///
    /// A finished run is never carried out twice in a results folder, and code that changed leaves no trace there: so checks
    /// take a new folder, or one that they are told to believe.
    pub(super) fn obtain(&self, plan: &Plan) -> Result<Option<Results>, HarnessError> {
        let results = match (&self.results, &self.keep) {
            (Some(folder), _) => {
                runs::find(plan, folder)?;
                return Ok(Some(Results::Kept(folder.clone())));
            }
            (None, Some(folder)) if folder.exists() => {
                let reason = format!(
                    "{} exists already, and may hold runs of other code; name a new folder, or --results to compare it",
                    folder.display()
                );
                return Err(HarnessError::Argument { option: "--keep", reason });
            }
            (None, Some(folder)) => Results::Kept(folder.clone()),
            (None, None) => Results::Temporary(
                tempfile::tempdir().map_err(HarnessError::io(std::env::temp_dir(), "create a folder in"))?,
            ),
        };
        let stopper = Stopper::listen(|| complain("goalbench: stopping"))
            .map_err(HarnessError::io("goalbench", "listen for signals"))?;
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let parallel = self.jobs.map_or(cores, usize::from);
        Ok(match runs::carry_out(plan, results.path(), parallel, &stopper)? {
            Progress::Ended => Some(results),
            Progress::Stopped => None,
        })
    }
}
