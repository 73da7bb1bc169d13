//! What stands beside the registered verdicts: other sets of runs, whole seeds as units, and comparisons
//! that the ledger lacks.

use std::collections::BTreeMap;

use reports::ReportOptions;
use reports::analysis::scores::area;
use reports::stats::{Resampling, SignFlip, mean, sign_flip, spearman};

use crate::sheet::{Row, Sheet};

/// The variant with a method's default settings.
pub(crate) const DEFAULT: &str = "default";
/// Seeds whose first steps were known before the study.
const KNOWN: u64 = 12;
/// Smaller differences are ties, as in the ledger: areas are sums, whose order leaves a rounding error.
const TIE: f64 = 1e-12;
/// Coverage of the intervals: the level 0.05 shared by four primary claims.
const CONFIDENCE: f64 = 1.0 - 0.05 / 4.0;

/// What a run is judged by.
#[derive(Clone, Copy)]
pub(crate) enum Measure {
    Area,
    Final,
}

/// Curriculum and variant.
type Method<'a> = (&'a str, &'a str);

/// A number of every run of one method, by environment and then by seed.
pub(crate) struct Scores(BTreeMap<String, BTreeMap<u64, f64>>);

/// (step, success rate) at every evaluation, by seed.
type Curves = BTreeMap<u64, Vec<(u64, f64)>>;

/// Differences of pairs by seed, by environment.
type Differences = BTreeMap<String, BTreeMap<u64, f64>>;

/// What a set of pairs says.
pub(crate) struct Beside {
    pub(crate) difference: f64,
    pub(crate) interval: Option<(f64, f64)>,
    /// Share of units ahead, ties one half, mean over environments.
    pub(crate) ahead: f64,
    pub(crate) p_signs: f64,
    pub(crate) units: usize,
}

/// The area of `ours` less that of `other` in every set of runs, and with whole seeds as units.
pub(crate) fn beside(records: &Sheet, ours: &str, other: &str) -> Vec<(&'static str, Beside)> {
    let all = areas(records, ours, other);
    let mazes = kept(&all, |environment, _| is_maze(environment));
    let unknown = kept(&all, |_, seed| seed >= KNOWN);
    let sets = [("all pairs", &all), ("pairs on the mazes", &mazes), ("pairs of seeds from 12 on", &unknown)];
    let rows = sets.into_iter().filter(|(_, pairs)| !pairs.is_empty());
    let rows = rows.map(|(what, pairs)| (what, by_pairs(pairs)));
    rows.chain([("whole seeds", by_seeds(&all))]).collect()
}

/// The rank correlations of one seed's differences in area between every two mazes.
pub(crate) fn correlations(records: &Sheet, ours: &str, other: &str) -> Vec<(String, f64)> {
    correlated(&kept(&areas(records, ours, other), |environment, _| is_maze(environment)))
}

/// The area of `ours` less that of `other` in single environments.
pub(crate) fn each(records: &Sheet, ours: &str, other: &str) -> Vec<(String, Beside)> {
    let all = areas(records, ours, other);
    all.keys()
        .map(|name| (name.clone(), by_pairs(&kept(&all, |environment, _| environment == name))))
        .collect()
}

/// A method in the records of one report less a method in those of another, over the environments and seeds
/// that both have.
pub(crate) fn less(measure: Measure, ours: (&Sheet, Method<'_>), other: (&Sheet, Method<'_>)) -> Beside {
    let [ours, other] = [ours, other].map(|(records, method)| Scores::of(records, method, measure));
    by_pairs(&ours.less(&other))
}

fn areas(records: &Sheet, ours: &str, other: &str) -> Differences {
    let [ours, other] =
        [ours, other].map(|curriculum| Scores::of(records, (curriculum, DEFAULT), Measure::Area));
    ours.less(&other)
}

fn is_maze(environment: &str) -> bool {
    environment.starts_with("Maze")
}

impl Scores {
    fn of(records: &Sheet, (curriculum, variant): Method<'_>, measure: Measure) -> Self {
        let mut curves: BTreeMap<String, Curves> = BTreeMap::new();
        let ours = |row: &Row<'_>| row.text("curriculum") == curriculum && row.text("variant") == variant;
        for row in records.rows().filter(ours) {
            let number = |column| row.number(column).expect("every evaluation has it");
            let cell = curves.entry(row.text("environment")).or_default();
            cell.entry(number("seed") as u64)
                .or_default()
                .push((number("step") as u64, number("success_rate")));
        }
        let scores = |cell: Curves| {
            let length = cell.values().map(Vec::len).max();
            assert!(
                cell.values().all(|curve| Some(curve.len()) == length),
                "runs that failed need their zeros"
            );
            cell.into_iter().map(|(seed, curve)| (seed, measure.of(curve))).collect()
        };
        Self(curves.into_iter().map(|(environment, cell)| (environment, scores(cell))).collect())
    }

    fn less(&self, other: &Self) -> Differences {
        let mut differences = Differences::new();
        for (environment, ours) in &self.0 {
            let Some(theirs) = other.0.get(environment) else { continue };
            let pairs = ours.iter().filter_map(|(seed, our)| Some((*seed, our - theirs.get(seed)?)));
            differences.insert(environment.clone(), pairs.collect());
        }
        differences
    }
}

impl Measure {
    /// The measure of a curve, whose first evaluation is that of the untrained student.
    fn of(self, curve: Vec<(u64, f64)>) -> f64 {
        match self {
            Self::Area => area(curve).expect("a curve spans the budget"),
            Self::Final => {
                let window = ReportOptions::default().window;
                let last: Vec<f64> = curve[1..].iter().rev().take(window).map(|point| point.1).collect();
                mean(&last).expect("a run has evaluations")
            }
        }
    }
}

