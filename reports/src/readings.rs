//! Does a verdict hang on how the paper is read?
//!
//! Where the paper allows several readings, each is a setting ([`CHOICES`]). A *reading* is a combination of their values
//! that TEACH was run with. TEACH under each reading is set against the runs of a baseline that agree with it in
//! everything outside `/curriculum`, with the measure, the test and the rule of the ledger's main claims.
//!
//! All readings are judged in the same environments, so that nothing but the reading differs: of the environments, those
//! with the largest set of readings.

use serde_json::Value;

use crate::ablation;
use crate::complete::Pair;
use crate::group::{self, Group};
use crate::ledger::{self, Entry, Measure, Verdict};
use crate::methods;
use crate::paper;
use crate::stats::Resampling;

/// A place where the paper can be read in more than one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What stands before a value: `states = replay`.
    pub name: &'static str,
    /// JSON pointer (RFC 6901) into a run's config.
    pub pointer: &'static str,
}

const COUNT: usize = 7;

/// All of them, in the order in which they are named.
pub static CHOICES: [Choice; COUNT] = [
    Choice { name: "states", pointer: "/curriculum/teach/states" },
    Choice { name: "selection", pointer: "/curriculum/teach/selection" },
    Choice { name: "record", pointer: "/curriculum/teach/record" },
    Choice { name: "signal", pointer: "/curriculum/teach/signal" },
    Choice { name: "confidence", pointer: ablation::CONFIDENCE.pointer },
    Choice { name: ablation::INTERPLAY.symbol, pointer: ablation::INTERPLAY.pointer },
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

/// `states = replay`, `Δ = 1, 2 or 5`; `not set` where a config lacks the field.
fn setting(choice: usize, values: &[Option<&str>]) -> String {
    let texts: Vec<&str> = values.iter().map(|value| value.unwrap_or("not set")).collect();
    let values = match texts.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => texts.concat(),
    };
    format!("{} = {values}", CHOICES[choice].name)
}

/// A claim under every reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The number of each reading, from 1 and the same for all claims, with its verdict. Readings without runs of the
    /// baseline are left out; there are at least two.
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

/// All claims under all readings; empty for fewer than two readings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// The readings, in the order of their groups; at least two, or none.
    pub readings: Vec<Reading>,
    /// The environments that all of them were run in.
    pub environments: Vec<String>,
    /// Environments that lack some of them, which no verdict rests on.
    pub left_out: Vec<String>,
    /// Every claim about a baseline that two readings or more can be set against.
    pub claims: Vec<Claim>,
}

impl Readings {
    /// The name of a reading by its number in [`Claim::judged`].
    pub fn name(&self, number: usize) -> String {
        self.readings.get(number.wrapping_sub(1)).map(Reading::name).unwrap_or_default()
    }

    /// Judges every claim under every reading; `groups` come in order. Final scores average `window` evaluations.
    pub fn of(groups: &[Group<'_>], window: usize, resampling: Resampling) -> Self {
        let places = places(groups);
        let Some((readings, shared)) = shared(groups, &places) else { return Self::default() };
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
        Self { readings, environments: names(inside), left_out: names(outside), claims }
    }
}

/// The readings of one environment: TEACH's groups whose configs differ in [`CHOICES`] alone.
struct Place {
    environment: String,
    /// What their configs agree in: all but the choices.
    rest: Value,
    /// What each was read as, and the index of its group among all groups.
    readings: Vec<(Values, usize)>,
}

impl Place {
    fn group(&self, values: &Values) -> Option<usize> {
        self.readings.iter().find(|(other, _)| other == values).map(|(_, group)| *group)
    }

