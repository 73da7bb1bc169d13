//! Configs of many runs, side by side: what they share, and what is their own.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::store::digest;

/// Config fields by path, as in `student.batch`.
pub type Fields = BTreeMap<String, Value>;

/// Every field of a config that is given as one object of objects.
///
/// ```
/// let config = serde_json::json!({ "student": { "batch": 16, "width": 8 } });
/// let fields = reports::gate::config::fields(&config);
/// assert_eq!(fields["student.batch"], 16);
/// ```
pub fn fields(config: &Value) -> Fields {
    let mut fields = Fields::new();
    flatten("", config, &mut fields);
    fields
}

fn flatten(path: &str, value: &Value, fields: &mut Fields) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, value, fields);
            }
        }
        _ => {
            fields.insert(path.to_owned(), value.clone());
        }
    }
}

/// The fields that have the same value in all of `configs`.
pub fn common<'a>(mut configs: impl Iterator<Item = &'a Fields>) -> Fields {
    let mut common = configs.next().cloned().unwrap_or_default();
    for config in configs {
        common.retain(|path, value| config.get(path) == Some(value));
    }
    common
}

/// The fields of `config` that `common` lacks.
pub fn own(config: &Fields, common: &Fields) -> Fields {
    config
        .iter()
        .filter(|(path, _)| !common.contains_key(*path))
        .map(|(p, v)| (p.clone(), v.clone()))
        .collect()
}

/// SHA-256 of a config, in hex.
pub fn hash(config: &Fields) -> String {
    let text = serde_json::to_string(config).expect("a config is plain data");
    digest::sha256(text.as_bytes())
}

/// The fields in which two configs differ, in words.
pub fn differences(there: &Fields, now: &Fields) -> Vec<String> {
    let say = |value: Option<&Value>| value.map_or("absent".to_owned(), Value::to_string);
    let added = now.keys().filter(|path| !there.contains_key(*path));
    let paths = there.keys().chain(added).filter(|path| there.get(*path) != now.get(*path));
    paths.map(|path| format!("{path}: {} there, {} now", say(there.get(path)), say(now.get(path)))).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn flat(value: Value) -> Fields {
        fields(&value)
    }

    #[test]
    fn what_is_shared_and_what_is_own_by_hand() {
        let a = flat(json!({ "budget": { "steps": 1 }, "student": { "batch": 2 } }));
        let b = flat(json!({ "budget": { "steps": 3 }, "student": { "batch": 2 } }));
        let shared = common([&a, &b].into_iter());
        assert_eq!(shared, flat(json!({ "student.batch": 2 })));
        assert_eq!(own(&b, &shared), flat(json!({ "budget.steps": 3 })));
    }

    #[test]
    fn differences_name_changed_added_and_removed_fields() {
        let there = flat(json!({ "a": 1, "b": 2, "c": 3 }));
        let now = flat(json!({ "a": 1, "b": 5, "d": 4 }));
        assert_eq!(
            differences(&there, &now),
            ["b: 2 there, 5 now", "c: 3 there, absent now", "d: absent there, 4 now"]
        );
        assert_ne!(hash(&there), hash(&now));
    }
}
