//! TensorBoard event files: their frames, their growth over a resumed run, and TensorBoard itself as the
//! reader.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "says that it was skipped")]

mod support;

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use goalbench::tracking::EVENTS;
use reports::store::layout;
use rustix::process::Signal;
use support::children::{signal, start, workers};
use support::{goalbench, stderr, toy, toy_args};

fn run(results: &Path) -> PathBuf {
    results.join("runs/Point/teach/default/seed-0")
}

fn records(results: &Path) -> usize {
    fs::read_to_string(run(results).join(layout::RECORDS)).map_or(0, |text| text.lines().count())
}

/// Long enough to be interrupted in: some seconds, with an evaluation every 200 steps.
const LONGER: [&str; 11] = [
    "--curriculum",
    "teach",
    "--seeds",
    "0",
    "--steps",
    "6000",
    "--set",
    "evaluation.every=200",
    "--set",
    "student.updates_per_cycle=12",
    "--tensorboard",
];

/// Kills `parent` and its workers without warning.
fn kill_all(parent: &mut Child) {
    let workers = workers(parent.id());
    signal(parent.id(), Signal::KILL);
    workers.into_iter().for_each(|pid| signal(pid, Signal::KILL));
    parent.wait().expect("it was started here");
}

fn wait_until(what: &str, is_so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "waited a minute for {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A run that is killed, stopped, and brought to its end, by the same command each time. `look` sees it after
/// each of these.
fn interrupted(results: &Path, mut look: impl FnMut()) {
    let mut parent = start(&toy_args(results, &LONGER));
    wait_until("three evaluations", || records(results) >= 3);
    kill_all(&mut parent);
    look();
    parent = start(&toy_args(results, &LONGER));
    wait_until("some more", || records(results) >= 8);
    signal(parent.id(), Signal::TERM);
    assert_eq!(parent.wait().expect("it was started here").code(), Some(3), "stopped, not ended");
    look();
    assert!(start(&toy_args(results, &LONGER)).wait().expect("it was started here").success());
    look();
}

#[test]
fn an_event_file_is_never_replaced_and_only_what_no_checkpoint_holds_is_taken_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let events = run(folder.path()).join(EVENTS);
    let mut seen: Vec<(u64, Vec<u8>)> = Vec::new();
    interrupted(folder.path(), || {
        let file = fs::metadata(&events).expect("an event file").ino();
        seen.push((file, fs::read(&events).expect("an event file")));
    });
    assert_eq!(seen[0].0, seen[2].0, "whoever has it open goes on reading");
    assert_eq!(seen[1].0, seen[2].0);
    // After a stop, which saves a checkpoint, everything in it stays.
    assert!(seen[2].1.starts_with(&seen[1].1) && seen[2].1.len() > seen[1].1.len());
    assert_eq!(support::tfrecords(&events), 1 + records(folder.path()));
}

/// Shows a folder in TensorBoard, and tells, for every line with a number of points on standard input, the
/// steps of a curve once it has so many of them, or after a minute.
const BOARD: &str = r"
import json, sys, time, urllib.error, urllib.parse, urllib.request
from tensorboard import program
folder, run, tag = sys.argv[1:]
board = program.TensorBoard()
board.configure(argv=['tensorboard', '--logdir', folder, '--port', '0', '--reload_interval', '1'])
url = board.launch()
ask = urllib.request.build_opener(urllib.request.ProxyHandler({})).open
curve = f'{url}data/plugin/scalars/scalars?' + urllib.parse.urlencode({'run': run, 'tag': tag})
def steps():
    try:
        return [step for _, step, _ in json.load(ask(curve))]
    except urllib.error.HTTPError:
        return []
for line in sys.stdin:
    wanted, begun = int(line), time.monotonic()
    while len(steps()) < wanted and time.monotonic() < begun + 60:
        time.sleep(0.2)
    print(*steps(), flush=True)
";

