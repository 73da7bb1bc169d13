//! Which groups of the paper's method are readings of one another, and which of them go together over
//! environments.

use std::collections::BTreeMap;

use serde_json::Value;

use super::Values;
use crate::analysis::ablation;
use crate::analysis::catalogue::{Paper, ReadingChoice};
use crate::analysis::group::Group;

/// The method's groups of one environment whose configs differ in the paper's choices alone.
pub(super) struct Place {
    pub(super) environment: String,
    /// What their configs agree in: all but the choices.
    rest: Value,
    /// What each was read as, and the index of its group among all groups.
    pub(super) readings: Vec<(Values, usize)>,
}

impl Place {
    pub(super) fn group(&self, values: &Values) -> Option<usize> {
        self.readings.iter().find(|(other, _)| other == values).map(|(_, group)| *group)
    }

    /// The readings without their order.
    pub(super) fn set(&self) -> Vec<&Values> {
        let mut set: Vec<&Values> = self.readings.iter().map(|(values, _)| values).collect();
        set.sort();
        set
    }
}

/// The places of several environments, at most one of each, that a family of readings may come from.
pub(super) struct Candidates {
    /// What their settings have apart from the default ones: `Δ = 10`; empty for the default ones.
    pub(super) name: String,
    pub(super) places: Vec<Place>,
}

/// What the places of a family agree in: the curriculum's settings, and the others as far as they are not
/// those of the first place of their environment. Environments may thus differ in budget or evaluation.
#[derive(PartialEq)]
struct Settings {
    curriculum: Leaves,
    outside: Vec<String>,
}

