//! Statistics against the numbers of numpy, scipy, statsmodels and rliable (`fixtures/statistics.py`).

use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use reports::stats::{self, Ddof, Resampling};
use serde_json::Value;

fn fixture() -> Value {
    serde_json::from_str(include_str!("../fixtures/statistics.json")).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn strata(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

fn slices(strata: &[Vec<f64>]) -> Vec<&[f64]> {
    strata.iter().map(Vec::as_slice).collect()
}

#[track_caller]
fn assert_close(got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "got {got}, expected {expected} ± {tolerance}");
}

#[test]
fn moments_and_order_statistics_agree() {
    let expected = fixture();
    let all = strata(&expected["x"]).concat();
    assert_close(stats::mean(&all).unwrap(), number(&expected["mean"]), 1e-12);
    for (ddof, name) in [(Ddof::Population, "population"), (Ddof::Sample, "sample")] {
        assert_close(stats::std_dev(&all, ddof).unwrap(), number(&expected["std"][name]), 1e-12);
    }
    for (p, value) in expected["quantiles"].as_object().unwrap() {
        assert_close(stats::quantile(&all, p.parse().unwrap()).unwrap(), number(value), 1e-12);
    }
    assert_close(stats::iqm(&all).unwrap(), number(&expected["iqm"]), 1e-12);
    assert_close(stats::optimality_gap(&all, 0.95).unwrap(), number(&expected["optimality_gap"]), 1e-12);
}

#[test]
fn probability_of_improvement_and_profiles_agree() {
    let expected = fixture();
    let (x, y) = (strata(&expected["x"]), strata(&expected["y"]));
    let probability = stats::probability_of_improvement(&slices(&x), &slices(&y)).unwrap();
    assert_close(probability, number(&expected["probability_of_improvement"]), 1e-12);
    let profile = stats::performance_profile(&slices(&x), &numbers(&expected["profile"]["taus"])).unwrap();
    for (got, expected) in profile.iter().zip(numbers(&expected["profile"]["shares"])) {
        assert_close(*got, expected, 1e-12);
    }
}

#[test]
fn bootstrap_intervals_approach_those_of_all_resamples() {
    let expected = fixture();
    let resampling = Resampling { resamples: 100_000, ..Resampling::default() };
    let two = strata(&expected["bootstrap"]["strata"]);
    let iqm = |strata: &[Vec<f64>]| stats::iqm(&strata.concat());
    let (low, high) = stats::stratified_interval(&slices(&two), iqm, resampling).unwrap();
    let exact = numbers(&expected["bootstrap"]["iqm"]);
    // Percentiles of 100,000 draws: their sampling error is well below a hundredth here.
    assert_close(low, exact[0], 0.01);
    assert_close(high, exact[1], 0.01);

    let pairs: Vec<(f64, f64)> =
        strata(&expected["paired"]["pairs"]).iter().map(|pair| (pair[0], pair[1])).collect();
    let (low, high) = stats::paired_interval(&pairs, resampling).unwrap();
    let exact = numbers(&expected["paired"]["mean"]);
    assert_close(low, exact[0], 0.01);
    assert_close(high, exact[1], 0.01);
}

#[test]
fn bootstrap_does_not_depend_on_the_number_of_threads() {
    let scores = [0.1, 0.35, 0.9, 0.6, 0.77];
    let interval = || {
        stats::stratified_interval(&[&scores], |strata| stats::iqm(&strata[0]), Resampling::default())
            .unwrap()
    };
    let with_threads =
        |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(interval);
    assert_eq!(with_threads(1), with_threads(4));
    let reseeded = Resampling { seed: 1, resamples: 50, ..Resampling::default() };
    let few = Resampling { resamples: 50, ..Resampling::default() };
    let of =
        |resampling| stats::paired_interval(&[(0.1, 0.0), (0.35, 0.0), (0.9, 0.1), (0.7, 0.3)], resampling);
    assert_ne!(of(few), of(reseeded), "the seed matters");
}

#[test]
fn tests_of_means_agree() {
    let expected = fixture();
    for case in expected["welch"].as_array().unwrap() {
        let test = stats::welch(&numbers(&case["a"]), &numbers(&case["b"])).unwrap();
        assert_close(test.t, number(&case["t"]), 1e-10);
        assert_close(test.df, number(&case["df"]), 1e-9);
        assert_close(test.p, number(&case["p"]), 1e-9);
    }
    let together = stats::fisher(&numbers(&expected["fisher"]["p"]));
    assert_close(together, number(&expected["fisher"]["together"]), 1e-12);
    for (correction, name) in [(stats::holm as fn(&[f64]) -> Vec<f64>, "holm"), (stats::hochberg, "hochberg")]
    {
        let adjusted = correction(&numbers(&expected[name]["p"]));
        for (got, expected) in adjusted.iter().zip(numbers(&expected[name]["adjusted"])) {
            assert_close(*got, expected, 1e-12);
        }
    }
}

#[test]
fn permutation_tests_agree() {
    let expected = fixture();
    for case in expected["permutation"].as_array().unwrap() {
        let test = stats::permutation(&numbers(&case["a"]), &numbers(&case["b"])).unwrap();
        assert_close(test.lower, number(&case["lower"]), 1e-12);
        assert_close(test.either, number(&case["either"]), 1e-12);
    }
    for case in expected["sign_flip"].as_array().unwrap() {
        let strata = strata(&case["strata"]);
        let resampling = Resampling { confidence: number(&case["confidence"]), ..Resampling::default() };
        let test = stats::sign_flip(&slices(&strata), resampling).unwrap();
        assert_close(test.p, number(&case["p"]), 1e-12);
        let (interval, bounds) = (test.interval.unwrap(), numbers(&case["interval"]));
        assert_close(interval.0, bounds[0], 1e-9);
        assert_close(interval.1, bounds[1], 1e-9);
    }
}

#[test]
fn effect_sizes_and_median_steps_agree() {
    let expected = fixture();
    for case in expected["effect_size"].as_array().unwrap() {
        let d = stats::effect_size(&numbers(&case["a"]), &numbers(&case["b"])).unwrap();
        assert_close(d, number(&case["d"]), 1e-10);
    }
    for case in expected["median_steps"].as_array().unwrap() {
        let times: Vec<Option<u64>> = case["times"].as_array().unwrap().iter().map(Value::as_u64).collect();
        assert_eq!(reports::analysis::summary::median_steps(&times), case["median"].as_u64(), "{times:?}");
    }
}

/// Final scores of a run: 100 episodes at a success probability that itself varies over seeds.
fn score(rng: &mut ChaCha8Rng) -> f64 {
    let rate = 0.6 + 0.15 * (0..12).map(|_| rng.random::<f64>() - 0.5).sum::<f64>();
    (0..100).filter(|_| rng.random_bool(rate.clamp(0.0, 1.0))).count() as f64 / 100.0
}

/// The shares of 2,000 made-up experiments in which an interval excludes 0 though both sides of every pair
/// come from one distribution: of the sign-flip test and of the bootstrap. `pairs` in each of the
/// environments.
fn false_alarms(pairs: &[usize], confidence: f64) -> (f64, f64) {
    const EXPERIMENTS: usize = 2_000;
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut flips, mut bootstraps) = (0, 0);
    for _ in 0..EXPERIMENTS {
        let strata: Vec<Vec<f64>> =
            pairs.iter().map(|&n| (0..n).map(|_| score(&mut rng) - score(&mut rng)).collect()).collect();
        let resampling = Resampling { confidence, resamples: 400, ..Resampling::default() };
        let excludes =
            |interval: Option<(f64, f64)>| interval.is_some_and(|(low, high)| low > 0.0 || high < 0.0);
        let mean = |strata: &[Vec<f64>]| {
            stats::mean(&strata.iter().filter_map(|stratum| stats::mean(stratum)).collect::<Vec<_>>())
        };
        let test = stats::sign_flip(&slices(&strata), resampling).unwrap();
        assert_eq!(excludes(test.interval), test.p <= 1.0 - confidence + 1e-9, "{strata:?}");
        flips += usize::from(excludes(test.interval));
        bootstraps += usize::from(excludes(stats::stratified_interval(&slices(&strata), mean, resampling)));
    }
    (flips as f64 / EXPERIMENTS as f64, bootstraps as f64 / EXPERIMENTS as f64)
}

