//! A choice is made once: what was chosen, and by what, stays as long as runs with it do.

use std::fs;
use std::path::Path;

use reports::store::layout;

use super::support::{goalbench, refused, stderr, stdout, write_protocol};
use super::{SEARCH, TOY, everything, search, text};

/// Carries a search out.
fn searched(args: &[&str], out: &Path) {
    let output = goalbench(&[&["run", "--out", text(out), "-q"], args].concat());
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
}

#[test]
fn a_command_that_would_choose_by_something_else_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let with =
        |old: &str, new: &str| write_protocol(folder.path(), &format!("{TOY}{SEARCH}").replace(old, new));
    let path = with("", "");
    searched(&[&path], &out);
    let before = everything(&out);
    // Fewer curricula: the choice of the others stays.
    searched(&[&path, "--curriculum", "teach"], &out);
    searched(&[&path, "--curriculum", "plr,teach"], &out);
    assert_eq!(everything(&out), before);
    let again = |path: &str, more: &[&str], expected: &str| {
        for dry in [&[][..], &["--dry-run"]] {
            refused(
                &[&["run", path, "--out", text(&out)], more, dry].concat(),
                &["protocol.toml:", "choice.json", expected],
            );
        }
        assert_eq!(everything(&out), before);
    };
    again(&path, &["--env", "MazeA"], "another environments: Point there, MazeA here");
    again(&with("[search]", "[search]\nmeasure = 'final'"), &[], "another measure");
    again(
        &with("'100..102'", "'100..103'"),
        &[],
        "another seeds of trials: 100, 101 there, 100, 101, 102 here",
    );
    again(&with("trials = 2", "trials = 1"), &[], "another number of trials: 2 there, 1 here");
    let more = with("trials = 2", "trials = 3");
    again(&more, &["--curriculum", "teach"], "another number of trials: 2 there, 3 here");
    refused(&["run", &more, "--out", text(&out), "--extend"], &["--extend", "does not go with [search]"]);
    assert_eq!(everything(&out), before);
    // More trials are welcome. Until they have ended, what was chosen stands for what will be.
    let output = goalbench(&["run", &more, "--out", text(&out), "--dry-run"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    assert!(said.contains("4 runs (1600 steps) still to do"), "the new trials: {said}");
}

#[test]
fn machines_share_a_search_by_curriculum() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    let path = write_protocol(folder.path(), &format!("{TOY}{SEARCH}"));
    searched(&[&path], &at("whole"));
    searched(&[&path, "--curriculum", "teach"], &at("a"));
    searched(&[&path, "--curriculum", "plr,teach"], &at("b"));
    let merge = |sources: &[&str], out: &str| {
        let paths: Vec<String> = sources.iter().map(|name| text(&at(name)).to_owned()).collect();
        let paths: Vec<&str> = paths.iter().map(String::as_str).collect();
        let output = goalbench(&[&["merge"], &paths[..], &["--out", text(&at(out))]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
    };
    merge(&["a", "b"], "merged");
    let (whole, merged) = (search(&at("whole")), search(&at("merged")));
    for one in &merged.curricula {
        assert!(whole.curricula.contains(one), "{}", one.curriculum);
    }
    assert_eq!(merged.curricula.len(), 2);
    // A machine that has done trials alone.
    fs::remove_dir_all(layout::runs_dir(&at("a"))).expect("it can be removed");
    merge(&["a", "b"], "again");
    assert_eq!(everything(&at("again")), everything(&at("merged")));
    fs::remove_dir_all(layout::runs_dir(&at("b"))).expect("it can be removed");
    merge(&["b", "a"], "trials");
    assert!(stdout(&goalbench(&["status", text(&at("trials"))])).contains("phase 1 of 2"));
    assert!(fs::read_dir(layout::protocols_dir(&at("trials"))).expect("a folder").count() > 0);
}

#[test]
fn runs_with_settings_that_are_not_chosen_are_not_taken_for_chosen_ones() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let tuned = "[[variant]]\nlabel = 'tuned'\ncurricula = ['teach']\nset = { student.actor_lr = 0.01 }\n";
    searched(&[&write_protocol(folder.path(), &format!("{TOY}{tuned}")), "--curriculum", "teach"], &out);
    // A trial with the default setting is no better than the default setting.
    let even = "[search]\ntrials = 1\nseeds = [100]\n[[search.range]]\nfield = 'student.critic_lr'\nvalues = [1e-3]\n";
    let path = write_protocol(folder.path(), &format!("{TOY}{even}"));
    refused(
        &["run", &path, "--out", text(&out)],
        &["tuned/seed-0", "no trial of teach is better than the default settings"],
    );
    assert!(!layout::choice_file(&out).exists());
    refused(&["run", &path, "--out", text(&out), "--dry-run"], &["tuned/seed-0"]);
}

#[test]
fn a_damaged_choice_is_named_and_made_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let path = write_protocol(folder.path(), &format!("{TOY}{SEARCH}"));
    searched(&[&path], &out);
    let before = everything(&out);
    let choice = layout::choice_file(&out);
    fs::write(&choice, "garbage").expect("it can be written");
    let (archive, merged) = (folder.path().join("a.tar.zst"), folder.path().join("merged"));
    refused(&["pack", text(&out), "--out", text(&archive), "--policies", "none"], &["choice.json"]);
    refused(&["merge", text(&out), "--out", text(&merged)], &["choice.json"]);
    assert!(!archive.exists() && !merged.exists());
    let status = goalbench(&["status", text(&out), "--strict"]);
    assert_eq!(status.status.code(), Some(1));
    assert!(!stdout(&status).contains("settings are chosen"), "{}", stdout(&status));
    refused(&["run", &path, "--out", text(&out)], &["choice.json", "remove it"]);
    fs::remove_file(&choice).expect("it can be removed");
    searched(&[&path], &out);
    assert_eq!(everything(&out), before);
}
