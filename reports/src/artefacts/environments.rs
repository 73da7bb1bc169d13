//! Dimensions of environments as they are, beside those that the paper prints.

use super::{Artefact, Section, columns};
use crate::analysis::catalogue::{EnvironmentInfo, Paper};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "dimensions", title: "Dimensions of the environments" };

pub(super) const ROW: Artefact = Artefact::table("environments", SECTION, "environment", sheet);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let run = analysis.groups.environments();
    let known = analysis.catalogue().environments.iter();
    let rows: Vec<&EnvironmentInfo> = known.filter(|info| run.contains(&info.id.as_str())).collect();
    Sheet::of(CAPTION.to_owned(), &rows, &columns(analysis.paper()))
}

fn columns<'a>(paper: &'a Paper) -> [Column<'a, &'a EnvironmentInfo>; 7] {
    let id = |row: &&EnvironmentInfo| row.id.clone();
    [
        Column::text(columns::ENVIRONMENT.0, columns::ENVIRONMENT.1, id).named("Environment", id),
        Column::count("state", "dimension of the state", |row: &&EnvironmentInfo| row.state as u64)
            .shown("State", |row| row.state.to_string()),
        Column::count("goal", "dimension of the goal", |row: &&EnvironmentInfo| row.goal as u64)
            .shown("Goal", |row| row.goal.to_string()),
        Column::count("action", "dimension of the action", |row: &&EnvironmentInfo| row.action as u64)
            .shown("Action", |row| row.action.to_string()),
        Column::count(
            "paper_action",
            "dimension of the action that the paper prints; empty where it prints no other one",
            |row: &&EnvironmentInfo| row.paper_action.map(|action| action as u64),
        )
        .shown("Action in the paper", |row| in_the_paper(row, paper)),
        Column::count("horizon", "steps per episode", |row: &&EnvironmentInfo| row.horizon as u64)
            .shown("Horizon", |row| row.horizon.to_string()),
        Column::text("note", "why they differ", |row: &&EnvironmentInfo| row.note.clone())
            .named("Note", |row| row.note.clone()),
    ]
}

/// The action dimension that the paper prints.
fn in_the_paper(row: &EnvironmentInfo, paper: &Paper) -> String {
    match row.paper_action {
        Some(action) => action.to_string(),
        None if paper.tasks.iter().any(|ids| ids.contains(&row.id)) => row.action.to_string(),
        None => "not in the paper".to_owned(),
    }
}

const CAPTION: &str = "Dimensions of state, goal and action as the environments have them; the paper's Table 1 prints \
                       another action dimension where both numbers differ. Horizon: steps per episode.";