fn kept(all: &Differences, keep: impl Fn(&str, u64) -> bool) -> Differences {
    let place = |(environment, pairs): (&String, &BTreeMap<u64, f64>)| {
        let pairs = pairs.iter().filter(|(seed, _)| keep(environment, **seed));
        (
            environment.clone(),
            pairs.map(|(seed, difference)| (*seed, *difference)).collect::<BTreeMap<_, _>>(),
        )
    };
    all.iter().map(place).filter(|(_, pairs)| !pairs.is_empty()).collect()
}

/// The test of the ledger: every pair a unit, every environment a stratum.
fn by_pairs(differences: &Differences) -> Beside {
    let strata: Vec<Vec<f64>> = differences.values().map(|pairs| pairs.values().copied().collect()).collect();
    Beside::of(&strata)
}

/// Every seed a unit: the mean of its differences over environments.
fn by_seeds(differences: &Differences) -> Beside {
    let mut seeds: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for (seed, difference) in differences.values().flatten() {
        seeds.entry(*seed).or_default().push(*difference);
    }
    let means: Vec<f64> = seeds.values().filter_map(|values| mean(values)).collect();
    Beside::of(&[means])
}

impl Beside {
    fn of(strata: &[Vec<f64>]) -> Self {
        let test = |strata: &[Vec<f64>]| -> SignFlip {
            let resampling = Resampling { confidence: CONFIDENCE, ..Resampling::default() };
            sign_flip(&strata.iter().map(Vec::as_slice).collect::<Vec<_>>(), resampling).expect("pairs")
        };
        let over = |of: &dyn Fn(f64) -> f64| -> f64 {
            let stratum =
                |values: &Vec<f64>| mean(&values.iter().map(|value| of(*value)).collect::<Vec<_>>());
            mean(&strata.iter().filter_map(stratum).collect::<Vec<_>>()).expect("strata")
        };
        let sign = |value: f64| if value.abs() < TIE { 0.0 } else { value.signum() };
        let signs: Vec<Vec<f64>> =
            strata.iter().map(|values| values.iter().copied().map(sign).collect()).collect();
        Self {
            difference: over(&|value| value),
            interval: test(strata).interval,
            ahead: over(&|value| (sign(value) + 1.0) / 2.0),
            p_signs: test(&signs).p,
            units: strata.iter().map(Vec::len).sum(),
        }
    }
}

/// The rank correlation of differences by seed between every two environments.
fn correlated(differences: &Differences) -> Vec<(String, f64)> {
    let places: Vec<(&String, &BTreeMap<u64, f64>)> = differences.iter().collect();
    let mut all = Vec::new();
    for (index, (one, a)) in places.iter().enumerate() {
        for (other, b) in &places[index + 1..] {
            let both: Vec<(f64, f64)> =
                a.iter().filter_map(|(seed, value)| Some((*value, *b.get(seed)?))).collect();
            let (a, b): (Vec<f64>, Vec<f64>) = both.into_iter().unzip();
            all.extend(spearman(&a, &b).map(|correlation| (format!("{one}, {other}"), correlation)));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences(places: &[(&str, &[f64])]) -> Differences {
        let place = |(name, values): &(&str, &[f64])| {
            ((*name).to_owned(), (0..).zip(values.iter().copied()).collect())
        };
        places.iter().map(place).collect()
    }

    #[test]
    fn whole_seeds_by_hand() {
        let two = differences(&[("MazeA", &[0.1, 0.3, 0.2]), ("MazeB", &[0.3, -0.1, 0.2])]);
        let by_seeds = by_seeds(&two);
        // Means 0.2, 0.1 and 0.2: all ahead, 2 of 8 flips as far from 0.
        assert!((by_seeds.difference - 0.5 / 3.0).abs() < 1e-12);
        assert_eq!((by_seeds.ahead, by_seeds.p_signs, by_seeds.units), (1.0, 0.25, 3));
        let by_pairs = by_pairs(&two);
        assert!((by_pairs.difference - 0.5 / 3.0).abs() < 1e-12);
        assert!((by_pairs.ahead - 5.0 / 6.0).abs() < 1e-12 && by_pairs.units == 6);
        // Ranks 1, 3, 2 and 3, 1, 2.
        assert_eq!(correlated(&two), [("MazeA, MazeB".to_owned(), -1.0)]);
        assert_eq!(kept(&two, |place, seed| place == "MazeA" && seed > 0), differences_from(&two));
    }

    #[test]
    fn a_curve_by_hand() {
        let curve = || (0..8).map(|step| (step, if step < 4 { 0.0 } else { 1.0 })).collect();
        // The last five are 0, 1, 1, 1, 1; the trapezoids are half of one and three whole ones, of seven.
        assert!((Measure::Final.of(curve()) - 0.8).abs() < 1e-12);
        assert!((Measure::Area.of(curve()) - 0.5).abs() < 1e-12);
        let short = vec![(0, 1.0), (1, 0.0), (2, 0.5)];
        assert!((Measure::Final.of(short) - 0.25).abs() < 1e-12, "the untrained student does not count");
    }

    fn differences_from(two: &Differences) -> Differences {
        let mut one = two.clone();
        one.remove("MazeB");
        one.get_mut("MazeA").expect("it is there").remove(&0);
        one
    }
}
