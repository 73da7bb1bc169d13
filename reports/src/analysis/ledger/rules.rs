//! The rules for claims about the values of a setting.

use super::effect::{Effect, PlaceEffect, sign};
use super::verdict::{Bench, Verdict, named};
use crate::analysis::catalogue::Rule;

/// A value as it is named, and its effect against the paper's own.
pub(super) type Tested = (String, Effect);

/// What a rule makes of the values tested.
#[derive(Default)]
pub(super) struct Finding {
    pub(super) verdict: Option<Verdict>,
    /// The value that the verdict hangs on, with its environment where the rule asks for each of them.
    pub(super) value: Option<String>,
    pub(super) effect: Effect,
    /// Coverage of the interval of that effect.
    pub(super) confidence: f64,
    /// What the verdict rests on beside the averages.
    pub(super) notes: Vec<String>,
}

impl Rule {
    /// The rule in words.
    pub(super) fn words(self, margin: f64) -> String {
        match self {
            Self::NotAbove => format!(
                "refuted if the interval lies wholly above 0 and the signs of the pairs say the same, or if one \
                 environment is above {margin} (corrected); otherwise confirmed if in every environment the one-sided \
                 interval lies below {margin}"
            ),
            Self::Equivalent => format!(
                "confirmed if in every environment every one-sided interval lies within ±{margin}, \
                 refuted if one environment is outside (corrected), or all of them together say that some are"
            ),
            Self::SomeAbove => "confirmed if one interval lies wholly above 0 and the signs of its pairs say the same, \
                                refuted if every value is below 0 by both"
                .to_owned(),
            Self::SomeBelow => "confirmed if one interval lies wholly below 0 and the signs of its pairs say the same, \
                                refuted if every value is above 0 by both"
                .to_owned(),
            Self::Mixed => format!(
                "confirmed if one value is above 0 in an environment and below 0 in another (corrected), refuted if in \
                 every environment every one-sided interval lies within ±{margin}"
            ),
            Self::SomewhereBest => "confirmed if in some environment every other value is below 0 (corrected over \
                                    environments), refuted if in every environment some other value is above 0"
                .to_owned(),
        }
    }

    /// How many tests of each value share its level.
    pub(super) const fn tests(self) -> usize {
        match self {
            // Of the average, and of the environments; of each environment, and of all together.
            Self::NotAbove | Self::Equivalent => 2,
            _ => 1,
        }
    }

    /// What the values say; `bench` holds the level of the whole claim, `each` that of a single value.
    pub(super) fn judge(self, tested: &[Tested], bench: Bench<'_>, each: Bench<'_>) -> Finding {
        match self {
            Self::NotAbove => not_above(tested, bench, each),
            Self::Equivalent => equivalent(tested, bench, each),
            Self::SomeAbove => some_beyond(tested, each, 1.0),
            Self::SomeBelow => some_beyond(tested, each, -1.0),
            Self::Mixed => mixed(tested, bench, each),
            Self::SomewhereBest => somewhere_best(tested, bench, each),
        }
    }
}

/// "At least one is above", or below where `direction` is -1.
fn some_beyond(tested: &[Tested], each: Bench<'_>, direction: f64) -> Finding {
    let judged: Vec<Verdict> = tested
        .iter()
        .map(|(_, effect)| match each.above(effect).verdict {
            Verdict::Confirmed if direction < 0.0 => Verdict::Refuted,
            Verdict::Refuted if direction < 0.0 => Verdict::Confirmed,
            other => other,
        })
        .collect();
    let verdict = if judged.contains(&Verdict::Confirmed) {
        Verdict::Confirmed
    } else if !judged.is_empty() && judged.iter().all(|verdict| *verdict == Verdict::Refuted) {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    };
    // Confirmed ones first; by the near end of the interval; without one by the difference, below all others.
    let weight = |index: &usize| {
        let (_, effect) = &tested[*index];
        let bonus = if judged[*index] == Verdict::Confirmed { 4.0 } else { 0.0 };
        bonus
            + match effect.interval {
                Some((low, high)) => {
                    if direction > 0.0 {
                        low
                    } else {
                        -high
                    }
                }
                None => effect.difference.map_or(-8.0, |difference| direction * difference - 4.0),
            }
    };
    let decisive = (0..tested.len()).max_by(|a, b| weight(a).total_cmp(&weight(b)));
    of_average(decisive.map(|index| &tested[index]), verdict, each)
}

