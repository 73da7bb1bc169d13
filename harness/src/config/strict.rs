//! Typed reading of a table with errors that name the path, the accepted names and the nearest one.

use guard::text::short;
use serde::de::DeserializeOwned;
use toml::Value;

use crate::suggest::closest;

/// What is wrong with a field.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldError {
    /// Path from the config's root, as in `student.batch`.
    pub path: String,
    /// What is wrong and what is accepted.
    pub reason: String,
}

/// Reads `table`, which stands at `prefix` in the config, as `T`.
///
/// # Errors
/// The path of the first field that does not fit, with what is accepted there.
pub fn read<T: DeserializeOwned>(value: Value, prefix: &str) -> Result<T, FieldError> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let inner = error.path().to_string();
        let message = error.inner().message().trim().replace('\n', " ");
        field_error(prefix, if inner == "." { "" } else { &inner }, &message)
    })
}

/// Builds the error of the field `inner` below `prefix`, with a suggestion where `message` is serde's
/// complaint about an unknown name.
pub fn field_error(prefix: &str, inner: &str, message: &str) -> FieldError {
    let mut path: Vec<&str> =
        prefix.split('.').chain(inner.split('.')).filter(|part| !part.is_empty()).collect();
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let is_unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    let reason = match names.split_first() {
        Some((typed, accepted)) if is_unknown => {
            if message.starts_with("unknown field") && path.last() != Some(typed) {
                path.push(typed);
            }
            let kind = if message.starts_with("unknown field") { "unknown key" } else { "unknown value" };
            let suggestion = closest(typed, accepted.iter().copied())
                .map_or(String::new(), |name| format!("; did you mean `{name}`?"));
            format!("{kind} `{}`{suggestion} (accepted: {})", short(typed), accepted.join(", "))
        }
        _ => plain(message),
    };
    FieldError { path: path.join("."), reason }
}

/// Serde's complaint about a value of a wrong type, in words that do not take a programmer. It reaches a user
/// only for options whose types are not known beforehand: those of curricula without a schema.
fn plain(message: &str) -> String {
    if let Some(field) = message.strip_prefix("missing field ") {
        return format!("{field} is missing");
    }
    let complaint =
        ["invalid type: ", "invalid value: "].iter().find_map(|start| message.strip_prefix(start));
    match complaint.and_then(|complaint| complaint.split_once(", expected ")) {
        Some((found, wanted)) => format!("is {}; must be {}", value_in_words(found), type_in_words(wanted)),
        None => ranges_in_words(message),
    }
}

/// `message` with `2 to 64` for `in 2..=64`.
fn ranges_in_words(message: &str) -> String {
    let mut words: Vec<String> = Vec::new();
    for word in message.split(' ') {
        if word.contains("..=") {
            words.pop_if(|before| before == "in");
        }
        words.push(word.replace("..=", " to "));
    }
    words.join(" ")
}

/// What serde found, as in ``integer `3` ``.
fn value_in_words(found: &str) -> String {
    match found {
        "map" => "a table".to_owned(),
        "sequence" => "a list".to_owned(),
        "unit variant" => "no accepted name".to_owned(),
        _ => match (found.split_once('`'), found.strip_prefix("string ")) {
            (Some((_, value)), None) => short(value.trim_end_matches('`')),
            (_, Some(text)) => short(text),
            _ => found.to_owned(),
        },
    }
}

/// What serde wanted, as in `usize`.
fn type_in_words(wanted: &str) -> &str {
    match wanted {
        "u8" | "u16" | "u32" | "u64" | "u128" | "usize" => "a whole number of at least 0, and not too large",
        "i8" | "i16" | "i32" | "i64" | "i128" | "isize" => "a whole number",
        "f32" | "f64" => "a number",
        "a boolean" => "true or false",
        "a string" => "a text",
        "a sequence" => "a list",
        "a map" => "a table",
        "string or map" | "string only" | "variant identifier" => "one of the accepted names",
        _ if wanted.starts_with("struct ") => "a table",
        _ if wanted.starts_with("internally tagged enum ") => "a table with a key that says its kind",
        _ => wanted,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only its shape matters")]
    struct Outer {
        inner: Inner,
    }

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only its shape matters")]
    struct Inner {
        window: usize,
        kind: Kind,
    }

    #[derive(Debug, serde::Deserialize)]
    #[serde(rename_all = "lowercase")]
    enum Kind {
        Online,
        Target,
    }

    fn error(text: &str) -> FieldError {
        read::<Outer>(Value::Table(text.parse().expect("TOML")), "curriculum").expect_err(text)
    }

    #[test]
    fn mistyped_keys_and_values_are_named_with_what_is_accepted() {
        let key = error("[inner]\nwindw = 1");
        assert_eq!(key.path, "curriculum.inner.windw");
        assert_eq!(key.reason, "unknown key `windw`; did you mean `window`? (accepted: window, kind)");
        let value = error("[inner]\nwindow = 1\nkind = 'targets'");
        assert_eq!(value.path, "curriculum.inner.kind");
        assert_eq!(
            value.reason,
            "unknown value `targets`; did you mean `target`? (accepted: online, target)"
        );
        let kind = error("[inner]\nwindow = -1\nkind = 'target'");
        assert_eq!(kind.path, "curriculum.inner.window");
        assert_eq!(kind.reason, "is -1; must be a whole number of at least 0, and not too large");
    }

    #[test]
    fn ranges_are_told_in_words() {
        let told = field_error("", "members", "must be \"auto\" or in 2..=64, got 99").reason;
        assert_eq!(told, "must be \"auto\" or 2 to 64, got 99");
    }

    #[test]
    fn no_complaint_takes_a_programmer() {
        for (text, reason) in [
            ("inner = 3", "is 3; must be a table"),
            ("[inner]\nwindow = 'x'\nkind = 'target'", "is \"x\"; must be a whole number"),
            ("[inner]\nwindow = 1.5\nkind = 'target'", "is 1.5; must be a whole number"),
            ("[inner]\nwindow = [1]\nkind = 'target'", "is a list; must be a whole number"),
            ("[inner]\nwindow = 1\nkind = 3", "must be one of the accepted names"),
            ("[inner]\nkind = 'target'", "`window` is missing"),
        ] {
            let found = error(text).reason;
            assert!(found.contains(reason), "{text}: {found}");
        }
    }
}
