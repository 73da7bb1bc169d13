//! How students learned: all diagnoses as tidy data, and, on request, one figure per environment.

use super::numbers::drawings;
use super::{Artefact, Drawing, Section, columns};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{Column, Sheet};
use crate::schema::{Learning, RunKey};

pub(super) const ROW: Artefact =
    Artefact::table("student", Section::Nowhere, "evaluation", sheet).with_parquet();

pub(super) const FIGURES: Artefact = Artefact::figures("student", Section::Environments, draw);

/// What stands in a figure's caption.
const CAPTION: &str = "losses, mean Q(s, g, a) and norms of gradients on one batch at each evaluation, and the size \
                       of the replay buffer";

type Row<'a> = (&'a RunKey, &'a Learning);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let lines = &analysis.student.lines;
    let rows: Vec<Row<'_>> =
        lines.iter().flat_map(|(run, lines)| lines.iter().map(move |line| (run, line))).collect();
    Sheet::of(String::new(), &rows, &columns())
}

fn columns<'a>() -> Vec<Column<'a, Row<'a>>> {
    let real = |name, meaning, value: fn(&Learning) -> Option<f64>| {
        Column::real(name, meaning, move |row: &Row<'a>| value(row.1))
    };
    let mut columns: Vec<Column<'a, Row<'a>>> = columns::run(|row: &Row<'a>| row.0).into();
    columns.extend([
        Column::count("step", "training steps taken in the environment", |row: &Row<'a>| row.1.step),
        Column::count(
            "eval_index",
            "index of the evaluation, 0 for the untrained student",
            |row: &Row<'a>| row.1.eval_index,
        ),
        real(
            "critic_loss",
            "mean (Q(s, g, a) - y)² on one batch, drawn and relabelled like those that the student learns from; empty, \
             as are the following, before the first episode or where it is not finite",
            |line| line.critic_loss,
        ),
        real("actor_loss", "-mean Q(s, g, π(s, g)) + λ·mean π² on it", |line| line.actor_loss),
        real("mean_q", "mean Q(s, g, a) on it", |line| line.mean_q),
        real("critic_gradient_norm", "Euclidean norm of the critic's gradient on it", |line| {
            line.critic_gradient_norm
        }),
        real("actor_gradient_norm", "Euclidean norm of the actor's gradient on it", |line| {
            line.actor_gradient_norm
        }),
        Column::count("replay_episodes", "episodes in the replay buffer", |row: &Row<'a>| {
            row.1.replay_episodes
        }),
        Column::count("replay_transitions", "transitions in the replay buffer", |row: &Row<'a>| {
            row.1.replay_transitions
        }),
    ]);
    columns
}

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    drawings(analysis, "student", "how the student learned", CAPTION, |analysis| {
        analysis.student.plots(analysis.groups)
    })
}
