//! Checks a value against a JSON schema before it is read: which keys there are, and of which types.
//!
//! Ranges are left to those who own the fields; here they are only told to a user who gave no number at all.

use guard::text::short;
use serde_json::Value as Json;
use toml::{Table, Value};

use super::count;
use super::strict::FieldError;
use super::words::{accepted, given, is_beyond_integers, names, tagged};
use crate::suggest::closest;

/// Checks `value`, which stands at `path`, against `schema`. A whole number may be written as a count
/// (`1e5`, `"100k"`) and is then replaced by the number.
///
/// # Errors
/// The path of the first value that does not fit, what was given there and what is accepted.
pub fn fit(schema: &Json, value: &mut Value, path: &str) -> Result<(), FieldError> {
    if let Some(names) = names(schema) {
        return choose(&names, value, path);
    }
    if let Some(kinds) = tagged(schema) {
        return match value {
            Value::Table(table) => fit_kind(schema, &kinds, table, path),
            _ => refuse(schema, value, path),
        };
    }
    if let Some(branches) = schema["anyOf"].as_array() {
        return fit_any(schema, branches, value, path);
    }
    let fits = match (schema["type"].as_str(), &mut *value) {
        (Some("object"), Value::Table(table)) => return fit_table(schema, table, path),
        (Some("array"), Value::Array(items)) => {
            for (index, item) in items.iter_mut().enumerate() {
                fit(&schema["items"], item, &format!("{path}[{index}]"))?;
            }
            true
        }
        (Some("integer"), _) => return fit_integer(schema, value, path),
        (Some("number"), Value::Float(_) | Value::Integer(_))
        | (Some("boolean"), Value::Boolean(_))
        | (Some("string"), Value::String(_))
        | (None, _) => schema["const"].as_str().is_none_or(|word| value.as_str() == Some(word)),
        _ => false,
    };
    if fits { Ok(()) } else { refuse(schema, value, path) }
}

/// The error of a value that `schema` does not accept.
fn refuse(schema: &Json, value: &Value, path: &str) -> Result<(), FieldError> {
    let reason = format!("is {}; must be {}{}", given(value), accepted(schema), largest(schema, value));
    Err(FieldError { path: path.to_owned(), reason })
}

/// Accepts what one of the `branches` accepts. Where the value is a list or a table and one branch is, too,
/// what is wrong within it is told.
fn fit_any(schema: &Json, branches: &[Json], value: &mut Value, path: &str) -> Result<(), FieldError> {
    let mut within = None;
    for branch in branches {
        match fit(branch, value, path) {
            Ok(()) => return Ok(()),
            Err(error) if error.path != path => within = Some(error),
            Err(_) => {}
        }
    }
    within.map_or_else(|| refuse(schema, value, path), Err)
}

fn fit_integer(schema: &Json, value: &mut Value, path: &str) -> Result<(), FieldError> {
    let written = match value {
        Value::Integer(number) => Some(*number),
        Value::Float(number) => count::whole(*number).and_then(|count| i64::try_from(count).ok()),
        Value::String(text) => count::parse(text).and_then(|count| i64::try_from(count).ok()),
        _ => None,
    };
    let unsigned = schema["format"].as_str().is_some_and(|format| format.starts_with("uint"));
    match written {
        Some(number) if number >= 0 || !unsigned => {
            *value = Value::Integer(number);
            Ok(())
        }
        _ => refuse(schema, value, path),
    }
}

/// What is added where `value` is beyond all integers and the field knows no smaller bound.
fn largest(schema: &Json, value: &Value) -> String {
    let branches = schema["anyOf"].as_array().into_iter().flatten();
    let is_unbounded = schema["maximum"].is_null()
        && [schema].into_iter().chain(branches).any(|one| one["type"] == "integer");
    if is_unbounded && is_beyond_integers(value) {
        format!(", and at most {}", i64::MAX)
    } else {
        String::new()
    }
}

fn choose(names: &[&str], value: &Value, path: &str) -> Result<(), FieldError> {
    let reason = match value {
        Value::String(word) if names.contains(&word.as_str()) => return Ok(()),
        Value::String(word) => unknown("value", word, names),
        other => format!("is {}; must be one of {}", given(other), names.join(", ")),
    };
    Err(FieldError { path: path.to_owned(), reason })
}

/// Checks a table that is told apart from others by its `kind`; the default's counts where it has none.
fn fit_kind(schema: &Json, kinds: &[(&str, &Json)], table: &mut Table, path: &str) -> Result<(), FieldError> {
    let names: Vec<&str> = kinds.iter().map(|(name, _)| *name).collect();
    let kind = match table.get("kind") {
        None => schema["default"]["kind"].as_str(),
        Some(value) => {
            choose(&names, value, &below(path, "kind"))?;
            value.as_str()
        }
    };
    match kinds.iter().find(|(name, _)| Some(*name) == kind) {
        Some((_, chosen)) => fit_table(chosen, table, path),
        None => {
            let reason = format!("has no `kind`; must be one of {}", names.join(", "));
            Err(FieldError { path: path.to_owned(), reason })
        }
    }
}

fn fit_table(schema: &Json, table: &mut Table, path: &str) -> Result<(), FieldError> {
    let fields = schema["properties"].as_object();
    for (key, value) in table.iter_mut() {
        match fields.and_then(|fields| fields.get(key)) {
            Some(field) => fit(field, value, &below(path, key))?,
            None if schema["additionalProperties"] == false => {
                let known: Vec<&str> = fields.into_iter().flatten().map(|(name, _)| name.as_str()).collect();
                let reason = unknown(schema["x-names"].as_str().unwrap_or("key"), key, &known);
                return Err(FieldError { path: below(path, key), reason });
            }
            None => {}
        }
    }
    let required = schema["required"].as_array().into_iter().flatten().filter_map(Json::as_str);
    match required.into_iter().find(|key| !table.contains_key(*key)) {
        None => Ok(()),
        Some(key) => {
            let field = &schema["properties"][key];
            let reason = format!("`{key}` is missing; must be {}", accepted(field));
            Err(FieldError { path: path.to_owned(), reason })
        }
    }
}

/// What is said of a `word` that is none of the `known` ones.
fn unknown(what: &str, word: &str, known: &[&str]) -> String {
    let hint = closest(word, known.iter().copied()).map(|name| format!("; did you mean `{name}`?"));
    let list = if known.is_empty() { "nothing".to_owned() } else { known.join(", ") };
    format!("unknown {what} `{}`{} (accepted: {list})", short(word), hint.unwrap_or_default())
}

/// The path of `key` in the table at `path`.
fn below(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
