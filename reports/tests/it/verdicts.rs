//! Verdicts that averages, unequal seeds or other students could turn: the cases behind the ledger's rules.

use std::path::Path;

use super::ledger::{entries, judging, nova};
use super::support::{key, options, write_configured};
use reports::ReportOptions;
use reports::analysis::catalogue::{Claim, ClaimKind, ClaimScope, EnvironmentInfo, Measure, Rule};
use reports::analysis::comparison::{self, TestFamily};
use reports::analysis::complete;
use reports::analysis::group;
use reports::analysis::ledger::{self, LedgerEntry, Verdict};
use reports::store::Store;
use serde_json::{Value, json};
use tempfile::TempDir;

/// A group of `seeds` runs that go to `rates` of the seed in a straight line.
pub(crate) fn write(
    results: &Path,
    (environment, curriculum, variant): (&str, &str, &str),
    seeds: u64,
    config: &Value,
    rates: impl Fn(u64) -> Vec<f64>,
) {
    for seed in 0..seeds {
        let run = key(environment, curriculum, variant, seed);
        write_configured(results, &run, &rates(seed), config.clone());
    }
}

/// Around `rate`, differing by seed as the episodes of evaluations do, in multiples of one of 20.
fn about(rate: f64) -> impl Fn(u64) -> Vec<f64> {
    move |seed| vec![0.0, ((rate + 0.01 * (seed % 3) as f64) * 1_000.0).round() / 1_000.0]
}

pub(crate) fn judged(results: &Path, options: &ReportOptions) -> Vec<LedgerEntry> {
    let store = Store::read(results).unwrap();
    let completed = complete::failed_as_zero(&store, options.failures);
    ledger::ledger(&group::counted(&store, &completed, &options.catalogue), options)
}

#[track_caller]
fn find<'a>(entries: &'a [LedgerEntry], id: &str) -> &'a LedgerEntry {
    entries.iter().find(|entry| entry.id == id).unwrap()
}

/// Judging by these claims alone.
pub(crate) fn claims(claims: &[Claim]) -> ReportOptions {
    let mut options = judging();
    options.catalogue.paper.claims = claims.to_vec();
    options
}

pub(crate) const fn values(axis: &'static str, measure: Measure, rule: Rule) -> Claim {
    let kind = ClaimKind::Values { axis, about: &[], measure, rule };
    Claim { id: "it", source: "here", statement: "it is so", scope: ClaimScope::All, kind }
}

/// Two tasks where n = 3 is better than n = 10 by 0.2, and two where it is worse by as much.
fn opposed(results: &Path) {
    for (environment, gain) in [("RoomA", 0.2), ("RoomB", 0.2), ("ArmPush", -0.2), ("ArmSlide", -0.2)] {
        write(results, (environment, "nova", "default"), 7, &nova(10, 1, "online"), about(0.5));
        write(results, (environment, "nova", "n=3"), 7, &nova(3, 1, "online"), about(0.5 + gain));
    }
}

#[test]
fn no_difference_on_average_is_no_invariance() {
    let results = TempDir::new().unwrap();
    opposed(results.path());
    let entries = entries(results.path());
    let window = find(&entries, "window");
    assert_eq!(window.verdict, Verdict::Refuted, "{window:#?}");
    let expected = "n = 3: outside ±0.1 in ArmPush (-0.20), ArmSlide (-0.20), RoomA (+0.20), RoomB (+0.20)";
    assert!(window.evidence.contains(expected), "{}", window.evidence);
    // The interval of one environment, at 1 - 2α.
    assert_eq!(window.value.as_deref().map(|value| value.starts_with("n = 3 in ")), Some(true));
    assert!((window.confidence - 0.9).abs() < 1e-12);
    assert!((window.effect.difference.unwrap().abs() - 0.2).abs() < 1e-9);
}

