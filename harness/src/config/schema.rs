//! The JSON schema of the config: its fields, their types, and what their doc comments say of them.
//!
//! It is derived from the config's own types, so a field cannot be missing. Everything else that tells of
//! fields comes from here: the reference, the schema for editors, and what is said of wrong values.

use curricula::{Entry, schema_of};
use serde_json::{Map, Value as Json, json};
use toml::Value;

use super::notes::Notes;
use super::{RunConfig, defaults};
use crate::Registry;

/// The schema of a config as users write it: every field may be left out, and has its default.
pub fn config(registry: &Registry) -> Json {
    let mut schema = schema_of::<RunConfig>().to_value();
    let curricula = registry.curricula().iter().map(|entry| (entry.id.to_owned(), curriculum(entry)));
    schema["properties"]["curriculum"] = json!({
        "type": "object",
        "description": "Options of curricula: a table for each, of which a run uses its own.",
        "properties": curricula.collect::<Map<_, _>>(),
        "additionalProperties": false,
        "x-names": "curriculum",
    });
    tidy(&mut schema);
    set_defaults(&mut schema, &Value::Table(defaults(registry)));
    schema
}

/// The options of one curriculum. One that does not describe its options has those of its default config, of
/// whatever types; a whole number there may be written as a count.
fn curriculum(entry: &Entry) -> Json {
    let mut schema = match (entry.schema)() {
        Some(schema) => {
            let mut schema = schema.to_value();
            if !schema["properties"].is_object() {
                schema["properties"] = json!({});
            }
            schema
        }
        None => {
            let like = |value: Value| match value {
                Value::Integer(_) => json!({ "anyOf": [{ "type": "integer" }, {}] }),
                _ => json!({}),
            };
            let fields = (entry.defaults)().into_iter().map(|(name, value)| (name, like(value)));
            json!({ "type": "object", "properties": fields.collect::<Map<_, _>>(), "additionalProperties": true })
        }
    };
    schema["description"] = json!(format!("Options of the curriculum `{}`: {}.", entry.id, entry.title));
    schema
}

/// Turns a derived schema into one of partial configs: no field is required, unknown ones are refused, and
/// what doc comments say of ranges stands where programs look for it.
pub fn tidy(schema: &mut Json) {
    let Json::Object(object) = schema else { return };
    for derived in ["$schema", "title", "required"] {
        object.remove(derived);
    }
    if object.contains_key("properties") && !object.contains_key("additionalProperties") {
        object.insert("additionalProperties".into(), json!(false));
    }
    // A table with a `kind` may leave it out, and then fits by its other keys.
    let has_kinds = |branches: &Json| branches[0]["properties"]["kind"].is_object();
    if object.get("oneOf").is_some_and(has_kinds)
        && let Some(branches) = object.remove("oneOf")
    {
        object.insert("anyOf".into(), branches);
    }
    annotate(object);
    for (key, value) in object.iter_mut() {
        match (key.as_str(), value) {
            ("properties", Json::Object(fields)) => fields.values_mut().for_each(tidy),
            ("anyOf" | "oneOf", Json::Array(branches)) => branches.iter_mut().for_each(tidy),
            ("items", items) => tidy(items),
            _ => {}
        }
    }
}

/// Replaces the doc comment in `description` by its meaning, and writes its notes as keywords.
fn annotate(object: &mut Map<String, Json>) {
    let Some(text) = object.get("description").and_then(Json::as_str) else { return };
    let notes = Notes::parse(text);
    // A range that cannot be read is left out here; a test refuses it.
    object.extend(notes.bounds().unwrap_or_default().into_iter().map(|(key, bound)| (key.to_owned(), bound)));
    for (key, note) in [("x-unit", notes.unit), ("x-auto", notes.auto), ("x-source", notes.source)] {
        if let Some(note) = note {
            object.insert(key.into(), json!(note));
        }
    }
    object.insert("description".into(), json!(notes.meaning));
}

/// Writes the defaults into the fields.
fn set_defaults(schema: &mut Json, default: &Value) {
    match (default, schema["properties"].is_object()) {
        (Value::Table(fields), true) => {
            for (name, value) in fields {
                set_defaults(&mut schema["properties"][name], value);
            }
        }
        _ => schema["default"] = json!(default),
    }
}
