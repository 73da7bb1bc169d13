//! What the subcommands of `goalbench regress` have in common.

use std::path::{Path, PathBuf};

use reports::gate::GateError;
use reports::gate::compare::Settings;
use reports::store::layout;
use reports::wording::counted;

use crate::cli::complain;
use crate::cli::flags::{DetailFlags, JobsFlag, number, whole};
use crate::error::HarnessError;
use crate::outputs;
use crate::protocol::plan::Plan;
use crate::sweep::signals::Stopper;
use crate::sweep::{Conduct, Ending, Endings, Reopen, Sweep, local, reporter};

/// How often a run whose worker crashed is begun again from its checkpoint.
const RETRIES: u32 = 1;

/// When a check fails.
#[derive(clap::Args)]
#[command(next_help_heading = "When a check fails")]
pub(super) struct SettingsArgs {
    /// Highest share of checks of unchanged code that may fail: corrected p-values up to it count [default:
    /// 0.02, or the baseline's]
    #[arg(long, value_name = "P", value_parser = number)]
    alpha: Option<f64>,
    /// Smallest fall of a success rate that matters [default: 0.05, or the baseline's]
    #[arg(long, value_name = "RATE", value_parser = number)]
    smallest_effect: Option<f64>,
    /// Evaluations that the final success is averaged over [default: 3, or the baseline's]
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..))]
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
    #[command(flatten)]
    jobs: JobsFlag,
    #[command(flatten)]
    detail: DetailFlags,
    /// Take the runs from this results folder and carry out none
    #[arg(long, value_name = "DIR", conflicts_with_all = ["keep", "jobs"])]
    results: Option<PathBuf>,
    /// Keep the runs in this new results folder, for `goalbench report` [default: they are removed]
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
}

/// Names the option `seeds` where with its number of seeds the gate could never fail or not be computed.
pub(super) fn name_options(seeds: &'static str) -> impl FnOnce(GateError) -> HarnessError {
    move |error| {
        let option = match error {
            GateError::TooFewSeeds { .. } | GateError::TooManySeeds { .. } => seeds,
            GateError::Draws { .. } => "--now, --before, --draws",
            error => return error.into(),
        };
        HarnessError::flag(option)(error)
    }
}

/// A results folder in which all runs have ended.
pub(super) enum EndedRuns {
    /// One that stays.
    Kept(PathBuf),
    /// One that is removed when dropped.
    Temporary(tempfile::TempDir),
}

impl EndedRuns {
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Kept(path) => path,
            Self::Temporary(folder) => folder.path(),
        }
    }
}

impl RunsArgs {
    /// Checks that the runs can be kept where they are to be kept, apart from what `--out` names.
    pub(super) fn check_outputs(&self, out: Option<&Path>) -> Result<(), HarnessError> {
        let Some(keep) = self.keep.as_deref() else { return Ok(()) };
        outputs::folder("--keep", keep, &[])?;
        out.map_or(Ok(()), |out| outputs::apart(("--keep", keep), ("--out", out)))
    }

    /// The runs of `plan`, carried out or found; `None` if a signal stopped them.
    ///
    /// A sweep keeps finished runs, and a results folder does not tell whether the code changed since. So a
    /// check carries its runs out in a new folder, or takes those of a folder that it is told to trust.
    pub(super) fn obtain(&self, plan: &Plan) -> Result<Option<EndedRuns>, HarnessError> {
        let results = match (&self.results, &self.keep) {
            (Some(folder), _) => {
                if !layout::runs_dir(folder).is_dir() {
                    let reason = format!("{} is no results folder: it has no runs/", folder.display());
                    return Err(HarnessError::Argument { option: "--results", reason });
                }
                let sweep = Sweep::survey(plan, folder, Reopen::default()).map_err(of_another_protocol)?;
                check_ended(&sweep, folder)?;
                return Ok(Some(EndedRuns::Kept(folder.clone())));
            }
            (None, Some(folder)) if folder.exists() => {
                let reason = format!(
                    "{} exists already, and may hold runs of other code; name a new folder, or --results to compare it",
                    folder.display()
                );
                return Err(HarnessError::Argument { option: "--keep", reason });
            }
            (None, Some(folder)) => EndedRuns::Kept(folder.clone()),
            (None, None) => EndedRuns::Temporary(
                tempfile::tempdir().map_err(HarnessError::io(std::env::temp_dir(), "create a folder in"))?,
            ),
        };
        let sweep = Sweep::survey(plan, results.path(), Reopen::default())?;
        sweep.check_device()?;
        local::limits::make_room(self.jobs.for_runs(sweep.open().count()))?;
        sweep.try_out(false)?;
        let sweep = sweep.prepare(false)?;
        let workers = self.jobs.for_runs(sweep.open().count());
        let reporter = reporter::for_stderr(sweep.jobs(), workers, self.detail.detail());
        let discard_replay = self.keep.is_none();
        let conduct = Conduct { retries: RETRIES, discard_replay, ..Conduct::share(workers, 1) };
        let stopper = Stopper::listen(|| complain("goalbench: stopping"));
        let stopper = stopper.map_err(HarnessError::system("listen for signals"))?;
        let endings = sweep.carry_out(conduct, reporter.as_ref(), &stopper)?;
        Ok(have_ended(&endings)?.then_some(results))
    }
}

/// Whether all runs came to an end, finished or failed; not if a signal stopped them.
///
/// # Errors
/// [`HarnessError::Run`] naming a run whose workers crashed for good.
fn have_ended(endings: &Endings) -> Result<bool, HarnessError> {
    if endings.stopped() + endings.taken() > 0 {
        return Ok(false);
    }
    let crash = endings.iter().find_map(|(run, ending)| match ending {
        Ending::Crashed { reason } => {
            Some(HarnessError::Run { run: run.clone(), reason: format!("crashed: {reason}") })
        }
        Ending::Ended(_) | Ending::Stopped | Ending::Taken => None,
    });
    crash.map_or(Ok(true), Err)
}

/// Says of results with runs of another config what a reader of them can do.
fn of_another_protocol(error: HarnessError) -> HarnessError {
    let reason = match error {
        HarnessError::OtherConfig { folder, differences } => {
            format!("{}: this run was recorded with another config:\n{differences}", folder.display())
        }
        HarnessError::Shorter { folder, recorded, wanted } => format!(
            "{}: this run was recorded with a budget of {recorded} training steps, not {wanted}",
            folder.display()
        ),
        error => return error,
    };
    HarnessError::Argument {
        option: "--results",
        reason: format!("{reason}\nName results of this protocol."),
    }
}

/// Checks that every run of a sweep has ended in `results` before.
///
/// # Errors
/// [`HarnessError::Run`] naming one that has not.
fn check_ended(sweep: &Sweep, results: &Path) -> Result<(), HarnessError> {
    let Some(first) = sweep.open().next() else { return Ok(()) };
    let reason = format!(
        "has not ended in {} ({} of {} not ended)",
        results.display(),
        sweep.open().count(),
        counted(sweep.jobs().len(), "run")
    );
    Err(HarnessError::Run { run: first.run().clone(), reason })
}
