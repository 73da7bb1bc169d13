//! Does a verdict hang on how the paper is read?
//!
//! Where a paper allows several readings, each is a setting
//! ([`ReadingChoice`](crate::analysis::catalogue::ReadingChoice)). A *reading* is a combination of their
//! values that the paper's method was run with. The method under each reading is set against the runs of a
//! baseline that agree with it in everything outside the settings of methods, with the measure, the test and
//! the rule of the ledger's main claims.
//!
//! Readings that agree in all other settings are a *family*, and every family of at least two is judged:
//! those at one value of a field that the paper varies apart from those at another. Other values of such a
//! field are no readings: the paper fixes these settings, or varies them itself.
//!
//! All readings of a family are judged in the same environments, so that nothing but the reading differs: of
//! the environments, those with the largest set of readings.

mod conclusion;
mod places;

use serde_json::Value;

use crate::analysis::catalogue::{ClaimKind, ClaimScope, Paper};
use crate::analysis::complete::Pair;
use crate::analysis::group::{self, Group};
use crate::analysis::ledger::{self, LedgerEntry, Versus};
use crate::analysis::options::ReportOptions;
use conclusion::{conclusion, setting};
use places::{Candidates, Place};

/// The value of every choice as text, in the order of the paper's choices; `None` where a config lacks the
/// field.
type Values = Vec<Option<String>>;

/// A reading under which the paper's method was run, and those that come to the same in the method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Values of the choices; first those that the reading is named after, then those with the same runs,
    /// evaluation by evaluation.
    values: Vec<Values>,
    /// The choices that vary among the readings at hand.
    varied: Vec<Varied>,
}

/// A choice that varies: its index among all choices, and its name.
type Varied = (usize, &'static str);

impl Reading {
    /// `states = replay, record = cycle`: the choices that vary; then in parentheses what comes to the same.
    pub fn name(&self) -> String {
        let named = |values: &Values| {
            let setting = |&(choice, name): &Varied| setting(name, &[values[choice].as_deref()]);
            self.varied.iter().map(setting).collect::<Vec<_>>().join(", ")
        };
        let mut names = self.values.iter().map(named);
        let first = names.next().unwrap_or_default();
        let rest: Vec<String> = names.collect();
        if rest.is_empty() { first } else { format!("{first} (the same runs: {})", rest.join("; ")) }
    }
}

/// A claim under every reading.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedClaim {
    /// The number of each reading, from 1 and the same for all claims of the family, with its verdict.
    /// Readings without runs of the baseline are left out; there are at least two.
    pub judged: Vec<(usize, LedgerEntry)>,
    /// Whether the verdict is the same under all of them, and under which it is what: `hangs on the reading:
    /// ...`.
    pub conclusion: String,
}

impl JudgedClaim {
    /// Whether the verdict differs between readings.
    pub fn hangs(&self) -> bool {
        self.judged.iter().any(|(_, entry)| entry.verdict != self.judged[0].1.verdict)
    }
}

/// The readings that the method was run with under the same other settings, and all claims under all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingFamily {
    /// What these other settings have apart from the method's default ones: `Δ = 10`; empty for the default
    /// ones.
    pub name: String,
    /// The readings, in the order of their groups; at least two.
    pub readings: Vec<Reading>,
    /// The environments that all of them were run in.
    pub environments: Vec<String>,
    /// Environments that lack some of them, which no verdict rests on.
    pub left_out: Vec<String>,
    /// Every claim about a baseline that two readings or more can be set against; at least one.
    pub claims: Vec<JudgedClaim>,
}

impl ReadingFamily {
    /// The name of a reading by its number in [`JudgedClaim::judged`].
    pub fn reading(&self, number: usize) -> String {
        self.readings.get(number.wrapping_sub(1)).map(Reading::name).unwrap_or_default()
    }

    /// `at Δ = 10`; `None` for the default settings.
    pub fn at(&self) -> Option<String> {
        (!self.name.is_empty()).then(|| format!("at {}", self.name))
    }

