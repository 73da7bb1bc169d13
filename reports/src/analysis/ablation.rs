//! A paper's ablations, found in what runs were configured with: variants of a method that differ in one
//! field alone.

use serde_json::Value;

use crate::analysis::catalogue::Axis;
use crate::analysis::group::Group;

/// The groups of one environment whose configs differ in the field of an axis alone.
#[derive(Clone, Debug)]
pub struct Ablation<'a> {
    /// What is varied.
    pub axis: &'a Axis,
    /// Value of the field and the index of its group, by rising value; at least two.
    pub levels: Vec<Level<'a>>,
}

/// One value of an ablation.
#[derive(Clone, Debug)]
pub struct Level<'a> {
    /// The value, from the first run's config.
    pub value: &'a Value,
    /// Index of the group among all groups.
    pub group: usize,
}

impl Level<'_> {
    /// The value as text, without quotes.
    pub fn text(&self) -> String {
        text(self.value)
    }
}

/// A value as text, without quotes.
pub fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// All ablations along `axis`, by environment; `groups` come in order. Runs of archives are no levels.
pub fn ablations<'a>(groups: &[Group<'a>], axis: &'a Axis) -> Vec<Ablation<'a>> {
    let mut found: Vec<(&str, Value, Ablation<'a>)> = Vec::new();
    for (index, group) in groups.iter().enumerate().filter(|(_, group)| group.is_own()) {
        let Some(run) = group.runs.first() else { continue };
        let Some(value) = run.manifest.config.pointer(&axis.pointer) else { continue };
        // What must agree: everything but the field itself.
        let mut rest = run.manifest.config.clone();
        if let Some(field) = rest.pointer_mut(&axis.pointer) {
            *field = Value::Null;
        }
        let environment = run.key().environment.as_str();
        let level = Level { value, group: index };
        match found.iter_mut().find(|(other, config, _)| *other == environment && *config == rest) {
            // A value that several variants share is represented by the first of them.
            Some((_, _, ablation)) if ablation.levels.iter().any(|other| other.value == value) => {}
            Some((_, _, ablation)) => ablation.levels.push(level),
            None => found.push((environment, rest, Ablation { axis, levels: vec![level] })),
        }
    }
    let mut ablations: Vec<Ablation<'a>> = found.into_iter().map(|(_, _, ablation)| ablation).collect();
    ablations.retain(|ablation| ablation.levels.len() > 1);
    for ablation in &mut ablations {
        let number = |level: &Level<'_>| level.value.as_f64().unwrap_or(f64::INFINITY);
        ablation.levels.sort_by(|a, b| number(a).total_cmp(&number(b)).then_with(|| a.text().cmp(&b.text())));
    }
    ablations
}