/// A TensorBoard at work.
struct Board {
    process: Child,
    ask: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Board {
    fn open(python: &Path, logdir: &Path, run: &str, tag: &str) -> Self {
        let mut command = Command::new(python);
        command.args(["-c", BOARD]).arg(logdir).args([run, tag]).stderr(Stdio::null());
        let mut process =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("Python starts");
        let (ask, answers) = (process.stdin.take(), process.stdout.take());
        let answers = BufReader::new(answers.expect("it is piped"));
        Self { process, ask: ask.expect("it is piped"), answers }
    }

    /// The steps of the curve, once it has `points` of them.
    fn steps(&mut self, points: usize) -> Vec<u64> {
        writeln!(self.ask, "{points}").expect("TensorBoard listens");
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("TensorBoard answers");
        line.split_whitespace().map(|step| step.parse().expect("a step")).collect()
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The Python that has TensorBoard, if there is one.
fn python() -> Option<PathBuf> {
    let python = std::env::var_os("GOALBENCH_TENSORBOARD_PYTHON").map(PathBuf::from);
    if python.is_none() {
        println!("skipped: set GOALBENCH_TENSORBOARD_PYTHON to a Python that has tensorboard");
    }
    python
}

#[test]
fn an_open_tensorboard_goes_on_over_interruptions() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let logdir = layout::runs_dir(folder.path());
    let tag = "evaluation/success_rate";
    let mut board = Board::open(&python, &logdir, "Point/teach/default/seed-0", tag);
    interrupted(folder.path(), || {
        let points = support::tfrecords(&run(folder.path()).join(EVENTS)) - 1;
        let seen = board.steps(points.min(3));
        assert!(seen.len() >= points.min(3), "TensorBoard has it open: {seen:?}");
    });
    let records = fs::read_to_string(run(folder.path()).join(layout::RECORDS)).expect("records");
    let record = |line| serde_json::from_str::<reports::schema::Record>(line).expect("a record").step;
    let expected: Vec<u64> = records.lines().map(record).collect();
    assert_eq!(board.steps(expected.len()), expected, "every evaluation, once");
}

/// Ended runs whose timings are gone or cut: all evaluations are shown, the file is named, the sweep goes on.
#[test]
fn lost_timings_cost_the_times_of_an_event_file_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0"]);
    let (timing, events) = (run(folder.path()).join(layout::TIMING), run(folder.path()).join(EVENTS));
    let whole = fs::read_to_string(&timing).expect("timings");
    let cut: String = whole.split_inclusive('\n').take(2).collect();
    let again = || goalbench(&toy_args(folder.path(), &["--seeds", "0", "--tensorboard"]));
    let other = folder.path().join("runs/Point/her-iid/default/seed-0").join(EVENTS);
    for damaged in [None, Some(cut.as_str()), Some("{\n")] {
        match damaged {
            Some(text) => fs::write(&timing, text).expect("it can be written"),
            None => fs::remove_file(&timing).expect("timings"),
        }
        let output = again();
        assert!(output.status.success(), "{}", stderr(&output));
        let named = format!("{}: ", timing.display());
        assert!(stderr(&output).contains(&named), "{}", stderr(&output));
        for events in [&events, &other] {
            assert_eq!(support::tfrecords(events), 6, "the version of the format and 5 evaluations");
        }
        let text = String::from_utf8_lossy(&fs::read(&events).expect("an event file")).into_owned();
        assert!(!text.contains("time/wall_s") && text.contains("student/critic_loss"));
        let status = goalbench(&["status", folder.path().to_str().expect("a test path is UTF-8")]);
        assert!(support::stdout(&status).contains(&timing.display().to_string()), "status names it, too");
        fs::remove_file(&events).expect("an event file");
    }
    // With sound timings times come back; and what is there stays if they are lost again.
    fs::write(&timing, &whole).expect("it can be written");
    assert!(again().status.success());
    let full = fs::read(&events).expect("an event file");
    assert!(String::from_utf8_lossy(&full).contains("time/wall_s"));
    fs::write(&timing, &cut).expect("it can be written");
    let output = again();
    assert!(stderr(&output).contains("timing.jsonl"), "{}", stderr(&output));
    assert_eq!(fs::read(&events).expect("an event file"), full);
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
    let Some(python) = python() else { return };
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
    let id = "Point/teach/default/seed-0";
    let lines = [
        format!("{id} evaluation/success_rate {}\n", series(|record| record.success_rate)),
        format!(
            "{id} evaluation/any_success_rate {}\n",
            series(|record| record.any_success_rate.expect("recorded"))
        ),
        format!("{id} evaluation/mean_return {}\n", series(|record| record.mean_return)),
        format!("{id} student/gradient_steps {}\n", series(|record| record.gradient_steps as f64)),
        format!(
            "{id} teacher/entropy {}\n",
            series(|record| record.teacher["entropy"].as_f64().expect("a number"))
        ),
    ];
    let student = fs::read_to_string(run(folder.path()).join(layout::STUDENT)).expect("diagnoses");
    let student: Vec<reports::schema::Learning> =
        student.lines().map(|line| serde_json::from_str(line).expect("a diagnosis")).collect();
    // The untrained student has learned from nothing.
    let points = student.iter().filter_map(|line| Some(format!("{}:{:.4}", line.step, line.mean_q?)));
    let points: Vec<String> = points.collect();
    assert_eq!((points.len(), records.len()), (4, 5));
    let mean_q = format!("{id} student/mean_q {}\n", points.join(" "));
    for line in lines.into_iter().chain([mean_q]) {
        assert!(read.contains(&line), "expected {line:?} in\n{read}");
    }
    assert!(read.contains("Point/her-iid/default/seed-1 training/success_rate "), "{read}");
}
