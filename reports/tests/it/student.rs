//! How students learned: read strictly, and drawn on request; and where they were sent in space.

use std::fs;
use std::path::Path;

use super::support::{key, line, options, seal, write_run};
use reports::ReportOptions;
use reports::analysis::catalogue::EnvironmentInfo;
use reports::schema::{Learning, Teaching};
use reports::store::layout::{self, STUDENT};
use reports::store::{self, Store};
use reports::synthetic::Experiment;
use tempfile::TempDir;

fn learning(eval_index: u64) -> Learning {
    Learning {
        eval_index,
        step: 1_000 * eval_index,
        critic_loss: Some(0.25),
        actor_loss: Some(3.5),
        mean_q: Some(-3.0),
        critic_gradient_norm: Some(1.0),
        actor_gradient_norm: None,
        replay_episodes: 20 * eval_index,
        replay_transitions: 1_000 * eval_index,
    }
}

#[test]
fn each_damaged_line_is_named() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    let below = Learning { critic_gradient_norm: Some(-1.0), ..learning(2) };
    let content = line(&learning(1)) + &line(&below) + &line(&learning(1)) + &line(&learning(0)) + "{\"ev";
    fs::write(folder.join(STUDENT), content).unwrap();
    seal(&folder);
    let store = Store::read(results.path()).unwrap();
    let (lines, problems) = store::learning(results.path(), &store.runs()[0]);
    assert_eq!(lines, [learning(0), learning(1)]);
    let expected = [
        "5: incomplete last line (4 bytes without a newline), ignored",
        "2: critic_gradient_norm is -1, line ignored; expected a number of at least 0",
        "3: evaluation 1 again, ignored; line 1 has it",
    ];
    let named: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(named, expected.map(|text| format!("runs/E/nova/default/seed-0/{STUDENT}:{text}")));
    let written = reports::write(results.path(), &options()).unwrap();
    assert_eq!(written.problems.len(), 3, "a report names them, too");
}

#[test]
fn an_ended_run_has_the_file_that_it_ended_with() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    fs::write(folder.join(STUDENT), line(&learning(0)) + &line(&learning(1))).unwrap();
    seal(&folder);
    assert_eq!(Store::read(results.path()).unwrap().problems(), []);
    fs::write(folder.join(STUDENT), line(&learning(0))).unwrap();
    let store = Store::read(results.path()).unwrap();
    let expected = format!(
        "runs/E/nova/default/seed-0/{STUDENT}: was cut off or altered after the run ended, run left out"
    );
    assert_eq!(store.problems().iter().map(ToString::to_string).collect::<Vec<_>>(), [expected]);
    // One that came only later belongs to no run.
    let late = write_run(results.path(), &key("E", "nova", "default", 1), &[0.0, 0.5]);
    fs::write(late.join(STUDENT), line(&learning(0))).unwrap();
    assert_eq!(Store::read(results.path()).unwrap().problems().len(), 2);
}

#[test]
fn all_lines_are_data() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 7), &[0.0, 0.5]);
    let empty = Learning { eval_index: 0, ..Learning::default() };
    fs::write(folder.join(STUDENT), line(&empty) + &line(&learning(1))).unwrap();
    seal(&folder);
    reports::write(results.path(), &options()).unwrap();
    let report = layout::report_dir(results.path());
    let csv = fs::read_to_string(report.join("student.csv")).unwrap();
    let expected = "environment,curriculum,variant,seed,step,eval_index,critic_loss,actor_loss,mean_q,\
                    critic_gradient_norm,actor_gradient_norm,replay_episodes,replay_transitions\n\
                    E,nova,default,7,0,0,,,,,,0,0\nE,nova,default,7,1000,1,0.25,3.5,-3.0,1.0,,20,1000\n";
    assert_eq!(csv, expected);
    assert!(report.join("student.parquet").is_file());
    assert!(fs::read_to_string(report.join("DATA.md")).unwrap().contains("## student.csv, student.parquet"));
}

fn figures(results: &Path) -> Vec<String> {
    let folder = layout::report_dir(results).join("figures");
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".svg")).collect();
    names.sort_unstable();
    names
}

#[test]
fn diagnostics_are_drawn_on_request() {
    let results = TempDir::new().unwrap();
    let experiment = Experiment {
        environments: vec!["RoomA".into()],
        curricula: ["nova", "moss", "dull"].map(String::from).to_vec(),
        seeds: 2,
        evaluations: 5,
        interval: 4_000,
        teaching: true,
        ..Experiment::default()
    };
    experiment.write(results.path()).unwrap();
    reports::write(results.path(), &options()).unwrap();
    let plain = figures(results.path());
    let asked = ReportOptions { diagnostics: true, ..options() };
    assert!(reports::write(results.path(), &asked).unwrap().problems.is_empty());
    let more: Vec<String> =
        figures(results.path()).into_iter().filter(|name| !plain.contains(name)).collect();
    assert_eq!(more, ["student-RoomA.svg", "teachers-RoomA.svg"]);
    let page = fs::read_to_string(layout::report_dir(results.path()).join("index.html")).unwrap();
    for title in ["RoomA: how the student learned", "RoomA: numbers of teachers"] {
        assert!(page.contains(title), "{title}");
    }
    write_run(results.path(), &key("RoomA", "dull", "old", 0), &[0.0, 0.5]);
    let missing = reports::write(results.path(), &asked).unwrap().missing;
    let silent = "how students learned: 1 of 7 runs without a record of it (student.jsonl)";
    assert!(missing.iter().any(|text| text == silent), "{missing:?}");
    fs::remove_dir_all(results.path().join("runs/RoomA/dull/old")).unwrap();
    // And are gone with the next report that is not asked for them.
    reports::write(results.path(), &options()).unwrap();
    assert_eq!(figures(results.path()), plain);
}

#[test]
fn goals_that_are_points_in_space_are_drawn_from_two_sides() {
    let results = TempDir::new().unwrap();
    let info = |id: &str, goal| EnvironmentInfo {
        id: id.to_owned(),
        state: 10,
        goal,
        action: 4,
        horizon: 50,
        paper_action: None,
        note: String::new(),
    };
    let mut options = options();
    options.catalogue.environments = vec![info("Arm", 3), info("Hand", 15), info("Still", 3)];
    for (environment, goal) in [("Arm", vec![1.3, 0.7, 0.5]), ("Hand", vec![0.0; 15])] {
        let folder = write_run(results.path(), &key(environment, "nova", "default", 0), &[0.0, 0.5]);
        let teaching = Teaching {
            eval_index: 1,
            step: 1_000,
            goals: vec![goal; 20],
            successes: vec![true; 20],
            ..Teaching::default()
        };
        fs::write(folder.join(layout::TEACHING), line(&teaching) + "damaged\n").unwrap();
        seal(&folder);
    }
    write_run(results.path(), &key("Still", "nova", "default", 0), &[0.0, 0.5]);
    let written = reports::write(results.path(), &options).unwrap();
    let maps: Vec<String> =
        figures(results.path()).into_iter().filter(|name| name.starts_with("goals-")).collect();
    assert_eq!(maps, ["goals-Arm.svg"]);
    let missing = "Still: no goal map of NOVA: there is no record of what their teachers did";
    assert!(written.missing.iter().any(|text| text == missing), "{:?}", written.missing);
    let problems: Vec<String> = written.problems.iter().map(ToString::to_string).collect();
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(problems[0].starts_with("runs/Arm/nova/default/seed-0/teaching.jsonl:2: "), "{problems:?}");
}
