//! What each variant is: the settings in which it departs from the default of its method.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::analysis::ablation;
use crate::analysis::group::Group;

/// A variant, and where it is that.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VariantSettings {
    /// Its label.
    pub variant: String,
    /// What it changes: `curriculum.teach.window = 3 (10)`, the value that it has in the place of the other
    /// in brackets; one per setting.
    pub settings: Vec<String>,
    /// Whether that is against the method's default; otherwise there is none, and these are the settings in
    /// which its variants differ.
    pub from_default: bool,
    /// Titles of the methods for which it is that, in order.
    pub curricula: Vec<String>,
    /// Ids of the environments in which it is that, in order.
    pub environments: Vec<String>,
}

/// Settings by their path in a config: `student.width`.
type Settings = BTreeMap<String, String>;

/// What a setting is that a config does not have.
const NOT_SET: &str = "not set";

/// All variants but `default` of `groups`, which come in order. A variant that is something else for another
/// method, or in another environment, has an entry for each.
pub fn variants(groups: &[Group<'_>]) -> Vec<VariantSettings> {
    let mut found: Vec<VariantSettings> = Vec::new();
    let of_method = |a: &Group<'_>, b: &Group<'_>| {
        (&a.key.environment, &a.key.curriculum) == (&b.key.environment, &b.key.curriculum)
    };
    for cell in groups.chunk_by(of_method) {
        let configs: Vec<Settings> = cell.iter().map(settings).collect();
        let default = cell.iter().position(|group| group.key.variant == "default");
        for (index, group) in cell.iter().enumerate().filter(|(index, _)| Some(*index) != default) {
            let settings = match default {
                Some(default) => departures(&configs[index], &configs[default]),
                None => distinctions(&configs[index], &configs),
            };
            let (variant, from_default) = (group.key.variant.clone(), default.is_some());
            let (title, environment) = (&group.key.curriculum.title, &group.key.environment);
            let is_it = |other: &&mut VariantSettings| {
                (&other.variant, &other.settings, other.from_default) == (&variant, &settings, from_default)
            };
            if let Some(known) = found.iter_mut().find(is_it) {
                for (names, name) in [(&mut known.curricula, title), (&mut known.environments, environment)] {
                    if !names.contains(name) {
                        names.push(name.clone());
                    }
                }
                continue;
            }
            let (curricula, environments) = (vec![title.clone()], vec![environment.clone()]);
            found.push(VariantSettings { variant, settings, from_default, curricula, environments });
        }
    }
    found
}

/// Where `own` departs from `default`.
fn departures(own: &Settings, default: &Settings) -> Vec<String> {
    let said = |name: &String| {
        let [own, other] = [own, default].map(|settings| settings.get(name).map_or(NOT_SET, String::as_str));
        (own != other).then(|| format!("{name} = {own} ({other})"))
    };
    own.keys().chain(default.keys().filter(|name| !own.contains_key(*name))).filter_map(said).collect()
}

/// What `own` has where not `all` have the same.
fn distinctions(own: &Settings, all: &[Settings]) -> Vec<String> {
    let mut names: Vec<&String> = all.iter().flat_map(BTreeMap::keys).collect();
    names.sort();
    names.dedup();
    names.retain(|name| all.iter().any(|other| other.get(*name) != own.get(*name)));
    let value = |name: &String| own.get(name).map_or(NOT_SET, String::as_str);
    names.into_iter().map(|name| format!("{name} = {}", value(name))).collect()
}

/// The settings of a group: those of its first run, seeds left out.
fn settings(group: &Group<'_>) -> Settings {
    let mut settings = Settings::new();
    if let Some(run) = group.runs.first() {
        collect("", &run.manifest.config, &mut settings);
    }
    settings
}

fn collect(path: &str, value: &Value, settings: &mut Settings) {
    match value {
        Value::Object(fields) if !fields.is_empty() => {
            for (name, field) in fields {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                collect(&path, field, settings);
            }
        }
        _ if path == "seed" => {}
        other => {
            settings.insert(path.to_owned(), ablation::text(other));
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn settings(value: &Value) -> Settings {
        let mut settings = Settings::new();
        collect("", value, &mut settings);
        settings
    }

    #[test]
    fn departures_by_hand() {
        let default = settings(&json!({"seed": 0, "student": {"width": 256, "noise": "gauss"}}));
        let own = settings(&json!({"seed": 1, "student": {"width": 64, "depth": 3}}));
        let expected =
            ["student.depth = 3 (not set)", "student.width = 64 (256)", "student.noise = not set (gauss)"];
        assert_eq!(departures(&own, &default), expected);
        assert!(departures(&own, &own).is_empty());
    }

    #[test]
    fn distinctions_by_hand() {
        let all = [3, 5].map(|n| settings(&json!({"teach": {"window": n}, "steps": 10})));
        assert_eq!(distinctions(&all[0], &all), ["teach.window = 3"]);
        assert!(distinctions(&all[0], &all[..1]).is_empty());
    }
}
