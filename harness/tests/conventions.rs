//! What users of other command lines expect: completions, pages of the manual, how much is said, and the same
//! words for the same thing.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use support::{goalbench, refused, stderr, stdout, toy_args};

fn text(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

#[test]
fn completions_of_every_shell_name_commands_and_options_and_no_hidden_ones() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = goalbench(&["completions", shell]);
        assert!(output.status.success(), "{shell}: {}", stderr(&output));
        let script = stdout(&output);
        for expected in ["evaluate", "export", "dry-run", "policies"] {
            assert!(script.contains(expected), "{shell}: no {expected}");
        }
        for hidden in ["try-cuda", "try-runs"] {
            assert!(!script.contains(hidden), "{shell}: {hidden}");
        }
    }
    refused(&["completions", "ksh"], &["ksh", "bash", "powershell"]);
}

/// What bash itself offers after `goalbench WORDS`.
fn offered(words: &[&str]) -> Vec<String> {
    let script = stdout(&goalbench(&["completions", "bash"]));
    let line: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
    let last = words.last().expect("a word");
    let asked = format!(
        "{script}\nCOMP_WORDS=(goalbench {}); COMP_CWORD={}\n_goalbench goalbench '{last}' x\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"",
        line.join(" "),
        words.len(),
    );
    let mut bash = Command::new("bash");
    let mut process =
        bash.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("bash, which CI's scripts need");
    std::io::Write::write_all(&mut process.stdin.take().expect("its input"), asked.as_bytes())
        .expect("it reads");
    let output = process.wait_with_output().expect("it ends");
    stdout(&output).lines().map(str::to_owned).collect()
}

#[test]
fn bash_completes_commands_and_options() {
    assert_eq!(offered(&["re"]), ["report", "render", "regress"]);
    assert_eq!(offered(&["pack", "--pol"]), ["--policies"]);
    assert_eq!(offered(&["regress", "rec"]), ["record"]);
}

#[test]
fn the_manual_has_a_page_for_every_command_and_none_for_hidden_ones() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = folder.path().join("man1");
    let output = goalbench(&["man", text(&place)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let mut pages: Vec<String> = fs::read_dir(&place)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
        .collect();
    pages.sort();
    for expected in ["goalbench.1", "goalbench-run.1", "goalbench-regress-check.1", "goalbench-pack.1"] {
        assert!(pages.iter().any(|page| page == expected), "no {expected} in {pages:?}");
    }
    assert!(pages.iter().all(|page| !page.contains("worker") && !page.contains("try-")), "{pages:?}");
    let mut printed: Vec<String> =
        stdout(&output).lines().map(|line| line.rsplit('/').next().unwrap_or_default().to_owned()).collect();
    printed.sort();
    assert_eq!(printed, pages);
    let page = fs::read_to_string(place.join("goalbench-run.1")).expect("a page");
    assert!(page.contains(".TH") && page.contains("retry"), "{page}");
    fs::write(folder.path().join("file"), "").expect("it can be written");
    refused(&["man", text(&folder.path().join("file"))], &["DIR", "is no folder"]);
}

#[test]
fn quiet_runs_say_nothing_but_the_result_and_what_goes_wrong() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("results");
    let output = goalbench(&toy_args(&out, &["--quiet"]));
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    assert!(stdout(&output).contains("4 runs finished"), "{}", stdout(&output));
    // A learning rate with which the student's numbers leave their range.
    let bad = folder.path().join("bad");
    let wild = ["-q", "--set", "student.critic_lr=1e30", "--set", "student.actor_lr=1e30"];
    let output = goalbench(&toy_args(&bad, &wild));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("FAILED at step").count(), 4, "{}", stderr(&output));
    assert!(!stderr(&output).contains("success 0."), "{}", stderr(&output));
    for command in ["evaluate", "report"] {
        let output = goalbench(&[command, text(&out), "-q"]);
        assert!(output.status.success() && stderr(&output).is_empty(), "{command}: {}", stderr(&output));
        assert_eq!(stdout(&output).is_empty(), command == "report");
    }
    refused(&toy_args(&out, &["-q", "-v"]), &["--quiet", "--verbose"]);
    refused(&toy_args(&out, &["-q", "--json"]), &["--quiet", "--json"]);
}

