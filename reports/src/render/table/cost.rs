//! What each method took: steps, gradient steps and time.

use polars::prelude::DataFrame;

use super::cells::{UNDEFINED, decimal, or_undefined, span, thousands};
use super::{Table, column};
use crate::analysis::cost::Cost;
use crate::analysis::summary::Row;
use crate::error::ReportError;
use crate::methods;

/// The costs as a data frame, unrounded; null where timings do not tell.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn cost_frame(rows: &[Row]) -> Result<DataFrame, ReportError> {
    let columns = vec![
        column("environment", rows, |row| row.key.environment.as_str()),
        column("curriculum", rows, |row| row.key.curriculum.as_str()),
        column("variant", rows, |row| row.key.variant.as_str()),
        column("n_seeds", rows, |row| row.n_seeds as u64),
        column("steps_min", rows, |row| row.cost.steps.0),
        column("steps_max", rows, |row| row.cost.steps.1),
        column("gradient_steps", rows, |row| row.cost.gradient_steps),
        column("wall_hours", rows, |row| row.cost.wall_hours),
        column("teacher_hours", rows, |row| row.cost.teacher_hours),
        column("learning_hours", rows, |row| row.cost.learning_hours),
        column("evaluation_hours", rows, |row| row.cost.evaluation_hours),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 9] = [
    "Environment",
    "Curriculum",
    "Variant",
    "Steps",
    "Gradient steps",
    "Hours per run",
    "Teacher",
    "Student's learning",
    "Evaluations",
];

/// The costs as a table to read.
pub fn cost_table(rows: &[Row]) -> Table {
    let cells = |row: &Row| {
        let cost = &row.cost;
        [
            row.key.environment.clone(),
            methods::title(&row.key.curriculum).to_owned(),
            row.key.variant.clone(),
            span(cost.steps),
            thousands(cost.gradient_steps.round() as u64),
            or_undefined(cost.wall_hours, decimal),
            part(cost, cost.teacher_hours),
            part(cost, cost.learning_hours),
            part(cost, cost.evaluation_hours),
        ]
    };
    let caption = format!(
        "What training took up to the last evaluation. Steps: in the environment, those of evaluations not counted, a \
         range where seeds differ. Gradient steps: of the student, without those of a teacher's own networks. Hours: \
         wall-clock time, evaluations included. Teacher: hours spent in proposing goals, observing episodes and its \
         own learning, with their share of the wall-clock time; the student's learning and evaluations likewise; the \
         rest is simulation. Means over seeds; {UNDEFINED} where timings do not tell. Times of runs that shared a \
         machine with others compare loosely."
    );
    Table::new(caption, 3, HEADER, rows.iter().map(cells))
}

/// `0.50 (25 %)`.
fn part(cost: &Cost, hours: Option<f64>) -> String {
    let share = cost.share(hours).map(|share| format!(" ({:.0} %)", 100.0 * share));
    or_undefined(hours, |hours| decimal(hours) + &share.unwrap_or_default())
}
