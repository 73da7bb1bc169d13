//! The reference of the config, as `goalbench help config` prints it: every field with its meaning, accepted
//! values, unit, default and source.

use std::fmt::Write as _;

use agents::{Preset, StudentConfig};
use envs::Spec;
use serde_json::Value as Json;

use super::words::{interval, names, tagged};
use crate::Registry;
use crate::protocol::presets::PRESETS;

/// A field of the config.
pub struct Field<'a> {
    /// Its path, as in `student.noise.std`.
    pub path: String,
    /// The kind of its table for which it is there, as in `gaussian`.
    pub kind: Option<&'a str>,
    /// What is known of it.
    pub schema: &'a Json,
}

/// All fields, in the order of the config.
pub fn fields(schema: &Json) -> Vec<Field<'_>> {
    let mut found = Vec::new();
    collect(schema, "", None, &mut found);
    found
}

fn collect<'a>(schema: &'a Json, path: &str, kind: Option<&'a str>, found: &mut Vec<Field<'a>>) {
    let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    if let Some(kinds) = tagged(schema) {
        found.push(Field { path: below("kind"), kind: None, schema });
        for (kind, branch) in kinds {
            for (name, field) in properties(branch).filter(|(name, _)| *name != "kind") {
                collect(field, &below(name), Some(kind), found);
            }
        }
    } else if schema["properties"].is_object() {
        for (name, field) in properties(schema) {
            collect(field, &below(name), kind, found);
        }
    } else {
        found.push(Field { path: path.to_owned(), kind, schema });
    }
}

fn properties(schema: &Json) -> impl Iterator<Item = (&str, &Json)> {
    schema["properties"].as_object().into_iter().flatten().map(|(name, field)| (name.as_str(), field))
}

/// The whole page, in Markdown.
pub fn page(registry: &Registry) -> String {
    let schema = registry.config_schema();
    let mut page = INTRODUCTION.to_owned();
    let mut section = String::new();
    for field in fields(schema) {
        let names: Vec<&str> = field.path.split('.').collect();
        let depth = if names[0] == "curriculum" { 2 } else { 1 };
        let of = names[..depth.min(names.len())].join(".");
        if of != section {
            let about = names[..depth].iter().fold(schema, |schema, name| &schema["properties"][name]);
            let _ = write!(page, "\n## {of}\n");
            // A field that is no table has one entry, which says it.
            if of != field.path {
                let _ = write!(page, "\n{}\n", about["description"].as_str().unwrap_or_default());
            }
            section = of;
        }
        page += &entry(&field);
    }
    page += &automatic(registry);
    page += &built_in();
    page
}

/// What the page says of the field at `path`, or of all fields below it; `None` if there are none.
pub fn part(registry: &Registry, path: &str) -> Option<String> {
    let within = |field: &Field<'_>| {
        field.path.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    let found: Vec<String> =
        fields(registry.config_schema()).iter().filter(|field| within(field)).map(entry).collect();
    (!found.is_empty()).then(|| found.concat().trim_start().to_owned())
}

const INTRODUCTION: &str = "\
# Config reference

Every field of a run's config. `goalbench help config` prints this page, with the curricula of the program at hand, and
`goalbench help config student.batch` a part of it. The text comes from the doc comments in the code.

Paths are the same in protocol files and in `--set student.batch=256`. A field that is left out has its default. `\"auto\"`
stands for a value that depends on the environment or on `student.preset`; a table near the end of this page has these
values. Whole numbers can be written as `100000`, `100_000`, `1e5` or, in quotes within a file, `\"100k\"` and `\"1.5M\"`.
`goalbench run ... --print-config` prints the config of every kind of run that a command stands for.
";

/// What the page says of one field.
fn entry(field: &Field<'_>) -> String {
    let schema = field.schema;
    let note = |key: &str| schema[key].as_str();
    let mut text = format!("\n### {}\n\n", field.path);
    if let Some(kind) = field.kind {
        let table = field.path.rsplit_once('.').map_or("", |(table, _)| table);
        let _ = write!(text, "With `{table}.kind = \"{kind}\"`. ");
    }
    let _ = writeln!(text, "{}\n", note("description").unwrap_or("No description."));
    let mut line = |name: &str, told: &str| {
        let _ = writeln!(text, "- {name}: {told}");
    };
    match choices(schema) {
        Some(choices) => {
            for (name, meaning) in choices {
                line(&format!("`\"{name}\"`"), meaning);
            }
        }
        None => line("accepted", &values(schema)),
    }
    if let Some(unit) = note("x-unit") {
        line("unit", unit);
    }
    let default = if tagged(schema).is_some() { &schema["default"]["kind"] } else { &schema["default"] };
    match note("x-auto") {
        Some(auto) if *default == "auto" => line("default", &format!("`\"auto\"`, that is, {auto}")),
        _ => line("default", &format!("`{}`", shown(default))),
    }
    if let Some(source) = note("x-source") {
        line("source", source);
    }
    text
}

