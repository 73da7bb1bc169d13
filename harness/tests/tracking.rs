//! TensorBoard event files: their frames, their growth over a resumed run, and TensorBoard itself as the
//! reader.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "says that it was skipped")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use goalbench::tracking::EVENTS;
use reports::store::layout;
use support::{goalbench, stderr, toy, toy_args};

fn run(results: &Path) -> PathBuf {
    results.join("runs/Point/teach/default/seed-0")
}

fn records(results: &Path) -> usize {
    fs::read_to_string(run(results).join(layout::RECORDS)).expect("records").lines().count()
}

#[test]
fn there_is_an_event_per_evaluation_on_request_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &[]);
    let events = run(folder.path()).join(EVENTS);
    assert!(!events.exists(), "not without being asked for");
    // Asked for later, also of runs that have ended.
    toy(folder.path(), &["--tensorboard"]);
    // The first frame holds the version of the format.
    assert_eq!(support::tfrecords(&events), 1 + records(folder.path()));
}

/// Prints, for every run and tag that TensorBoard finds, its steps and values.
const READER: &str = r"
import sys
from tensorboard.backend.event_processing.event_multiplexer import EventMultiplexer
multiplexer = EventMultiplexer().AddRunsFromDirectory(sys.argv[1])
multiplexer.Reload()
for run, tags in sorted(multiplexer.Runs().items()):
    for tag in sorted(tags['scalars']):
        scalars = multiplexer.Scalars(run, tag)
        print(run, tag, ' '.join(f'{s.step}:{s.value:.4f}' for s in scalars))
";

#[test]
fn tensorboard_reads_what_the_records_say() {
    let Some(python) = std::env::var_os("GOALBENCH_TENSORBOARD_PYTHON") else {
        println!("skipped: set GOALBENCH_TENSORBOARD_PYTHON to a Python that has tensorboard");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = goalbench(&toy_args(folder.path(), &["--tensorboard"]));
    assert!(output.status.success(), "{}", stderr(&output));
    let logdir = layout::runs_dir(folder.path());
    let output = Command::new(python).args(["-c", READER]).arg(&logdir).output().expect("Python starts");
    assert!(output.status.success(), "{}", stderr(&output));
    let read = support::stdout(&output);

    let records = fs::read_to_string(run(folder.path()).join(layout::RECORDS)).expect("records");
    let records: Vec<reports::schema::Record> =
        records.lines().map(|line| serde_json::from_str(line).expect("a record")).collect();
    let series = |value: fn(&reports::schema::Record) -> f64| {
        let points = records.iter().map(|record| format!("{}:{:.4}", record.step, value(record)));
        points.collect::<Vec<_>>().join(" ")
    };
    let run = "Point/teach/default/seed-0";
    let lines = [
        format!("{run} evaluation/success_rate {}\n", series(|record| record.success_rate)),
        format!(
            "{run} evaluation/any_success_rate {}\n",
            series(|record| record.any_success_rate.expect("recorded"))
        ),
        format!("{run} evaluation/mean_return {}\n", series(|record| record.mean_return)),
        format!("{run} student/gradient_steps {}\n", series(|record| record.gradient_steps as f64)),
        format!(
            "{run} teacher/entropy {}\n",
            series(|record| record.teacher["entropy"].as_f64().expect("a number"))
        ),
    ];
    for line in lines {
        assert!(read.contains(&line), "expected {line:?} in\n{read}");
    }
    assert!(read.contains("Point/her-iid/default/seed-1 training/success_rate "), "{read}");
}
