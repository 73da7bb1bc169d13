//! Teachers that watched: read strictly, told in tables and data, drawn in mazes.

use std::fs;

use super::support::{fail, key, line, options, seal, write_configured, write_run};
use reports::analysis::catalogue::MazeInfo;
use reports::schema::{Beliefs, Frontier, ShadowNote, Shadowing, Teaching};
use reports::store::layout::{self, FRONTIER, SHADOW, TEACHING};
use reports::store::{self, Store};
use serde_json::json;
use tempfile::TempDir;

fn note(id: &str, weights: Option<[f32; 4]>, picks: &[(u32, u32)], elsewhere: u64) -> ShadowNote {
    ShadowNote {
        id: id.to_owned(),
        weights: weights.map(Vec::from),
        picks: picks.to_vec(),
        elsewhere,
        ..ShadowNote::default()
    }
}

/// Four episodes, of which `wren` wants the first goal and `moss` the last.
fn shadowing(eval_index: u64, weights: [f32; 4]) -> Shadowing {
    let shadows = vec![note("wren", Some(weights), &[(0, 3), (2, 1)], 0), note("moss", None, &[(3, 4)], 4)];
    Shadowing { eval_index, step: 1_000 * eval_index, episodes: 4, shadows }
}

fn with(line: Shadowing, change: impl FnOnce(&mut Shadowing)) -> Shadowing {
    let mut line = line;
    change(&mut line);
    line
}

#[test]
fn each_damaged_line_is_named() {
    let results = TempDir::new().unwrap();
    let config = json!({ "pool": { "size": 4 }, "shadow": ["wren", "moss"] });
    let folder = write_configured(results.path(), &key("E", "nova", "default", 0), &[0.0; 8], config);
    let even = [0.25; 4];
    let two = || shadowing(2, even);
    let failed = |note: &mut ShadowNote| note.failed = Some("step 3: it failed".to_owned());
    let silent = with(shadowing(3, even), |line| {
        line.shadows[0] = ShadowNote { weights: None, picks: vec![(1, 2)], ..line.shadows[0].clone() };
        failed(&mut line.shadows[0]);
    });
    let believed =
        |scores: &[f32]| Beliefs { success: None, scores: Some(scores.iter().copied().map(Some).collect()) };
    let lines = [
        shadowing(1, even),
        with(two(), |line| line.shadows.truncate(1)),
        with(two(), |line| line.shadows[1].id = "wren".to_owned()),
        with(two(), |line| line.shadows[0].weights = Some(vec![0.5; 2])),
        with(two(), |line| line.shadows[0].weights = Some(vec![0.5, 0.5, -0.25, 0.25])),
        with(two(), |line| failed(&mut line.shadows[0])),
        with(two(), |line| line.shadows[0].picks = vec![(0, 3), (4, 1)]),
        with(two(), |line| line.shadows[0].picks = vec![(2, 1), (0, 3)]),
        with(two(), |line| line.shadows[0].picks = vec![(0, 4), (1, 0)]),
        with(two(), |line| line.shadows[0].picks = vec![(0, 3)]),
        with(two(), |line| line.shadows[1].elsewhere = 5),
        Shadowing { step: 7, ..two() },
        with(two(), |line| line.shadows[1].beliefs = Some(believed(&[0.0; 5]))),
        with(two(), |line| {
            line.shadows[1] = ShadowNote { beliefs: Some(believed(&[0.0; 4])), ..line.shadows[1].clone() };
            failed(&mut line.shadows[1]);
        }),
        silent.clone(),
    ];
    fs::write(folder.join(SHADOW), lines.iter().map(line).collect::<String>()).unwrap();
    seal(&folder);
    let store = Store::read(results.path()).unwrap();
    let (kept, problems) = store::shadowing(results.path(), &store.runs()[0]);
    assert_eq!(kept, [shadowing(1, even), silent]);
    let expected = [
        "2: shadows is wren, line ignored; expected the shadows of the config",
        "3: shadows is wren, wren, line ignored; expected the shadows of the config",
        "4: weights of wren is 2 long, line ignored; expected an entry for every goal of the pool",
        "5: weights of wren is -0.25, line ignored; expected numbers in [0, 1]",
        "6: weights of wren is given, line ignored; expected none from a shadow that has failed",
        "7: picks of wren is 4, line ignored; expected indices below the number of goals",
        "8: picks of wren is 0 after 2, line ignored; expected goals by rising index",
        "9: picks of wren is 0 times, line ignored; expected goals that were proposed",
        "10: picks of wren is 3 in all, line ignored; expected one for every episode",
        "11: elsewhere of moss is 5, line ignored; expected at most one for every proposal",
        "13: beliefs.scores of moss is 5 long, line ignored; expected an entry for every goal of the pool",
        "14: beliefs of moss is given, line ignored; expected none from a shadow that has failed",
        "12: step is 7, line ignored; expected the step of the same evaluation",
    ];
    let named: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(named, expected.map(|text| format!("runs/E/nova/default/seed-0/{SHADOW}:{text}")));
    let written = reports::write(results.path(), &options()).unwrap();
    assert_eq!(written.problems.len(), expected.len(), "a report names them, too");
    let told = "E: NOVA: shadow WREN fell silent in 1 of 1 run (step 3: it failed)";
    assert!(written.missing.iter().any(|text| text == told), "{:?}", written.missing);
}