/// All candidates: first those of the method's default settings, then in the order of `groups`, which come in
/// order. The default settings are those of the first group called `default`, without one those of the
/// method's first group.
pub(super) fn candidates(groups: &[Group<'_>], paper: &Paper) -> Vec<Candidates> {
    let places = places(groups, paper);
    let is_default =
        |place: &&Place| place.readings.iter().any(|(_, group)| groups[*group].key.variant == "default");
    let Some(default) =
        places.iter().find(is_default).or(places.first()).map(|place| split(&place.rest, paper).0)
    else {
        return Vec::new();
    };
    let settings: Vec<Settings> = places.iter().map(|place| settings(place, &places, paper)).collect();
    let mut found: Vec<(Settings, Candidates)> = Vec::new();
    for (settings, place) in settings.into_iter().zip(places) {
        match found.iter_mut().find(|(other, _)| *other == settings) {
            Some((_, candidates)) => candidates.places.push(place),
            None => {
                let mut name = differences(&settings.curriculum, &default, paper);
                name.extend(settings.outside.iter().cloned());
                found.push((settings, Candidates { name: name.join(", "), places: vec![place] }));
            }
        }
    }
    let mut candidates: Vec<Candidates> = found.into_iter().map(|(_, candidates)| candidates).collect();
    candidates.sort_by_key(|candidates| !candidates.name.is_empty());
    candidates
}

/// All places, in the order of `groups`. Of several groups that are read the same the first counts.
fn places(groups: &[Group<'_>], paper: &Paper) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for (index, group) in groups.iter().enumerate().filter(|(_, group)| group.key.is_of(&paper.method)) {
        let Some(run) = group.runs.first() else { continue };
        let config = &run.manifest.config;
        let values = |choice: &ReadingChoice| config.pointer(choice.pointer).map(ablation::text);
        let values: Values = paper.choices.iter().map(values).collect();
        let mut rest = config.clone();
        paper.choices.iter().for_each(|choice| remove(&mut rest, choice.pointer));
        let environment = &group.key.environment;
        let is_it = |place: &&mut Place| place.environment == *environment && place.rest == rest;
        match places.iter_mut().find(is_it) {
            Some(place) if place.group(&values).is_some() => {}
            Some(place) => place.readings.push((values, index)),
            None => {
                let environment = environment.clone();
                places.push(Place { environment, rest, readings: vec![(values, index)] });
            }
        }
    }
    places
}

/// Takes the field at a JSON pointer out of `config`, if it is there.
fn remove(config: &mut Value, pointer: &str) {
    let Some((parent, name)) = pointer.rsplit_once('/') else { return };
    if let Some(Value::Object(fields)) = config.pointer_mut(parent) {
        fields.remove(name);
    }
}

fn settings(place: &Place, places: &[Place], paper: &Paper) -> Settings {
    let (curriculum, outside) = split(&place.rest, paper);
    let first = places.iter().find(|other| other.environment == place.environment).unwrap_or(place);
    Settings { curriculum, outside: differences(&outside, &split(&first.rest, paper).1, paper) }
}

/// Every value of a config that is no object, as text, by its JSON pointer.
type Leaves = BTreeMap<String, String>;

/// The settings of the method, and all others.
fn split(config: &Value, paper: &Paper) -> (Leaves, Leaves) {
    let inside = format!("{}/", paper.outer());
    let mut leaves = Leaves::new();
    collect("", config, &mut leaves);
    leaves.into_iter().partition(|(pointer, _)| pointer.starts_with(&inside))
}

fn collect(pointer: &str, value: &Value, leaves: &mut Leaves) {
    if let Value::Object(fields) = value {
        fields.iter().for_each(|(name, field)| collect(&format!("{pointer}/{name}"), field, leaves));
    } else {
        leaves.insert(pointer.to_owned(), ablation::text(value));
    }
}

/// `Δ = 10`, `student.width = 64`: the settings of `config` that `reference` has otherwise or not at all, and
/// as `not set` those that it alone has.
fn differences(config: &Leaves, reference: &Leaves, paper: &Paper) -> Vec<String> {
    let others = config.iter().filter(|(pointer, value)| reference.get(*pointer) != Some(*value));
    let lacking = reference.keys().filter(|pointer| !config.contains_key(*pointer));
    let others = others.map(|(pointer, value)| format!("{} = {value}", symbol(pointer, paper)));
    others.chain(lacking.map(|pointer| format!("{} = not set", symbol(pointer, paper)))).collect()
}

/// `Δ` for a setting that the paper varies, otherwise its path: `replay_states` for one of the method's own,
/// `student.width` for another.
fn symbol(pointer: &str, paper: &Paper) -> String {
    if let Some(axis) = paper.axes.iter().find(|axis| axis.pointer == pointer) {
        return axis.symbol.clone();
    }
    let own = pointer.strip_prefix(&paper.settings).filter(|rest| rest.starts_with('/'));
    own.unwrap_or(pointer).trim_start_matches('/').replace('/', ".")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Axis;
    use serde_json::json;

    /// A paper that varies one field, which it calls Δ.
    fn paper() -> Paper {
        let axis = Axis {
            id: "interplay".into(),
            source: "Figure 5".into(),
            pointer: "/curriculum/nova/interplay".into(),
            title: "interplay".into(),
            symbol: "Δ".into(),
            reference: "1".into(),
        };
        Paper { settings: "/curriculum/nova".into(), axes: vec![axis], ..Paper::default() }
    }

    #[test]
    fn differences_are_named_by_hand() {
        let config =
            |own: Value, width: u64| json!({"curriculum": {"nova": own}, "student": {"width": width}});
        let (curriculum, outside) =
            split(&config(json!({"interplay": 10, "window": 10, "signal": "x"}), 64), &paper());
        let (reference, other) =
            split(&config(json!({"interplay": 1, "window": 10, "renewal": 5}), 256), &paper());
        assert_eq!(
            differences(&curriculum, &reference, &paper()),
            ["Δ = 10", "signal = x", "renewal = not set"]
        );
        assert_eq!(differences(&outside, &other, &paper()), ["student.width = 64"]);
        assert!(differences(&outside, &outside, &paper()).is_empty());
    }

    #[test]
    fn fields_are_removed_where_they_are() {
        let mut config = json!({"evaluation": {"goals": "pool", "every": 5}});
        remove(&mut config, "/evaluation/goals");
        remove(&mut config, "/curriculum/nova/states");
        assert_eq!(config, json!({"evaluation": {"every": 5}}));
    }
}
