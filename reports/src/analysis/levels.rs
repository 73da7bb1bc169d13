//! Which variant stands for each level of an ablation, so that figures can draw both alike.

use std::cmp::Ordering;

use crate::analysis::ablation::{Ablation, text};
use crate::analysis::catalogue::Axis;
use crate::analysis::group::{Group, GroupKey};

/// A level of an ablation, and the variant that stands for it wherever variants are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelVariant {
    /// Curriculum id.
    pub curriculum: String,
    /// Which of the axes that the paper varies it lies on.
    pub axis: usize,
    /// As in legends: `n = 3`.
    pub name: String,
    /// Label of the variant; `None` where every variant with this value stands for another one already.
    pub variant: Option<String>,
    /// In how many fields that the paper varies that variant departs from the paper's own values.
    pub deviations: usize,
    /// Whether it is the paper's own value.
    pub is_reference: bool,
}

/// The levels of all ablations, `ablations` by axis. Of several variants with a value that one stands for it
/// that departs in the fewest other fields, in whatever environment.
pub fn levels(groups: &[Group<'_>], axes: &[Axis], ablations: &[Vec<Ablation<'_>>]) -> Vec<LevelVariant> {
    let mut all = Vec::new();
    for (place, (axis, ablations)) in axes.iter().zip(ablations).enumerate() {
        let mut found: Vec<Candidate<'_>> = Vec::new();
        for level in ablations.iter().flat_map(|ablation| &ablation.levels) {
            let Some(group) = groups.get(level.group) else { continue };
            let value = level.text();
            found.push(Candidate {
                key: &group.key,
                is_reference: value == axis.reference,
                name: axis.level(&value),
                deviations: deviations(group, axes),
            });
        }
        // Stable: of equals the first.
        found.sort_by(Candidate::cmp);
        let mut of_axis: Vec<LevelVariant> = Vec::new();
        for candidate in &found {
            let id = candidate.key.curriculum.id.as_str();
            let is_it = |level: &LevelVariant| level.curriculum == id && level.name == candidate.name;
            let variant = Some(candidate.key.variant.clone());
            let is_taken = of_axis.iter().any(|level| level.curriculum == id && level.variant == variant);
            let known = of_axis.iter_mut().find(|level| is_it(level));
            let level = LevelVariant {
                curriculum: id.to_owned(),
                axis: place,
                name: candidate.name.clone(),
                variant: variant.filter(|_| !is_taken),
                deviations: candidate.deviations,
                is_reference: candidate.is_reference,
            };
            match known {
                Some(known) if known.variant.is_some() || is_taken => {}
                Some(known) => *known = level,
                None => of_axis.push(level),
            }
        }
        all.extend(of_axis);
    }
    all
}

/// A group that could stand for a level.
struct Candidate<'a> {
    key: &'a GroupKey,
    name: String,
    deviations: usize,
    is_reference: bool,
}

impl Candidate<'_> {
    /// The best first: levels of the paper's own value, then those that depart least.
    fn cmp(&self, other: &Self) -> Ordering {
        let rank = |one: &Self| (!one.is_reference, one.deviations);
        rank(self).cmp(&rank(other)).then_with(|| self.key.cmp_method(other.key))
    }
}

fn deviations(group: &Group<'_>, axes: &[Axis]) -> usize {
    let Some(run) = group.runs.first() else { return 0 };
    let departs = |axis: &&Axis| {
        let value = run.manifest.config.pointer(&axis.pointer);
        value.is_some_and(|value| text(value) != axis.reference)
    };
    axes.iter().filter(departs).count()
}
