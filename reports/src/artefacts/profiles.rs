//! Performance profiles of all methods.

use super::{ACROSS, Artefact, Drawing, basis, style};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::wording::counted;

pub(super) const ROW: Artefact = Artefact::figures("profiles", ACROSS, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let across = &analysis.across;
    if across.profiles.is_empty() {
        return Ok(Vec::new());
    }
    let (basis, style) = (basis(analysis), style(analysis));
    Ok(vec![Drawing {
        name: "profiles".to_owned(),
        title: format!("Performance profiles, {}", counted(basis.environments, "environment")),
        environment: None,
        svg: figure::profiles(&across.profiles, &basis, &style)?,
    }])
}
