//! What others put in place of files: pipes, links, text that terminals obey, and what killed processes left.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use reports::store::{RunFolder, layout};
use support::{stderr, stdout, toy, toy_args};

fn run(results: &Path) -> PathBuf {
    results.join("runs/Point/teach/default/seed-0")
}

fn finished() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    toy(folder.path(), &["--seeds", "0"]);
    folder
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

/// Runs goalbench with `args`; it must end by itself within a minute.
fn ends(args: &[&str]) -> Output {
    let output = Command::new("timeout")
        .args(["-k", "1", "60", env!("CARGO_BIN_EXE_goalbench")])
        .args(args)
        .output()
        .expect("the program starts");
    assert!(!matches!(output.status.code(), None | Some(124 | 137)), "{args:?} waits for ever");
    output
}

fn pipe(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status().expect("mkfifo starts");
    assert!(made.success());
}

#[test]
fn no_command_waits_for_a_pipe_in_place_of_a_file() {
    let folder = finished();
    let out = folder.path().with_extension("merged");
    let names = layout::FILES.iter().map(|row| row.name).filter(|name| *name != layout::REPLAY);
    for name in names.chain(["replay/episodes-0.bin"]) {
        let path = run(folder.path()).join(name);
        let kept = path.with_extension("kept");
        let was_there = fs::rename(&path, &kept).is_ok();
        fs::create_dir_all(path.parent().expect("it lies in a folder")).expect("it can be created");
        pipe(&path);
        let results = text(folder.path());
        let status = ends(&["status", results]);
        assert!(status.status.success(), "{}", stderr(&status));
        ends(&["report", results]);
        ends(&["evaluate", "--episodes", "2", results]);
        ends(&["merge", results, "--out", text(&out)]);
        ends(&["render", text(&run(folder.path())), "--out", text(&folder.path().join("x.gif"))]);
        ends(&toy_args(folder.path(), &["--seeds", "0"]));
        if [layout::MANIFEST, layout::RECORDS, layout::TEACHING, layout::CHECKPOINT].contains(&name) {
            assert!(stdout(&status).contains("it is a pipe; a regular file is expected"), "{name}");
        }
        let _ = fs::remove_dir_all(&out);
        fs::remove_file(&path).expect("a pipe");
        if was_there {
            fs::rename(&kept, &path).expect("it can be put back");
        }
    }
}

#[test]
fn no_input_file_may_be_a_pipe() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [protocol, traces] = ["p.toml", "traces"].map(|name| folder.path().join(name));
    pipe(&protocol);
    fs::create_dir(&traces).expect("it can be created");
    pipe(&traces.join("a.json.gz"));
    let out = folder.path().join("out");
    for (args, code) in [
        (&["run", text(&protocol), "--out", text(&out)][..], 2),
        (&["regress", "check", "--baseline", text(&protocol)], 2),
        (&["verify", text(&traces)], 1),
    ] {
        let output = ends(args);
        let said = stdout(&output) + &stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.contains("it is a pipe; a regular file is expected"), "{args:?}: {said}");
    }
    assert!(!out.exists());
}

#[test]
fn nothing_is_written_through_links() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [results, other] = ["results", "other"].map(|name| folder.path().join(name));
    fs::create_dir(&results).expect("it can be created");
    fs::write(&other, "precious").expect("it can be written");
    symlink(&other, results.join(".lock")).expect("it can be linked");
    let refused = ends(&toy_args(&results, &["--seeds", "0"]));
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("nothing is written through links"), "{}", stderr(&refused));
    fs::remove_file(results.join(".lock")).expect("a link");

    for name in [layout::LOCK, layout::RECORDS, layout::TEACHING, layout::TIMING] {
        fs::create_dir_all(run(&results)).expect("it can be created");
        symlink(&other, run(&results).join(name)).expect("it can be linked");
        let refused = ends(&toy_args(&results, &["--seeds", "0", "--retries", "0"]));
        // A lock beside nothing else belongs to no run: its link is removed, and the run begins anew.
        assert!(name == layout::LOCK || !refused.status.success(), "{name}");
        fs::remove_dir_all(run(&results)).expect("a run");
    }
    assert_eq!(fs::read_to_string(&other).expect("it is there"), "precious");
    toy(&results, &["--seeds", "0"]);
    let page = results.join("report/index.html");
    fs::create_dir(results.join("report")).expect("it can be created");
    symlink(&other, &page).expect("it can be linked");
    let refused = ends(&["report", text(&results)]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("index.html: is in the way"), "{}", stderr(&refused));
    // Reports replace links that lie in place of what a report before them wrote.
    fs::remove_file(&page).expect("a link");
    assert!(ends(&["report", text(&results)]).status.success());
    fs::remove_file(&page).expect("a page");
    symlink(&other, &page).expect("it can be linked");
    assert!(ends(&["report", text(&results)]).status.success());
    assert!(page.symlink_metadata().expect("a page").is_file());
    assert_eq!(fs::read_to_string(&other).expect("it is there"), "precious");
}

