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
    use crate::config::layer::Origin;

    fn range(field: &str, spread: Spread) -> SettingRange {
        SettingRange {
            curricula: Vec::new(),
            field: field.into(),
            spread,
            origin: Origin::Option(String::new()),
        }
    }

    fn three() -> [(SettingRange, Option<Kind>); 3] {
        let values = [3, 5, 10, 20].map(Value::Integer).to_vec();
        [
            (range("curriculum.teach.window", Spread::Values(values)), None),
            (
                range("curriculum.teach.interplay", Spread::Between { low: 1.0, high: 9.0, log: false }),
                Some(Kind::Whole),
            ),
            (
                range("student.critic_lr", Spread::Between { low: 1e-4, high: 1e-2, log: true }),
                Some(Kind::Real),
            ),
        ]
    }

    fn drawn(seed: u64, curriculum: &str, number: usize) -> String {
        let one = |(range, kind): &(SettingRange, Option<Kind>)| {
            draw(range, *kind, seed, curriculum, number).to_string()
        };
        three().iter().map(one).collect::<Vec<_>>().join(" ")
    }

    /// Results can be compared and searches extended only as long as no draw changes.
    #[test]
    fn draws_stay_what_they_are() {
        let found: Vec<String> = (1..=4).map(|number| drawn(0, "teach", number)).collect();
        assert_eq!(found, ["3 3 0.0001518", "5 1 0.000789", "5 2 0.000179", "20 1 0.0008802"]);
        assert_eq!(drawn(1, "teach", 1), "10 3 0.0002183");
        assert!(drawn(0, "vds", 1).ends_with(" 0.007802"), "{}", drawn(0, "vds", 1));
    }

    #[test]
    fn draws_fill_their_ranges_and_stay_within() {
        let [values, whole, real] = three();
        let all = |(range, kind): &(SettingRange, Option<Kind>)| -> Vec<Value> {
            (1..=2_000).map(|number| draw(range, *kind, 7, "teach", number)).collect()
        };
        let count =
            |drawn: &[Value], value: i64| drawn.iter().filter(|one| one.as_integer() == Some(value)).count();
        // Four values of 2,000 draws: 500 each, with a standard deviation of 19; nine: 222 with 14.
        for value in [3, 5, 10, 20] {
            assert!((420..580).contains(&count(&all(&values), value)), "{value}");
        }
        for value in 1..=9 {
            assert!((166..278).contains(&count(&all(&whole), value)), "{value}");
        }
        let real: Vec<f64> = all(&real).iter().filter_map(Value::as_float).collect();
        assert!(real.iter().all(|number| (1e-4..=1e-2).contains(number)));
        // Even in the logarithm: half of them below the geometric mean.
        let below = real.iter().filter(|number| **number < 1e-3).count();
        assert!((900..1_100).contains(&below), "{below}");
        assert!(real.iter().all(|number| format!("{number:e}").len() <= "1.234e-4".len()), "four digits");
    }

    #[test]
    fn a_number_is_rounded_and_a_path_followed() {
        assert_eq!([0.000_123_456, 98_765.4, 0.5].map(rounded), [0.000_123_5, 98_770.0, 0.5]);
        let table: Table = "a.b.c = 3\nd = 'x'".parse().expect("TOML");
        assert_eq!(value_at(&table, "a.b.c"), Some(&Value::Integer(3)));
        assert_eq!((value_at(&table, "a.x"), value_at(&table, "d.x")), (None, None));
        assert_eq!((kind(&table, "a.b.c"), kind(&table, "d")), (Some(Kind::Whole), None));
    }
}
