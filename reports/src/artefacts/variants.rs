//! Variants of a method that no other figure shows, with its default: one figure per environment.

use std::slice;

use super::files::file_name;
use super::{Artefact, Drawing, Section, style};
use crate::analysis::curves::{Curve, Progress};
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure;

pub(super) const ROW: Artefact = Artefact::figures("variants", Section::Environments, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let style = style(analysis);
    let mut drawings = Vec::new();
    for (index, panel) in figure::by_environment(&curves(analysis)).iter().enumerate() {
        drawings.push(Drawing {
            name: format!("variants-{}", file_name(&panel.title, index)),
            title: format!("{}: further variants", panel.title),
            environment: Some(panel.title.clone()),
            svg: figure::learning(slice::from_ref(panel), &style, Progress::EnvironmentSteps)?,
        });
    }
    Ok(drawings)
}

/// The curves to show, in order.
fn curves<'a>(analysis: &Analysis<'a>) -> Vec<&'a Curve> {
    let groups = analysis.groups;
    let in_ablation = |index: usize| {
        let levels = analysis.ablations.iter().flatten().flat_map(|ablation| &ablation.levels);
        levels.into_iter().any(|level| level.group == index)
    };
    let is_hidden = |index: &usize| !groups.compared[*index] && !in_ablation(*index);
    let hidden: Vec<&Curve> =
        (0..groups.all.len()).filter(is_hidden).map(|index| &groups.curves[index]).collect();
    let is_beside = |curve: &&Curve| {
        let method = |curve: &Curve| (curve.key.environment.clone(), curve.key.curriculum.clone());
        hidden.iter().any(|other| method(other) == method(curve))
    };
    let all = groups.compared_curves().into_iter().chain(hidden.iter().copied());
    let mut shown: Vec<&Curve> = all.filter(is_beside).collect();
    shown.sort_by(|a, b| a.key.cmp(&b.key));
    shown
}
