//! Where each teacher sent the student in a task whose goals are points in space: one figure per task.

use super::files::file_name;
use super::{Artefact, Drawing, Section};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;

pub(super) const ROW: Artefact = Artefact::figures("goals", Section::Environments, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let mut drawings = Vec::new();
    for (index, maps) in analysis.goals.environments.iter().enumerate() {
        let id = &maps.environment;
        drawings.push(Drawing {
            name: format!("goals-{}", file_name(id, index)),
            title: format!("{id}: goals of training episodes from above and from the side, over time"),
            environment: Some(id.clone()),
            svg: figure::goal_map(maps)?,
        });
    }
    Ok(drawings)
}
