//! Measures of the frontier: read strictly, told in tables and data, drawn in mazes.

use std::fs;

use super::support::{fail, key, line, options, seal, write_configured, write_run};
use reports::ReportOptions;
use reports::analysis::catalogue::MazeInfo;
use reports::analysis::options::Failures;
use reports::schema::{Beliefs, Frontier};
use reports::store::layout::{self, FRONTIER};
use reports::store::{self, Store};
use serde_json::json;
use tempfile::TempDir;

/// Four goals in the four cells of a maze of two by two.
fn measure(eval_index: u64, successes: [u64; 4], weights: Option<[f32; 4]>) -> Frontier {
    let goals = [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]];
    Frontier {
        eval_index,
        step: 1_000 * eval_index,
        episodes: 5,
        successes: successes.to_vec(),
        goals: (eval_index == 0).then(|| goals.map(Vec::from).to_vec()),
        weights: weights.map(Vec::from),
        ..Frontier::default()
    }
}

#[test]
fn each_damaged_line_is_named() {
    let results = TempDir::new().unwrap();
    let config = json!({ "pool": { "size": 4 }, "frontier": { "every": 1, "episodes": 5 } });
    let folder = write_configured(results.path(), &key("E", "nova", "default", 0), &[0.0; 8], config);
    let sound = measure(1, [0, 1, 2, 3], Some([0.25; 4]));
    let every = |values: Vec<f32>| values.into_iter().map(Some).collect();
    let believed = |success: Option<Vec<f32>>, scores: Option<Vec<f32>>| Frontier {
        beliefs: Some(Beliefs { success: success.map(every), scores: scores.map(every) }),
        ..measure(2, [0; 4], None)
    };
    let lines = [
        measure(0, [0; 4], None),
        sound.clone(),
        Frontier { episodes: 0, ..measure(2, [0; 4], None) },
        Frontier { episodes: 6, ..measure(2, [0; 4], None) },
        Frontier { successes: vec![0; 3], ..measure(2, [0; 4], None) },
        measure(2, [0, 6, 0, 0], None),
        Frontier { weights: Some(vec![0.5; 2]), ..measure(2, [0; 4], None) },
        measure(2, [0; 4], Some([0.5, 1.5, 0.0, 0.0])),
        Frontier { goals: Some(vec![vec![0.0, 0.0], vec![0.0], vec![], vec![]]), ..measure(2, [0; 4], None) },
        Frontier { step: 7, ..measure(3, [0; 4], None) },
        believed(Some(vec![0.5; 3]), None),
        believed(Some(vec![0.5, -0.5, 0.0, 0.0]), None),
        believed(None, Some(vec![0.0; 5])),
        sound.clone(),
    ];
    fs::write(folder.join(FRONTIER), lines.iter().map(line).collect::<String>() + "{\"ev").unwrap();
    seal(&folder);
    let store = Store::read(results.path()).unwrap();
    let (kept, problems) = store::frontier(results.path(), &store.runs()[0]);
    assert_eq!(kept, [measure(0, [0; 4], None), sound]);
    let expected = [
        "15: incomplete last line (4 bytes without a newline), ignored",
        "3: episodes is 0, line ignored; expected at least 1",
        "4: episodes is 6, line ignored; expected as many as the config says",
        "5: successes is 3 long, line ignored; expected an entry for every goal of the pool",
        "6: successes is 6, line ignored; expected at most as many as episodes",
        "7: weights is 2 long, line ignored; expected as many entries as successes",
        "8: weights is 1.5, line ignored; expected numbers in [0, 1]",
        "9: goals is [0.0], line ignored; expected goals of finite numbers, all of one length",
        "11: beliefs.success is 3 long, line ignored; expected an entry for every goal of the pool",
        "12: beliefs.success is -0.5, line ignored; expected numbers in [0, 1]",
        "13: beliefs.scores is 5 long, line ignored; expected an entry for every goal of the pool",
        "14: evaluation 1 again, ignored; line 2 has it",
        "10: step is 7, line ignored; expected the step of the same evaluation",
    ];
    let named: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(named, expected.map(|text| format!("runs/E/nova/default/seed-0/{FRONTIER}:{text}")));
    let written = reports::write(results.path(), &options()).unwrap();
    assert_eq!(written.problems.len(), expected.len(), "a report names them, too");
}

#[test]
fn an_ended_run_has_the_measures_that_it_ended_with() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    fs::write(folder.join(FRONTIER), line(&measure(0, [0; 4], None))).unwrap();
    let of_nobody = format!(
        "runs/E/nova/default/seed-0/{FRONTIER}: was cut off or altered after the run ended, run left out"
    );
    let problems = || -> Vec<String> {
        Store::read(results.path()).unwrap().problems().iter().map(ToString::to_string).collect()
    };
    assert_eq!(problems(), std::slice::from_ref(&of_nobody), "one that came only later belongs to no run");
    seal(&folder);
    assert_eq!(problems(), [""; 0]);
    fs::write(folder.join(FRONTIER), line(&measure(0, [1; 4], None))).unwrap();
    assert_eq!(problems(), [of_nobody]);
}