#[test]
fn verdicts_are_wrong_no_more_often_than_they_say() {
    // The levels of a single claim and of one of four baselines; 20 pairs are more than are enumerated.
    for (pairs, confidence) in
        [(&[5][..], 0.95), (&[7], 0.95), (&[7], 0.9875), (&[5, 5], 0.9875), (&[7, 6, 7], 0.9875)]
    {
        let (rate, _) = false_alarms(pairs, confidence);
        let level: f64 = 1.0 - confidence;
        // Three standard errors of 2,000 experiments.
        let most = level + 3.0 * (level * confidence / 2_000.0).sqrt();
        assert!(
            rate <= most,
            "{pairs:?} at {confidence}: {rate} of verdicts are false, at most {level} may be"
        );
    }
}

#[test]
fn bootstrap_intervals_of_few_seeds_cover_less() {
    // What captions say of them, and why no verdict rests on them.
    for (pairs, coverage) in [(2, 0.51), (3, 0.77), (5, 0.83), (7, 0.88)] {
        let (_, missed) = false_alarms(&[pairs], 0.95);
        assert_close(1.0 - missed, coverage, 0.03);
    }
}

#[test]
fn wilson_intervals_agree() {
    for case in fixture()["wilson"].as_array().unwrap() {
        let count = |name: &str| case[name].as_u64().unwrap();
        let interval =
            stats::wilson_interval(count("successes"), count("trials"), number(&case["confidence"])).unwrap();
        let expected = numbers(&case["interval"]);
        assert_close(interval.0, expected[0], 1e-9);
        assert_close(interval.1, expected[1], 1e-9);
    }
}

