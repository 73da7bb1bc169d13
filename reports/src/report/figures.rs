//! Which figures a report has.

use std::path::Path;

use rayon::prelude::*;

use super::Options;
use super::analysis::{Analysis, Groups};
use super::files::{File, file_name};
use crate::analysis::ablation::{AXES, Ablation, Axis};
use crate::analysis::curves::{Curve, Progress};
use crate::analysis::group::GroupKey;
use crate::error::ReportError;
use crate::render::figure::{self, LearningPanel};
use crate::render::page::{Picture, Section};

/// A figure before it is rendered.
struct Drawing {
    /// Name of its files, without extension.
    name: String,
    section: Section,
    title: String,
    svg: String,
}

/// All figures, rendered.
pub(super) struct Figures {
    /// For the page, in order.
    pub(super) pictures: Vec<Picture>,
    /// SVG and PNG of each: path within the report and content.
    pub(super) files: Vec<File>,
}

/// Draws and renders all figures that the results allow.
pub(super) fn figures(
    groups: &Groups<'_>,
    analysis: &Analysis<'_>,
    options: &Options,
) -> Result<Figures, ReportError> {
    let mut drawings = learning(groups)?;
    drawings.extend(across(groups, analysis, options)?);
    drawings.extend(ablations(groups, analysis)?);
    drawings.extend(variants(groups, analysis)?);
    for (index, heat) in analysis.heat.mazes.iter().enumerate() {
        drawings.push(Drawing {
            name: format!("heat-{}", file_name(&heat.maze.id, index)),
            section: Section::Environment(heat.maze.id.clone()),
            title: format!("{}: goals of training episodes and success at them, over time", heat.maze.id),
            svg: figure::heat(heat.maze, &heat.maps)?,
        });
    }
    let rendered: Result<Vec<_>, ReportError> = drawings.into_par_iter().map(render).collect();
    let (pictures, files): (Vec<_>, Vec<_>) = rendered?.into_iter().unzip();
    Ok(Figures { pictures, files: files.into_iter().flatten().collect() })
}

/// A figure for the page, and its files.
type Rendered = (Picture, Vec<File>);

fn render(drawing: Drawing) -> Result<Rendered, ReportError> {
    let Drawing { name, section, title, svg } = drawing;
    let png = figure::png(&name, &svg)?;
    let svg = figure::outlined(&name, &svg)?;
    let path = |extension: &str| Path::new("figures").join(format!("{name}.{extension}"));
    let files = vec![(path("svg"), svg.clone().into_bytes()), (path("png"), png)];
    Ok((Picture { section, title, svg }, files))
}

/// Learning curves against each kind of progress: one figure of all environments, and one of each.
fn learning(groups: &Groups<'_>) -> Result<Vec<Drawing>, ReportError> {
    let kinds = [
        (Progress::EnvironmentSteps, "grid", "success", "environment steps (Figures 2 and 6 of the paper)"),
        (Progress::GradientSteps, "grid-gradient-steps", "gradient-steps", "gradient steps"),
        (Progress::Hours, "grid-hours", "hours", "wall-clock time"),
    ];
    let mut drawings = Vec::new();
    let curves = groups.compared_curves();
    for (progress, grid, prefix, against) in kinds {
        // Without timings there is nothing to draw over hours.
        let mut panels = figure::by_environment(&curves);
        for panel in &mut panels {
            panel.curves.retain(|curve| curve.points.iter().any(|point| point.at(progress).is_some()));
        }
        panels.retain(|panel| !panel.curves.is_empty());
        if panels.is_empty() {
            continue;
        }
        drawings.push(Drawing {
            name: grid.to_owned(),
            section: Section::Overview,
            title: format!("All environments: success rate against {against}"),
            svg: figure::learning(&panels, groups.keys(), progress)?,
        });
        for (index, panel) in panels.iter().enumerate() {
            drawings.push(Drawing {
                name: format!("{prefix}-{}", file_name(&panel.title, index)),
                section: Section::Environment(panel.title.clone()),
                title: format!("{}: success rate against {against}", panel.title),
                svg: figure::learning(std::slice::from_ref(panel), groups.keys(), progress)?,
            });
        }
    }
    Ok(drawings)
}

