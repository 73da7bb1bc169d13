//! Folders and files whose names are no UTF-8, with every command that takes a path.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use support::{TOY, stderr, stdout};

/// Runs goalbench in `folder` and checks that it succeeds.
fn succeeds(folder: &Path, args: &[&OsStr]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_goalbench"))
        .current_dir(folder)
        .args(args)
        .output()
        .expect("it starts");
    let said = stderr(&output);
    assert!(output.status.success() && !said.contains("panicked"), "{args:?}: {said}");
    output
}

fn name(bytes: &[u8]) -> OsString {
    OsStr::from_bytes(bytes).to_owned()
}

#[test]
fn names_that_are_no_utf_8_are_taken_by_every_command() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (results, traces) = (name(b"res\xffults"), name(b"tr\xfeaces"));
    let run = |more: &[&OsStr]| {
        let toy = TOY.iter().map(OsStr::new);
        let args: Vec<&OsStr> =
            toy.chain([OsStr::new("--out"), results.as_os_str()]).chain(more.iter().copied()).collect();
        succeeds(folder.path(), &args)
    };
    run(&[]);
    let told = stdout(&run(&["--json".as_ref(), "--tensorboard".as_ref()]));
    assert!(told.lines().all(|line| serde_json::from_str::<serde_json::Value>(line).is_ok()), "{told}");

    let subject = PathBuf::from(&results).join("runs/Point/teach/default/seed-0");
    let here = |args: &[&OsStr]| succeeds(folder.path(), args);
    here(&["status".as_ref(), &results]);
    here(&["report".as_ref(), &results]);
    here(&["evaluate".as_ref(), subject.as_ref(), "--episodes".as_ref(), "2".as_ref()]);
    here(&["merge".as_ref(), &results, "--out".as_ref(), &name(b"mer\xffged")]);
    let small = ["--episodes", "1", "--size", "16"].map(OsStr::new);
    let (gif, frames) = (name(b"\xff.gif"), name(b"fra\xffmes"));
    let drawn =
        ["render".as_ref(), subject.as_os_str(), "--out".as_ref(), &gif, "--frames".as_ref(), &frames];
    here(&[&drawn[..], &small[..]].concat());
    assert!(folder.path().join(&gif).exists() && folder.path().join(&frames).join("frame-0020.png").exists());

    std::fs::create_dir(folder.path().join(&traces)).expect("the test folder can be written");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../envs/tests/golden/MazeA.json.gz");
    let copy = folder.path().join(&traces).join(name(b"Ma\xffzeA.json.gz"));
    std::fs::copy(golden, copy).expect("the test folder can be written");
    here(&["verify".as_ref(), &traces]);
    for told in [
        stdout(&here(&["verify".as_ref(), &traces, "--json".as_ref()])),
        stdout(&here(&["status".as_ref(), &results, "--json".as_ref()])),
    ] {
        serde_json::from_str::<serde_json::Value>(&told).expect("JSON");
    }
    let told = stdout(&here(&[
        "evaluate".as_ref(),
        &results,
        "--json".as_ref(),
        "--episodes".as_ref(),
        "2".as_ref(),
    ]));
    assert_eq!(
        told.lines().filter(|line| serde_json::from_str::<serde_json::Value>(line).is_ok()).count(),
        4
    );
}

#[test]
fn gates_take_them_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let protocol = name(b"ga\xffte.toml");
    let text = "name = 'gate'\nenvironments = ['Point']\ncurricula = ['her-iid']\nseeds = [0]\nbudget.steps = 80\n\
        evaluation.every = 40\nevaluation.episodes = 2\nstudent.batch = 16\nstudent.width = 8\n\
        student.updates_per_cycle = 1\npool.size = 5\n";
    std::fs::write(folder.path().join(&protocol), text).expect("the test folder can be written");
    let (results, base, out) = (name(b"ru\xffns"), name(b"ba\xffse.json"), name(b"che\xffck"));
    let args: [&OsStr; 3] = ["regress".as_ref(), "record".as_ref(), protocol.as_os_str()];
    let places: [&OsStr; 4] = ["--results".as_ref(), results.as_os_str(), "--out".as_ref(), &base];
    let run: [&OsStr; 4] = ["run".as_ref(), &protocol, "--out".as_ref(), &results];
    succeeds(folder.path(), &run);
    succeeds(folder.path(), &[&args[..], &places[..]].concat());
    let check: [&OsStr; 5] =
        ["regress".as_ref(), "check".as_ref(), "--baseline".as_ref(), &base, "--exact".as_ref()];
    let places: [&OsStr; 4] = ["--results".as_ref(), &results, "--out".as_ref(), &out];
    succeeds(folder.path(), &[&check[..], &places[..]].concat());
}

#[test]
fn the_next_command_can_be_copied_whatever_the_folder_is_called() {
    for results in [&b"$(id)"[..], b"spa ce", b"new\nline", b"it's", b"-x", b"a\x1b[31mb", b"res\xffults"] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = OsString::from_vec([b"--out=", results].concat());
        let mut args: Vec<&OsStr> = TOY.iter().map(OsStr::new).collect();
        args.extend(["--seeds", "0", "--curriculum", "teach"].map(OsStr::new));
        args.push(&out);
        let told = stdout(&succeeds(folder.path(), &args));
        let (_, next) = told.trim_end().split_once("next: goalbench ").expect("a hint");
        let script = format!("\"$0\" {next}");
        let output = Command::new("bash")
            .args(["-c", &script, env!("CARGO_BIN_EXE_goalbench")])
            .env("LC_ALL", "C.UTF-8")
            .current_dir(folder.path())
            .output()
            .expect("it starts");
        assert!(output.status.success(), "{next}: {}", stderr(&output));
        let report = folder.path().join(OsStr::from_bytes(results)).join("report");
        assert!(report.is_dir(), "{next}");
    }
}
