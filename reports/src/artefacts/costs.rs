//! What each method took: steps, gradient steps and time.

use super::{Artefact, Repeated, Section, columns};
use crate::analysis::cost::Cost;
use crate::analysis::summary::GroupSummary;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::cells::{UNDEFINED, duration, or_undefined, span, thousands};
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "costs", title: "What training took" };

pub(super) const ROW: Artefact =
    Artefact::table("costs", SECTION, "environment, curriculum and variant", sheet).repeated(Repeated::Open);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    Sheet::of(caption(&analysis.summaries), &analysis.summaries, &columns())
}

fn columns() -> [Column<'static, GroupSummary>; 16] {
    [
        columns::environment(|row| &row.key),
        columns::curriculum(|row| &row.key),
        columns::variant(|row| &row.key),
        columns::seeds(|row| row.n_seeds),
        columns::finished(),
        Column::count(
            "steps_min",
            "fewest training steps at a finished run's last evaluation",
            |row: &GroupSummary| row.cost.steps.0,
        ),
        Column::count("steps_max", "most of them", |row: &GroupSummary| row.cost.steps.1),
        Column::only_shown("Steps", |row: &GroupSummary| steps(&row.cost)),
        Column::real(
            "probe_steps",
            "mean over finished runs of the steps in probe rollouts that the teacher asked for",
            |row: &GroupSummary| row.cost.probe_steps,
        ),
        Column::real(
            "uncharged_steps",
            "mean over finished runs of those of them that are not charged to the budget, and so are not in steps_min and \
             steps_max",
            |row: &GroupSummary| row.cost.uncharged_steps,
        ),
        Column::real(
            "gradient_steps",
            "mean over finished runs of the student's gradient steps",
            |row: &GroupSummary| row.cost.gradient_steps,
        )
        .shown("Gradient steps", |row| thousands(row.cost.gradient_steps.round() as u64)),
        Column::count(
            "n_timed",
            "finished runs whose last evaluation has a timing: those that the times are means over",
            |row: &GroupSummary| row.cost.n_timed as u64,
        ),
        Column::real(
            "wall_hours",
            "mean over these of the hours of wall-clock time; empty where there are none",
            |row: &GroupSummary| row.cost.wall_hours,
        )
        .shown("Time per run", time),
        Column::real(
            "teacher_hours",
            "hours of it spent in the teacher; empty where timings do not tell",
            |row: &GroupSummary| row.cost.teacher_hours,
        )
        .shown("Teacher", |row| part(&row.cost, row.cost.teacher_hours)),
        Column::real(
            "learning_hours",
            "hours of it spent in the student's gradient steps; likewise",
            |row: &GroupSummary| row.cost.learning_hours,
        )
        .shown("Student's learning", |row| part(&row.cost, row.cost.learning_hours)),
        Column::real("evaluation_hours", "hours of it spent in evaluations", |row: &GroupSummary| {
            row.cost.evaluation_hours
        })
        .shown("Evaluations", |row| part(&row.cost, row.cost.evaluation_hours)),
    ]
}

fn caption(rows: &[GroupSummary]) -> String {
    let probes = if rows.iter().any(|row| row.cost.probe_steps > 0.0) {
        " Probe rollouts: steps in episodes that the teacher asked for and that train nobody, a mean over seeds; part of the \
         steps where they are charged to the budget, beyond them where not."
    } else {
        ""
    };
    format!(
        "What training took up to the last evaluation, of finished runs; where there are none, of all as far as they got. \
         Steps: in the environment, those of evaluations not counted, a range where seeds differ. Gradient steps: of \
         the student, without those of a teacher's own networks. Time: by the clock on the wall, evaluations included. \
         Teacher: time spent in proposing goals, observing episodes and its \
         own learning, with their share of the wall-clock time; the student's learning and evaluations likewise; the \
         rest is simulation. Means over seeds, over fewer where n says so, because the timings of the others were lost; {UNDEFINED} where \
         timings do not tell. Times of runs that shared a \
         machine with others compare loosely.{probes}"
    )
}

/// `400,000`; `400,000 (172,000 in probe rollouts)`, or `400,000 + 172,000 in probe rollouts` where those are
/// not charged.
fn steps(cost: &Cost) -> String {
    let rounded = |steps: f64| thousands(steps.round() as u64);
    let (charged, uncharged) = (cost.probe_steps - cost.uncharged_steps, cost.uncharged_steps);
    let mut text = span(cost.steps);
    if charged > 0.0 {
        text += &format!(" ({} in probe rollouts)", rounded(charged));
    }
    if uncharged > 0.0 {
        text += &format!(" + {} in probe rollouts", rounded(uncharged));
    }
    text
}

/// `0.50 h`; `0.50 h (n = 1)` where other runs have lost their timings.
fn time(row: &GroupSummary) -> String {
    let counted = if row.n_finished > 0 { row.n_finished } else { row.n_seeds };
    let n_timed = row.cost.n_timed;
    let few = if n_timed < counted { format!(" (n = {n_timed})") } else { String::new() };
    or_undefined(row.cost.wall_hours, |hours| duration(hours) + &few)
}

/// `0.50 h (25 %)`.
fn part(cost: &Cost, hours: Option<f64>) -> String {
    let share = cost.share(hours).map(|share| format!(" ({:.0} %)", 100.0 * share));
    or_undefined(hours, |hours| duration(hours) + &share.unwrap_or_default())
}
