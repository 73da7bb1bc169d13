//! What stands beside the registered verdicts on area: other sets of runs, and whole seeds as units.

use std::collections::BTreeMap;
use std::path::Path;

use reports::analysis::scores::area;
use reports::stats::{Resampling, SignFlip, mean, sign_flip, spearman};

use crate::sheet::Sheet;

/// Seeds whose first steps were known before the study.
const KNOWN: u64 = 12;
/// Smaller differences are ties, as in the ledger: areas are sums, whose order leaves a rounding error.
const TIE: f64 = 1e-12;
/// Coverage of the intervals: the level 0.05 shared by four primary claims.
const CONFIDENCE: f64 = 1.0 - 0.05 / 4.0;

/// A number of every run with default settings, by environment and curriculum and then by seed.
struct Scores(BTreeMap<(String, String), BTreeMap<u64, f64>>);

/// (step, success rate) at every evaluation, by seed.
type Curves = BTreeMap<u64, Vec<(u64, f64)>>;

/// Differences of pairs by seed, by environment.
type Differences = BTreeMap<String, BTreeMap<u64, f64>>;

/// What a set of pairs says.
pub(crate) struct Beside {
    pub(crate) what: &'static str,
    pub(crate) difference: f64,
    pub(crate) interval: Option<(f64, f64)>,
    /// Share of units ahead, ties one half, mean over environments.
    pub(crate) ahead: f64,
    pub(crate) p_signs: f64,
    pub(crate) units: usize,
}

/// The area of `ours` less that of `other` in every set of runs, and the mean rank correlation of one seed's
/// differences over pairs of mazes.
pub(crate) fn beside(report: &Path, ours: &str, other: &str) -> (Vec<Beside>, Option<f64>) {
    let all = Scores::areas(report).differences(ours, other);
    let is_maze = |environment: &str| environment.starts_with("Maze");
    let mazes = kept(&all, |environment, _| is_maze(environment));
    let unknown = kept(&all, |_, seed| seed >= KNOWN);
    let sets = [("all pairs", &all), ("mazes alone", &mazes), ("seeds from 12 on", &unknown)];
    let rows =
        sets.into_iter().filter(|(_, pairs)| !pairs.is_empty()).map(|(what, pairs)| by_pairs(what, pairs));
    (rows.chain([by_seeds("whole seeds", &all)]).collect(), correlation(&mazes))
}

impl Scores {
    fn areas(report: &Path) -> Self {
        let mut curves: BTreeMap<(String, String), Curves> = BTreeMap::new();
        for row in Sheet::read(report, "records").rows().filter(|row| row.text("variant") == "default") {
            let number = |column| row.number(column).expect("every evaluation has it");
            let cell = curves.entry((row.text("environment"), row.text("curriculum"))).or_default();
            cell.entry(number("seed") as u64)
                .or_default()
                .push((number("step") as u64, number("success_rate")));
        }
        let areas = |cell: Curves| {
            let length = cell.values().map(Vec::len).max();
            assert!(
                cell.values().all(|curve| Some(curve.len()) == length),
                "runs that failed need their zeros"
            );
            let area = |curve: Vec<(u64, f64)>| area(curve).expect("a curve spans the budget");
            cell.into_iter().map(|(seed, curve)| (seed, area(curve))).collect()
        };
        Self(curves.into_iter().map(|(key, cell)| (key, areas(cell))).collect())
    }

    fn differences(&self, a: &str, b: &str) -> Differences {
        let mut differences = Differences::new();
        for ((environment, curriculum), ours) in &self.0 {
            let theirs = self.0.get(&(environment.clone(), b.to_owned()));
            let Some(theirs) = theirs.filter(|_| curriculum == a) else { continue };
            let pairs = ours.iter().filter_map(|(seed, our)| Some((*seed, our - theirs.get(seed)?)));
            differences.insert(environment.clone(), pairs.collect());
        }
        differences
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
fn by_pairs(what: &'static str, differences: &Differences) -> Beside {
    let strata: Vec<Vec<f64>> = differences.values().map(|pairs| pairs.values().copied().collect()).collect();
    Beside::of(what, &strata)
}

/// Every seed a unit: the mean of its differences over environments.
fn by_seeds(what: &'static str, differences: &Differences) -> Beside {
    let mut seeds: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for (seed, difference) in differences.values().flatten() {
        seeds.entry(*seed).or_default().push(*difference);
    }
    let means: Vec<f64> = seeds.values().filter_map(|values| mean(values)).collect();
    Beside::of(what, &[means])
}

impl Beside {
    fn of(what: &'static str, strata: &[Vec<f64>]) -> Self {
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
            what,
            difference: over(&|value| value),
            interval: test(strata).interval,
            ahead: over(&|value| (sign(value) + 1.0) / 2.0),
            p_signs: test(&signs).p,
            units: strata.iter().map(Vec::len).sum(),
        }
    }
}

/// The mean over pairs of environments of the rank correlation of their differences by seed; `None` for fewer
/// than two environments.
fn correlation(differences: &Differences) -> Option<f64> {
    let places: Vec<&BTreeMap<u64, f64>> = differences.values().collect();
    let mut all = Vec::new();
    for (index, a) in places.iter().enumerate() {
        for b in &places[index + 1..] {
            let both: Vec<(f64, f64)> =
                a.iter().filter_map(|(seed, value)| Some((*value, *b.get(seed)?))).collect();
            let (a, b): (Vec<f64>, Vec<f64>) = both.into_iter().unzip();
            all.extend(spearman(&a, &b));
        }
    }
    mean(&all)
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
        let by_seeds = by_seeds("", &two);
        // Means 0.2, 0.1 and 0.2: all ahead, 2 of 8 flips as far from 0.
        assert!((by_seeds.difference - 0.5 / 3.0).abs() < 1e-12);
        assert_eq!((by_seeds.ahead, by_seeds.p_signs, by_seeds.units), (1.0, 0.25, 3));
        let by_pairs = by_pairs("", &two);
        assert!((by_pairs.difference - 0.5 / 3.0).abs() < 1e-12);
        assert!((by_pairs.ahead - 5.0 / 6.0).abs() < 1e-12 && by_pairs.units == 6);
        // Ranks 1, 3, 2 and 3, 1, 2.
        assert_eq!(correlation(&two), Some(-1.0));
        assert_eq!(kept(&two, |place, seed| place == "MazeA" && seed > 0), differences_from(&two));
    }

    fn differences_from(two: &Differences) -> Differences {
        let mut one = two.clone();
        one.remove("MazeB");
        one.get_mut("MazeA").expect("it is there").remove(&0);
        one
    }
}