#[test]
fn an_ended_run_has_the_shadows_that_it_ended_with() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    fs::write(folder.join(SHADOW), line(&shadowing(1, [0.25; 4]))).unwrap();
    let problems = || -> Vec<String> {
        Store::read(results.path()).unwrap().problems().iter().map(ToString::to_string).collect()
    };
    let altered = format!(
        "runs/E/nova/default/seed-0/{SHADOW}: was cut off or altered after the run ended, run left out"
    );
    assert_eq!(problems(), std::slice::from_ref(&altered), "one that came only later belongs to no run");
    seal(&folder);
    assert_eq!(problems(), [""; 0]);
    fs::write(folder.join(SHADOW), line(&shadowing(1, [0.5, 0.5, 0.0, 0.0]))).unwrap();
    assert_eq!(problems(), [altered]);
}

fn assert_close(found: &[Option<f64>], expected: &[Option<f64>]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (one, other) in found.iter().zip(expected) {
        let same = match (one, other) {
            (Some(one), Some(other)) => (one - other).abs() < 1e-12,
            (one, other) => one == other,
        };
        assert!(same, "{found:?} is not {expected:?}");
    }
}

/// A goal in each cell of a maze of two by two.
const GOALS: [[f32; 2]; 4] = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];

/// Two seeds of a teacher, each watched by one with weights and one without.
#[test]
fn tables_data_and_maps_by_hand() {
    let results = TempDir::new().unwrap();
    let acting = [0.4, 0.3, 0.2, 0.1];
    let run = |seed: u64, lines: &[Shadowing]| {
        let folder = write_run(results.path(), &key("Four", "nova", "default", seed), &[0.0, 0.5, 0.5, 0.5]);
        let teaching = |eval_index| Teaching {
            eval_index,
            step: 1_000 * eval_index,
            goals: vec![vec![0.5, 0.5], vec![0.4, 0.4], vec![-0.5, 0.5], vec![-0.5, -0.5]],
            successes: vec![false; 4],
            weights: Some(acting.to_vec()),
            // The second goal is from elsewhere, next to the fourth one.
            picks: Some(vec![Some(3), None, Some(1), Some(0)]),
            ..Teaching::default()
        };
        let taught: String = (0..4).map(|index| line(&teaching(index))).collect();
        let measure = |eval_index, successes: [u64; 4]| Frontier {
            eval_index,
            step: 1_000 * eval_index,
            episodes: 5,
            successes: successes.to_vec(),
            goals: (eval_index == 0).then(|| GOALS.map(Vec::from).to_vec()),
            weights: Some(acting.to_vec()),
            ..Frontier::default()
        };
        let measures = [measure(0, [0; 4]), measure(1, [2, 0, 0, 5]), measure(3, [5, 5, 0, 3])];
        fs::write(folder.join(TEACHING), taught).unwrap();
        fs::write(folder.join(FRONTIER), measures.iter().map(line).collect::<String>()).unwrap();
        fs::write(folder.join(SHADOW), lines.iter().map(line).collect::<String>()).unwrap();
        seal(&folder);
    };
    let (same, turned) = ([0.7, 0.2, 0.1, 0.0], [0.1, 0.2, 0.3, 0.4]);
    run(0, &[shadowing(0, turned), shadowing(1, same), shadowing(2, same), shadowing(3, turned)]);
    run(1, &[shadowing(0, same), shadowing(1, same), shadowing(2, [0.25; 4]), shadowing(3, same)]);
    let mut options = options();
    options.catalogue.mazes = vec![MazeInfo { id: "Four".into(), grid: vec!["..".into(), ".S".into()] }];
    let written = reports::write(results.path(), &options).unwrap();
    assert!(written.problems.is_empty(), "{:?}", written.problems);
    let report = layout::report_dir(results.path());
    let read = |name: &str| fs::read_to_string(report.join(name)).unwrap();
    let rows = |csv: &str| -> Vec<String> { read(csv).lines().skip(1).map(str::to_owned).collect() };

    // Correlations 1, 1, -1 and 1, none, 1; of four goals the highest one counts, by chance one of four.
    let root = f64::sqrt(2.0);
    let [a, b, c] = [2.0, 0.75, 1.0].map(|deviation| deviation / root);
    let expected = format!("Four,nova,default,nova,wren,2,1.0,0.0,1.0,,0.0,{a},1.0,0.0,0.625,{b},0.5,{c}");
    let agreement = rows("agreement.csv");
    assert_eq!(agreement.len(), 1, "moss weighs nothing: {agreement:?}");
    let numbers = |row: &str| -> Vec<Option<f64>> { row.split(',').map(|text| text.parse().ok()).collect() };
    assert_close(&numbers(&agreement[0]), &numbers(&expected));

    // In the first measure the first goal is one of intermediate success, in the second one the last.
    let sight = rows("frontier.csv");
    let of = |teacher: &str| -> Vec<Option<f64>> {
        let row = sight.iter().find(|row| row.starts_with(&format!("Four,nova,default,{teacher},")));
        numbers(row.unwrap_or_else(|| panic!("{teacher}: {sight:?}"))).split_off(4)
    };
    // Own proposals: one of four goes to the first goal, two to the last, one of them from elsewhere.
    let own = of("nova");
    assert_eq!(own[..6], [Some(2.0), Some(0.25), Some(0.375), Some(2.0), Some(0.5), Some(0.0)], "{own:?}");
    assert_eq!((own[6], own[10], own[12]), (Some(1.0), Some(0.0), Some(-1.0)), "{own:?}");
    // Three of four, then none. Areas 1 and 1 of one seed, 1 and 0 of the other.
    let wren = of("wren");
    assert_eq!(wren[..5], [Some(2.0), Some(0.25), Some(0.375), Some(2.0), Some(0.75)], "{wren:?}");
    assert_eq!((wren[6], wren[10], wren[12]), (Some(1.0), Some(0.5), Some(-0.5)), "{wren:?}");
    let moss = of("moss");
    assert_eq!(moss[..5], [Some(2.0), Some(0.25), Some(0.5), Some(0.0), None], "{moss:?}");

    let lines = rows("shadows.csv");
    assert_eq!(lines.len(), 2 * 4 * 2);
    assert!(lines.contains(&"Four,nova,default,0,3000,3,wren,4,0,2,-1.0,0.0,no".to_owned()), "{lines:?}");
    assert!(lines.contains(&"Four,nova,default,1,2000,2,moss,4,4,1,,,no".to_owned()), "{lines:?}");
    for file in ["shadows.parquet", "figures/frontier-Four.svg", "figures/agreement-Four.svg"] {
        assert!(report.join(file).is_file(), "{file}");
    }
    let page = read("index.html");
    assert!(page.contains("What other teachers would have done") && page.contains("WREN (watched)"));
    let dictionary = read("DATA.md");
    for name in ["agreement.csv", "shadows.csv, shadows.parquet"] {
        assert!(dictionary.contains(&format!("## {name}")), "{name}");
    }
}

