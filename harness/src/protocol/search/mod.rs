//! `[search]`: the same random search over settings for every curriculum, before the experiment.
//!
//! A search turns its protocol into two: that of the [`Trials`], whose runs have seeds of their own, and the
//! fresh one, which sets the chosen settings beside the default ones. Both are protocols like any other.

mod draw;
mod trials;

use guard::text::short;
use reports::schema::TuningMeasure;
use toml::Value;

use super::header::{WrittenRange, WrittenSearch};
use super::{Protocol, Reader, seeds_of};
use crate::config::layer::{ConfigLayer, Origin};
use crate::error::HarnessError;

pub use trials::Trials;

/// What a search draws, and on which seeds.
#[derive(Clone, Debug)]
pub(crate) struct Search {
    /// Draws for each curriculum with ranges.
    pub(crate) trials: usize,
    /// Seeds of their runs.
    pub(crate) seeds: Vec<u64>,
    /// What settings are chosen by.
    pub(crate) measure: TuningMeasure,
    /// The seed of the draws.
    pub(crate) seed: u64,
    ranges: Vec<SettingRange>,
    /// Where it stands.
    pub(crate) place: String,
}

/// What one setting is drawn from.
#[derive(Clone, Debug)]
struct SettingRange {
    /// Only these curricula; empty means all.
    curricula: Vec<String>,
    /// Config path.
    field: String,
    spread: Spread,
    origin: Origin,
}

#[derive(Clone, Debug, PartialEq)]
enum Spread {
    /// One of these, all alike.
    Values(Vec<Value>),
    /// From `low` to `high`, evenly, or evenly in the logarithm.
    Between { low: f64, high: f64, log: bool },
}

/// More trials than this are a slip of the keyboard.
const MOST_TRIALS: u64 = 1_000;
/// The sections that a search may vary: what is left is the experiment itself.
const SECTIONS: [&str; 3] = ["student", "curriculum", "pool"];

impl Reader<'_> {
    /// The search of a document that also has `curricula`.
    pub(super) fn search(&self, written: WrittenSearch) -> Result<Search, HarnessError> {
        let WrittenSearch { trials, seeds, measure, seed, ranges } = written;
        if !(1..=MOST_TRIALS).contains(&trials) {
            let reason = format!("is {trials}; must be 1 to {MOST_TRIALS}");
            return Err(self.config_error("search.trials", reason));
        }
        let seeds = seeds_of(seeds).map_err(|reason| self.config_error("search.seeds", reason))?;
        if seeds.is_empty() {
            return Err(self.config_error("search.seeds", "is empty; name at least one".to_owned()));
        }
        if ranges.is_empty() {
            let reason = "has no `[[search.range]]`; a search needs at least one".to_owned();
            return Err(self.error(&["search"], reason));
        }
        let place = self.document.place(&["search"]);
        let read = |(index, written)| self.range(index, written);
        let ranges: Vec<SettingRange> = ranges.into_iter().enumerate().map(read).collect::<Result<_, _>>()?;
        for (index, range) in ranges.iter().enumerate() {
            if let Some(other) = ranges[..index].iter().find(|other| range.meets(other)) {
                let reason = format!("`{}` and `{}` are ranges of one setting", other.field, range.field);
                return Err(self.error(&["search", "range", &index.to_string()], reason));
            }
        }
        Ok(Search { trials: trials as usize, seeds, measure, seed, ranges, place })
    }

    fn range(&self, index: usize, written: WrittenRange) -> Result<SettingRange, HarnessError> {
        let index = index.to_string();
        let keys = ["search", "range", &index];
        let wrong = |reason: String| Err(self.error(&keys, reason));
        let WrittenRange { curricula, field, values, low, high, log } = written;
        let mut curricula = self.registry.expand_curricula(&curricula, &self.prefix(&keys))?;
        let names: Vec<&str> = field.split('.').collect();
        let told = short(&field);
        if let Some(reason) = unfit(&names) {
            return wrong(format!("`{told}` {reason}"));
        }
        if let ["curriculum", id, ..] = names[..] {
            if let Some(other) = curricula.iter().find(|other| *other != id) {
                return wrong(format!("`{told}` is a setting of `{id}`, which runs of `{other}` do not use"));
            }
            curricula = self.registry.expand_curricula(&[id.to_owned()], &self.prefix(&keys))?;
        }
        let spread = match (values, low, high) {
            (Some(values), None, None) if !log => {
                if values.is_empty() {
                    return wrong(format!("`values` of `{told}` is empty; name at least one"));
                }
                Spread::Values(values)
            }
            (None, Some(low), Some(high)) => {
                if let Some(reason) = misfit(low, high, log) {
                    return wrong(format!("`{told}`: {reason}"));
                }
                Spread::Between { low, high, log }
            }
            _ => {
                let accepted = "accepted: `values`, or `low` and `high`, with `log = true` for draws that are even in the logarithm";
                return wrong(format!("`{told}` has no clear range; {accepted}"));
            }
        };
        let origin = Origin::Document(self.document.clone(), keys.map(str::to_owned).to_vec());
        Ok(SettingRange { curricula, field, spread, origin })
    }
}