/// What sums up environments.
fn across(
    groups: &Groups<'_>,
    analysis: &Analysis<'_>,
    options: &Options,
) -> Result<Vec<Drawing>, ReportError> {
    let across = &analysis.across;
    let count = across.environments.len();
    let resampling = options.resampling;
    let drawing = |name: &str, title: &str, svg: String| Drawing {
        name: name.to_owned(),
        section: Section::Across,
        title: format!("{title}, {count} environments"),
        svg,
    };
    let mut drawings = Vec::new();
    if !across.aggregates.is_empty() {
        let svg = figure::aggregates(&across.aggregates, resampling, groups.keys())?;
        drawings.push(drawing("aggregates", "Interquartile mean and optimality gap", svg));
    }
    if !across.profiles.is_empty() {
        let svg = figure::profiles(&across.profiles, count, resampling, groups.keys())?;
        drawings.push(drawing("profiles", "Performance profiles", svg));
    }
    if !across.efficiency.is_empty() {
        let svg = figure::efficiency(&across.efficiency, count, resampling, groups.keys())?;
        drawings.push(drawing("efficiency", "Sample efficiency", svg));
    }
    if !across.improvements.is_empty() {
        let svg = figure::improvements(&across.improvements, resampling, groups.keys())?;
        drawings.push(Drawing {
            title: "Probability of improvement, environments that both methods have".to_owned(),
            ..drawing("improvement", "", svg)
        });
    }
    Ok(drawings)
}

/// Figures 3 to 5 of the paper: one figure of all environments, and one of each where there are several.
fn ablations(groups: &Groups<'_>, analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let mut drawings = Vec::new();
    for (axis, ablations) in AXES.iter().zip(&analysis.ablations) {
        let labelled: Vec<(String, Vec<Curve>)> = ablations
            .iter()
            .enumerate()
            .map(|(index, one)| labelled(groups, ablations, index, one))
            .collect();
        if labelled.is_empty() {
            continue;
        }
        let panels: Vec<LearningPanel<'_>> = labelled
            .iter()
            .map(|(title, curves)| LearningPanel { title: title.clone(), curves: curves.iter().collect() })
            .collect();
        let keys = || labelled.iter().flat_map(|(_, curves)| curves).map(|curve| &curve.key);
        let plain = format!("{} = {}", axis.symbol, axis.reference);
        let heading = |what: &str| format!("Figure {} of the paper, {what}: {}", axis.figure, axis.title);
        drawings.push(Drawing {
            name: format!("ablation-{}", axis.id),
            section: Section::Ablations,
            title: heading("all environments"),
            svg: figure::ablation(&panels, keys(), &plain)?,
        });
        for (index, panel) in panels.iter().enumerate() {
            drawings.push(Drawing {
                name: format!("ablation-{}-{}", axis.id, file_name(&panel.title, index)),
                section: Section::Environment(panel.curves[0].key.environment.clone()),
                title: heading(&panel.title),
                svg: figure::ablation(std::slice::from_ref(panel), keys(), &plain)?,
            });
        }
    }
    Ok(drawings)
}

/// The curves of an ablation, each named by its value, below a title that no other ablation of the axis has.
fn labelled(
    groups: &Groups<'_>,
    all: &[Ablation<'_>],
    index: usize,
    ablation: &Ablation<'_>,
) -> (String, Vec<Curve>) {
    let environment = |ablation: &Ablation<'_>| &groups.all[ablation.levels[0].group].key.environment;
    let same = |other: &&Ablation<'_>| environment(other) == environment(ablation);
    let before = all[..index].iter().filter(same).count();
    let id = environment(ablation);
    let title = if before == 0 { id.clone() } else { format!("{id} ({})", before + 1) };
    let Axis { symbol, .. } = ablation.axis;
    let curve = |level: &crate::analysis::ablation::Level<'_>| {
        let curve = &groups.curves[level.group];
        let key = GroupKey { variant: format!("{symbol} = {}", level.text()), ..curve.key.clone() };
        Curve { key, ..curve.clone() }
    };
    (title, ablation.levels.iter().map(curve).collect())
}

/// Variants of one curriculum that no other figure shows, with its default: one figure per environment.
fn variants(groups: &Groups<'_>, analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let in_ablation = |index: usize| {
        analysis
            .ablations
            .iter()
            .flatten()
            .flat_map(|ablation| &ablation.levels)
            .any(|level| level.group == index)
    };
    let is_hidden = |index: &usize| !groups.compared[*index] && !in_ablation(*index);
    let hidden: Vec<&Curve> =
        (0..groups.all.len()).filter(is_hidden).map(|index| &groups.curves[index]).collect();
    let shown: Vec<&Curve> = groups
        .compared_curves()
        .into_iter()
        .chain(hidden.iter().copied())
        .filter(|curve| {
            let same = |other: &&Curve| {
                (&other.key.environment, &other.key.curriculum)
                    == (&curve.key.environment, &curve.key.curriculum)
            };
            hidden.iter().any(same)
        })
        .collect();
    let mut sorted = shown;
    sorted.sort_by(|a, b| a.key.cmp(&b.key));
    let mut drawings = Vec::new();
    for (index, panel) in figure::by_environment(&sorted).iter().enumerate() {
        drawings.push(Drawing {
            name: format!("variants-{}", file_name(&panel.title, index)),
            section: Section::Environment(panel.title.clone()),
            title: format!("{}: further variants", panel.title),
            svg: figure::learning(std::slice::from_ref(panel), groups.keys(), Progress::EnvironmentSteps)?,
        });
    }
    Ok(drawings)
}
