//! Learning curves of all methods against each kind of progress: one figure of all environments, and one of
//! each.

use std::slice;

use super::files::file_name;
use super::{Artefact, Drawing, RESULTS, style};
use crate::analysis::curves::Progress;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;
use crate::schema::Record;

/// The paper's main comparison.
pub(super) const STEPS: Artefact = Artefact::figures("success", RESULTS, |analysis| {
    let source = &analysis.paper().figures;
    let source = if source.is_empty() { String::new() } else { format!(" ({source} of the paper)") };
    draw(analysis, Progress::EnvironmentSteps, ["grid", "success"], &format!("environment steps{source}"))
});

/// The same against all steps taken, where probe rollouts were not charged to some budget: else it is the
/// same figure.
pub(super) const ALL_STEPS: Artefact = Artefact::figures("all-steps", RESULTS, |analysis| {
    let is_uncharged = |record: &Record| record.uncharged_steps > 0;
    if !analysis.store.runs().iter().any(|run| run.records.iter().any(is_uncharged)) {
        return Ok(Vec::new());
    }
    draw(
        analysis,
        Progress::AllSteps,
        ["grid-all-steps", "all-steps"],
        "all steps taken, probe rollouts included",
    )
});

/// The same against gradient steps of the student.
pub(super) const GRADIENT_STEPS: Artefact = Artefact::figures("gradient-steps", RESULTS, |analysis| {
    draw(analysis, Progress::GradientSteps, ["grid-gradient-steps", "gradient-steps"], "gradient steps")
});

/// The same against time.
pub(super) const HOURS: Artefact = Artefact::figures("hours", RESULTS, |analysis| {
    draw(analysis, Progress::Hours, ["grid-hours", "hours"], "wall-clock time")
});

/// `grid` is the name of the figure of all environments, `single` that of each one's, up to its id.
fn draw(
    analysis: &Analysis<'_>,
    progress: Progress,
    [grid, single]: [&str; 2],
    against: &str,
) -> Result<Vec<Drawing>, ReportError> {
    let style = style(analysis);
    let curves = analysis.groups.compared_curves();
    let mut panels = figure::by_environment(&curves);
    // Without timings there is nothing to draw over hours.
    for panel in &mut panels {
        panel.curves.retain(|curve| curve.points.iter().any(|point| point.at(progress).is_some()));
    }
    panels.retain(|panel| !panel.curves.is_empty());
    if panels.is_empty() {
        return Ok(Vec::new());
    }
    let mut drawings = vec![Drawing {
        name: grid.to_owned(),
        title: format!("All environments: success rate against {against}"),
        environment: None,
        svg: figure::learning(&panels, &style, progress)?,
    }];
    for (index, panel) in panels.iter().enumerate() {
        drawings.push(Drawing {
            name: format!("{single}-{}", file_name(&panel.title, index)),
            title: format!("{}: success rate against {against}", panel.title),
            environment: Some(panel.title.clone()),
            svg: figure::learning(slice::from_ref(panel), &style, progress)?,
        });
    }
    Ok(drawings)
}
