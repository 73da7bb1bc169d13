//! Does a verdict hang on how the paper is read?
//!
//! Where the paper allows several readings, each is a setting ([`CHOICES`]). A *reading* is a combination of their values
//! that TEACH was run with. TEACH under each reading is set against the runs of a baseline that agree with it in
//! everything outside `/curriculum`, with the measure, the test and the rule of the ledger's main claims.
//!
//! Readings that agree in all other settings are a *family*, and every family of at least two is judged: those at Δ = 10
//! apart from those at Δ = 1. Other values of Δ, of the window and so on are no readings: the paper fixes these settings,
//! or varies them itself.
//!
//! All readings of a family are judged in the same environments, so that nothing but the reading differs: of the
//! environments, those with the largest set of readings.

mod conclusion;
mod places;

use serde_json::Value;

use crate::analysis::complete::Pair;
use crate::analysis::group::{self, Group};
use crate::analysis::ledger::{self, Entry, Measure};
use crate::methods;
use crate::paper;
use crate::stats::Resampling;
use conclusion::{conclusion, setting};
use places::{Candidates, Place};

/// A place where the paper can be read in more than one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What stands before a value: `states = replay`.
    pub name: &'static str,
    /// JSON pointer (RFC 6901) into a run's config.
    pub pointer: &'static str,
}

const COUNT: usize = 4;

/// All of them, in the order in which they are named.
pub static CHOICES: [Choice; COUNT] = [
    Choice { name: "states", pointer: "/curriculum/teach/states" },
    Choice { name: "selection", pointer: "/curriculum/teach/selection" },
    Choice { name: "record", pointer: "/curriculum/teach/record" },
    Choice { name: "evaluation goals", pointer: "/evaluation/goals" },
];

/// The value of every choice as text, in the order of [`CHOICES`]; `None` where a config lacks the field.
type Values = [Option<String>; COUNT];

/// A reading under which TEACH was run, and those that come to the same in the method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Values of the choices; first those that the reading is named after, then those with the same runs, evaluation
    /// by evaluation.
    values: Vec<Values>,
    /// The choices that vary among the readings at hand, as indices into [`CHOICES`].
    varied: Vec<usize>,
}

impl Reading {
    /// `states = replay, record = cycle`: the choices that vary; then in parentheses what comes to the same.
    pub fn name(&self) -> String {
        let setting = |values: &Values, choice: usize| setting(choice, &[values[choice].as_deref()]);
        let named = |values: &Values| {
            self.varied.iter().map(|&choice| setting(values, choice)).collect::<Vec<_>>().join(", ")
        };
        let mut names = self.values.iter().map(named);
        let first = names.next().unwrap_or_default();
        let rest: Vec<String> = names.collect();
        if rest.is_empty() { first } else { format!("{first} (the same runs: {})", rest.join("; ")) }
    }
}

/// A claim under every reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The number of each reading, from 1 and the same for all claims of the family, with its verdict. Readings without
    /// runs of the baseline are left out; there are at least two.
    pub judged: Vec<(usize, Entry)>,
    /// Whether the verdict is the same under all of them, and under which it is what: `hangs on the reading: ...`.
    pub conclusion: String,
}

impl Claim {
    /// Whether the verdict differs between readings.
    pub fn hangs(&self) -> bool {
        self.judged.iter().any(|(_, entry)| entry.verdict != self.judged[0].1.verdict)
    }
}

/// The readings that TEACH was run with under the same other settings, and all claims under all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// What these other settings have apart from TEACH's default ones: `Δ = 10`; empty for the default ones.
    pub name: String,
    /// The readings, in the order of their groups; at least two.
    pub readings: Vec<Reading>,
    /// The environments that all of them were run in.
    pub environments: Vec<String>,
    /// Environments that lack some of them, which no verdict rests on.
    pub left_out: Vec<String>,
    /// Every claim about a baseline that two readings or more can be set against; at least one.
    pub claims: Vec<Claim>,
}

impl Family {
    /// The name of a reading by its number in [`Claim::judged`].
    pub fn reading(&self, number: usize) -> String {
        self.readings.get(number.wrapping_sub(1)).map(Reading::name).unwrap_or_default()
    }

    /// `at Δ = 10`; `None` for the default settings.
    pub fn at(&self) -> Option<String> {
        (!self.name.is_empty()).then(|| format!("at {}", self.name))
    }

    /// Judges every claim under every reading; `None` where there are not two readings, or no claim about them.
    fn of(
        groups: &[Group<'_>],
        candidates: Candidates,
        window: usize,
        resampling: Resampling,
    ) -> Option<Self> {
        let Candidates { name, places } = candidates;
        let (readings, shared) = shared(groups, &places)?;
        let mut claims = Vec::new();
        for measure in [Measure::Final, Measure::Area] {
            for baseline in paper::BASELINES.iter().chain([&paper::CONTROL]) {
                let judge = Judge { groups, shared: &shared, baseline, measure, window, resampling };
                claims.extend(judge.claim(&readings));
            }
        }
        let is_shared = |place: &&Place| shared.iter().any(|other| other.environment == place.environment);
        let (inside, outside): (Vec<&Place>, Vec<&Place>) = places.iter().partition(is_shared);
        let names = |places: Vec<&Place>| places.into_iter().map(|place| place.environment.clone()).collect();
        let (environments, left_out) = (names(inside), names(outside));
        (!claims.is_empty()).then_some(Self { name, readings, environments, left_out, claims })
    }
}

/// All families with a claim that can be judged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// First that of TEACH's default settings, if it is one.
    pub families: Vec<Family>,
}