/// Runs goalbench as somebody whom permissions bind: root is not one, unless it gives that up.
fn bound(args: &[&str]) -> Output {
    let locked = tempfile::tempdir().expect("a temporary folder");
    permit(locked.path(), 0o000);
    let mut command = Command::new(env!("CARGO_BIN_EXE_goalbench"));
    if fs::read_dir(locked.path()).is_ok() {
        command = Command::new("setpriv");
        command.args(["--bounding-set=-dac_override,-dac_read_search", env!("CARGO_BIN_EXE_goalbench")]);
    }
    permit(locked.path(), 0o700);
    command.args(args).output().expect("goalbench starts, under setpriv where this is root")
}

fn permit(path: &Path, mode: u32) {
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("it is ours");
}

/// Of `results`, where one of two runs cannot be used or something hides others: every reader says each of
/// `expected` once, status and evaluation go on with the other run, and a merge writes nothing.
fn named_by_all(results: &Path, expected: &[&str]) {
    let out = results.with_extension("merged");
    let (text, out) = (text(results), text(&out));
    for (args, code) in [
        (&["status", text][..], 0),
        (&["status", "--strict", text], 1),
        (&["evaluate", "--episodes", "2", text, text], 1),
        (&["report", text], 1),
        (&["merge", text, "--out", out], 2),
    ] {
        let output = bound(args);
        let said = stdout(&output) + &stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        for part in expected {
            assert_eq!(said.matches(part).count(), 1, "{args:?}: expected {part:?} once in {said}");
        }
        let goes_on = ["status", "evaluate"].contains(&args[0]);
        assert!(!goes_on || said.contains("Point/her-iid/default/seed-0"), "{args:?}: {said}");
    }
    assert!(!Path::new(out).exists());
}

#[test]
fn links_that_lead_nowhere_are_no_missing_files() {
    let folder = finished();
    let (found, told) =
        ([layout::RECORDS, layout::TEACHING, layout::STUDENT], "it is a link that leads nowhere");
    for name in
        [layout::MANIFEST, layout::OUTCOME, layout::CHECKSUMS, layout::CHECKPOINT].into_iter().chain(found)
    {
        let path = run(folder.path()).join(name);
        let kept = path.with_extension("kept");
        fs::rename(&path, &kept).expect(name);
        symlink("nowhere", &path).expect("it can be linked");
        named_by_all(folder.path(), &[told]);
        let again = ends(&toy_args(folder.path(), &["--seeds", "0"]));
        // Nothing goes on from the checkpoint of a run that has ended.
        assert!(name == layout::CHECKPOINT || stderr(&again).contains(told), "{name}: {}", stderr(&again));
        fs::rename(&kept, &path).expect(name);
    }
}

#[test]
fn what_may_not_be_read_is_named_and_the_rest_goes_on() {
    let folder = finished();
    let seed = run(folder.path());
    permit(&seed, 0o000);
    named_by_all(folder.path(), &["Permission denied"]);
    assert_eq!(bound(&toy_args(folder.path(), &["--seeds", "0"])).status.code(), Some(2));
    permit(&seed, 0o700);
    let variant = folder.path().join("runs/Point/teach/default");
    permit(&variant, 0o000);
    named_by_all(folder.path(), &["runs/Point/teach/default: cannot be read: Permission denied"]);
    permit(&variant, 0o700);
    for name in ["loop", "runs/Point/loop"] {
        let link = folder.path().join("runs").join(name.trim_start_matches("runs/"));
        symlink(if name == "loop" { "loop" } else { ".." }, &link).expect("it can be linked");
        named_by_all(folder.path(), &["loop: cannot be read: "]);
        fs::remove_file(link).expect("a link");
    }
    permit(folder.path(), 0o000);
    for args in [&["status", text(folder.path())][..], &["evaluate", text(folder.path())]] {
        let refused = bound(args);
        assert_eq!(refused.status.code(), Some(2));
        assert!(stderr(&refused).contains("Permission denied"), "{}", stderr(&refused));
    }
    permit(folder.path(), 0o700);
}

