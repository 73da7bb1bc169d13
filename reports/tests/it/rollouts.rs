//! What a report tells of probe rollouts.

use std::fs;
use std::path::Path;

use reports::schema::Record;
use reports::store::layout::{self, RECORDS};
use reports::store::{RunFolder, Store};
use tempfile::TempDir;

use super::support::{key, line, options, seal, write_run};

/// A finished run of 3,000 steps by `curriculum`: of every 1,000 of them so many were `charged` for rollouts,
/// and beside them there were `uncharged` more.
fn probed(results: &Path, curriculum: &str, charged: u64, uncharged: u64) {
    let folder = write_run(results, &key("E", curriculum, "default", 0), &[0.0, 0.25, 0.5, 0.75]);
    rewrite(&folder, |record| {
        record.probe_steps = (charged + uncharged) * record.eval_index;
        record.uncharged_steps = uncharged * record.eval_index;
    });
}

fn rewrite(folder: &Path, change: impl Fn(&mut Record)) {
    let mut records = RunFolder::new(folder).records().unwrap();
    records.iter_mut().for_each(change);
    fs::write(folder.join(RECORDS), records.iter().map(line).collect::<String>()).unwrap();
    seal(folder);
}

/// The file `name` of a report on `results`.
fn report(results: &Path, name: &str) -> Option<String> {
    reports::write(results, &options()).unwrap();
    fs::read_to_string(layout::report_dir(results).join(name)).ok()
}

#[test]
fn the_table_of_costs_counts_them_charged_or_not() {
    let results = TempDir::new().unwrap();
    probed(results.path(), "nova", 400, 0);
    probed(results.path(), "wren", 0, 700);
    probed(results.path(), "kite", 0, 0);
    let summary = report(results.path(), "summary.md").unwrap();
    for cell in ["| 3,000 (1,200 in probe rollouts) |", "| 3,000 + 2,100 in probe rollouts |", "| 3,000 |"] {
        assert!(summary.contains(cell), "{cell}: {summary}");
    }
    assert!(summary.contains("Probe rollouts: steps in episodes that the teacher asked for"), "{summary}");
    let costs = report(results.path(), "costs.csv").unwrap();
    let column = |name: &str| costs.lines().next().unwrap().split(',').position(|cell| cell == name).unwrap();
    let (probe, uncharged) = (column("probe_steps"), column("uncharged_steps"));
    let cells: Vec<Vec<&str>> = costs.lines().skip(1).map(|row| row.split(',').collect()).collect();
    let mut counted: Vec<[&str; 2]> = cells.iter().map(|row| [row[probe], row[uncharged]]).collect();
    counted.sort_unstable();
    assert_eq!(counted, [["0.0", "0.0"], ["1200.0", "0.0"], ["2100.0", "2100.0"]]);
}

#[test]
fn curves_against_all_steps_are_drawn_where_some_were_not_charged() {
    let results = TempDir::new().unwrap();
    probed(results.path(), "nova", 400, 0);
    let figure = "figures/all-steps-E.svg";
    assert_eq!(report(results.path(), figure), None, "it would be the figure against steps");
    probed(results.path(), "wren", 0, 700);
    let drawn = report(results.path(), figure).unwrap();
    let steps = report(results.path(), "figures/success-E.svg").unwrap();
    // Letters are drawn as shapes, so what the axis says cannot be read here.
    assert_ne!(drawn, steps, "its axis goes further: 3,000 steps and 2,100 more");
}

#[test]
fn counts_that_cannot_be_are_named() {
    let named = |change: fn(&mut Record)| {
        let results = TempDir::new().unwrap();
        let folder = write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
        rewrite(&folder, change);
        let store = Store::read(results.path()).unwrap();
        store.problems().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let told = named(|record| record.uncharged_steps = 3);
    assert!(told.contains("uncharged_steps is 3, line ignored; expected at most probe_steps"), "{told}");
    let told = named(|record| record.probe_steps = 2_000);
    assert!(told.contains("probe_steps is 2000, line ignored; expected at most step"), "{told}");
    assert_eq!(named(|record| record.probe_steps = record.step), "");
}
