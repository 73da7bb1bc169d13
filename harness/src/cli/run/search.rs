//! A protocol with a search: first all trials, then the chosen settings beside the default ones. Each phase
//! is a plan in a results folder of its own. Killed at any moment, the same command goes on: what has ended
//! is kept, and the same trials lead to the same choice.

use std::path::Path;

use reports::schema::Tuning;
use reports::store::layout;
use reports::wording::counted;

use super::dry;
use super::phase::{Command, Done, code, tell_submitted};
use crate::cli::{Exit, print};
use crate::console::word;
use crate::error::HarnessError;
use crate::protocol::plan::Plan;
use crate::protocol::search::Trials;
use crate::sweep::reporter::Detail;
use crate::sweep::{Ending, Endings, ExitCode};
use crate::tuning;

/// Carries both phases out.
pub(super) fn run(command: &Command<'_>, trials: &Trials) -> Exit {
    let Command { registry, args, protocol, results, .. } = *command;
    let folder = layout::tuning_dir(results);
    let plan = Plan::new(&trials.protocol, registry)?;
    // Refused now, not after days of trials: the part of the experiment that is known.
    let stored = tuning::stored(protocol, trials, results)?;
    command.survey(&Plan::new(&protocol.without_search(), registry)?, results)?;
    let endings = match command.carry_out(&plan, &folder)? {
        Done::Submitted(submitted) => {
            tell_submitted(&submitted, results);
            print(
                "these are the trials; when they have ended, the same command submits the chosen and the default settings\n",
            );
            return Ok(ExitCode::Success);
        }
        Done::Here(endings) | Done::Before(endings) => endings,
    };
    let first = code(&endings, &folder);
    if !all_ended(&endings, plan.runs.len()) {
        return Ok(first);
    }
    let choice = tuning::choose(protocol, trials, results)?;
    let plan = Plan::new(&protocol.tuned(trials, &tuning::chosen(&choice)), registry)?;
    // Before the choice is written: runs with other chosen settings are refused, and stay with their choice.
    command.survey(&plan, results)?;
    tuning::refuse_other_runs(&choice, results)?;
    let choice = tuning::beside(stored, choice);
    tuning::save(&choice, results)?;
    if !args.json && args.detail.detail() != Detail::Quiet {
        print(&said(&choice, endings.total(), results));
    }
    let second = command.carry_out(&plan, results)?.told(results, args.json)?;
    // A failure weighs more than a stop.
    Ok(if second == ExitCode::Success || first == ExitCode::Failed { first } else { second })
}

/// Whether all `count` runs have ended, well or not.
fn all_ended(endings: &Endings, count: usize) -> bool {
    let ended = endings.iter().filter(|(_, ending)| matches!(ending, Ending::Ended(_))).count();
    ended == count
}

fn said(choice: &Tuning, runs: usize, results: &Path) -> String {
    let file = layout::choice_file(results);
    let mut text = format!("{} of trials ended; chosen by them, in {}:\n", counted(runs, "run"), word(&file));
    for one in &choice.curricula {
        text += &format!("  {}: {}\n", one.curriculum, one.reason);
    }
    text
}

/// Says what both phases would take.
pub(super) fn dry_run(command: &Command<'_>, trials: &Trials) -> Exit {
    let Command { registry, args, protocol, results, .. } = *command;
    let folder = layout::tuning_dir(results);
    let plan = Plan::new(&trials.protocol, registry)?;
    let stored = tuning::stored(protocol, trials, results)?;
    let sweep = command.survey(&plan, &folder)?;
    print("phase 1 of 2: trials\n");
    dry::dry_run(registry, args, &plan, &sweep, &folder)?;
    let have_ended = sweep.open().next().is_none();
    let (plan, note) = if have_ended {
        let choice = tuning::choose(protocol, trials, results)?;
        tuning::refuse_other_runs(&choice, results)?;
        (Plan::new(&protocol.tuned(trials, &tuning::chosen(&choice)), registry)?, "")
    } else {
        let note =
            "; where no trial is better, `tuned` falls away; what is chosen counts as the default settings";
        let before = stored.as_ref().map(tuning::chosen).unwrap_or_default();
        (Plan::new(&protocol.untuned(trials, &before), registry)?, note)
    };
    let sweep = command.survey(&plan, results)?;
    print(&format!("phase 2 of 2: chosen and default settings{note}\n"));
    dry::dry_run(registry, args, &plan, &sweep, results)
}

/// The configs of both phases, as far as they are known before anything is chosen.
pub(super) fn configs(command: &Command<'_>, trials: &Trials) -> Result<String, HarnessError> {
    let mut all = Plan::new(&command.protocol.without_search(), command.registry)?;
    all.runs.extend(Plan::new(&trials.protocol, command.registry)?.runs);
    Ok(all.configs())
}