    /// The readings without their order.
    fn set(&self) -> Vec<&Values> {
        let mut set: Vec<&Values> = self.readings.iter().map(|(values, _)| values).collect();
        set.sort();
        set
    }
}

/// The largest set of readings of every environment where TEACH was run, of equals the first (that of `default`, if it
/// has one); of groups with one reading the first.
fn places(groups: &[Group<'_>]) -> Vec<Place> {
    let mut families: Vec<Place> = Vec::new();
    for (index, group) in groups.iter().enumerate().filter(|(_, group)| group.key.curriculum == paper::METHOD)
    {
        let Some(run) = group.runs.first() else { continue };
        let config = &run.manifest.config;
        let values = CHOICES.map(|choice| config.pointer(choice.pointer).map(ablation::text));
        let mut rest = config.clone();
        for choice in CHOICES {
            if let Some(field) = rest.pointer_mut(choice.pointer) {
                *field = Value::Null;
            }
        }
        let environment = &group.key.environment;
        let is_it = |place: &&mut Place| place.environment == *environment && place.rest == rest;
        match families.iter_mut().find(is_it) {
            Some(family) if family.group(&values).is_some() => {}
            Some(family) => family.readings.push((values, index)),
            None => {
                families.push(Place {
                    environment: environment.clone(),
                    rest,
                    readings: vec![(values, index)],
                });
            }
        }
    }
    let mut places: Vec<Place> = Vec::new();
    for family in families {
        match places.iter_mut().find(|place| place.environment == family.environment) {
            Some(place) if place.readings.len() >= family.readings.len() => {}
            Some(place) => *place = family,
            None => places.push(family),
        }
    }
    places
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

/// `the same under all 4 readings: confirmed`, or what the verdict is under which: named by the value of a single choice
/// where that decides, otherwise by the numbers of the readings.
fn conclusion(readings: &[Reading], judged: &[(usize, Entry)], baseline: &str) -> String {
    let verdicts: Vec<(usize, Verdict)> =
        judged.iter().map(|(number, entry)| (*number, entry.verdict)).collect();
    let lacking = match readings.len() - verdicts.len() {
        0 => String::new(),
        k => format!("; no runs of {baseline} with the same settings under {k} more"),
    };
    let first = verdicts[0].1;
    if verdicts.iter().all(|(_, verdict)| *verdict == first) {
        return format!("the same under all {} readings: {}{lacking}", verdicts.len(), first.as_str());
    }
    let under = |parts: Vec<(Verdict, String)>| {
        let part = |(verdict, names): &(Verdict, String)| format!("{} under {names}", verdict.as_str());
        let parts: Vec<String> = parts.iter().map(part).collect();
        format!("hangs on the reading: {}{lacking}", parts.join(", "))
    };
    let varied = readings.first().map_or(&[][..], |reading| &reading.varied);
    if let Some(parts) = varied.iter().find_map(|&choice| by_choice(readings, &verdicts, choice)) {
        return under(parts);
    }
    let of = |verdict: Verdict| {
        let numbers =
            verdicts.iter().filter(|(_, other)| *other == verdict).map(|(number, _)| number.to_string());
        let numbers: Vec<String> = numbers.collect();
        let what = if numbers.len() == 1 { "reading" } else { "readings" };
        (!numbers.is_empty()).then(|| (verdict, format!("{what} {}", numbers.join(", "))))
    };
    under([Verdict::Confirmed, Verdict::Refuted, Verdict::Undecided].into_iter().filter_map(of).collect())
}

/// The verdicts by the values of one choice; `None` where readings of one value have several.
fn by_choice(
    readings: &[Reading],
    verdicts: &[(usize, Verdict)],
    choice: usize,
) -> Option<Vec<(Verdict, String)>> {
    let mut values: Vec<(Option<&str>, Verdict)> = Vec::new();
    for &(number, verdict) in verdicts {
        for value in readings.get(number - 1)?.values.iter().map(|values| values[choice].as_deref()) {
            match values.iter().find(|(other, _)| *other == value) {
                Some((_, other)) if *other != verdict => return None,
                Some(_) => {}
                None => values.push((value, verdict)),
            }
        }
    }
    let of = |verdict: Verdict| {
        let same = values.iter().filter(|(_, other)| *other == verdict);
        let same: Vec<Option<&str>> = same.map(|(value, _)| *value).collect();
        (!same.is_empty()).then(|| (verdict, setting(choice, &same)))
    };
    Some([Verdict::Confirmed, Verdict::Refuted, Verdict::Undecided].into_iter().filter_map(of).collect())
}
