//! Where each teacher sent the student in a maze, and where the student succeeded: one figure per maze.

use super::files::file_name;
use super::{Artefact, Drawing, Section};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;

pub(super) const ROW: Artefact = Artefact::figures("heat", Section::Environments, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let mut drawings = Vec::new();
    for (index, heat) in analysis.heat.mazes.iter().enumerate() {
        let id = &heat.maze.id;
        drawings.push(Drawing {
            name: format!("heat-{}", file_name(id, index)),
            title: format!("{id}: goals of training episodes and success at them, over time"),
            environment: Some(id.clone()),
            svg: figure::heat(heat)?,
        });
    }
    Ok(drawings)
}
