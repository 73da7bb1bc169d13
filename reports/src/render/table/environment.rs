//! The paper's Table 1: dimensions as they are, beside those it prints.

use polars::prelude::DataFrame;

use super::{Align, Table, column};
use crate::environment::EnvironmentInfo;
use crate::error::ReportError;
use crate::paper;

/// The environments as a data frame; null where the paper prints the true dimension.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot hold the rows.
pub fn environment_frame(rows: &[&EnvironmentInfo]) -> Result<DataFrame, ReportError> {
    let columns = vec![
        column("environment", rows, |row| row.id.as_str()),
        column("state", rows, |row| row.state as u64),
        column("goal", rows, |row| row.goal as u64),
        column("action", rows, |row| row.action as u64),
        column("paper_action", rows, |row| row.paper_action.map(|action| action as u64)),
        column("horizon", rows, |row| row.horizon as u64),
        column("note", rows, |row| row.note.as_str()),
    ];
    Ok(DataFrame::new(rows.len(), columns)?)
}

const HEADER: [&str; 7] =
    ["Environment", "State", "Goal", "Action", "Action in the paper", "Horizon", "Note"];

/// The action dimension that the paper prints.
fn in_the_paper(row: &EnvironmentInfo) -> String {
    match row.paper_action {
        Some(action) => action.to_string(),
        None if paper::TASKS.iter().any(|ids| ids.contains(&row.id.as_str())) => row.action.to_string(),
        None => "not in the paper".to_owned(),
    }
}

/// The environments as a table to read.
pub fn environment_table(rows: &[&EnvironmentInfo]) -> Table {
    let cells = |row: &&EnvironmentInfo| {
        [
            row.id.clone(),
            row.state.to_string(),
            row.goal.to_string(),
            row.action.to_string(),
            in_the_paper(row),
            row.horizon.to_string(),
            row.note.clone(),
        ]
    };
    let caption = "Dimensions of state, goal and action as the environments have them; the paper's Table 1 prints \
                   another action dimension where both numbers differ. Horizon: steps per episode.";
    let mut table = Table::new(caption.into(), 1, HEADER, rows.iter().map(cells));
    if let Some(note) = table.columns.last_mut() {
        note.1 = Align::Text;
    }
    table
}