#[test]
fn environments_that_are_each_too_noisy_refute_together() {
    let results = TempDir::new().unwrap();
    let off: [f64; 7] = [-0.1, -0.02, 0.0, 0.02, 0.05, 0.08, 0.11];
    for (environment, gain) in [("RoomA", 0.2_f64), ("RoomB", 0.2), ("ArmPush", -0.2), ("ArmSlide", -0.2)] {
        write(results.path(), (environment, "nova", "default"), 7, &nova(10, 1, "online"), |_| {
            vec![0.0, 0.5]
        });
        let noisy = |seed: u64| {
            vec![0.0, ((0.5 + gain + gain.signum() * off[seed as usize]) * 1e3_f64).round() / 1e3]
        };
        write(results.path(), (environment, "nova", "n=3"), 7, &nova(3, 1, "online"), noisy);
    }
    let store = Store::read(results.path()).unwrap();
    let strict = ReportOptions { margin: 0.13, ..judging() };
    let entries = ledger::ledger(&group::groups(&store, &options().catalogue), &strict);
    let window = find(&entries, "window");
    assert_eq!(window.verdict, Verdict::Refuted, "{window:#?}");
    assert!(window.evidence.contains("n = 3: some of "), "{}", window.evidence);
}

#[test]
fn one_environment_outside_the_margin_is_enough() {
    let results = TempDir::new().unwrap();
    for (environment, gain) in [("RoomA", 0.0), ("RoomB", 0.01), ("ArmPush", -0.3)] {
        write(results.path(), (environment, "nova", "default"), 10, &nova(10, 1, "online"), about(0.5));
        let config = nova(3, 1, "online");
        write(results.path(), (environment, "nova", "n=3"), 10, &config, about(0.5 + gain));
    }
    let window = find(&entries(results.path()), "window").clone();
    assert_eq!((window.verdict, window.value.as_deref()), (Verdict::Refuted, Some("n = 3 in ArmPush")));
    assert!(window.evidence.contains("within ±0.1 in RoomA (+0.00), RoomB (+0.01)"), "{}", window.evidence);
    // A wider margin calls that no difference.
    let wide = ReportOptions { margin: 0.4, ..judging() };
    assert_eq!(find(&judged(results.path(), &wide), "window").verdict, Verdict::Confirmed);
}

#[test]
fn five_seeds_can_show_no_difference_and_four_cannot() {
    for (seeds, expected) in [(5, Verdict::Confirmed), (4, Verdict::Undecided)] {
        let results = TempDir::new().unwrap();
        for environment in ["RoomA", "RoomB"] {
            write(
                results.path(),
                (environment, "nova", "default"),
                seeds,
                &nova(10, 1, "online"),
                about(0.5),
            );
            write(results.path(), (environment, "nova", "n=3"), seeds, &nova(3, 1, "online"), about(0.52));
        }
        let window = find(&entries(results.path()), "window").clone();
        assert_eq!(window.verdict, expected, "{window:#?}");
    }
}

#[test]
fn what_learns_faster_to_the_same_end_is_faster() {
    let results = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        let slow = |_: u64| vec![0.0, 0.2, 0.5, 0.8];
        let fast = |seed: u64| vec![0.0, 0.6 + 0.05 * (seed % 3) as f64, 0.8, 0.8];
        write(results.path(), (environment, "nova", "default"), 7, &nova(10, 1, "online"), slow);
        write(results.path(), (environment, "nova", "delta=5"), 7, &nova(10, 5, "online"), fast);
    }
    let by = |measure| {
        let options = claims(&[values("interplay", measure, Rule::SomeAbove)]);
        judged(results.path(), &options)[0].verdict
    };
    assert_eq!((by(Measure::Final), by(Measure::Area)), (Verdict::Undecided, Verdict::Confirmed));
    // The change per evaluation is 0.8 / 3 in both: neither is noisier.
    assert_eq!(by(Measure::Noise), Verdict::Undecided);
}

#[test]
fn different_tasks_for_different_values() {
    let results = TempDir::new().unwrap();
    opposed(results.path());
    let mixed = |results: &Path| judged(results, &claims(&[values("window", Measure::Final, Rule::Mixed)]));
    let entry = &mixed(results.path())[0];
    assert_eq!(entry.verdict, Verdict::Confirmed);
    let expected =
        "n = 3: better in RoomA (+0.20), RoomB (+0.20), worse in ArmPush (-0.20), ArmSlide (-0.20)";
    assert!(entry.evidence.contains(expected), "{}", entry.evidence);
    let alike = TempDir::new().unwrap();
    for environment in ["RoomA", "RoomB"] {
        write(alike.path(), (environment, "nova", "default"), 7, &nova(10, 1, "online"), about(0.5));
        write(alike.path(), (environment, "nova", "n=3"), 7, &nova(3, 1, "online"), about(0.51));
    }
    assert_eq!(mixed(alike.path())[0].verdict, Verdict::Refuted);
}

