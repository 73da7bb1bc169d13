//! Interquartile mean and optimality gap of all methods, with their intervals.

use super::{ACROSS, Artefact, Drawing, basis, style};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::wording::counted;

pub(super) const ROW: Artefact = Artefact::figures("aggregates", ACROSS, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let across = &analysis.across;
    if across.aggregates.is_empty() {
        return Ok(Vec::new());
    }
    let (basis, style) = (basis(analysis), style(analysis));
    Ok(vec![Drawing {
        name: "aggregates".to_owned(),
        title: format!(
            "Interquartile mean and optimality gap, {}",
            counted(basis.environments, "environment")
        ),
        environment: None,
        svg: figure::aggregates(&across.aggregates, &basis, &style)?,
    }])
}
