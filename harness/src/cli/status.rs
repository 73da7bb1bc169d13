//! `goalbench status`.

use guard::text::in_line;
use reports::store::layout;
use reports::store::problem::StoreProblem;
use reports::wording::counted;
use serde_json::json;
use std::path::PathBuf;

use super::{Exit, ExitCode, complain, print};
use crate::pace::{self, human};
use crate::status::{Activity, Overview, RunStatus, status};

#[derive(clap::Args)]
pub(super) struct Args {
    /// Results folder
    results: PathBuf,
    /// Exit with 1 if a run is damaged, or something lies where only runs belong
    #[arg(long)]
    strict: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

const ACTIVITIES: [(Activity, &str); 7] = [
    (Activity::Finished, "finished"),
    (Activity::Running, "running"),
    (Activity::Stopped, "stopped"),
    (Activity::Waiting, "waiting"),
    (Activity::Failed, "failed"),
    (Activity::Crashed, "crashed"),
    (Activity::Damaged, "damaged"),
];

pub(super) fn show(args: &Args) -> Exit {
    let Overview { runs, strays, trials } = status(&args.results)?;
    let named = |strays: &[StoreProblem]| strays.iter().map(StoreProblem::to_string).collect::<Vec<_>>();
    if args.json {
        let mut all = as_json(&runs, &named(&strays));
        if let Some(trials) = &trials {
            all["trials"] = as_json(&trials.runs, &named(&trials.strays));
            all["trials"]["chosen"] = trials.has_chosen.into();
        }
        print(&format!("{all:#}\n"));
    } else if let Some(trials) = &trials {
        let chosen = if trials.has_chosen { "settings are chosen" } else { "nothing is chosen yet" };
        print(&format!("phase 1 of 2: trials; {chosen}\n{}", as_text(&trials.runs)));
        print(&format!("\nphase 2 of 2: chosen and default settings\n{}", as_text(&runs)));
    } else {
        print(&as_text(&runs));
    }
    let of_trials = trials.as_ref().map_or(&[][..], |trials| &trials.strays);
    let lines = named(&strays)
        .into_iter()
        .chain(named(of_trials).into_iter().map(|line| format!("{}/{line}", layout::TUNING)));
    let mut is_sound = true;
    for line in lines {
        complain(&format!("goalbench: {line}"));
        is_sound = false;
    }
    let of_trials = trials.as_ref().map_or(&[][..], |trials| &trials.runs);
    is_sound &= count(&runs, Activity::Damaged) + count(of_trials, Activity::Damaged) == 0;
    Ok(if is_sound || !args.strict { ExitCode::Success } else { ExitCode::Failed })
}

fn as_json(runs: &[RunStatus], strays: &[String]) -> serde_json::Value {
    let counts: serde_json::Map<_, _> = ACTIVITIES
        .iter()
        .map(|(activity, name)| ((*name).to_owned(), count(runs, *activity).into()))
        .collect();
    json!({ "counts": counts, "runs": runs, "strays": strays })
}

fn count(runs: &[RunStatus], activity: Activity) -> usize {
    runs.iter().filter(|run| run.activity == activity).count()
}

fn as_text(runs: &[RunStatus]) -> String {
    if runs.is_empty() {
        return "no runs yet\n".to_owned();
    }
    let mut text = format!(
        "{:<52} {:<9} {:>17} {:>8} {:>8} {:>8}\n",
        "run", "state", "step", "success", "steps/s", "left"
    );
    for run in runs {
        let state =
            ACTIVITIES.iter().find(|(activity, _)| *activity == run.activity).map_or("", |(_, name)| name);
        let left = run.left_s.map_or("-".to_owned(), |left| human(pace::seconds(left)));
        text += &format!(
            "{:<52} {state:<9} {:>17} {:>8} {:>8} {left:>8}",
            in_line(&run.run.to_string()),
            pace::of_steps(run.step, run.steps),
            run.success_rate.map_or("-".to_owned(), |rate| format!("{rate:.2}")),
            run.steps_per_s.map_or("-".to_owned(), pace::rounded),
        );
        if run.crashes > 0 {
            text += &format!("  {}", counted(run.crashes, "crash"));
        }
        if let Some(reason) = &run.reason {
            text += &format!("  {}", in_line(reason));
        }
        text.push('\n');
    }
    let counts = ACTIVITIES
        .iter()
        .map(|(activity, name)| (count(runs, *activity), name))
        .filter(|(count, _)| *count > 0);
    let counts: Vec<String> = counts.map(|(count, name)| format!("{count} {name}")).collect();
    text += &format!("{}: {}", counted(runs.len(), "run"), counts.join(", "));
    let running: Vec<&RunStatus> = runs.iter().filter(|run| run.activity == Activity::Running).collect();
    let left: f64 = runs.iter().filter_map(|run| run.left_s).sum();
    if !running.is_empty() && left > 0.0 {
        let speed: f64 = running.iter().filter_map(|run| run.steps_per_s).sum();
        let left = human(pace::seconds(left / running.len() as f64));
        text += &format!("; {} steps/s together, about {left} left for what has begun", pace::rounded(speed));
    }
    text + "\n"
}