#[test]
fn the_papers_own_value_is_best_where_it_beats_every_other() {
    let results = TempDir::new().unwrap();
    // In RoomA n = 20 is as good; in RoomB n = 10 beats both.
    for (environment, three, twenty) in [("RoomA", 0.3, 0.5), ("RoomB", 0.3, 0.4)] {
        write(results.path(), (environment, "nova", "default"), 8, &nova(10, 1, "online"), about(0.5));
        write(results.path(), (environment, "nova", "n=3"), 8, &nova(3, 1, "online"), about(three));
        let tied = move |seed: u64| {
            let off = if twenty == 0.5 { 0.01 * (seed % 2) as f64 - 0.005 } else { 0.0 };
            vec![0.0, about(twenty)(seed)[1] + off]
        };
        write(results.path(), (environment, "nova", "n=20"), 8, &nova(20, 1, "online"), tied);
    }
    let best = claims(&[values("window", Measure::Final, Rule::SomewhereBest)]);
    let entry = &judged(results.path(), &best)[0];
    assert_eq!((entry.verdict, entry.value.as_deref()), (Verdict::Confirmed, Some("n = 20 in RoomB")));
    assert!(entry.evidence.contains("better than all others in RoomB"), "{}", entry.evidence);
}

#[test]
fn a_value_of_few_pairs_is_neither_beaten_nor_beats() {
    for (three, clear) in [(0.3, Verdict::Confirmed), (0.7, Verdict::Refuted)] {
        let results = TempDir::new().unwrap();
        write(results.path(), ("RoomA", "nova", "default"), 7, &nova(10, 1, "online"), about(0.5));
        write(results.path(), ("RoomA", "nova", "n=3"), 7, &nova(3, 1, "online"), about(three));
        let best = claims(&[values("window", Measure::Final, Rule::SomewhereBest)]);
        assert_eq!(judged(results.path(), &best)[0].verdict, clear, "p = 1/64");
        let strict = ReportOptions { fewest_pairs: 20, ..best };
        let entry = &judged(results.path(), &strict)[0];
        assert_eq!(entry.verdict, Verdict::Undecided, "{entry:#?}");
        assert!(entry.evidence.contains("7 pairs of runs, 20 are needed"), "{}", entry.evidence);
    }
}

#[test]
fn many_environments_of_few_seeds_decide() {
    let results = TempDir::new().unwrap();
    let tasks: Vec<String> = options().catalogue.paper.tasks.iter().map(|ids| ids[0].clone()).collect();
    for environment in &tasks {
        write(results.path(), (environment, "nova", "default"), 3, &json!({}), about(0.8));
        write(results.path(), (environment, "wren", "default"), 3, &json!({}), about(0.3));
    }
    let entry = find(&entries(results.path()), "final-wren").clone();
    assert_eq!((entry.verdict, entry.effect.pairs), (Verdict::Confirmed, 33));
    let expected = "ahead in 11 and behind in 0 of 11 environments, 33 pairs of runs; fewer than 5 pairs in each environment; \
                    p from 2000 random flips";
    assert_eq!(entry.evidence, expected);
}

#[test]
fn an_environment_of_few_pairs_is_named_with_its_direction() {
    let results = TempDir::new().unwrap();
    for (environment, own, other, seeds) in
        [("RoomA", 0.6, 0.5, 7), ("RoomB", 0.6, 0.5, 7), ("ClawReach", 0.1, 0.9, 4)]
    {
        write(results.path(), (environment, "nova", "default"), 7, &json!({}), about(own));
        write(results.path(), (environment, "wren", "default"), seeds, &json!({}), about(other));
    }
    let entry = find(&entries(results.path()), "final-wren").clone();
    assert_ne!(entry.verdict, Verdict::Confirmed, "what TEACH loses there counts: {entry:#?}");
    assert!(entry.evidence.contains("; few pairs: ClawReach (4, -0.80)"), "{}", entry.evidence);
}

#[test]
fn environments_outside_the_paper_have_a_ledger_of_their_own() {
    let results = TempDir::new().unwrap();
    for (environment, own, other) in [("Point", 0.95, 0.3), ("RoomA", 0.5, 0.5), ("RoomB", 0.5, 0.5)] {
        write(results.path(), (environment, "nova", "default"), 8, &json!({}), about(own));
        write(results.path(), (environment, "wren", "default"), 8, &json!({}), about(other));
    }
    let entry = find(&entries(results.path()), "final-wren").clone();
    assert_eq!(entry.verdict, Verdict::Undecided);
    assert_eq!(entry.effect.environments(), ["RoomA", "RoomB"]);
    let store = Store::read(results.path()).unwrap();
    let elsewhere = ledger::ledger_elsewhere(&group::groups(&store, &options().catalogue), &judging());
    let ids: Vec<&str> = elsewhere.iter().map(|entry| entry.id.as_str()).collect();
    assert_eq!(ids, ["final-wren", "area-wren", "consistent-wren"], "claims with runs alone");
    assert_eq!(
        (elsewhere[0].verdict, elsewhere[0].effect.environments()),
        (Verdict::Confirmed, vec!["Point"])
    );
}

