//! Which places of its ordering a teacher trained on over time: one figure per environment.

use super::files::file_name;
use super::{Artefact, Drawing, Section};
use crate::analysis::ranks::RankMap;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;

pub(super) const ROW: Artefact = Artefact::figures("ranks", Section::Environments, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let mut drawings = Vec::new();
    for (index, id) in analysis.groups.environments().into_iter().enumerate() {
        let here = analysis.ranks.iter().filter(|map| map.key.environment == *id);
        let maps: Vec<RankMap> = here.cloned().collect();
        if !maps.is_empty() {
            drawings.push(Drawing {
                name: format!("ranks-{}", file_name(id, index)),
                title: format!("{id}: places of the teacher's ordering that were trained on, over time"),
                environment: Some(id.to_string()),
                svg: figure::ranks(&maps)?,
            });
        }
    }
    Ok(drawings)
}
