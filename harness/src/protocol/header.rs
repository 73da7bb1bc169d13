//! A protocol document as it is written, apart from config: its keys, their types, and the schema of both.

use reports::schema::TuningMeasure;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::{Value as Json, json};
use toml::{Table, Value};

use crate::Registry;
use crate::config::SECTIONS;
use crate::config::fit::fit;
use crate::config::schema::tidy;
use crate::config::strict::{self, FieldError};

/// The keys of a protocol document that are not config.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    /// The experiment's name; results go to `results/NAME` unless `--out` says otherwise.
    pub(super) name: String,
    /// What it is for, one line.
    #[serde(default)]
    pub(super) description: String,
    /// Environments and suites; `goalbench list` names them.
    pub(super) environments: Vec<String>,
    /// Curricula; `goalbench list curricula` names them.
    pub(super) curricula: Vec<String>,
    /// Seeds of the runs: a range such as "0..7" (0 to 6), or a list such as [0, 3].
    pub(super) seeds: Seeds,
    /// Config for some environments or curricula, later ones above earlier ones.
    #[serde(default, rename = "override")]
    pub(super) overrides: Vec<WrittenPatch>,
    /// Labelled alternatives, run beside each other.
    #[serde(default, rename = "variant")]
    pub(super) variants: Vec<WrittenVariant>,
    /// The same random search over settings for every curriculum, on seeds of its own; the chosen and the
    /// default settings are then run beside each other on `seeds`.
    #[serde(default)]
    #[schemars(with = "WrittenSearch")]
    pub(super) search: Option<WrittenSearch>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenSearch {
    /// Draws of settings for each curriculum with ranges: 1 to 1,000. The default settings, which compete
    /// with them, are not counted.
    pub(super) trials: u64,
    /// Seeds of their runs, none of which is one of the experiment.
    pub(super) seeds: Seeds,
    /// What settings are chosen by: the mean over environments and seeds of the `area` under the curve of
    /// success rates, or of the `final` success.
    #[serde(default)]
    pub(super) measure: TuningMeasure,
    /// The seed of the draws.
    #[serde(default)]
    pub(super) seed: u64,
    /// What settings are drawn from.
    #[serde(default, rename = "range")]
    pub(super) ranges: Vec<WrittenRange>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenRange {
    /// Only these curricula; all if left out, or the one whose setting it is.
    #[serde(default)]
    pub(super) curricula: Vec<String>,
    /// The setting, by its path: curriculum.teach.window, student.polyak, pool.size.
    pub(super) field: String,
    /// The values to draw from, all alike.
    #[serde(default)]
    #[schemars(schema_with = "any_list")]
    pub(super) values: Option<Vec<Value>>,
    /// The lowest number.
    #[serde(default)]
    #[schemars(with = "f64")]
    pub(super) low: Option<f64>,
    /// The highest number.
    #[serde(default)]
    #[schemars(with = "f64")]
    pub(super) high: Option<f64>,
    /// Whether draws between them are even in the logarithm.
    #[serde(default)]
    pub(super) log: bool,
}

#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(extend("x-expecting" = "a list of seeds such as [0, 3], or a range such as \"0..7\""))]
pub(super) enum Seeds {
    List(Vec<u64>),
    Text(String),
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenPatch {
    /// Only these environments or suites; all if left out.
    #[serde(default)]
    pub(super) environments: Vec<String>,
    /// Only these curricula; all if left out.
    #[serde(default)]
    pub(super) curricula: Vec<String>,
    /// The config that it sets.
    #[schemars(schema_with = "any_table")]
    pub(super) set: Table,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenVariant {
    /// Names it in run ids and figures.
    pub(super) label: String,
    /// Only these environments or suites; all if left out.
    #[serde(default)]
    pub(super) environments: Vec<String>,
    /// Only these curricula; all if left out.
    #[serde(default)]
    pub(super) curricula: Vec<String>,
    /// The config that it sets; nothing if left out.
    #[serde(default)]
    #[schemars(schema_with = "any_table")]
    pub(super) set: Table,
}

fn any_list(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "array", "items": {} })
}

fn any_table(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "object" })
}

impl Header {
    /// Reads the keys of a document that are not config.
    ///
    /// # Errors
    /// The path of the first field that does not fit, with what is accepted there.
    pub(super) fn read(table: Table) -> Result<Self, FieldError> {
        let mut schema = keys();
        // Accepted beside them, and checked where runs are planned.
        for section in SECTIONS {
            schema["properties"][section] = json!({});
        }
        let mut value = Value::Table(table);
        fit(&schema, &mut value, "")?;
        strict::read(value, "")
    }
}

/// Where the tables of a document that have required keys stand in its schema.
const TABLES: [&str; 5] = [
    "",
    "/properties/override/items",
    "/properties/variant/items",
    "/properties/search",
    "/properties/search/properties/range/items",
];

/// The schema of the keys that are not config.
fn keys() -> Json {
    let mut schema = curricula::schema_of::<Header>().to_value();
    let required = TABLES.map(|table| schema.pointer(table).map(|table| table["required"].clone()));
    tidy(&mut schema);
    // Unlike fields of the config, these have no defaults.
    for (table, required) in TABLES.into_iter().zip(required) {
        if let (Some(table), Some(required)) = (schema.pointer_mut(table), required) {
            table["required"] = required;
        }
    }
    schema
}

/// The JSON schema of protocol files, for editors: `goalbench list schema`.
pub fn schema(registry: &Registry) -> Json {
    let mut schema = keys();
    let config = registry.config_schema();
    let suites = registry.suites().iter().map(|suite| suite.id);
    let environments: Vec<&str> =
        registry.environments().iter().map(envs::Environment::id).chain(suites).collect();
    let curricula: Vec<&str> = registry.curricula().iter().map(|entry| entry.id).collect();
    let name = |fields: &mut Json| {
        fields["environments"]["items"]["enum"] = json!(environments);
        fields["curricula"]["items"]["enum"] = json!(curricula);
    };
    name(&mut schema["properties"]);
    let range = &mut schema["properties"]["search"]["properties"]["range"]["items"]["properties"];
    range["curricula"]["items"]["enum"] = json!(curricula);
    for list in ["override", "variant"] {
        let fields = &mut schema["properties"][list]["items"]["properties"];
        name(fields);
        fields["set"] = config.clone();
    }
    for section in SECTIONS {
        schema["properties"][section] = config["properties"][section].clone();
    }
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("A protocol of goalbench");
    schema
}
