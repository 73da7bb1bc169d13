//! Timings that were lost, cut off or altered: named with their file, and left out of times alone.

use std::fs;
use std::path::Path;

use super::support::{key, options, seal, write_run};
use reports::schema::Timing;
use reports::store::layout::{self, CHECKSUMS, OUTCOME, TIMING};
use reports::store::{RunFolder, Store};
use tempfile::TempDir;

const FOLDER: &str = "runs/E/nova/default/seed-1";

/// Two finished runs of an hour and a half each, of which the second is damaged. Gives what the report names,
/// what it lacks, and the numbers of its costs by column.
fn told(damage: impl FnOnce(&Path)) -> (Vec<String>, Vec<String>, Vec<(String, String)>) {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5, 0.5, 0.5]);
    let folder = write_run(results.path(), &key("E", "nova", "default", 1), &[0.0, 1.0, 1.0, 1.0]);
    damage(&folder);
    let written = reports::write(results.path(), &options()).unwrap();
    let problems = written.problems.iter().map(ToString::to_string).collect();
    let about_time = written.missing.into_iter().filter(|text| text.contains("timing")).collect();
    let csv = fs::read_to_string(layout::report_dir(results.path()).join("costs.csv")).unwrap();
    let (names, row) = csv.trim_end().split_once('\n').unwrap();
    let cells = names.split(',').map(String::from).zip(row.split(',').map(String::from));
    (problems, about_time, cells.collect())
}

fn cell<'a>(costs: &'a [(String, String)], name: &str) -> &'a str {
    &costs.iter().find(|(column, _)| column == name).unwrap().1
}

fn lines(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join(TIMING)).unwrap();
    text.split_inclusive('\n').map(String::from).collect()
}

#[test]
fn times_of_an_ended_run_are_those_that_it_ended_with_or_none() {
    let altered = "was cut off or altered after the run ended, times left out";
    let lost = "cannot read this file: No such file or directory (os error 2), times left out";
    type Damage = fn(&Path);
    let cases: [(Damage, &str); 4] = [
        (|folder| fs::remove_file(folder.join(TIMING)).unwrap(), lost),
        (|folder| fs::write(folder.join(TIMING), "").unwrap(), altered),
        (|folder| fs::write(folder.join(TIMING), lines(folder)[..2].concat()).unwrap(), altered),
        (
            |folder| {
                let text = lines(folder).concat().replace("\"wall_s\":5400.0", "\"wall_s\":5401.0");
                fs::write(folder.join(TIMING), text).unwrap();
            },
            altered,
        ),
    ];
    for (damage, expected) in cases {
        let (problems, missing, costs) = told(damage);
        assert_eq!(problems, [format!("{FOLDER}/{TIMING}: {expected}")]);
        assert_eq!(
            missing,
            ["E: NOVA: timings (timing.jsonl) of seed 1: times are those of the other seeds"]
        );
        // The evaluations of both count, and the time of the one that tells it.
        let counted = ["n_seeds", "n_finished", "n_timed", "wall_hours"].map(|name| cell(&costs, name));
        assert_eq!(counted, ["2", "2", "1", "1.5"]);
    }
    let (problems, missing, costs) = told(|_| {});
    assert_eq!((problems.len(), missing.len(), cell(&costs, "n_timed")), (0, 0, "2"));
}

/// As in results of old versions, which noted no checksums of timings, and of runs that have not ended.
#[test]
fn times_that_nothing_vouches_for_must_fit_their_evaluations() {
    let unsealed = |folder: &Path| {
        let sums = fs::read_to_string(folder.join(CHECKSUMS)).unwrap();
        let mut sums: serde_json::Value = serde_json::from_str(&sums).unwrap();
        assert!(sums["sha256"].as_object_mut().unwrap().remove(TIMING).is_some(), "timings have a checksum");
        fs::write(folder.join(CHECKSUMS), sums.to_string()).unwrap();
    };
    let (problems, _, costs) = told(|folder| {
        unsealed(folder);
        fs::write(folder.join(TIMING), lines(folder)[..2].concat()).unwrap();
    });
    assert_eq!(problems, [format!("{FOLDER}/{TIMING}: evaluations 2 to 3 are missing")]);
    assert_eq!((cell(&costs, "n_timed"), cell(&costs, "wall_hours")), ("1", "1.5"));

    let (problems, _, costs) = told(|folder| {
        unsealed(folder);
        let text = lines(folder).concat();
        let text =
            text.replace("\"step\":3000", "\"step\":2000").replace("\"wall_s\":3600.0", "\"wall_s\":1.0");
        let text = text.replace(
            "\"evaluation_s\":0.0,\"teacher_s\":720.0,\"learning_s\":1800.0",
            "\"evaluation_s\":0.0",
        );
        fs::write(folder.join(TIMING), text).unwrap();
    });
    let expected = [
        "3: wall_s is 1, line ignored; expected no less than at the evaluation before",
        "4: step is 2000, line ignored; expected the step of the same evaluation",
    ];
    assert_eq!(problems, expected.map(|text| format!("{FOLDER}/{TIMING}:{text}")));
    assert_eq!(cell(&costs, "n_timed"), "1");
}

/// The record of an evaluation is written before its timing.
#[test]
fn a_running_run_may_lack_its_last_timing() {
    let results = TempDir::new().unwrap();
    let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5, 0.5]);
    fs::remove_file(folder.join(OUTCOME)).unwrap();
    fs::write(folder.join(TIMING), lines(&folder)[..2].concat()).unwrap();
    let store = Store::read(results.path()).unwrap();
    assert_eq!(store.problems(), []);
    let timed = |timing: &Timing| timing.eval_index;
    assert_eq!(store.runs()[0].timings.iter().map(timed).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(RunFolder::new(&folder).timings().unwrap().len(), 2);
}

/// The curve of success against time is that of the seeds that tell it, all the way.
#[test]
fn one_lost_file_does_not_cost_the_figures_over_time() {
    let results = TempDir::new().unwrap();
    let path = results.path();
    let damaged = write_run(path, &key("E", "nova", "default", 0), &[0.0, 0.5]);
    write_run(path, &key("E", "nova", "default", 1), &[0.0, 0.5]);
    fs::remove_file(damaged.join(TIMING)).unwrap();
    reports::write(path, &options()).unwrap();
    let figure = layout::report_dir(path).join("figures/hours-E.svg");
    assert!(figure.is_file());
    let other = RunFolder::of(path, &key("E", "nova", "default", 1));
    fs::remove_file(other.file(TIMING)).unwrap();
    seal(other.path());
    reports::write(path, &options()).unwrap();
    assert!(!figure.exists(), "nobody tells the time");
}