/// The finding that hangs on the average of one value.
fn of_average(decisive: Option<&Tested>, verdict: Verdict, each: Bench<'_>) -> Finding {
    let (value, effect) =
        decisive.cloned().map_or((None, Effect::default()), |(value, effect)| (Some(value), effect));
    let disagreement = each.above(&effect).disagreement;
    Finding {
        verdict: Some(verdict),
        value,
        effect,
        confidence: each.resampling.confidence,
        notes: disagreement.into_iter().collect(),
    }
}

/// "None is any better".
fn not_above(tested: &[Tested], bench: Bench<'_>, each: Bench<'_>) -> Finding {
    let margin = bench.options.margin;
    let mut notes = Vec::new();
    let (mut refuted, mut confirmed) = (false, !tested.is_empty());
    for (value, effect) in tested {
        let above = each.beyond(effect, margin, |_| 1.0, each.level());
        if !above.is_empty() {
            notes.push(format!("{value}: above {margin} in {}", named(&above)));
        }
        refuted |= !above.is_empty() || each.above(effect).verdict == Verdict::Confirmed;
        let open: Vec<&PlaceEffect> = effect
            .places
            .iter()
            .filter(|place| !place.interval(bench.one_sided()).is_some_and(|(_, high)| high < margin))
            .collect();
        if !open.is_empty() && above.is_empty() {
            notes.push(format!("{value}: not shown to be below {margin} in {}", named(&open)));
        }
        confirmed &= bench.everywhere(effect, |(_, high)| high < margin);
    }
    let verdict = match (refuted, confirmed) {
        (true, _) => Verdict::Refuted,
        (false, true) => Verdict::Confirmed,
        (false, false) => Verdict::Undecided,
    };
    let weight = |(_, effect): &&Tested| match effect.interval {
        Some((low, _)) if low > 0.0 => 4.0 + low,
        Some((_, high)) => high,
        None => effect.difference.map_or(-8.0, |difference| difference - 4.0),
    };
    let decisive = tested.iter().max_by(|a, b| weight(a).total_cmp(&weight(b)));
    let finding = of_average(decisive, verdict, each);
    Finding { notes: [notes, finding.notes].concat(), ..finding }
}

/// The environments of a value by what they say of "no difference".
struct Sides<'e> {
    outside: Vec<&'e PlaceEffect>,
    within: Vec<&'e PlaceEffect>,
    open: Vec<&'e PlaceEffect>,
}

fn sides<'e>(effect: &'e Effect, bench: Bench<'_>, each: Bench<'_>) -> Sides<'e> {
    let margin = bench.options.margin;
    let outside = each.beyond(effect, margin, |place| sign(place.difference), each.level());
    let is_within = |place: &PlaceEffect| {
        let interval = place.interval(bench.one_sided());
        !effect.is_small(bench.options) && interval.is_some_and(|(low, high)| low > -margin && high < margin)
    };
    let rest = effect.places.iter().filter(|place| !outside.contains(place));
    let (within, open) = rest.partition(|place| is_within(place));
    Sides { outside, within, open }
}

/// "It makes no difference".
fn equivalent(tested: &[Tested], bench: Bench<'_>, each: Bench<'_>) -> Finding {
    let margin = bench.options.margin;
    let mut notes = Vec::new();
    let (mut refuted, mut confirmed) = (false, !tested.is_empty());
    // How far each environment is from the claim: those outside first, then by the farther end.
    let mut farthest: Option<(f64, String, &PlaceEffect)> = None;
    for (value, effect) in tested {
        let found = sides(effect, bench, each);
        let together = each.p_together(effect, margin);
        let is_refused = together <= each.level();
        refuted |= is_refused || !found.outside.is_empty();
        if is_refused && found.outside.is_empty() {
            let far: Vec<&PlaceEffect> =
                effect.places.iter().filter(|place| place.difference.abs() > margin).collect();
            notes.push(format!("{value}: some of {} are outside ±{margin} (p = {together:.4})", named(&far)));
        }
        confirmed &=
            !is_refused && found.outside.is_empty() && found.open.is_empty() && !found.within.is_empty();
        let parts = [
            (format!("outside ±{margin} in"), &found.outside),
            (format!("within ±{margin} in"), &found.within),
            ("open in".to_owned(), &found.open),
        ];
        let parts = parts.into_iter().filter(|(_, places)| !places.is_empty());
        let parts: Vec<String> = parts.map(|(what, places)| format!("{what} {}", named(places))).collect();
        if !parts.is_empty() {
            notes.push(format!("{value}: {}", parts.join(", ")));
        }
        for place in &effect.places {
            let end = |(low, high): (f64, f64)| high.max(-low);
            let reach = place.interval(bench.one_sided()).map_or(2.0 + place.difference.abs(), end);
            let weight = if found.outside.contains(&place) { 4.0 + place.difference.abs() } else { reach };
            if farthest.as_ref().is_none_or(|(most, ..)| weight > *most) {
                farthest = Some((weight, format!("{value} in {}", place.environment), place));
            }
        }
    }
    let verdict = match (refuted, confirmed) {
        (true, _) => Verdict::Refuted,
        (false, true) => Verdict::Confirmed,
        (false, false) => Verdict::Undecided,
    };
    let decisive = farthest.map(|(_, value, place)| (value, place.clone()));
    of_place(decisive, verdict, bench, notes)
}

