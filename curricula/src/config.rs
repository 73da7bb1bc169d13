//! A method's config, between TOML and its own type.

use std::fmt;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

use crate::curriculum::{Curriculum, Setting};
use crate::error::CurriculumError;
use crate::method::Method;
use crate::teacher::Teacher;

/// A method with a config that is complete, of the right types and within its ranges.
pub trait Configured {
    /// The config, with every field.
    fn table(&self) -> Table;

    /// [`Method::version`] with this config.
    fn version(&self) -> String;

    /// Makes the teacher.
    ///
    /// # Errors
    /// [`CurriculumError`] if it cannot be built for this setting, such as an empty pool.
    fn build(self: Box<Self>, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError>;
}

impl fmt::Debug for dyn Configured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.table().fmt(f)
    }
}

/// A checked config of method `M`.
pub(crate) struct Checked<M: Method>(M::Config);

impl<M: Method> Checked<M> {
    /// Completes what is `written` with defaults, and checks it.
    ///
    /// # Errors
    /// [`CurriculumError::Config`], naming the field.
    pub(crate) fn new(written: Table) -> Result<Self, CurriculumError> {
        let config = read(written)?;
        M::check(&config)?;
        Ok(Self(config))
    }
}

impl<M: Method> Configured for Checked<M> {
    fn table(&self) -> Table {
        table(&self.0)
    }

    fn version(&self) -> String {
        M::version(&self.0)
    }

    fn build(self: Box<Self>, setting: &Setting) -> Result<Box<dyn Curriculum>, CurriculumError> {
        Ok(Box::new(Teacher::<M>::new(self.0, setting)?))
    }
}

/// The JSON schema of the config `C`.
///
/// Its descriptions are the doc comments of the fields. A last paragraph of the form `Unit: episodes. Range:
/// 1 to 100. Auto: what "auto" means. Source: a paper.`, any part of which can be left out, becomes columns
/// of the reference that `goalbench help config` prints. A range is `2 to 64`, `0 to below 1`, `above 0` or
/// `at least 1`.
///
/// ```
/// /// Options of a method.
/// #[derive(schemars::JsonSchema)]
/// struct MineConfig {
///     /// Episodes looked back on.
///     ///
///     /// Unit: episodes. Range: at least 1. Source: a choice.
///     episodes: u64,
/// }
///
/// let schema = curricula::schema_of::<MineConfig>();
/// let field = &schema.as_value()["properties"]["episodes"];
/// assert_eq!(field["type"], "integer");
/// assert!(field["description"].as_str().is_some_and(|text| text.starts_with("Episodes looked back on.")));
/// ```
pub fn schema_of<C: JsonSchema>() -> Schema {
    let inline = |settings: &mut SchemaSettings| settings.inline_subschemas = true;
    SchemaSettings::draft2020_12().with(inline).into_generator().into_root_schema_for::<C>()
}

/// A config as a complete table.
pub(crate) fn table<C: Serialize>(config: &C) -> Table {
    Table::try_from(config).expect("a method's config is a struct of TOML values")
}

/// The config that `written` gives, with defaults for everything else.
///
/// Unknown names are refused here and not by serde, whose `deny_unknown_fields` cannot be had together with
/// the `flatten` by which methods share [`ProbeConfig`](crate::ProbeConfig). The words are serde's.
fn read<C: Serialize + DeserializeOwned + Default>(written: Table) -> Result<C, CurriculumError> {
    let defaults = table(&C::default());
    let with = |more: Table| defaults.clone().into_iter().chain(more).collect::<Table>();
    let config: C = parse(with(written.clone())).map_err(|error| {
        // Serde loses the name of a flattened field: look for the one that does not fit by itself.
        let alone = |(key, value): (&String, &Value)| {
            let (_, reason) = parse::<C>(with(Table::from_iter([(key.clone(), value.clone())]))).err()?;
            Some((key.clone(), reason))
        };
        let (field, reason) = error;
        let (field, reason) = match field.as_str() {
            "." => written.iter().find_map(alone).unwrap_or((field, reason)),
            _ => (field, reason),
        };
        CurriculumError::Config { field, reason }
    })?;
    let known = table(&config);
    match written.keys().find(|key| !known.contains_key(*key)) {
        None => Ok(config),
        Some(field) => Err(CurriculumError::Config { field: field.clone(), reason: unknown(field, &known) }),
    }
}

/// `table` as a `C`, or the path of the field that does not fit, and why.
fn parse<C: DeserializeOwned>(table: Table) -> Result<C, (String, String)> {
    serde_path_to_error::deserialize(Value::Table(table))
        .map_err(|error| (error.path().to_string(), error.inner().message().to_owned()))
}

/// What serde says of a `field` that is none of the `known` ones.
fn unknown(field: &str, known: &Table) -> String {
    let names: Vec<String> = known.keys().map(|name| format!("`{name}`")).collect();
    let expected = match names.as_slice() {
        [] => "there are no fields".to_owned(),
        [one] => format!("expected {one}"),
        [one, other] => format!("expected {one} or {other}"),
        all => format!("expected one of {}", all.join(", ")),
    };
    format!("unknown field `{field}`, {expected}")
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
    struct Outer {
        first: u64,
        #[serde(flatten)]
        shared: Shared,
        optional: Option<u64>,
        inner: Inner,
    }

    #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
    struct Shared {
        second: u64,
        kind: Kind,
    }

    #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    enum Kind {
        #[default]
        Plain,
        Fancy,
    }

    #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Inner {
        third: u64,
    }

    /// The field that is named, and why.
    fn refusal(text: &str) -> (String, String) {
        match read::<Outer>(text.parse().expect("TOML")) {
            Err(CurriculumError::Config { field, reason }) => (field, reason),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_left_out_has_its_default() {
        let read = |text: &str| read::<Outer>(text.parse().expect("TOML")).expect("valid");
        assert_eq!(read(""), Outer::default());
        let some = read("second = 2\noptional = 3\ninner.third = 4");
        let shared = Shared { second: 2, kind: Kind::Plain };
        assert_eq!(some, Outer { first: 0, shared, optional: Some(3), inner: Inner { third: 4 } });
    }

    #[test]
    fn a_value_that_does_not_fit_is_named_wherever_its_field_is_declared() {
        for field in ["first", "second", "optional"] {
            let (named, reason) = refusal(&format!("{field} = -1"));
            assert_eq!(named, field);
            assert!(reason.contains("integer `-1`, expected u64"), "{field}: {reason}");
        }
        let (named, reason) = refusal("first = 1\nkind = 'odd'");
        assert_eq!((&*named, &*reason), ("kind", "unknown variant `odd`, expected `plain` or `fancy`"));
        assert_eq!(refusal("inner.third = true").0, "inner.third");
    }

    #[test]
    fn unknown_names_are_refused_in_serdes_words() {
        let (named, reason) = refusal("secnd = 2");
        assert_eq!(named, "secnd");
        // An option that is not set has no form in TOML.
        let expected = "unknown field `secnd`, expected one of `first`, `second`, `kind`, `inner`";
        assert_eq!(reason, expected);
        let (named, reason) = refusal("inner.thrd = 2");
        assert_eq!((&*named, &*reason), ("inner.thrd", "unknown field `thrd`, expected `third`"));
        assert_eq!(unknown("x", &Table::new()), "unknown field `x`, there are no fields");
        assert_eq!(unknown("x", &"a = 1\nb = 2".parse().unwrap()), "unknown field `x`, expected `a` or `b`");
    }
}
