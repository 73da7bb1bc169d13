//! What teachers did: read strictly, and counted in heat maps.

use std::fs;
use std::path::Path;

use super::support::{key, line, options, seal, write_run};
use reports::analysis::catalogue::MazeInfo;
use reports::schema::Teaching;
use reports::store::layout;
use reports::store::{self, Store};
use reports::synthetic::Experiment;
use tempfile::TempDir;

fn teaching(eval_index: u64) -> Teaching {
    Teaching {
        eval_index,
        step: 1_000 * eval_index,
        goals: vec![vec![-0.5, 0.5], vec![0.5, 0.5]],
        successes: vec![true, false],
        weights: Some(vec![0.25, 0.75]),
        picks: Some(vec![Some(1), None]),
        scores: Some(vec![Some(0.5), None]),
        ranks: Some(vec![Some(0), None]),
    }
}

/// A run in a maze with this content of its teaching file. Gives the lines read and the problems as text.
fn read(content: &str) -> (Vec<Teaching>, Vec<String>) {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("M", "nova", "default", 0), &[0.0, 0.5]);
    fs::write(folder.join(layout::TEACHING), content).unwrap();
    seal(&folder);
    let store = Store::read(results.path()).unwrap();
    assert_eq!(store.problems(), [], "records are sound");
    let (lines, problems) = store::teaching(results.path(), &store.runs()[0]);
    (lines, problems.iter().map(ToString::to_string).collect())
}

#[test]
fn sound_lines_are_read_by_rising_evaluation() {
    let (lines, problems) = read(&[teaching(2), teaching(1)].map(|teaching| line(&teaching)).concat());
    assert_eq!((lines, problems), (vec![teaching(1), teaching(2)], vec![]));
}

#[test]
fn each_damaged_line_is_named() {
    let short = Teaching { successes: vec![true], ..teaching(2) };
    let uneven = Teaching { goals: vec![vec![0.0, 0.0], vec![0.0]], ..teaching(3) };
    let heavy = Teaching { weights: Some(vec![0.5, 1.5]), ..teaching(4) };
    let few = Teaching { picks: Some(vec![None]), ..teaching(5) };
    let many = Teaching { ranks: Some(vec![None; 3]), ..teaching(6) };
    let beyond = Teaching { picks: Some(vec![Some(2), None]), ..teaching(7) };
    let scored = Teaching { scores: Some(vec![None; 3]), ..teaching(8) };
    let damaged = [&short, &uneven, &heavy, &few, &many, &beyond, &scored].map(line).concat();
    let content = line(&teaching(1)) + &damaged + &line(&teaching(1)) + "{\"ev";
    let (lines, problems) = read(&content);
    assert_eq!(lines, [teaching(1)]);
    let expected = [
        "10: incomplete last line (4 bytes without a newline), ignored",
        "2: successes is 1 long, line ignored; expected as many entries as goals",
        "3: goals is [0.0], line ignored; expected goals of finite numbers, all of one length",
        "4: weights is 1.5, line ignored; expected numbers in [0, 1]",
        "5: picks is 1 long, line ignored; expected as many entries as goals",
        "6: ranks is 3 long, line ignored; expected as many entries as goals",
        "7: picks is 2, line ignored; expected indices below the number of weights",
        "8: scores is 3 long, line ignored; expected as many entries as goals",
        "9: evaluation 1 again, ignored; line 1 has it",
    ];
    assert_eq!(problems, expected.map(|text| format!("runs/M/nova/default/seed-0/teaching.jsonl:{text}")));
}

#[test]
fn lines_older_than_a_field_are_read() {
    let new = line(&teaching(1));
    let (old, _) = new.split_once(",\"picks\"").unwrap();
    let expected = Teaching { picks: None, scores: None, ranks: None, ..teaching(1) };
    assert_eq!(read(&format!("{old}}}\n")), (vec![expected], vec![]));
}