/// The finding that hangs on one environment.
fn of_place(
    decisive: Option<(String, PlaceEffect)>,
    verdict: Verdict,
    bench: Bench<'_>,
    notes: Vec<String>,
) -> Finding {
    let one_sided = bench.one_sided();
    let (value, effect) = decisive.map_or((None, Effect::default()), |(value, place)| {
        (Some(value), Effect::over(vec![place], one_sided))
    });
    Finding { verdict: Some(verdict), value, effect, confidence: one_sided.confidence, notes }
}

/// "One is better in one environment and worse in another".
fn mixed(tested: &[Tested], bench: Bench<'_>, each: Bench<'_>) -> Finding {
    let none = equivalent(tested, bench, each);
    for (value, effect) in tested {
        let above = each.beyond(effect, 0.0, |_| 1.0, each.level());
        let below = each.beyond(effect, 0.0, |_| -1.0, each.level());
        if let (Some(first), false) = (above.first(), below.is_empty()) {
            let note = format!("{value}: better in {}, worse in {}", named(&above), named(&below));
            let decisive = Some((format!("{value} in {}", first.environment), (*first).clone()));
            return of_place(decisive, Verdict::Confirmed, bench, vec![note]);
        }
    }
    let verdict = match none.verdict {
        Some(Verdict::Confirmed) => Verdict::Refuted,
        _ => Verdict::Undecided,
    };
    Finding { verdict: Some(verdict), ..none }
}

/// "The paper's own is better than every other somewhere".
fn somewhere_best(tested: &[Tested], bench: Bench<'_>, each: Bench<'_>) -> Finding {
    let mut environments: Vec<&str> = Vec::new();
    for (_, effect) in tested {
        let new = effect.environments().into_iter().filter(|name| !environments.contains(name));
        environments.extend(new.collect::<Vec<_>>());
    }
    let at = |effect: &'_ Effect, name: &str| {
        effect.places.iter().find(|place| place.environment == name).cloned()
    };
    // A value of too few pairs is neither beaten nor beats.
    let p = |bench: Bench<'_>, (_, effect): &Tested, name: &str, direction: f64| match at(effect, name) {
        Some(place) if !effect.is_small(bench.options) => bench.p_beyond(&place, 0.0, direction),
        _ => 1.0,
    };
    // The hardest of the others to beat decides in each environment.
    let worst =
        |name: &&str| -> f64 { tested.iter().map(|value| p(bench, value, name, -1.0)).fold(0.0, f64::max) };
    let p_values: Vec<f64> = environments.iter().map(worst).collect();
    let adjusted = crate::stats::hochberg(&p_values);
    let is_best = |(_, p): &(&&str, f64)| *p <= bench.level() + 1e-9;
    let best: Vec<&str> = environments.iter().zip(adjusted).filter(is_best).map(|(name, _)| *name).collect();
    let is_beaten = |name: &&str| tested.iter().any(|value| p(each, value, name, 1.0) <= each.level() + 1e-9);
    let beaten: Vec<&str> = environments.iter().copied().filter(|name| is_beaten(name)).collect();
    let verdict = if !best.is_empty() {
        Verdict::Confirmed
    } else if !environments.is_empty() && beaten.len() == environments.len() {
        Verdict::Refuted
    } else {
        Verdict::Undecided
    };
    let list =
        |what: &str, names: &[&str]| (!names.is_empty()).then(|| format!("{what} {}", names.join(", ")));
    let notes = [list("better than all others in", &best), list("another is better in", &beaten)];
    // Where it is best, its closest rival; otherwise that of the environment where it comes nearest.
    let nearest = environments.iter().min_by(|a, b| worst(a).total_cmp(&worst(b)));
    let rival = nearest.and_then(|name| {
        let here = tested.iter().filter_map(|(value, effect)| Some((value, at(effect, name)?)));
        let (value, place) = here.max_by(|(_, a), (_, b)| a.difference.total_cmp(&b.difference))?;
        Some((format!("{value} in {name}"), place))
    });
    of_place(rival, verdict, bench, notes.into_iter().flatten().collect())
}