#[test]
fn different_students_are_named_and_not_judged() {
    let results = TempDir::new().unwrap();
    let student =
        |curriculum: &str, width: u64| json!({"curriculum": {curriculum: {}}, "student": {"width": width}});
    write(results.path(), ("RoomA", "nova", "default"), 8, &student("nova", 512), about(0.8));
    write(results.path(), ("RoomA", "wren", "default"), 8, &student("wren", 8), about(0.4));
    let entry = find(&entries(results.path()), "final-wren").clone();
    assert_eq!((entry.verdict, entry.effect.pairs), (Verdict::Undecided, 0));
    let expected = "not judged: RoomA (different students: student.width = 512 against 8)";
    assert!(entry.evidence.contains(expected), "{}", entry.evidence);
    let mixed = ReportOptions { mixed_students: true, ..judging() };
    assert_eq!(find(&judged(results.path(), &mixed), "final-wren").verdict, Verdict::Confirmed);
}

#[test]
fn means_that_few_collapses_decide_are_undecided() {
    let results = TempDir::new().unwrap();
    // WREN is a little better in 13 of 16 pairs, and collapses in three.
    for environment in ["RoomA", "RoomB"] {
        write(results.path(), (environment, "nova", "default"), 8, &json!({}), |_| vec![0.0, 0.8]);
        let wren = |seed: u64| vec![0.0, if seed < 3 { 0.0 } else { 0.81 + 0.001 * seed as f64 }];
        write(results.path(), (environment, "wren", "default"), 8, &json!({}), wren);
    }
    let lenient = ReportOptions {
        resampling: reports::stats::Resampling { confidence: 0.7, ..judging().resampling },
        ..judging()
    };
    let entry = find(&judged(results.path(), &lenient), "final-wren").clone();
    assert!(entry.effect.interval.unwrap().0 > 0.0, "by the means alone it would be confirmed: {entry:#?}");
    assert_eq!(entry.effect.improvement, Some(3.0 / 8.0));
    assert_eq!(entry.verdict, Verdict::Undecided);
    assert!(entry.evidence.contains("means and signs of the pairs disagree: confirmed by the means, "));
}

#[test]
fn a_mean_that_hides_many_losses_is_not_consistent() {
    let tasks: Vec<String> = options().catalogue.paper.tasks.iter().map(|ids| ids[0].clone()).collect();
    let consistent = |seeds: u64, gain: &dyn Fn(usize) -> f64| {
        let results = TempDir::new().unwrap();
        for (index, environment) in tasks.iter().enumerate() {
            let noisy = |seed: u64| vec![0.0, 0.4 + gain(index) + 0.02 * (seed % 4) as f64];
            write(results.path(), (environment, "nova", "default"), seeds, &json!({}), noisy);
            write(results.path(), (environment, "wren", "default"), seeds, &json!({}), |_| vec![0.0, 0.43]);
        }
        find(&entries(results.path()), "consistent-wren").clone()
    };
    let hidden = consistent(7, &|index| if index < 3 { 0.5 } else { -0.05 });
    assert_ne!(hidden.verdict, Verdict::Confirmed, "{hidden:#?}");
    assert!(
        hidden.evidence.starts_with("ahead in 3 and behind in 8 of 11 environments"),
        "{}",
        hidden.evidence
    );
    assert!(hidden.evidence.contains("each by its own test, uncorrected: ahead in "), "{}", hidden.evidence);
    assert_eq!(consistent(7, &|_| 0.2).verdict, Verdict::Confirmed);
    // With 7 seeds nothing could refute it, four baselines and three winners beside: 4/64 is above 2 ·
    // 0.05/4.
    let refuted = consistent(10, &|index| if index < 3 { 0.5 } else { -0.3 });
    assert_eq!(refuted.verdict, Verdict::Refuted);
}