    /// Judges every claim under every reading; `None` where there are not two readings, or no claim about
    /// them.
    fn of(groups: &[Group<'_>], candidates: Candidates, options: &ReportOptions) -> Option<Self> {
        let Candidates { name, places } = candidates;
        let catalogue = &options.catalogue;
        let paper = &catalogue.paper;
        let (readings, shared) = shared(groups, paper, &places)?;
        let mut claims = Vec::new();
        for claim in &paper.claims {
            let (ClaimKind::AboveBaselines(measure), ClaimScope::All) = (claim.kind, claim.scope) else {
                continue;
            };
            for baseline in paper.baselines.iter().chain(&paper.control) {
                let title = &catalogue.title(baseline);
                let versus = Versus { claim, measure, baseline, title };
                let judge = Judge { groups, outer: paper.outer(), shared: &shared, versus, options };
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
    /// First that of the method's default settings, if it is one.
    pub families: Vec<ReadingFamily>,
}

impl Readings {
    /// Judges every claim about all of the paper's tasks under every reading of every family; `groups` come
    /// in order, and those of other environments do not count.
    pub fn of(groups: &[Group<'_>], options: &ReportOptions) -> Self {
        let groups = ledger::of_tasks(groups, options, true);
        let family = |candidates| ReadingFamily::of(&groups, candidates, options);
        let candidates = places::candidates(&groups, &options.catalogue.paper);
        Self { families: candidates.into_iter().filter_map(family).collect() }
    }
}

/// The largest set of readings that an environment has, of equals the one that most environments have, and
/// these environments; `None` for fewer than two readings.
fn shared<'a>(
    groups: &[Group<'_>],
    paper: &Paper,
    places: &'a [Place],
) -> Option<(Vec<Reading>, Vec<&'a Place>)> {
    let alike = |place: &&Place| places.iter().filter(|other| other.set() == place.set()).count();
    // The first of equals: `max_by_key` takes the last.
    let first = places.iter().rev().max_by_key(|place| (place.readings.len(), alike(place)))?;
    let shared: Vec<&Place> = places.iter().filter(|place| place.set() == first.set()).collect();
    let all: Vec<&Values> = first.readings.iter().map(|(values, _)| values).collect();
    let named = paper.choices.iter().map(|choice| choice.name).enumerate();
    let varied: Vec<Varied> =
        named.filter(|&(index, _)| all.iter().any(|values| values[index] != all[0][index])).collect();
    let mut readings: Vec<Reading> = Vec::new();
    for values in all {
        let same =
            |reading: &&mut Reading| is_same(groups, paper.outer(), &shared, &reading.values[0], values);
        match readings.iter_mut().find(same) {
            Some(reading) => reading.values.push(values.clone()),
            None => readings.push(Reading { values: vec![values.clone()], varied: varied.clone() }),
        }
    }
    (readings.len() > 1).then_some((readings, shared))
}

/// Whether two readings gave the same runs in every environment, set against the same runs of baselines.
fn is_same(groups: &[Group<'_>], outer: &str, shared: &[&Place], a: &Values, b: &Values) -> bool {
    shared.iter().all(|place| {
        let found = place.group(a).zip(place.group(b));
        found.is_some_and(|(a, b)| {
            outside(&groups[a], outer) == outside(&groups[b], outer)
                && group::is_repeated(&groups[a], &groups[b])
        })
    })
}

/// The config of a group without the settings of methods, which stand at the pointer `outer`; `None` without
/// a run.
fn outside(group: &Group<'_>, outer: &str) -> Option<Value> {
    let mut config = group.runs.first()?.manifest.config.clone();
    if let Some(methods) = config.pointer_mut(outer) {
        *methods = Value::Null;
    }
    Some(config)
}

/// The method and a baseline.
type Opponents<'a> = (&'a Group<'a>, &'a Group<'a>);

/// What one claim is judged by under every reading.
struct Judge<'a> {
    groups: &'a [Group<'a>],
    /// Where the settings of methods stand.
    outer: &'a str,
    shared: &'a [&'a Place],
    versus: Versus<'a>,
    options: &'a ReportOptions,
}

impl Judge<'_> {
    /// The claim under every reading that has runs of the baseline; `None` for fewer than two.
    fn claim(&self, readings: &[Reading]) -> Option<JudgedClaim> {
        let opponents = |reading: &Reading| -> Vec<Option<Opponents<'_>>> {
            self.shared.iter().map(|place| self.versus(place, reading)).collect()
        };
        let all: Vec<(usize, Vec<Option<Opponents<'_>>>)> =
            readings.iter().enumerate().map(|(index, reading)| (index + 1, opponents(reading))).collect();
        let tested: Vec<_> = all.iter().filter(|(_, found)| found.iter().any(Option::is_some)).collect();
        // Only environments where every one of them has runs of the baseline.
        let places: Vec<usize> = (0..self.shared.len())
            .filter(|&place| tested.iter().all(|(_, found)| found[place].is_some()))
            .collect();
        if tested.len() < 2 || places.is_empty() {
            return None;
        }
        let resampling = ledger::corrected(self.options.resampling, tested.len());
        let judge = |(number, found): &&(usize, Vec<Option<Opponents<'_>>>)| {
            let pairs: Vec<Pair<'_>> =
                places.iter().filter_map(|&place| found[place]).map(|(a, b)| Pair::of(a, b)).collect();
            (*number, self.versus.judge(&pairs, self.options, resampling))
        };
        let judged: Vec<(usize, LedgerEntry)> = tested.iter().map(judge).collect();
        let conclusion = conclusion(readings, &judged, self.versus.title);
        Some(JudgedClaim { judged, conclusion })
    }

    /// The method under `reading` and the baseline's runs of the same settings, in one environment.
    fn versus(&self, place: &Place, reading: &Reading) -> Option<Opponents<'_>> {
        let own = &self.groups[place.group(reading.values.first()?)?];
        let settings = outside(own, self.outer)?;
        // In order: `default` first.
        let fits = |group: &&Group<'_>| {
            group.key.environment == place.environment
                && group.key.is_of(self.versus.baseline)
                && outside(group, self.outer).as_ref() == Some(&settings)
        };
        Some((own, self.groups.iter().find(fits)?))
    }
}
