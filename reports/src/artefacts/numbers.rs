//! Numbers over training that are drawn on request, and those of teachers among them.

use super::files::file_name;
use super::{Artefact, Drawing, Section, style};
use crate::analysis::numbers::{self, NumberPlots};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;

/// What teachers recorded, as far as there are numbers.
pub(super) const TEACHERS: Artefact = Artefact::figures("teachers", Section::Environments, |analysis| {
    let caption = "the numbers that teachers record at each evaluation";
    drawings(analysis, "teachers", "numbers of teachers", caption, |analysis| {
        numbers::of_teachers(analysis.groups)
    })
});

/// A figure per environment, if the report was asked for them.
pub(super) fn drawings(
    analysis: &Analysis<'_>,
    id: &str,
    what: &str,
    caption: &str,
    plots: impl Fn(&Analysis<'_>) -> Vec<NumberPlots>,
) -> Result<Vec<Drawing>, ReportError> {
    if !analysis.options.diagnostics {
        return Ok(Vec::new());
    }
    let style = style(analysis);
    let mut drawings = Vec::new();
    for (index, plots) in plots(analysis).iter().enumerate() {
        drawings.push(Drawing {
            name: format!("{id}-{}", file_name(&plots.environment, index)),
            title: format!("{}: {what}", plots.environment),
            environment: Some(plots.environment.clone()),
            svg: figure::numbers(plots, &style.palette, caption)?,
        });
    }
    Ok(drawings)
}
