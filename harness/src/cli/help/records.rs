//! The page of the files that a run writes, made from the schema of records.

use std::fmt::Write as _;

use reports::schema::{
    Crash, Frontier, Learning, Manifest, Outcome, Record, Shadowing, Teaching, Timing, Tuning,
};
use reports::store::layout;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde_json::Value as Json;

const INTRODUCTION: &str = "\
# Records

What lies in the folder of a run, field by field, made from the code that writes and reads it. `goalbench help records` prints this
page. [Protocols](protocols.md#results) shows where the folder is and which files beside these lie in it, and
[Curricula](curricula.md#what-is-recorded) tells which numbers each teacher records. The tidy tables that `report` makes of
them are explained in the report's own `DATA.md`.

Files ending in `.jsonl` hold a JSON object per line. Types are JSON's, where `integer` is a whole number and `number[]` a list of
numbers; `[N]` is the shape of a list, with N goals in the pool and G numbers in a goal. An unknown field is an error. The last file,
`tuning/choice.json`, is one of the results folder: what a [search over settings](protocols.md#a-search-over-settings) chose.
";

/// A file, and what one line or all of it is.
struct File {
    name: &'static str,
    schema: Schema,
}

fn of<T: JsonSchema>(name: &'static str) -> File {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    File { name, schema: settings.into_generator().into_root_schema_for::<T>() }
}

/// The page, in Markdown.
pub(super) fn page() -> String {
    let files = [
        of::<Manifest>(layout::MANIFEST),
        of::<Record>(layout::RECORDS),
        of::<Teaching>(layout::TEACHING),
        of::<Learning>(layout::STUDENT),
        of::<Frontier>(layout::FRONTIER),
        of::<Shadowing>(layout::SHADOW),
        of::<Timing>(layout::TIMING),
        of::<Outcome>(layout::OUTCOME),
        of::<Crash>(layout::CRASHES),
        of::<Tuning>("tuning/choice.json"),
    ];
    let mut text = INTRODUCTION.to_owned();
    for File { name, schema } in files {
        let schema = schema.as_value();
        let _ = write!(text, "\n## {name}\n\n{}\n", about(schema));
        match schema["oneOf"].as_array() {
            Some(kinds) => {
                for kind in kinds {
                    let tag = kind["properties"]["status"]["const"].as_str().unwrap_or_default();
                    let _ = write!(text, "\nWith `\"status\": \"{tag}\"`: {}\n", about(kind));
                    text += &table(kind);
                }
            }
            None => text += &table(schema),
        }
    }
    text
}

fn table(schema: &Json) -> String {
    let mut text = "\n| field | type | meaning |\n|---|---|---|\n".to_owned();
    rows(schema, "", &mut text);
    text
}

/// A row for each field of `schema`, and for the fields of those.
fn rows(schema: &Json, path: &str, text: &mut String) {
    for (name, field) in schema["properties"].as_object().into_iter().flatten() {
        if field.get("const").is_some() {
            // It tells the kinds apart, and stands above.
            continue;
        }
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let meaning = about(field).replace('|', "\\|").replace("\n\n", " ");
        let _ = writeln!(text, "| `{path}` | `{}` | {meaning} |", kind(field));
        rows(field, &path, text);
        rows(&field["items"], &format!("{path}[]"), text);
    }
}

/// The type of a field, as in `number[][]` or `(integer or null)[]`.
fn kind(schema: &Json) -> String {
    let tuple = |items: &Vec<Json>| items.iter().map(kind).collect::<Vec<_>>().join(", ");
    let word = |name: &Json| match name.as_str().unwrap_or_default() {
        "array" if let Some(items) = schema["prefixItems"].as_array() => format!("[{}]", tuple(items)),
        "array" => match kind(&schema["items"]) {
            items if items.contains(" or ") => format!("({items})[]"),
            items => format!("{items}[]"),
        },
        other => other.to_owned(),
    };
    match &schema["type"] {
        Json::Array(names) => names.iter().map(word).collect::<Vec<_>>().join(" or "),
        // One of several words.
        Json::Null if !schema["oneOf"][0]["const"].is_null() => "string".to_owned(),
        Json::Null => "any".to_owned(),
        name => word(name),
    }
}

/// What the doc comment says, with links to other items as plain code.
fn about(schema: &Json) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    let mut parts = text.split("[`");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (code, rest) = part.split_once("`]").unwrap_or((part, ""));
        let rest =
            rest.strip_prefix('(').and_then(|rest| rest.split_once(')')).map_or(rest, |(_, rest)| rest);
        let _ = write!(plain, "`{code}`{rest}");
    }
    plain.replace('\n', " ").replace("  ", "\n\n")
}