#[test]
fn what_teachers_picked_is_a_table_where_they_tell() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    let write = |curriculum: &str, seed: u64, picked: [u64; 3]| {
        let folder = write_run(path, &key("M", curriculum, "default", seed), &[0.0, 0.5, 0.5]);
        let records = folder.join(layout::RECORDS);
        let lines = fs::read_to_string(&records).unwrap();
        let told = lines.lines().zip(picked).map(|(line, picked)| {
            line.replace("\"undefined\":null", &format!("\"picked_goals\":{picked},\"pick_rank_mean\":null"))
                + "\n"
        });
        fs::write(&records, told.collect::<String>()).unwrap();
        seal(&folder);
    };
    write_run(path, &key("M", "dull", "default", 0), &[0.0, 0.5, 0.5]);
    let table = layout::report_dir(path).join("tables/teaching.tex");
    reports::write(path, &options()).unwrap();
    assert!(!table.exists(), "no teacher tells anything");
    write("moss", 0, [900, 10, 20]);
    write("moss", 1, [900, 40, 50]);
    // One that has not ended counts for nothing.
    write("moss", 2, [900, 900, 900]);
    fs::remove_file(layout::run_dir(path, &key("M", "moss", "default", 2)).join(layout::OUTCOME)).unwrap();
    let written = reports::write(path, &options()).unwrap();
    // The one of DULL; no environment is known to be a maze.
    let silent =
        "which goals of the pool were picked: 1 of 4 runs without a record of it (older than the field)";
    assert!(written.missing.iter().any(|text| text == silent), "{:?}", written.missing);
    assert!(table.is_file());
    let csv = fs::read_to_string(layout::report_dir(path).join("teaching.csv")).unwrap();
    let expected = "environment,curriculum,variant,n_counted,picked_goals,effective_picks,effective_goals,pick_rank_mean,\
                    score_success_correlation\nM,moss,default,2,30.0,,,,\nM,dull,default,1,,,,,\n";
    // Over evaluations 1 and 2 of two seeds: (15 + 45) / 2.
    assert_eq!(csv, expected);
    let summary = fs::read_to_string(layout::report_dir(path).join("summary.md")).unwrap();
    let (_, section) = summary.split_once("## What teachers picked").unwrap();
    assert!(section.contains("| M | MoSS | default | 30.0 | – | – | – | – |"), "{section}");
    assert!(section.contains("0.5 where every rank has its fair share of turns"));
}

fn report(results: &Path) -> reports::Written {
    let maze = MazeInfo { id: "M".into(), grid: ["..", ".S"].map(String::from).to_vec() };
    let mut options = options();
    options.catalogue.mazes = vec![maze];
    reports::write(results, &options).unwrap()
}

#[test]
fn mazes_get_heat_maps_where_teachers_were_recorded() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("M", "nova", "default", 0), &[0.0, 0.5]);
    let heat = layout::report_dir(results.path()).join("figures/heat-M.svg");
    let without = report(results.path());
    assert!(!heat.exists());
    let lacks = |written: &reports::Written, method: &str| {
        let text = format!("M: no heat map of {method}: there is no record of what their teachers did");
        written.missing.contains(&text)
    };
    assert!(lacks(&without, "NOVA"));
    write_run(results.path(), &key("M", "wren", "default", 0), &[0.0, 0.5]);
    fs::write(folder.join(layout::TEACHING), line(&teaching(1)) + "damaged\n").unwrap();
    seal(&folder);
    let with = report(results.path());
    assert!(heat.is_file());
    assert!(lacks(&with, "WREN") && !lacks(&with, "NOVA"), "{:?}", with.missing);
    assert_eq!(with.problems.len(), 1);
    assert_eq!(with.problems[0].line, Some(2));
}

#[test]
fn all_runs_are_asked_for_what_was_picked_whatever_they_choose_from() {
    let made = |variant: &str| {
        let results = TempDir::new().unwrap();
        let experiment = Experiment { seeds: 1, evaluations: 3, ..Experiment::default() };
        experiment.write(results.path()).unwrap();
        write_run(results.path(), &key("ArmReach", "nova", variant, 0), &[0.0, 0.5]);
        let missing = reports::write(results.path(), &options()).unwrap().missing;
        missing.into_iter().find(|text| text.contains("were picked"))
    };
    // Of six methods none is silent, DULL with its number that is not defined neither; an ablation's run
    // counts.
    let silent =
        "which goals of the pool were picked: 1 of 7 runs without a record of it (older than the field)";
    assert_eq!(made("n=3").as_deref(), Some(silent));
    assert_eq!(made("default").as_deref(), Some(silent.replace('7', "6").as_str()));
}