impl Readings {
    /// Judges every claim under every reading of every family; `groups` come in order. Final scores average `window`
    /// evaluations.
    pub fn of(groups: &[Group<'_>], window: usize, resampling: Resampling) -> Self {
        let family = |candidates| Family::of(groups, candidates, window, resampling);
        Self { families: places::candidates(groups).into_iter().filter_map(family).collect() }
    }
}

/// The largest set of readings that an environment has, of equals the one that most environments have, and these
/// environments; `None` for fewer than two readings.
fn shared<'a>(groups: &[Group<'_>], places: &'a [Place]) -> Option<(Vec<Reading>, Vec<&'a Place>)> {
    let alike = |place: &&Place| places.iter().filter(|other| other.set() == place.set()).count();
    // The first of equals: `max_by_key` takes the last.
    let first = places.iter().rev().max_by_key(|place| (place.readings.len(), alike(place)))?;
    let shared: Vec<&Place> = places.iter().filter(|place| place.set() == first.set()).collect();
    let all: Vec<&Values> = first.readings.iter().map(|(values, _)| values).collect();
    let varied: Vec<usize> =
        (0..COUNT).filter(|&choice| all.iter().any(|values| values[choice] != all[0][choice])).collect();
    let mut readings: Vec<Reading> = Vec::new();
    for values in all {
        let same = |reading: &&mut Reading| is_same(groups, &shared, &reading.values[0], values);
        match readings.iter_mut().find(same) {
            Some(reading) => reading.values.push(values.clone()),
            None => readings.push(Reading { values: vec![values.clone()], varied: varied.clone() }),
        }
    }
    (readings.len() > 1).then_some((readings, shared))
}

/// Whether two readings gave the same runs in every environment, set against the same runs of baselines.
fn is_same(groups: &[Group<'_>], shared: &[&Place], a: &Values, b: &Values) -> bool {
    shared.iter().all(|place| {
        let found = place.group(a).zip(place.group(b));
        found.is_some_and(|(a, b)| {
            outside(&groups[a]) == outside(&groups[b]) && group::is_repeated(&groups[a], &groups[b])
        })
    })
}

/// The config of a group without its curriculum's; `None` without a run.
fn outside(group: &Group<'_>) -> Option<Value> {
    let mut config = group.runs.first()?.manifest.config.clone();
    if let Some(curriculum) = config.get_mut("curriculum") {
        *curriculum = Value::Null;
    }
    Some(config)
}

/// TEACH and a baseline.
type Versus<'a> = (&'a Group<'a>, &'a Group<'a>);

/// What one claim is judged by under every reading.
struct Judge<'a> {
    groups: &'a [Group<'a>],
    shared: &'a [&'a Place],
    baseline: &'a str,
    measure: Measure,
    window: usize,
    resampling: Resampling,
}

impl Judge<'_> {
    /// The claim under every reading that has runs of the baseline; `None` for fewer than two.
    fn claim(&self, readings: &[Reading]) -> Option<Claim> {
        let opponents = |reading: &Reading| -> Vec<Option<Versus<'_>>> {
            self.shared.iter().map(|place| self.versus(place, reading)).collect()
        };
        let all: Vec<(usize, Vec<Option<Versus<'_>>>)> =
            readings.iter().enumerate().map(|(index, reading)| (index + 1, opponents(reading))).collect();
        let tested: Vec<_> = all.iter().filter(|(_, found)| found.iter().any(Option::is_some)).collect();
        // Only environments where every one of them has runs of the baseline.
        let places: Vec<usize> = (0..self.shared.len())
            .filter(|&place| tested.iter().all(|(_, found)| found[place].is_some()))
            .collect();
        if tested.len() < 2 || places.is_empty() {
            return None;
        }
        let resampling = ledger::corrected(self.resampling, tested.len());
        let judge = |(number, found): &&(usize, Vec<Option<Versus<'_>>>)| {
            let pairs: Vec<Pair<'_>> =
                places.iter().filter_map(|&place| found[place]).map(|(a, b)| Pair::of(a, b)).collect();
            (*number, ledger::versus(&pairs, self.baseline, self.measure, self.window, resampling))
        };
        let judged: Vec<(usize, Entry)> = tested.iter().map(judge).collect();
        let conclusion = conclusion(readings, &judged, methods::title(self.baseline));
        Some(Claim { judged, conclusion })
    }

    /// TEACH under `reading` and the baseline's runs of the same settings, in one environment.
    fn versus(&self, place: &Place, reading: &Reading) -> Option<Versus<'_>> {
        let teach = &self.groups[place.group(reading.values.first()?)?];
        let settings = outside(teach)?;
        // In order: `default` first.
        let fits = |group: &&Group<'_>| {
            group.key.environment == place.environment
                && group.key.curriculum == self.baseline
                && outside(group).as_ref() == Some(&settings)
        };
        Some((teach, self.groups.iter().find(fits)?))
    }
}
