//! Performance profiles of all methods.

use super::{ACROSS, Artefact, Drawing};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;

pub(super) const ROW: Artefact = Artefact::figures("profiles", ACROSS, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let across = &analysis.across;
    if across.profiles.is_empty() {
        return Ok(Vec::new());
    }
    let (count, resampling) = (across.environments.len(), analysis.options.resampling);
    let keys = analysis.groups.keys();
    Ok(vec![Drawing {
        name: "profiles".to_owned(),
        title: format!("Performance profiles, {count} environments"),
        environment: None,
        svg: figure::profiles(&across.profiles, count, resampling, keys)?,
    }])
}
