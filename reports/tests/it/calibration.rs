//! What teachers believe of their pools, set against what was measured: tables, data and diagrams.

use std::fs;

use super::support::{key, line, options, seal, write_run};
use reports::schema::{Beliefs, Frontier, ShadowNote, Shadowing};
use reports::store::layout::{self, FRONTIER, SHADOW};
use tempfile::TempDir;

/// A measure of four goals in 10 episodes each.
fn measure(eval_index: u64, successes: [u64; 4], beliefs: Option<Beliefs>) -> Frontier {
    Frontier {
        eval_index,
        step: 1_000 * eval_index,
        episodes: 10,
        successes: successes.to_vec(),
        beliefs,
        ..Frontier::default()
    }
}

fn believed(success: Option<[f32; 4]>, scores: Option<[f32; 4]>) -> Option<Beliefs> {
    let every = |values: [f32; 4]| values.map(Some).to_vec();
    Some(Beliefs { success: success.map(every), scores: scores.map(every) })
}

/// Two seeds of NOVA, which estimates and scores; the first is watched by WREN, which only scores.
fn results() -> TempDir {
    let results = TempDir::new().unwrap();
    let estimates = Some([0.25, 0.25, 0.75, 1.0]);
    let run = |seed: u64, measures: &[Frontier], watched: bool| {
        let folder = write_run(results.path(), &key("E", "nova", "default", seed), &[0.0, 0.5, 0.5, 0.5]);
        fs::write(folder.join(FRONTIER), measures.iter().map(line).collect::<String>()).unwrap();
        if watched {
            let note = |eval_index: u64, beliefs| Shadowing {
                eval_index,
                step: 1_000 * eval_index,
                episodes: 0,
                shadows: vec![ShadowNote { id: "wren".into(), beliefs, ..ShadowNote::default() }],
            };
            let lines = [
                note(0, None),
                note(1, believed(None, Some([4.0, 3.0, 2.0, 1.0]))),
                note(2, None),
                note(3, believed(None, Some([1.0, 1.0, 1.0, 1.0]))),
            ];
            fs::write(folder.join(SHADOW), lines.iter().map(line).collect::<String>()).unwrap();
        }
        seal(&folder);
    };
    // What the untrained student's teacher believes does not count: it would be wrong by 1.
    let untrained = || measure(0, [0; 4], believed(Some([1.0; 4]), Some([1.0; 4])));
    let last = || measure(3, [0, 10, 5, 10], believed(estimates, Some([0.0, 4.0, 2.0, 1.0])));
    run(
        0,
        &[untrained(), measure(1, [0, 0, 5, 10], believed(estimates, Some([1.0, 2.0, 3.0, 4.0]))), last()],
        true,
    );
    run(1, &[untrained(), measure(1, [0, 5, 5, 10], None), last()], false);
    results
}

fn rows(results: &TempDir, name: &str) -> Vec<String> {
    let text = fs::read_to_string(layout::report_dir(results.path()).join(name)).unwrap();
    text.lines().skip(1).map(str::to_owned).collect()
}

fn numbers(row: &str, from: usize) -> Vec<Option<f64>> {
    row.split(',').skip(from).map(|text| text.parse().ok()).collect()
}

fn assert_close(found: &[Option<f64>], expected: &[Option<f64>]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (one, other) in found.iter().zip(expected) {
        let same = match (one, other) {
            (Some(one), Some(other)) => (one - other).abs() < 1e-9,
            (one, other) => one == other,
        };
        assert!(same, "{found:?} is not {expected:?}");
    }
}