#[test]
fn claims_can_be_about_some_tasks_alone() {
    let results = TempDir::new().unwrap();
    for (environment, own) in [("RoomA", 0.8), ("ClawReach", 0.2)] {
        write(results.path(), (environment, "nova", "default"), 8, &json!({}), about(own));
        write(results.path(), (environment, "wren", "default"), 8, &json!({}), about(0.5));
    }
    let kind = ClaimKind::AboveBaselines(Measure::Final);
    let claim = |id, scope| Claim { id, source: "here", statement: "it is so", scope, kind };
    let mut options = claims(&[
        claim("low", ClaimScope::GoalsUpTo(3)),
        claim("high", ClaimScope::GoalsFrom(7)),
        claim("one", ClaimScope::Only(&["ClawReach"])),
        Claim { kind: ClaimKind::AboveControl(Measure::Final), ..claim("control", ClaimScope::All) },
        Claim { kind: ClaimKind::Untestable("there is none"), ..claim("never", ClaimScope::All) },
    ]);
    let info = |id: &str, goal| EnvironmentInfo {
        id: id.into(),
        state: 2,
        goal,
        action: 2,
        horizon: 50,
        paper_action: None,
        note: String::new(),
    };
    options.catalogue.environments = vec![info("RoomA", 2), info("ClawReach", 15)];
    write(results.path(), ("RoomA", "dull-pool", "default"), 8, &json!({}), about(0.3));
    let entries = judged(results.path(), &options);
    let verdict = |id: &str| find(&entries, id).verdict;
    assert_eq!(verdict("low-wren"), Verdict::Confirmed);
    assert_eq!((verdict("high-wren"), verdict("one-wren")), (Verdict::Refuted, Verdict::Refuted));
    // Eight pairs and one test: 1/128.
    assert_eq!(verdict("control-dull-pool"), Verdict::Confirmed);
    let never = find(&entries, "never");
    assert_eq!((never.verdict.as_str(), never.evidence.as_str()), ("not testable", "there is none"));
}

#[test]
fn comparisons_tie_match_variants_and_explain_what_they_lack() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    let flat = |rate: f64| move |_: u64| vec![0.0, rate];
    for (curriculum, rate) in [("nova", 0.0), ("wren", 0.0), ("moss", 1.0)] {
        write(path, ("RoomA", curriculum, "default"), 7, &json!({}), flat(rate));
    }
    for curriculum in ["nova", "wren"] {
        write(path, ("RoomB", curriculum, "default"), 7, &json!({}), about(0.4));
        write(path, ("RoomB", curriculum, "wide"), 7, &json!({"student": {"width": 512}}), about(0.8));
    }
    let store = Store::read(path).unwrap();
    let groups = group::groups(&store, &options().catalogue);
    let compared = group::compared(&groups.iter().map(|group| &group.key).collect::<Vec<_>>());
    let found = comparison::comparisons(&groups, &compared, &judging());
    let row = |environment: &str, curriculum: &str, variant: &str| {
        let key = |one: &&comparison::Comparison<'_>| {
            let key = one.method;
            (key.environment.as_str(), key.curriculum.id.as_str(), key.variant.as_str())
                == (environment, curriculum, variant)
        };
        found.iter().find(key).unwrap()
    };
    // Both at 0 throughout: a result, and no silence.
    let tie = row("RoomA", "wren", "default");
    assert_eq!((tie.difference, tie.p_holm), (Some(0.0), Some(1.0)));
    assert_eq!((tie.sign_flip.unwrap().p, tie.note), (1.0, Some("all final scores of both sides are equal")));
    let extreme = row("RoomA", "moss", "default");
    assert_eq!(extreme.sign_flip.unwrap().p, 1.0 / 64.0);
    // The exact permutation test of 7 runs against 7, by Holm's method for four tests.
    assert!((extreme.p_holm.unwrap() - 4.0 * 2.0 / 3432.0).abs() < 1e-12, "{:?}", extreme.p_holm);
    assert!(extreme.note.unwrap().starts_with("final scores vary on neither side"));
    let wide = row("RoomB", "wren", "wide");
    assert_eq!((wide.family, wide.reference.name()), (TestFamily::Methods, "NOVA (wide)".to_owned()));
    assert!(wide.difference.unwrap().abs() < 1e-9);
    let own = row("RoomB", "nova", "wide");
    assert_eq!((own.family, own.reference.name()), (TestFamily::Variants, "NOVA".to_owned()));
}
