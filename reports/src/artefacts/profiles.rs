//! Performance profiles of all methods.

use super::{ACROSS, Artefact, Drawing, basis};
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
    let (basis, keys) = (basis(analysis), analysis.groups.keys());
    Ok(vec![Drawing {
        name: "profiles".to_owned(),
        title: format!("Performance profiles, {}", counted(basis.environments, "environment")),
        environment: None,
        svg: figure::profiles(&across.profiles, &basis, keys)?,
    }])
}