#[test]
fn a_copied_folder_is_no_run_and_is_named() {
    let folder = finished();
    let copy = run(folder.path()).with_file_name("seed-0 (copy)");
    RunFolder::new(run(folder.path())).copy_to(&copy).expect("it can be copied");
    let results = text(folder.path());
    let home = tempfile::tempdir().expect("a temporary folder");
    let out = home.path().join("merged");
    let out = text(&out);
    for (args, code) in [
        (&["status", results][..], 0),
        (&["status", "--json", results], 0),
        (&["status", "--strict", results], 1),
        (&["report", results], 1),
        (&["evaluate", "--episodes", "2", results], 0),
        (&["merge", results, "--out", out], 0),
    ] {
        let output = ends(args);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {}", stderr(&output));
        assert!(stderr(&output).contains("seed-0 (copy)"), "{args:?}: {}", stderr(&output));
    }
    assert!(stdout(&ends(&["status", results])).contains("2 runs: 2 finished"));
    assert!(!Path::new(out).join("runs/Point/teach/default/seed-0 (copy)").exists());
}

#[test]
fn a_copied_run_that_has_a_run_s_name_is_no_run() {
    let folder = finished();
    RunFolder::new(run(folder.path()))
        .copy_to(&run(folder.path()).with_file_name("seed-5"))
        .expect("it can be copied");
    named_by_all(folder.path(), &["seed-5/manifest.json"]);
    assert!(stdout(&bound(&["status", text(folder.path())])).contains("3 runs: 2 finished, 1 damaged"));
}

#[test]
fn what_killed_processes_left_is_removed_by_the_next_and_nothing_else() {
    let folder = finished();
    assert!(ends(&["report", text(folder.path())]).status.success());
    let places = [run(folder.path()), folder.path().join("report"), folder.path().join("report/figures")];
    let held = run(folder.path()).join(".goalbench-held56789abc.new");
    let file = fs::File::create(&held).expect("it can be created");
    file.lock().expect("it can be locked");
    for place in &places {
        for name in [".goalbench-0123456789ab.new", ".tmpAbCdEf", ".goalbench-notes.new"] {
            fs::write(place.join(name), "half").expect("it can be written");
        }
    }
    toy(folder.path(), &["--seeds", "0"]);
    assert!(ends(&["report", text(folder.path())]).status.success());
    for place in &places {
        assert!(!place.join(".goalbench-0123456789ab.new").exists(), "{}", place.display());
        assert!(place.join(".tmpAbCdEf").exists() && place.join(".goalbench-notes.new").exists());
    }
    assert!(held.exists(), "somebody is writing it");
}

#[test]
fn control_characters_are_shown_and_not_obeyed() {
    let folder = finished();
    let reason = "\\u001b]0;owned\\u0007\\u001b[31mred\\u009b2J";
    let line = format!("{{\"attempt\":0,\"step\":null,\"reason\":\"{reason}\"}}\n");
    for name in [layout::OUTCOME, layout::CHECKSUMS] {
        fs::remove_file(run(folder.path()).join(name)).expect(name);
    }
    fs::write(run(folder.path()).join(layout::CRASHES), line).expect("it can be written");
    fs::create_dir_all(folder.path().join("runs/\u{1b}[32mgreen\u{7}/c/v/seed-0 (copy)"))
        .expect("it can be created");
    let results = text(folder.path());
    for args in [
        &["status", results][..],
        &["status", "--json", results],
        &["report", results],
        &["evaluate", "--episodes", "2", results],
        &["merge", results, "--out", text(&folder.path().with_extension("merged"))],
        &["status", "/nowhere/\u{1b}[31m"],
    ] {
        let output = ends(args);
        let said = stdout(&output) + &stderr(&output);
        let obeyed = said.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
        assert_eq!(obeyed, None, "{args:?}: {said:?}");
        // A merge that is refused names what keeps it from merging, which here has no strange name.
        assert!(args[0] == "merge" || said.contains("\\u001b["), "{args:?}: {said}");
        if args.contains(&"--json") {
            serde_json::from_str::<serde_json::Value>(&stdout(&output)).expect("JSON");
        }
    }
    for name in ["index.html", "summary.md"] {
        let page = fs::read_to_string(folder.path().join("report").join(name)).expect(name);
        assert!(!page.contains(['\u{1b}', '\u{7}', '\u{9b}']) && page.contains("owned"), "{name}");
    }
}
