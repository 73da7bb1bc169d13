//! From a protocol with a search to the protocol of its trials, and to that of the experiment.

use std::collections::BTreeMap;

use reports::analysis::tuning::TUNED;
use serde_json::{Map, Value as Json};
use toml::{Table, Value};

use super::draw::{self, Kind, value_at};
use super::{Search, SettingRange, said};
use crate::Registry;
use crate::config::layer::{ConfigLayer, Origin, merge};
use crate::error::HarnessError;
use crate::protocol::{DEFAULT_VARIANT, Patch, Protocol, Variant};

/// The trials of a search.
#[derive(Clone, Debug)]
pub struct Trials {
    /// The default settings and every trial of the curricula with ranges, as variants, on the search's seeds.
    pub protocol: Protocol,
    /// The search.
    pub(crate) search: Search,
}

impl Protocol {
    /// The trials of its search; `None` without one.
    ///
    /// # Errors
    /// [`HarnessError`] if seeds overlap, a range is not one of its field, an option fixes what is searched,
    /// or none of the curricula has a range.
    pub fn trials(&self, registry: &Registry) -> Result<Option<Trials>, HarnessError> {
        let Some(search) = &self.search else { return Ok(None) };
        let wrong = |reason: String| Err(HarnessError::Protocol { place: search.place.clone(), reason });
        if let Some(seed) = search.seeds.iter().find(|seed| self.seeds.contains(seed)) {
            return wrong(format!(
                "seed {seed} is one of the search and of the experiment; settings must be chosen on seeds of their own"
            ));
        }
        // A mistake in a range of none of these curricula is reported now, not on the day when it first
        // matters.
        for range in search.ranges.iter().filter(|range| !self.curricula.iter().any(|id| range.is_of(id))) {
            range.curricula.iter().try_for_each(|id| draw::check(range, id, self, registry).map(drop))?;
        }
        let (mut variants, mut searched) = (Vec::new(), Vec::new());
        for curriculum in &self.curricula {
            let ranges: Vec<&SettingRange> = search.of(curriculum).collect();
            if !ranges.is_empty() {
                self.check_options(&ranges)?;
                let check = |range: &&SettingRange| draw::check(range, curriculum, self, registry);
                let kinds = ranges.iter().map(check).collect::<Result<Vec<_>, _>>()?;
                variants.extend(search.variants(curriculum, &ranges, &kinds));
                searched.push(curriculum.clone());
            }
        }
        if searched.is_empty() {
            return wrong(format!(
                "no range is one of {}; nothing could be searched",
                self.curricula.join(", ")
            ));
        }
        let (seeds, curricula) = (search.seeds.clone(), searched);
        let protocol = Self { variants, seeds, curricula, search: None, ..self.clone() };
        Ok(Some(Trials { protocol, search: search.clone() }))
    }

    /// For what has no phases.
    ///
    /// # Errors
    /// [`HarnessError::Protocol`] if there is a search.
    pub(crate) fn refuse_search(&self) -> Result<(), HarnessError> {
        self.search.as_ref().map_or(Ok(()), |search| {
            let reason = "a baseline is of settings that are known; leave out [search]".to_owned();
            Err(HarnessError::Protocol { place: search.place.clone(), reason })
        })
    }

    /// # Errors
    /// [`HarnessError`] if an option sets what is searched over: all trials would be the same.
    fn check_options(&self, ranges: &[&SettingRange]) -> Result<(), HarnessError> {
        for range in ranges {
            let path: Vec<&str> = range.field.split('.').collect();
            if let Some(layer) = self.options.iter().find(|layer| layer.touches(&path)) {
                let (place, path) = (layer.origin.place(&path), range.field.clone());
                let reason = "is searched over; leave out the option, or the range".to_owned();
                return Err(HarnessError::Config { place, path, reason });
            }
        }
        Ok(())
    }