/// Why no search can vary the field with these `names`, if none can.
fn unfit(names: &[&str]) -> Option<String> {
    if names.iter().any(|name| name.is_empty()) || names.len() < 2 || names.len() > 16 {
        return Some("is no path of a setting; accepted: one such as curriculum.teach.window".to_owned());
    }
    (!SECTIONS.contains(&names[0])).then(|| {
        format!(
            "cannot be searched over: all runs of an experiment have the same `{}`; accepted: settings of {}",
            short(names[0]),
            SECTIONS.join(", ")
        )
    })
}

/// What is wrong with the ends of a range, if anything is.
fn misfit(low: f64, high: f64, log: bool) -> Option<String> {
    if !(high - low).is_finite() {
        return Some(
            "`low` and `high` must be finite numbers, and so must be what lies between them".to_owned(),
        );
    }
    if low >= high {
        return Some(format!("`low` is {low} and `high` is {high}; `low` must be below `high`"));
    }
    (log && low <= 0.0)
        .then(|| format!("`low` is {low}; must be above 0 for draws that are even in the logarithm"))
}

impl SettingRange {
    /// Whether it is one for this curriculum.
    fn is_of(&self, curriculum: &str) -> bool {
        self.curricula.is_empty() || self.curricula.iter().any(|id| id == curriculum)
    }

    /// Whether some curriculum would have both, of one field or of fields of which one holds the other.
    fn meets(&self, other: &Self) -> bool {
        let is_within =
            |a: &str, b: &str| a == b || a.strip_prefix(b).is_some_and(|rest| rest.starts_with('.'));
        let shared = self.curricula.is_empty() || self.curricula.iter().any(|id| other.is_of(id));
        (shared || other.curricula.is_empty())
            && (is_within(&self.field, &other.field) || is_within(&other.field, &self.field))
    }

    /// What sets the field to `value`.
    fn layer(&self, value: Value) -> ConfigLayer {
        let names: Vec<&str> = self.field.split('.').collect();
        ConfigLayer { origin: self.origin.clone(), ..ConfigLayer::from_option(String::new(), &names, value) }
    }

    /// `curriculum.teach.window: 3, 5, 10 or 20`.
    fn said(&self) -> String {
        let spread = match &self.spread {
            Spread::Values(values) => {
                let texts: Vec<String> = values.iter().map(said).collect();
                match texts.split_last() {
                    Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
                    _ => texts.concat(),
                }
            }
            Spread::Between { low, high, log } => {
                format!("{low} to {high}{}", if *log { ", even in the logarithm" } else { "" })
            }
        };
        format!("{}: {spread}", self.field)
    }
}

/// A value as text, without quotes.
fn said(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

impl Search {
    fn of<'a>(&'a self, curriculum: &'a str) -> impl Iterator<Item = &'a SettingRange> {
        self.ranges.iter().filter(move |range| range.is_of(curriculum))
    }

    /// What the settings of a curriculum are drawn from, in words; empty where it has no range.
    pub(crate) fn ranges_of(&self, curriculum: &str) -> Vec<String> {
        self.of(curriculum).map(SettingRange::said).collect()
    }

    /// A sentence for each range that no run of `protocol` has.
    pub(super) fn idle(&self, protocol: &Protocol) -> Vec<String> {
        let is_idle = |range: &&SettingRange| !protocol.curricula.iter().any(|id| range.is_of(id));
        let said = |range: &SettingRange| {
            let ids = range.curricula.join(" or ");
            format!(
                "{}: this range changes nothing: no run has the curriculum {ids}",
                range.origin.place(&[])
            )
        };
        self.ranges.iter().filter(is_idle).map(said).collect()
    }
}