/// Its budget is 9,000 steps; it failed at 3,000. A teacher of its user's own watched.
#[test]
fn a_run_that_fails_early_was_in_its_first_third_alone_and_its_shadow_has_the_users_title() {
    let results = TempDir::new().unwrap();
    let config = json!({
        "budget": { "steps": 9_000 },
        "curriculum": { "process": { "title": "Mine" } },
    });
    write_configured(results.path(), &key("Four", "wren", "default", 0), &[0.5; 10], config.clone());
    let folder =
        write_configured(results.path(), &key("Four", "nova", "default", 0), &[0.0, 0.5, 0.5, 0.5], config);
    let weights = [0.4, 0.3, 0.2, 0.1];
    let watched = |eval_index: u64| Shadowing {
        eval_index,
        step: 1_000 * eval_index,
        episodes: 0,
        shadows: vec![note("process", Some(weights), &[], 0)],
    };
    let teaching = |eval_index: u64| Teaching {
        eval_index,
        step: 1_000 * eval_index,
        weights: Some(weights.to_vec()),
        ..Teaching::default()
    };
    let measure = |eval_index: u64| Frontier {
        eval_index,
        step: 1_000 * eval_index,
        episodes: 5,
        successes: vec![2, 0, 0, 5],
        weights: Some(weights.to_vec()),
        ..Frontier::default()
    };
    fs::write(folder.join(SHADOW), (0..4).map(|index| line(&watched(index))).collect::<String>()).unwrap();
    fs::write(folder.join(TEACHING), (0..4).map(|index| line(&teaching(index))).collect::<String>()).unwrap();
    fs::write(folder.join(FRONTIER), (0..4).map(|index| line(&measure(index))).collect::<String>()).unwrap();
    fail(&folder);
    let written = reports::write(results.path(), &options()).unwrap();
    let problems: Vec<String> = written.problems.iter().map(ToString::to_string).collect();
    assert!(problems.iter().all(|problem| problem.contains("NaN")), "{problems:?}");
    let report = layout::report_dir(results.path());
    let read = |name: &str| fs::read_to_string(report.join(name)).unwrap();
    let agreement = read("agreement.csv");
    let row = agreement.lines().nth(1).unwrap();
    assert_eq!(row, "Four,nova,default,nova,process,1,1.0,,,,,,1.0,,,,,");
    let sight = read("frontier.csv");
    let row = sight.lines().find(|row| row.starts_with("Four,nova,default,process,1,")).unwrap();
    // AUC: all measures, then each third, all without a standard deviation.
    assert!(row.starts_with("Four,nova,default,process,1,0.25,,1,1.0,,1.0,,,,,,,,"), "{row}");
    let page = read("index.html");
    assert!(page.contains("Mine (watched)") && !page.contains("process (watched)"), "its title");
}

#[test]
fn results_without_shadows_say_nothing_of_them() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    reports::write(results.path(), &options()).unwrap();
    let summary = fs::read_to_string(layout::report_dir(results.path()).join("summary.md")).unwrap();
    assert!(!summary.contains("watched"), "{summary}");
}