    /// The experiment: the default settings of every curriculum, and beside them the `chosen` ones of those
    /// for which they are others, each given by the variant of its trials.
    pub(crate) fn tuned(&self, trials: &Trials, chosen: &BTreeMap<String, String>) -> Self {
        let default =
            Variant { label: DEFAULT_VARIANT.to_owned(), patch: patch(Vec::new(), Table::new(), "") };
        let mut variants = vec![default];
        for (curriculum, label) in chosen.iter().filter(|(_, label)| *label != DEFAULT_VARIANT) {
            let table = trials.variant(curriculum, label).map(|variant| variant.patch.layer.table.clone());
            let origin = format!("the chosen settings of {curriculum}");
            let patch = patch(vec![curriculum.clone()], table.unwrap_or_default(), &origin);
            variants.push(Variant { label: TUNED.to_owned(), patch });
        }
        Self { variants, search: None, ..self.clone() }
    }

    /// The experiment with the default settings alone.
    pub(crate) fn without_search(&self) -> Self {
        Self { search: None, ..self.clone() }
    }

    /// The experiment before the trials have ended, as large as it can become: every curriculum with ranges
    /// stands in it twice, the second time with the settings that were chosen `before`, or else with the
    /// default ones.
    pub(crate) fn untuned(&self, trials: &Trials, before: &BTreeMap<String, String>) -> Self {
        let mut protocol = self.tuned(trials, before);
        let is_new =
            |curriculum: &&String| before.get(*curriculum).is_none_or(|label| label == DEFAULT_VARIANT);
        for curriculum in trials.protocol.curricula.iter().filter(is_new) {
            let patch = patch(vec![curriculum.clone()], Table::new(), "");
            protocol.variants.push(Variant { label: TUNED.to_owned(), patch });
        }
        protocol
    }
}

fn patch(curricula: Vec<String>, table: Table, origin: &str) -> Patch {
    let layer = ConfigLayer { origin: Origin::Option(origin.to_owned()), table };
    Patch { environments: Vec::new(), curricula, layer }
}

impl Search {
    /// The default settings of a curriculum, then each of its trials.
    fn variants(&self, curriculum: &str, ranges: &[&SettingRange], kinds: &[Option<Kind>]) -> Vec<Variant> {
        let of = |label: String, table: Table, origin: &str| Variant {
            label,
            patch: patch(vec![curriculum.to_owned()], table, origin),
        };
        let mut variants = vec![of(DEFAULT_VARIANT.to_owned(), Table::new(), "")];
        for number in 1..=self.trials {
            let (mut table, mut told) = (Table::new(), Vec::new());
            for (range, kind) in ranges.iter().zip(kinds) {
                let value = draw::draw(range, *kind, self.seed, curriculum, number);
                told.push(format!("{} = {}", range.field, said(&value)));
                merge(&mut table, &range.layer(value).table);
            }
            let label = format!("trial-{number:02}");
            let origin = format!("{}: {label} of {curriculum} ({})", self.place, told.join(", "));
            variants.push(of(label, table, &origin));
        }
        variants
    }
}

impl Trials {
    /// The variants of a curriculum: the default settings, then its trials.
    pub(crate) fn of<'a>(&'a self, curriculum: &'a str) -> impl Iterator<Item = &'a Variant> {
        self.protocol.variants.iter().filter(move |one| one.patch.curricula.iter().any(|id| id == curriculum))
    }

    fn variant<'a>(&'a self, curriculum: &'a str, label: &str) -> Option<&'a Variant> {
        self.of(curriculum).find(|variant| variant.label == label)
    }

    /// What a trial of a curriculum sets, by path.
    pub(crate) fn settings(&self, curriculum: &str, variant: &Variant) -> Map<String, Json> {
        let value = |range: &SettingRange| {
            let value: &Value = value_at(&variant.patch.layer.table, &range.field)?;
            Some((range.field.clone(), serde_json::to_value(value).ok()?))
        };
        self.search.of(curriculum).filter_map(value).collect()
    }
}
