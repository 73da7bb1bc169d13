//! `verify` and `render` from the command line.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::io::Read;
use std::path::Path;

use support::{goalbench, stderr, stdout, toy};

/// Recorded traces, shortened copies that the environments' own tests use.
fn golden() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../envs/tests/golden"))
}

#[test]
fn verify_agrees_with_the_recordings_and_prints_json() {
    let output = goalbench(&["verify", golden().to_str().expect("UTF-8"), "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(report["passed"], true);
    let files = report["files"].as_array().expect("a list");
    assert!(files.len() >= 15, "every environment is there");
    assert!(files.iter().all(|file| file["deviations"]["qpos"].as_f64().expect("a number") <= 1e-9));
}

#[test]
fn verify_names_the_place_of_damage() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let name = "MazeA.json.gz";
    let whole = fs::read(golden().join(name)).expect("a recording");
    fs::write(folder.path().join(name), &whole[..whole.len() / 2]).expect("the test folder can be written");
    let output = goalbench(&["verify", folder.path().to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains(name), "{}", stderr(&output));

    let empty = tempfile::tempdir().expect("a temporary folder");
    let output = goalbench(&["verify", empty.path().to_str().expect("UTF-8")]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}

#[test]
fn render_draws_random_actions_and_a_trained_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let (gif, frames) = (path("maze.gif"), path("frames"));
    let args =
        ["render", "--env", "MazeA", "--episodes", "1", "--size", "64", "--out", &gif, "--frames", &frames];
    let output = goalbench(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    let mut head = [0; 6];
    fs::File::open(&gif).expect("it is written").read_exact(&mut head).expect("a header");
    assert_eq!(&head, b"GIF89a");
    assert_eq!(fs::read_dir(&frames).expect("they are written").count(), 51, "the start and 50 steps");

    let results = folder.path().join("results");
    toy(&results, &["--seeds", "0"]);
    let run = path("results/runs/Point/teach/default/seed-0");
    let output = goalbench(&["render", &run, "--episodes", "2", "--size", "64", "--out", &path("point.gif")]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("42 pictures of 2 episodes"), "{}", stdout(&output));
}

#[test]
fn pictures_are_never_mixed_with_others_and_are_what_their_names_say() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let draw = |more: &[&str]| {
        let args = ["render", "--env", "Point", "--size", "16"];
        goalbench(&[&args[..], more].concat())
    };
    let frames = path("frames");
    assert!(draw(&["--episodes", "2", "--frames", &frames]).status.success());
    let before: Vec<_> =
        fs::read_dir(&frames).expect("they are written").map(|entry| entry.expect("one").path()).collect();
    assert_eq!(before.len(), 42);
    let refused = draw(&["--episodes", "1", "--frames", &frames]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("is not empty; name a new or an empty folder"), "{}", stderr(&refused));
    assert_eq!(fs::read_dir(&frames).expect("they are there").count(), 42);

    for name in ["x.mp4", "x", "x.gif.png", ".gif"] {
        let refused = draw(&["--episodes", "1", "--out", &path(name)]);
        assert_eq!(refused.status.code(), Some(2), "{name}");
        assert!(stderr(&refused).contains("animations are written as .gif"), "{}", stderr(&refused));
        assert!(!Path::new(&path(name)).exists(), "{name}");
    }
    assert!(draw(&["--episodes", "1", "--out", &path("X.GIF")]).status.success());
    // A place that cannot be written is found out before anything is drawn.
    let refused = draw(&["--episodes", "1000", "--out", "/proc/x.gif", "--frames", &path("none")]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(!Path::new(&path("none")).exists());
}

#[test]
fn pictures_are_drawn_in_bounded_memory() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // 102 pictures of 2048² pixels are 1.3 GB; the address space without any is 0.7 GB.
    let script = "ulimit -v 1500000; exec \"$goalbench\" render --env MazeA --episodes 2 --size 2048 --frames \"$dir\"";
    let output = std::process::Command::new("sh")
        .args(["-ec", script])
        .env("goalbench", env!("CARGO_BIN_EXE_goalbench"))
        .env("dir", folder.path().join("frames"))
        .output()
        .expect("a shell starts");
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("102 pictures of 2 episodes"), "{}", stdout(&output));
}

#[test]
fn render_refuses_what_it_cannot_draw() {
    for (args, expected) in [
        (vec!["render", "--env", "MazeD", "--out", "x.gif"], "did you mean `MazeA`"),
        (vec!["render", "/nowhere", "--out", "x.gif"], "/nowhere: is no folder of a run"),
        (vec!["render", "--env", "MazeA", "--size", "0", "--out", "x.gif"], "1 to 4096"),
        (vec!["render", "--env", "MazeA"], "--out"),
        (
            vec!["render", "--env", "MazeA", "--out", "/proc/x/x.gif"],
            "--out: /proc: cannot write in this folder",
        ),
    ] {
        let output = goalbench(&args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(stderr(&output).contains(expected), "{args:?}: {}", stderr(&output));
    }
}