#[test]
fn tables_and_data_by_hand() {
    let results = results();
    let written = reports::write(results.path(), &options()).unwrap();
    assert!(written.problems.is_empty(), "{:?}", written.problems);
    let calibration = rows(&results, "calibration.csv");
    assert_eq!(calibration.len(), 1, "WREN makes no estimates: {calibration:?}");
    assert!(calibration[0].starts_with("E,nova,default,nova,2,"), "{calibration:?}");
    let found = numbers(&calibration[0], 4);
    // Measure 1: the two of 0.25 have 0, that of 0.75 has 0.5, that of 1 has 1: (0.5 + 0.25) / 4. Measure 3:
    // the two of 0.25 have 0 and 1, 0.5 less than the truth: (0.5 + 0.25) / 4. Together they are 0.5 off in
    // seed 0, all of it at 0.75.
    let (whole, part) = (0.5 / 8.0, 0.75 / 4.0);
    let std = |a: f64, b: f64| Some((a - b).abs() / f64::sqrt(2.0));
    assert_close(&found[..3], &[Some(2.0), Some(0.5625), Some(f64::midpoint(0.5, 0.625))]);
    assert_close(
        &found[3..11],
        &[
            Some(f64::midpoint(whole, part)),
            std(whole, part),
            Some(part),
            None,
            None,
            None,
            Some(part),
            Some(0.0),
        ],
    );
    // Ranks 1.5, 1.5, 3, 4 against 1.5, 1.5, 3, 4 and, in the last measure, against 1, 3.5, 2, 3.5.
    let late = (1.0 * 1.5 - 1.0 * 1.0 - 0.5 * 0.5 + 1.5) / (4.5_f64 * 4.5).sqrt();
    assert!((found[11].unwrap() - f64::midpoint(f64::midpoint(1.0, late), late)).abs() < 1e-9, "{found:?}");

    let progress = rows(&results, "progress.csv");
    assert_eq!(progress.len(), 2, "{progress:?}");
    let of = |teacher: &str| {
        let row = progress.iter().find(|row| row.starts_with(&format!("E,nova,default,{teacher},")));
        numbers(row.unwrap(), 4)
    };
    // Seed 0: changes 0, 0, 0.5, 1 and scores in the same order but for a tie: 4.5/√(5 · 4.5). Then changes
    // 0, 1, 0, 0 against 0, 4, 2, 1: 3/√(5 · 3). Seed 1: the first measure has no scores; then 0, 0.5, 0, 0.
    let first = 4.5 / (5.0_f64 * 4.5).sqrt();
    let second = 3.0 / (5.0_f64 * 3.0).sqrt();
    let nova = of("nova");
    assert_close(&nova[..2], &[Some(2.0), Some(f64::midpoint(f64::midpoint(0.5, 0.25), 0.25))]);
    assert_close(
        &nova[2..4],
        &[
            Some(f64::midpoint(f64::midpoint(first, second), second)),
            std(f64::midpoint(first, second), second),
        ],
    );
    // WREN wants most what changes least: −4.5/√(5 · 4.5); at last it makes no difference. Until the next
    // measure only the second goal changes, which has a rank of 3 of 4.
    let wren = of("wren");
    assert_close(&wren[..3], &[Some(1.0), Some(0.375), Some(-first)]);
    assert_close(&wren[10..11], &[Some(1.0 / (5.0_f64 * 3.0).sqrt())]);

    let bins = rows(&results, "reliability.csv");
    // All, first third and last third of 0.25, 0.75 and 1.
    assert_eq!(bins.len(), 9, "{bins:?}");
    let all = bins.iter().find(|row| row.starts_with("E,nova,default,nova,all,0.2,")).unwrap();
    assert_close(
        &numbers(all, 5)[..6],
        &[Some(0.2), Some(0.3), Some(6.0), Some(0.25), Some(2.0 / 6.0), Some(2.0)],
    );
    assert_close(&numbers(all, 11), &[std(0.25, 0.5)]);
    let judgements = rows(&results, "judgements.csv");
    // Three measures of one seed, two of the other, and two of WREN.
    assert_eq!(judgements.len(), 7, "{judgements:?}");
    assert!(
        judgements.contains(&"E,nova,default,0,3000,3,wren,,0.625,,,0.25,,".to_owned()),
        "{judgements:?}"
    );
    let report = layout::report_dir(results.path());
    let dictionary = fs::read_to_string(report.join("DATA.md")).unwrap();
    for name in [
        "calibration.csv",
        "progress.csv",
        "reliability.csv, reliability.parquet",
        "judgements.csv, judgements",
    ] {
        assert!(dictionary.contains(&format!("## {name}")), "{name}");
    }
    let page = fs::read_to_string(report.join("index.html")).unwrap();
    assert!(page.contains("Is what teachers believe true?") && page.contains("WREN (watched)"));
    assert!(page.contains("E: teachers&#39; estimates of success, and what was measured"), "its diagram");
    assert!(report.join("figures/calibration-E.png").is_file());
}

#[test]
fn results_without_beliefs_say_nothing_of_them() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    let lines = [measure(0, [0; 4], None), measure(1, [1; 4], None)];
    // As old versions wrote it.
    let old = lines.iter().map(line).collect::<String>();
    assert!(!old.contains("beliefs"), "{old}");
    fs::write(folder.join(FRONTIER), old).unwrap();
    seal(&folder);
    let written = reports::write(results.path(), &options()).unwrap();
    assert!(written.problems.is_empty(), "{:?}", written.problems);
    let report = layout::report_dir(results.path());
    let summary = fs::read_to_string(report.join("summary.md")).unwrap();
    assert!(summary.contains("The frontier") && !summary.contains("believe"), "{summary}");
    assert!(!report.join("figures/calibration-E.svg").exists());
}