fn close(found: &[Option<f64>], expected: &[Option<f64>]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        let same = match (found, expected) {
            (Some(found), Some(expected)) => (found - expected).abs() < 1e-12,
            (found, expected) => found == expected,
        };
        assert!(same, "{found:?} is not {expected:?}");
    }
}

const SIGHT_COLUMNS: &str = "environment,curriculum,variant,teacher,n_measured,intermediate,proposed,n_roc_auc,roc_auc,roc_auc_std,roc_auc_1,roc_auc_1_std,\
     roc_auc_2,roc_auc_2_std,roc_auc_3,roc_auc_3_std,roc_auc_change,roc_auc_change_std,n_score_roc_auc,score_roc_auc,score_roc_auc_std,score_roc_auc_1,\
     score_roc_auc_1_std,score_roc_auc_2,score_roc_auc_2_std,score_roc_auc_3,score_roc_auc_3_std,score_roc_auc_change,\
     score_roc_auc_change_std,border,border_proposed,n_border_roc_auc,border_roc_auc,border_roc_auc_std,border_roc_auc_1,\
     border_roc_auc_1_std,border_roc_auc_2,border_roc_auc_2_std,border_roc_auc_3,border_roc_auc_3_std,border_roc_auc_change,\
     border_roc_auc_change_std,n_border_score_roc_auc,border_score_roc_auc,border_score_roc_auc_std,border_score_roc_auc_1,\
     border_score_roc_auc_1_std,border_score_roc_auc_2,border_score_roc_auc_2_std,border_score_roc_auc_3,\
     border_score_roc_auc_3_std,border_score_roc_auc_change,border_score_roc_auc_change_std";

/// Two seeds of a teacher with weights, one of one without, and a run that was never measured.
#[test]
fn tables_data_and_maps_by_hand() {
    let results = TempDir::new().unwrap();
    let run = |curriculum: &str, seed: u64, measures: &[Frontier]| {
        let folder = write_run(results.path(), &key("Four", curriculum, "default", seed), &[0.0, 0.5, 0.5]);
        if !measures.is_empty() {
            fs::write(folder.join(FRONTIER), measures.iter().map(line).collect::<String>()).unwrap();
        }
        seal(&folder);
    };
    let untrained = || measure(0, [0; 4], Some([0.25; 4]));
    // Intermediate: the second goal, which has the highest weight; then the third, which ties with one of
    // three.
    let first = measure(1, [5, 2, 0, 0], Some([0.2, 0.4, 0.2, 0.2]));
    let second = measure(2, [5, 5, 1, 0], Some([0.5, 0.3, 0.1, 0.1]));
    run("nova", 0, &[untrained(), first.clone(), second]);
    // The goal that was solved is forgotten.
    run("nova", 1, &[untrained(), first, measure(2, [2, 0, 0, 0], Some([0.4, 0.6, 0.0, 0.0]))]);
    run("moss", 0, &[measure(0, [0; 4], None), measure(2, [0; 4], None)]);
    run("dull", 0, &[]);
    let mut options = options();
    options.catalogue.mazes = vec![MazeInfo { id: "Four".into(), grid: vec!["..".into(), ".S".into()] }];
    let written = reports::write(results.path(), &options).unwrap();
    assert!(written.problems.is_empty(), "{:?}", written.problems);
    let report = layout::report_dir(results.path());
    let read = |name: &str| fs::read_to_string(report.join(name)).unwrap();
    let numbers = |csv: &str, curriculum: &str| -> Vec<Option<f64>> {
        let text = read(csv);
        let row = text.lines().find(|row| row.starts_with(&format!("Four,{curriculum},default,")));
        // Of text there is no number.
        let columns = row.unwrap_or_default().split(',').skip(3);
        columns.filter(|text| *text != curriculum).map(|number| number.parse().ok()).collect()
    };
    assert_eq!(read("frontier.csv").lines().next(), Some(SIGHT_COLUMNS));
    // Seed 0: (1 + (0 + 0 + 1/2) / 3) / 2. Seed 1: in both measures one goal of four; in the second it is the
    // first goal, which lies above two of three: (1 + 2/3) / 2.
    let (zero, one) = (7.0 / 12.0, 5.0 / 6.0);
    let std = (one - zero) / f64::sqrt(2.0);
    let unknown = [&[Some(0.0)][..], &[None; 10]].concat();
    close(
        &numbers("frontier.csv", "nova"),
        &[
            &[Some(2.0), Some(0.25), None, Some(2.0), Some((zero + one) / 2.0), Some(std)][..],
            // The first measure lies in the second third of the run, the other one in the last.
            &[None, None, Some(1.0), Some(0.0), Some(5.0 / 12.0), Some(0.5 / f64::sqrt(2.0)), None, None],
            // It has scored nothing.
            &unknown,
            // All four goals together have 7, 11, 7 and 2 of 20: all of them intermediate but for the last.
            &[Some(0.75), None],
            &unknown,
            &unknown,
        ]
        .concat(),
    );
    let none = [&[Some(0.0), None][..], &unknown, &unknown].concat();
    let nothing = [&[Some(1.0)][..], &none, &none].concat();
    close(&numbers("frontier.csv", "moss"), &nothing);
    assert!(numbers("frontier.csv", "dull").is_empty());
    assert_eq!(
        read("coverage.csv").lines().next(),
        Some("environment,curriculum,variant,n_measured,success,solved,forgotten,cvar_10,cvar_25")
    );
    // Success 11/20 and 2/20; solved two of four and one of four; forgotten none of two and one of one.
    let expected = [Some(2.0), Some(0.325), Some(0.375), Some(0.5), Some(0.0), Some(0.0)];
    close(&numbers("coverage.csv", "nova"), &expected);
    let expected = [Some(1.0), Some(0.0), Some(0.0), None, Some(0.0), Some(0.0)];
    close(&numbers("coverage.csv", "moss"), &expected);
    assert!(
        read("measures.csv")
            .contains("\nFour,nova,default,0,2000,2,4,5,0.55,0.25,0.5,0.16666666666666666,\n"),
        "{}",
        read("measures.csv")
    );
    assert!(report.join("measures.parquet").is_file());
    assert!(report.join("figures/frontier-Four.svg").is_file());
    let page = read("index.html");
    assert!(
        page.contains("Four: measured success at the goals of the pool") && page.contains("The frontier")
    );
    let dictionary = read("DATA.md");
    for name in ["frontier.csv", "coverage.csv", "measures.csv, measures.parquet"] {
        assert!(dictionary.contains(&format!("## {name}")), "{name}");
    }
    let missing = "Four: DULL: no measure of the frontier";
    assert!(written.missing.iter().any(|text| text == missing), "{:?}", written.missing);
}

