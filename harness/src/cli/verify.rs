//! `goalbench verify`.

use std::path::PathBuf;

use envs::trace::{FileReport, TraceError, verify_dir};
use reports::wording::counted;
use serde_json::{Value, json};

use super::{Exit, ExitCode, complain, print};
use crate::error::{HarnessError, chain};

#[derive(clap::Args)]
#[command(
    after_help = "Exit code 0 only if every deviation is within its file's tolerance and no reward or success differs."
)]
pub(super) struct Args {
    /// Folder of trace files (*.json.gz), folders below it included
    folder: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn verify(args: &Args) -> Exit {
    if !args.folder.is_dir() {
        let reason =
            format!("{} is no folder; name one that holds traces (*.json.gz)", args.folder.display());
        return Err(HarnessError::Argument { option: "FOLDER", reason });
    }
    let files = verify_dir(&args.folder).map_err(HarnessError::Traces)?;
    let good = |file: &Result<FileReport, TraceError>| file.as_ref().is_ok_and(FileReport::passed);
    let failures = files.iter().filter(|file| !good(file)).count();
    if args.json {
        print(&format!("{:#}\n", as_json(&files, failures == 0)));
    } else {
        print(&as_text(&files));
        for file in &files {
            match file {
                Err(error) => complain(&format!("goalbench: {}", chain(error))),
                Ok(report) => {
                    if let Some(failure) = &report.first_failure {
                        complain(&format!("goalbench: {}: {failure}", report.file.display()));
                    }
                }
            }
        }
        let agreeing = files.len() - failures;
        print(&format!(
            "{agreeing} of {} {}\n",
            counted(files.len(), "file"),
            if agreeing == 1 { "agrees" } else { "agree" }
        ));
    }
    Ok(if failures == 0 { ExitCode::Success } else { ExitCode::Failed })
}

fn as_json(files: &[Result<FileReport, TraceError>], passed: bool) -> Value {
    let files = files.iter().map(|file| match file {
        Ok(report) => {
            let mut value = serde_json::to_value(report).expect("a report is plain data");
            value["passed"] = report.passed().into();
            value
        }
        Err(error) => json!({
            "file": error.file.display().to_string(), "passed": false, "error": chain(error),
        }),
    });
    json!({ "passed": passed, "files": files.collect::<Vec<_>>() })
}

fn as_text(files: &[Result<FileReport, TraceError>]) -> String {
    let mut text = format!(
        "{:<34} {:<10} {:>6} {:>6} {:>11} {:>11} {:>11} {:>11} {:>8} {:>7} {:>8}  result\n",
        "environment",
        "physics",
        "resets",
        "steps",
        "observation",
        "achieved",
        "qpos",
        "qvel",
        "tolerance",
        "reward",
        "success"
    );
    for report in files.iter().flatten() {
        let deviations = &report.deviations;
        let physics = report.physics.map_or("-".to_owned(), |physics| format!("{physics:?}").to_lowercase());
        text += &format!(
            "{:<34} {:<10} {:>6} {:>6} {:>11.1e} {:>11.1e} {:>11.1e} {:>11.1e} {:>9.0e} {:>7} {:>8}  {}\n",
            report.environment,
            physics,
            report.resets,
            report.steps,
            deviations.observation,
            deviations.achieved_goal,
            deviations.qpos,
            deviations.qvel,
            report.tolerance,
            report.reward_mismatches,
            report.success_mismatches,
            if report.passed() { "agrees" } else { "DIFFERS" }
        );
    }
    text
}
