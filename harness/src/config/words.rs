//! How a value that was given and what is accepted in its place are told.

use guard::text::short;
use serde_json::Value as Json;
use toml::Value;

/// A value that was given.
pub fn given(value: &Value) -> String {
    match value {
        // TOML's integers and floats end below it, so it was read as a text.
        Value::String(text) if is_beyond_integers(value) => short(text),
        Value::String(text) => format!("\"{}\"", short(text)),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) if number.abs() >= MOST_DIGITS => format!("{number:e}"),
        Value::Float(number) => number.to_string(),
        Value::Boolean(flag) => flag.to_string(),
        Value::Datetime(date) => format!("the date {date}"),
        Value::Array(_) => "a list".to_owned(),
        Value::Table(_) => "a table".to_owned(),
    }
}

/// Floats from here on are told with an exponent, as they are typed.
const MOST_DIGITS: f64 = 1e16;

/// Whether `value` is a number beyond all integers that a config can hold.
pub fn is_beyond_integers(value: &Value) -> bool {
    let is_beyond = |number: f64| number.is_finite() && number.abs() >= i64::MAX as f64;
    match value {
        Value::Float(number) => is_beyond(*number),
        Value::String(text) => {
            let is_number = text.bytes().all(|byte| byte.is_ascii_digit() || b"+-._eE".contains(&byte));
            let plain = text.replace('_', "");
            let number = plain.parse();
            // The largest integers round to a float beyond all of them.
            let is_integer = plain.parse::<i64>().is_ok();
            is_number
                && !is_integer
                && number.is_ok_and(|number: f64| number.is_infinite() || is_beyond(number))
        }
        _ => false,
    }
}

/// What a field with this `schema` accepts.
pub fn accepted(schema: &Json) -> String {
    if let Some(text) = schema["x-expecting"].as_str() {
        return text.to_owned();
    }
    if let Some(names) = names(schema) {
        return format!("one of {}", names.join(", "));
    }
    if tagged(schema).is_some() {
        return "a table with the key `kind`".to_owned();
    }
    if let Some(branches) = schema["anyOf"].as_array() {
        let each = branches.iter().map(|branch| accepted_within(branch, schema));
        return each.collect::<Vec<_>>().join(" or ");
    }
    accepted_within(schema, schema)
}

/// What `branch` accepts, in the range that the schema around it gives.
fn accepted_within(branch: &Json, range: &Json) -> String {
    if let Some(word) = branch["const"].as_str() {
        return format!("\"{word}\"");
    }
    match branch["type"].as_str() {
        Some("integer") => format!("a whole number{}", interval(range, branch)),
        Some("number") => format!("a number{}", interval(range, branch)),
        Some("boolean") => "true or false".to_owned(),
        Some("string") => "a text".to_owned(),
        Some("array") => match branch["items"]["type"].as_str() {
            Some("string") => "a list of names, as in [\"one\", \"other\"]".to_owned(),
            Some("object") => "a list of tables".to_owned(),
            _ => "a list".to_owned(),
        },
        Some("object") => {
            let keys: Vec<String> = branch["properties"]
                .as_object()
                .into_iter()
                .flatten()
                .map(|(key, _)| format!("`{key}`"))
                .collect();
            match keys.as_slice() {
                [] => "a table".to_owned(),
                [key] => format!("a table with the key {key}"),
                keys => format!("a table with the keys {}", keys.join(", ")),
            }
        }
        _ => "another value".to_owned(),
    }
}

/// The range of a number in words, with a space before it; nothing where all numbers are accepted.
pub fn interval(range: &Json, number: &Json) -> String {
    let bound = |key: &str| [range, number].into_iter().find_map(|schema| schema[key].as_number());
    let above = bound("exclusiveMinimum").map(|bound| format!(" above {bound}"));
    let least = bound("minimum");
    match (above, least, bound("exclusiveMaximum"), bound("maximum")) {
        (Some(above), _, None, None) => above,
        (Some(above), _, Some(below), _) => format!("{above} and below {below}"),
        (Some(above), _, _, Some(most)) => format!("{above} and at most {most}"),
        (None, Some(least), Some(below), _) => format!(" from {least} to below {below}"),
        (None, Some(least), None, Some(most)) => format!(" from {least} to {most}"),
        (None, Some(least), None, None) => format!(" of at least {least}"),
        (None, None, Some(below), _) => format!(" below {below}"),
        (None, None, None, Some(most)) => format!(" of at most {most}"),
        (None, None, None, None) => String::new(),
    }
}

/// The words that a choice accepts, if `schema` is one.
pub fn names(schema: &Json) -> Option<Vec<&str>> {
    if let Some(list) = schema["enum"].as_array() {
        return list.iter().map(Json::as_str).collect();
    }
    schema["oneOf"].as_array()?.iter().map(|branch| branch["const"].as_str()).collect()
}

/// The kinds of a table that a key `kind` tells apart, if `schema` is one: the name and the schema of each.
pub fn tagged(schema: &Json) -> Option<Vec<(&str, &Json)>> {
    let branches = schema["anyOf"].as_array()?;
    branches.iter().map(|branch| Some((branch["properties"]["kind"]["const"].as_str()?, branch))).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn numbers_are_told_as_they_are_typed() {
        let value = |text: &str| format!("x = {text}").parse::<toml::Table>().expect("TOML")["x"].clone();
        for text in ["16", "-1", "0.5", "1e308", "1e16", "inf", "\"16\"", "\"x\""] {
            assert_eq!(given(&value(text)), text);
        }
        for text in ["18446744073709551615", "99999999999999999999", "1e999", "-9_300_000_000_000_000_000"] {
            let read = Value::String(text.to_owned());
            assert_eq!(given(&read), text);
            assert!(is_beyond_integers(&read), "{text}");
        }
        for text in ["1", "9223372036854775806", "inf", "nan", "e", "", "x"] {
            assert!(!is_beyond_integers(&Value::String(text.to_owned())), "{text}");
        }
    }

    #[test]
    fn ranges_are_told_in_words() {
        let told = |schema: Json| accepted(&schema);
        assert_eq!(told(json!({ "type": "integer", "minimum": 1 })), "a whole number of at least 1");
        assert_eq!(told(json!({ "type": "number", "exclusiveMinimum": 0 })), "a number above 0");
        let auto =
            json!({ "anyOf": [{ "const": "auto" }, { "type": "integer" }], "minimum": 1, "maximum": 8 });
        assert_eq!(told(auto), "\"auto\" or a whole number from 1 to 8");
        let discount = json!({ "type": "number", "minimum": 0, "exclusiveMaximum": 1 });
        assert_eq!(told(discount), "a number from 0 to below 1");
        assert_eq!(told(json!({ "enum": ["a", "b"] })), "one of a, b");
        assert_eq!(told(json!({ "type": "boolean" })), "true or false");
    }
}