/// The accepted words of a choice with their meanings.
fn choices(schema: &Json) -> Option<Vec<(&str, &str)>> {
    if let Some(kinds) = tagged(schema) {
        return Some(kinds.into_iter().map(|(name, branch)| (name, description(branch))).collect());
    }
    names(schema)?;
    let branches = schema["oneOf"].as_array()?;
    branches.iter().map(|branch| Some((branch["const"].as_str()?, description(branch)))).collect()
}

fn description(schema: &Json) -> &str {
    schema["description"].as_str().unwrap_or_default()
}

/// What a field without a list of choices accepts.
fn values(schema: &Json) -> String {
    let numbers = |branch: &Json| match branch["type"].as_str() {
        Some("integer") => format!("a whole number{}", grouped(&interval(schema, branch))),
        Some("number") => format!("a number{}", grouped(&interval(schema, branch))),
        Some("boolean") => "`true` or `false`".to_owned(),
        Some("string") => "a text in quotes".to_owned(),
        Some("array") if branch["items"]["type"] == "string" => "a list of names in quotes".to_owned(),
        _ if branch["const"] == "auto" => "`\"auto\"`".to_owned(),
        _ => "a value like the default".to_owned(),
    };
    match schema["anyOf"].as_array() {
        Some(branches) if branches.iter().any(|branch| branch["const"] == "auto") => {
            branches.iter().map(numbers).collect::<Vec<_>>().join(" or ")
        }
        Some(_) => "a value like the default".to_owned(),
        None => numbers(schema),
    }
}

/// `text` with commas between the thousands of its numbers.
fn grouped(text: &str) -> String {
    let group = |word: &str| {
        if word.len() < 5 || !word.chars().all(|c| c.is_ascii_digit()) {
            return word.to_owned();
        }
        let comma =
            |(index, digit): (usize, char)| (index > 0 && (word.len() - index).is_multiple_of(3), digit);
        let digits = word.chars().enumerate().map(comma);
        digits.flat_map(|(comma, digit)| comma.then_some(',').into_iter().chain([digit])).collect()
    };
    text.split(' ').map(group).collect::<Vec<_>>().join(" ")
}

/// A value as TOML has it.
fn shown(value: &Json) -> String {
    match value {
        Json::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or_default();
            if number != 0.0 && number.abs() < 1e-2 { format!("{number:e}") } else { format!("{number}") }
        }
        other => other.to_string(),
    }
}

/// What "auto" becomes for every family of environments and every preset of the student.
fn automatic(registry: &Registry) -> String {
    let mut text = "\n## What auto becomes\n\nFor each family of environments and each `student.preset`:\n\n\
        | family | preset | budget.steps | evaluation.every | student.batch | student.layers | student.gamma | \
        student.episodes_per_cycle |\n|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    let mut families: Vec<(&str, Vec<&Spec>)> = Vec::new();
    for environment in registry.environments() {
        let spec = &environment.spec;
        match families.iter_mut().find(|(family, _)| *family == spec.family) {
            Some((_, specs)) => specs.push(spec),
            None => families.push((spec.family, vec![spec])),
        }
    }
    for (family, specs) in families {
        for (name, preset) in [("harmonised", Preset::Harmonised), ("official", Preset::Official)] {
            let student = StudentConfig::preset(preset);
            let each = |of: &dyn Fn(&Spec) -> String| {
                let mut values: Vec<String> = specs.iter().map(|spec| of(spec)).collect();
                values.dedup();
                values.join(" or ")
            };
            let _ = writeln!(
                text,
                "| {family} | {name} | {} | {} | {} | {} | {} | {} |",
                each(&|spec| grouped(&spec.defaults.steps.to_string())),
                each(&|spec| grouped(&spec.defaults.evaluate_every.to_string())),
                student.batch(),
                each(&|spec| student.layers(spec).to_string()),
                each(&|spec| student.gamma(spec).to_string()),
                student.episodes_per_cycle(),
            );
        }
    }
    text
}

/// What each built-in protocol sets.
fn built_in() -> String {
    let mut text = "\n## What built-in protocols set\n\nBeside these, every field has its default. `goalbench protocol show \
        NAME` prints a protocol whole.\n\n"
        .to_owned();
    for preset in &PRESETS {
        let settings = preset.settings();
        let said = if settings.is_empty() { "nothing".to_owned() } else { settings.join("; ") };
        let _ = writeln!(text, "- `{}`: {said}", preset.id);
    }
    text
}