/// What a terminal is sent by `line`; `script` makes one.
fn on_a_terminal(line: &str, environment: &[(&str, &str)]) -> String {
    let output = Command::new("script")
        .args(["--quiet", "--return", "--command", line, "/dev/null"])
        .env_remove("NO_COLOR")
        .env("TERM", "xterm")
        .envs(environment.iter().copied())
        .stdin(Stdio::null())
        .output()
        .expect("script of util-linux, which Debian always has");
    stdout(&output)
}

#[test]
fn colours_are_for_terminals_whose_users_want_them() {
    let wrong = format!("'{}' run --no-such-option", env!("CARGO_BIN_EXE_goalbench"));
    assert!(on_a_terminal(&wrong, &[]).contains("\x1b["));
    for plain in [("NO_COLOR", "1"), ("TERM", "dumb")] {
        let sent = on_a_terminal(&wrong, &[plain]);
        assert!(sent.contains("--no-such-option") && !sent.contains('\x1b'), "{plain:?}: {sent:?}");
    }
    let help = format!("'{}' --help", env!("CARGO_BIN_EXE_goalbench"));
    assert!(!on_a_terminal(&help, &[("NO_COLOR", "1")]).contains('\x1b'));
}

#[test]
fn verbose_runs_tell_of_every_evaluation_on_terminals() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let args: Vec<String> =
        toy_args(folder.path(), &["-v", "--seeds", "0"]).iter().map(|arg| format!("'{arg}'")).collect();
    let sent = on_a_terminal(
        &format!("stty cols 120; '{}' {}", env!("CARGO_BIN_EXE_goalbench"), args.join(" ")),
        &[],
    );
    assert_eq!(sent.matches("  step ").count(), 10, "two runs of five evaluations: {sent}");
    assert!(!sent.contains('\x1b'), "{sent:?}");
}

#[test]
fn run_record_and_check_take_protocols_the_same_way() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| text(&folder.path().join(name)).to_owned();
    let (protocol, baseline, results) = (place("p.toml"), place("b.json"), place("r"));
    let written = "name = 'x'\nenvironments = ['Point']\ncurricula = ['her-iid']\nseeds = '0..2'\n\
                   budget.steps = 400\nstudent = { batch = 8, width = 8 }\n";
    fs::write(&protocol, written).expect("a protocol can be written");
    let works = |args: &[&str]| {
        let output = goalbench(args);
        assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    };
    works(&["run", &protocol, "--out", &results, "-q"]);
    works(&["run", "--protocol", &protocol, "--out", &results, "-q"]);
    works(&["regress", "record", "--protocol", &protocol, "--out", &baseline, "--results", &results]);
    works(&["regress", "record", &protocol, "--out", &baseline, "--results", &results]);
    let check = ["regress", "check", "--baseline", &baseline, "--exact", "--results", &results];
    for given in [vec![], vec![protocol.as_str()], vec!["--protocol", &protocol]] {
        works(&[&check[..], &given].concat());
    }
    refused(
        &[&check[..], &["--preset", "smoke"]].concat(),
        &["preset smoke is not the protocol", "record the baseline again"],
    );
    fs::write(&protocol, written.replace("400", "500")).expect("a protocol can be written");
    refused(&[&check[..], &[&protocol]].concat(), &["is not the protocol that", &baseline]);
    for command in [&["run"][..], &["regress", "record", "--out", &baseline], &check] {
        refused(&[command, &[&protocol, "--preset", "smoke"]].concat(), &["cannot be used with"]);
        refused(
            &[command, &["--protocol", "/nowhere.toml"]].concat(),
            &["/nowhere.toml", "read this protocol"],
        );
        refused(&[command, &["--preset", "smok"]].concat(), &["did you mean `smoke`?"]);
    }
}