/// One seed has finished, one failed after its second evaluation, when it was at its best, and one goes on.
#[test]
fn runs_that_have_ended_count_and_a_failure_covers_nothing() {
    let results = TempDir::new().unwrap();
    let run = |seed: u64, rates: &[f64], measures: &[Frontier]| {
        let folder = write_run(results.path(), &key("E", "nova", "default", seed), rates);
        fs::write(folder.join(FRONTIER), measures.iter().map(line).collect::<String>()).unwrap();
        seal(&folder);
        folder
    };
    // The last measure: success 0.5, everything solved but one goal, one of them forgotten.
    let finished = [measure(0, [0; 4], None), measure(1, [4, 5, 5, 3], None), measure(2, [5, 5, 0, 0], None)];
    run(0, &[0.0, 0.5, 0.5], &finished);
    // Its teacher saw the goal of intermediate success.
    let best = measure(1, [5, 5, 5, 3], Some([0.1, 0.2, 0.3, 0.4]));
    fail(&run(1, &[0.0, 0.5], &[measure(0, [0; 4], None), best]));
    let ongoing = measure(1, [5; 4], Some([0.25; 4]));
    let folder = run(2, &[0.0, 0.5], &[measure(0, [0; 4], None), ongoing]);
    fs::remove_file(folder.join(layout::OUTCOME)).unwrap();
    let read = |csv: &str, failures: Failures| -> Vec<Option<f64>> {
        reports::write(results.path(), &ReportOptions { failures, ..options() }).unwrap();
        let text = fs::read_to_string(layout::report_dir(results.path()).join(csv)).unwrap();
        let row = text.lines().nth(1).unwrap().split(',').skip(3).map(|number| number.parse().ok());
        row.collect()
    };
    // Solved: three of four in both. Forgotten: one of three, and all.
    let coverage = read("coverage.csv", Failures::Zero);
    close(&coverage[..4], &[Some(2.0), Some(0.25), Some(0.75), Some(f64::midpoint(1.0 / 3.0, 1.0))]);
    close(&coverage[4..], &[Some(0.0); 2]);
    let coverage = read("coverage.csv", Failures::Apart);
    close(&coverage[..4], &[Some(1.0), Some(0.5), Some(0.75), Some(1.0 / 3.0)]);
    // What the failed run's teacher saw before that counts.
    let sight = read("frontier.csv", Failures::Zero);
    assert_eq!((sight[1], sight[4], sight[5]), (Some(2.0), Some(1.0), Some(1.0)), "{sight:?}");
    let sight = read("frontier.csv", Failures::Apart);
    assert_eq!((sight[1], sight[4], sight[5]), (Some(1.0), Some(0.0), None), "{sight:?}");
}

#[test]
fn results_without_measures_say_nothing_of_them() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    let written = reports::write(results.path(), &options()).unwrap();
    assert!(written.missing.iter().all(|text| !text.contains("frontier")), "{:?}", written.missing);
    let summary = fs::read_to_string(layout::report_dir(results.path()).join("summary.md")).unwrap();
    assert!(!summary.contains("frontier"), "{summary}");
}
