//! Drawing settings. A draw depends on the search's seed, the curriculum, the trial's number and the field,
//! and on nothing else: whoever adds a curriculum, a trial or a range changes no other draw.

use envs::rng::{Purpose, Rng, stream, uniform};
use reports::store::digest;
use toml::{Table, Value};

use super::{SettingRange, Spread};
use crate::Registry;
use crate::config;
use crate::error::HarnessError;
use crate::protocol::Protocol;
use crate::protocol::plan;

/// Digits of a drawn number: enough for a setting, and so few that it is the same on every machine.
const DIGITS: usize = 4;

/// What kind of numbers a field takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Whole,
    Real,
}

/// Checks that the field of `range` takes all of its values, or both of its ends, in every environment of
/// `protocol`. Gives the kind of its numbers; `None` where it is a list of values.
///
/// # Errors
/// [`HarnessError`] naming the range and what the field accepts.
pub(super) fn check(
    range: &SettingRange,
    curriculum: &str,
    protocol: &Protocol,
    registry: &Registry,
) -> Result<Option<Kind>, HarnessError> {
    let mut kinds = Vec::new();
    let values = match &range.spread {
        Spread::Values(values) => values.clone(),
        Spread::Between { low, high, .. } => [*low, *high].map(written).to_vec(),
    };
    for environment in &protocol.environments {
        for value in &values {
            let layer = range.layer(value.clone());
            let config = plan::resolve(protocol, registry, environment, curriculum, Some(&layer))?;
            kinds.push(kind(&config::to_table(&config), &range.field));
        }
    }
    match (&range.spread, kinds.first()) {
        (Spread::Values(_), _) => Ok(None),
        (_, Some(Some(kind))) => Ok(Some(*kind)),
        _ => {
            let reason = "takes no numbers; give `values` in the place of `low` and `high`".to_owned();
            let place = range.origin.place(&[]);
            Err(HarnessError::Config { place, path: range.field.clone(), reason })
        }
    }
}

/// A number as one would write it.
fn written(number: f64) -> Value {
    let whole = number as i64;
    if whole as f64 == number { Value::Integer(whole) } else { Value::Float(number) }
}

/// The kind of the number at `path`, if it is one.
fn kind(config: &Table, path: &str) -> Option<Kind> {
    match value_at(config, path)? {
        Value::Integer(_) => Some(Kind::Whole),
        Value::Float(_) => Some(Kind::Real),
        _ => None,
    }
}

/// The value at `path`.
pub(super) fn value_at<'a>(table: &'a Table, path: &str) -> Option<&'a Value> {
    let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
    match (table.get(first)?, rest) {
        (value, None) => Some(value),
        (Value::Table(below), Some(rest)) => value_at(below, rest),
        _ => None,
    }
}

/// What the trial `number` of a curriculum sets the field of `range` to.
pub(super) fn draw(
    range: &SettingRange,
    kind: Option<Kind>,
    seed: u64,
    curriculum: &str,
    number: usize,
) -> Value {
    let text = format!("{curriculum}\0{}\0{number}", range.field);
    let index = u64::from_str_radix(&digest::sha256(text.as_bytes())[..16], 16).expect("a hash is in hex");
    let rng = &mut stream(seed, Purpose::Trial(index));
    match &range.spread {
        Spread::Values(values) => {
            let place = uniform(rng, 0.0, values.len() as f64).floor() as usize;
            values[place.min(values.len() - 1)].clone()
        }
        Spread::Between { low, high, log } => match kind {
            // All whole numbers from `low` to `high`, both included, have a stretch of their own.
            Some(Kind::Whole) => {
                let drawn = between(rng, *low, high + 1.0, *log).floor().clamp(*low, *high);
                Value::Integer(drawn as i64)
            }
            _ => Value::Float(rounded(between(rng, *low, *high, *log)).clamp(*low, *high)),
        },
    }
}

fn between(rng: &mut Rng, low: f64, high: f64, log: bool) -> f64 {
    if log { uniform(rng, low.ln(), high.ln()).exp() } else { uniform(rng, low, high) }
}

fn rounded(number: f64) -> f64 {
    format!("{number:.*e}", DIGITS - 1).parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_rounded_and_a_path_followed() {
        assert_eq!([0.000_123_456, 98_765.4, 0.5].map(rounded), [0.000_123_5, 98_770.0, 0.5]);
        let table: Table = "a.b.c = 3\nd = 'x'".parse().expect("TOML");
        assert_eq!(value_at(&table, "a.b.c"), Some(&Value::Integer(3)));
        assert_eq!((value_at(&table, "a.x"), value_at(&table, "d.x")), (None, None));
        assert_eq!((kind(&table, "a.b.c"), kind(&table, "d")), (Some(Kind::Whole), None));
    }
}
