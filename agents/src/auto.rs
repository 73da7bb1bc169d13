//! A setting that is either given or left to be worked out.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{F64Deserializer, I64Deserializer, U64Deserializer};
use serde::de::{Error, IntoDeserializer, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number, or "auto": the value that the preset and the environment call for.
///
/// In TOML and JSON it is the number itself or the string `"auto"`.
///
/// ```
/// use agents::Auto;
///
/// assert_eq!(Auto::Value(3).value_or(|| 7), 3);
/// assert_eq!(Auto::Auto.value_or(|| 7), 7);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Auto<T> {
    /// To be worked out.
    #[default]
    Auto,
    /// Given.
    Value(T),
}

impl<T: Copy> Auto<T> {
    /// The given value, or else `automatic()`.
    pub fn value_or(self, automatic: impl FnOnce() -> T) -> T {
        match self {
            Self::Auto => automatic(),
            Self::Value(value) => value,
        }
    }
}

impl<T: Serialize> Serialize for Auto<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => serializer.serialize_str("auto"),
            Self::Value(value) => value.serialize(serializer),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Auto<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AutoVisitor(PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for Auto<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("Auto_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let value = generator.subschema_for::<T>();
        json_schema!({ "anyOf": [{ "const": "auto" }, value] })
    }
}

struct AutoVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for AutoVisitor<T> {
    type Value = Auto<T>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number or \"auto\"")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Auto<T>, E> {
        match text {
            "auto" => Ok(Auto::Auto),
            other => Err(E::invalid_value(Unexpected::Str(other), &self)),
        }
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Auto<T>, E> {
        let number: I64Deserializer<E> = number.into_deserializer();
        T::deserialize(number).map(Auto::Value)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Auto<T>, E> {
        let number: U64Deserializer<E> = number.into_deserializer();
        T::deserialize(number).map(Auto::Value)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Auto<T>, E> {
        let number: F64Deserializer<E> = number.into_deserializer();
        T::deserialize(number).map(Auto::Value)
    }
}

#[cfg(test)]
mod tests {
    use super::Auto;

    fn read<T: serde::de::DeserializeOwned>(json: &str) -> Result<Auto<T>, String> {
        serde_json::from_str(json).map_err(|error| error.to_string())
    }

    #[test]
    fn reads_a_number_or_the_word() {
        assert_eq!(read::<usize>("3"), Ok(Auto::Value(3)));
        assert_eq!(read::<f64>("1"), Ok(Auto::Value(1.0)));
        assert_eq!(read::<f64>("0.98"), Ok(Auto::Value(0.98)));
        assert_eq!(read::<usize>("\"auto\""), Ok(Auto::Auto));
    }

    #[test]
    fn says_what_is_accepted() {
        let error = read::<usize>("\"automatic\"").unwrap_err();
        assert!(error.contains("expected a number or \"auto\""), "{error}");
        assert!(read::<usize>("-2").is_err());
        assert!(read::<usize>("2.5").is_err());
    }

    #[test]
    fn writes_what_it_reads() {
        assert_eq!(serde_json::to_string(&Auto::Value(3usize)).unwrap(), "3");
        assert_eq!(serde_json::to_string(&Auto::<f64>::Auto).unwrap(), "\"auto\"");
    }
}
