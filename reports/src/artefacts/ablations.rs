//! The paper's ablations: for every field that it varies one figure of all environments, and one of each.

use std::slice;

use super::files::file_name;
use super::{Artefact, Drawing, Section, style};
use crate::analysis::ablation::{Ablation, Level};
use crate::analysis::curves::Curve;
use crate::analysis::group::GroupKey;
use crate::analysis::groups::Groups;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::figure::{self, LearningPanel};

const SECTION: Section = Section::Named { id: "ablations", title: "Ablations" };

pub(super) const ROW: Artefact = Artefact::figures("ablation", SECTION, draw);

fn draw(analysis: &Analysis<'_>) -> Result<Vec<Drawing>, ReportError> {
    let style = style(analysis);
    let mut drawings = Vec::new();
    for (axis, ablations) in analysis.paper().axes.iter().zip(&analysis.ablations) {
        let label = |index| labelled(analysis.groups, ablations, index);
        let labelled: Vec<(String, Vec<Curve>)> = (0..ablations.len()).map(label).collect();
        if labelled.is_empty() {
            continue;
        }
        let panels: Vec<LearningPanel<'_>> = labelled
            .iter()
            .map(|(title, curves)| LearningPanel { title: title.clone(), curves: curves.iter().collect() })
            .collect();
        let heading = |what: &str| format!("{} of the paper, {what}: {}", axis.source, axis.title);
        drawings.push(Drawing {
            name: format!("ablation-{}", axis.id),
            title: heading("all environments"),
            environment: None,
            svg: figure::ablation(&panels, &style)?,
        });
        for (index, panel) in panels.iter().enumerate() {
            drawings.push(Drawing {
                name: format!("ablation-{}-{}", axis.id, file_name(&panel.title, index)),
                title: heading(&panel.title),
                environment: Some(panel.curves[0].key.environment.clone()),
                svg: figure::ablation(slice::from_ref(panel), &style)?,
            });
        }
    }
    Ok(drawings)
}

/// The curves of ablation `index`, each named by its value, below a title that no other ablation of the axis
/// has.
fn labelled(groups: &Groups<'_>, all: &[Ablation<'_>], index: usize) -> (String, Vec<Curve>) {
    let ablation = &all[index];
    let environment = |ablation: &Ablation<'_>| &groups.all[ablation.levels[0].group].key.environment;
    let id = environment(ablation);
    let before = all[..index].iter().filter(|other| environment(other) == id).count();
    let title = if before == 0 { id.clone() } else { format!("{id} ({})", before + 1) };
    let curve = |level: &Level<'_>| {
        let curve = &groups.curves[level.group];
        let key = GroupKey { variant: ablation.axis.level(&level.text()), ..curve.key.clone() };
        Curve { key, ..curve.clone() }
    };
    (title, ablation.levels.iter().map(curve).collect())
}