#[test]
fn power_and_detectable_effects_agree() {
    let expected = fixture();
    for case in expected["power"].as_array().unwrap() {
        let power =
            stats::power(number(&case["d"]), case["n"].as_u64().unwrap(), number(&case["alpha"])).unwrap();
        assert_close(power, number(&case["power"]), 1e-7);
    }
    for case in expected["detectable"].as_array().unwrap() {
        let n = case["n"].as_u64().unwrap();
        let d = stats::detectable_effect(n, number(&case["alpha"]), 0.8).unwrap();
        assert_close(d, number(&case["d"]), 1e-5);
    }
}

#[test]
fn tests_of_signs_agree() {
    for case in fixture()["signs"].as_array().unwrap() {
        let sign = |difference: &f64| if difference.abs() < 1e-12 { 0.0 } else { difference.signum() };
        let signs: Vec<Vec<f64>> =
            strata(&case["strata"]).iter().map(|stratum| stratum.iter().map(sign).collect()).collect();
        let means: Vec<f64> = signs.iter().map(|signs| stats::mean(signs).unwrap()).collect();
        assert_close((1.0 + stats::mean(&means).unwrap()) / 2.0, number(&case["share"]), 1e-12);
        let test = stats::sign_flip(&slices(&signs), Resampling::default()).unwrap();
        assert_close(test.p, number(&case["p"]), 1e-12);
    }
}

proptest! {
    #[test]
    fn quantiles_and_iqm_stay_among_the_values(values in prop::collection::vec(-1e3..1e3, 1..20), p in 0.0..1.0) {
        let (low, high) = (stats::quantile(&values, 0.0).unwrap(), stats::quantile(&values, 1.0).unwrap());
        prop_assert!((low..=high).contains(&stats::quantile(&values, p).unwrap()));
        let iqm = stats::iqm(&values).unwrap();
        prop_assert!(iqm >= low - 1e-9 && iqm <= high + 1e-9);
    }

    #[test]
    fn one_of_two_methods_improves_on_the_other(
        a in prop::collection::vec(0_u8..5, 1..8),
        b in prop::collection::vec(0_u8..5, 1..8),
    ) {
        let scores = |counts: Vec<u8>| -> Vec<f64> { counts.into_iter().map(f64::from).collect() };
        let (a, b) = (scores(a), scores(b));
        let forth = stats::probability_of_improvement(&[&a], &[&b]).unwrap();
        let back = stats::probability_of_improvement(&[&b], &[&a]).unwrap();
        prop_assert!((forth + back - 1.0).abs() < 1e-12);
    }

    #[test]
    fn holm_only_raises_and_keeps_the_order(p_values in prop::collection::vec(0.0..1.0, 0..12)) {
        let adjusted = stats::holm(&p_values);
        for (i, &p) in p_values.iter().enumerate() {
            prop_assert!(adjusted[i] >= p && adjusted[i] <= 1.0);
            for (j, &other) in p_values.iter().enumerate() {
                prop_assert!(p > other || adjusted[i] <= adjusted[j]);
            }
        }
    }

    #[test]
    fn wilson_intervals_hold_the_share(trials in 1_u64..500, share in 0.0..=1.0) {
        let successes = (share * trials as f64) as u64;
        let (low, high) = stats::wilson_interval(successes, trials, 0.95).unwrap();
        let observed = successes as f64 / trials as f64;
        prop_assert!(0.0 <= low && low <= observed && observed <= high && high <= 1.0);
    }
}
