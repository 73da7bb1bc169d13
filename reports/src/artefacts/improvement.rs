//! The probability that the first method improves on each other one.

use super::{ACROSS, Artefact, Drawing, basis, style};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure::{self, Basis};

pub(super) const ROW: Artefact = Artefact::figures("improvement", ACROSS, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let across = &analysis.across;
    if across.improvements.is_empty() {
        return Ok(Vec::new());
    }
    let fewest_runs = across.improvements.iter().map(|row| row.fewest_runs).min().unwrap_or(0);
    let (basis, style) = (Basis { fewest_runs, ..basis(analysis) }, style(analysis));
    Ok(vec![Drawing {
        name: "improvement".to_owned(),
        title: "Probability of improvement, environments that both methods have".to_owned(),
        environment: None,
        svg: figure::improvements(&across.improvements, &basis, &style)?,
    }])
}
