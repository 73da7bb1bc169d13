//! Verdicts, p-values and intervals of simulated experiments against those that numpy and scipy come to, by
//! `tests/fixtures/calibration.py`.

use reports::ReportOptions;
use reports::analysis::comparison::{self, Comparison};
use reports::analysis::group;
use reports::analysis::ledger::{self, Effect};
use reports::schema::RunKey;
use reports::store::Store;
use serde::Deserialize;
use serde_json::{Value, json};

use super::curve::EPISODES;
use super::experiment::{paper, run};

/// An experiment, and what is to be found in it.
#[derive(Deserialize)]
struct DataSet {
    name: String,
    /// By baseline.
    above: serde_json::Map<String, Value>,
    invariance: String,
    /// The effect of a value in an environment, by both.
    places: serde_json::Map<String, Value>,
    comparisons: Vec<Value>,
    runs: Vec<Counts>,
}

#[derive(Deserialize)]
struct Counts {
    environment: String,
    curriculum: String,
    variant: String,
    seed: u64,
    /// `[evaluations]`
    successes: Vec<u32>,
}

fn store(runs: &[Counts]) -> Store {
    let run = |counts: &Counts| {
        let Counts { environment, curriculum, variant, seed, successes } = counts;
        let key = RunKey {
            environment: environment.clone(),
            curriculum: curriculum.clone(),
            variant: variant.clone(),
            seed: *seed,
        };
        let window = variant.strip_prefix("n=").map_or(10, |value| value.parse::<u64>().unwrap());
        let own = if curriculum == "nova" { json!({"window": window}) } else { json!({}) };
        let rates: Vec<f64> = successes.iter().map(|&count| f64::from(count) / EPISODES as f64).collect();
        run(key, json!({"curriculum": {curriculum: own}}), &rates)
    };
    Store::of(runs.iter().map(run).collect())
}

#[track_caller]
fn close(what: &str, found: Option<f64>, expected: &Value) {
    let same = match (found, expected.as_f64()) {
        (Some(found), Some(expected)) => (found - expected).abs() < 1e-9,
        (found, expected) => found.is_none() && expected.is_none(),
    };
    assert!(same, "{what}: {found:?}, not {expected}");
}

#[track_caller]
fn same_effect(name: &str, effect: &Effect, expected: &Value) {
    let numbers = [
        ("difference", effect.difference),
        ("p", effect.p),
        ("improvement", effect.improvement),
        ("improvement_p", effect.improvement_p),
    ];
    for (field, found) in numbers {
        close(&format!("{name}, {field}"), found, &expected[field]);
    }
    close(&format!("{name}, low"), effect.interval.map(|(low, _)| low), &expected["interval"][0]);
    close(&format!("{name}, high"), effect.interval.map(|(_, high)| high), &expected["interval"][1]);
}

#[track_caller]
fn same_comparison(name: &str, one: &Comparison<'_>, expected: &Value) {
    let numbers = [
        ("difference", one.difference),
        ("sign_flip_p", one.sign_flip.map(|test| test.p)),
        ("improvement_p", one.improvement_p),
        ("probability_of_improvement", one.probability_of_improvement),
        ("t", one.welch.map(|test| test.t)),
        ("df", one.welch.map(|test| test.df)),
        ("welch_p", one.welch.map(|test| test.p)),
        ("p_holm", one.p_holm),
    ];
    for (field, found) in numbers {
        let method = &one.method;
        close(
            &format!("{name}, {} in {}, {field}", method.name(), method.environment),
            found,
            &expected[field],
        );
    }
}

#[test]
fn numbers_are_those_of_another_tool() {
    let sets: Vec<DataSet> = serde_json::from_str(include_str!("../fixtures/calibration.json")).unwrap();
    assert_eq!(sets.len(), 5);
    let options = ReportOptions { catalogue: paper(4), ..ReportOptions::default() };
    for set in &sets {
        let store = store(&set.runs);
        let groups = group::groups(&store, &options.catalogue);
        let entries = ledger::ledger(&groups, &options);
        let find = |id: &str| entries.iter().find(|entry| entry.id == id).unwrap();
        for (baseline, expected) in &set.above {
            let entry = find(&format!("final-{baseline}"));
            let name = format!("{}, {baseline}", set.name);
            assert_eq!(entry.verdict.as_str(), expected["verdict"], "{name}");
            same_effect(&name, &entry.effect, expected);
        }
        let window = find("window");
        assert_eq!(window.verdict.as_str(), set.invariance, "{}", set.name);
        let place = window.value.as_ref().unwrap();
        same_effect(&format!("{}, {place}", set.name), &window.effect, &set.places[place]);

        let keys: Vec<_> = groups.iter().map(|group| &group.key).collect();
        let comparisons = comparison::comparisons(&groups, &group::compared(&keys), &options);
        for expected in &set.comparisons {
            let is_it = |one: &&Comparison<'_>| {
                one.method.environment == expected["environment"]
                    && one.method.curriculum.id == expected["method"]
            };
            same_comparison(&set.name, comparisons.iter().find(is_it).unwrap(), expected);
        }
    }
}
