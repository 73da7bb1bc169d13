//! What cannot be searched, and what is only named.

use super::support::{goalbench, refused, stderr, stdout, write_protocol};
use super::{SEARCH, TOY, text};

#[test]
fn what_cannot_be_searched_is_refused_with_its_place_and_what_is_accepted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let range =
        |text: &str| format!("{TOY}\n[search]\ntrials = 2\nseeds = [100]\n[[search.range]]\n{text}\n");
    let window = "field = 'curriculum.teach.window'\nvalues = [3]";
    let with = |head: &str| format!("{TOY}\n[search]\n{head}\n[[search.range]]\n{window}\n");
    let cases: Vec<(String, &[&str])> = vec![
        (
            with("trials = 2\nseeds = [100, 1]"),
            &["protocol.toml:11:", "seed 1 is one of the search and of the experiment"],
        ),
        (with("trials = 0\nseeds = [100]"), &["protocol.toml:12:", "search.trials", "must be 1 to 1000"]),
        (with("trials = 2\nseeds = []"), &["search.seeds", "empty"]),
        (with("trials = 2\nseeds = '9..3'"), &["search.seeds"]),
        (with("seeds = [100]"), &["search", "`trials` is missing"]),
        (with("trials = 2\nseeds = [100]\nmeasure = 'best'"), &["search.measure", "area, final"]),
        (format!("{TOY}\n[search]\ntrials = 2\nseeds = [100]\n"), &["needs at least one"]),
        (
            range("field = 'student.critic_lr'\nlow = 2.0\nhigh = 1.0"),
            &["protocol.toml:14:", "`low` must be below `high`"],
        ),
        (
            range("field = 'student.critic_lr'\nlow = 0.0\nhigh = 1.0\nlog = true"),
            &["must be above 0 for draws"],
        ),
        (range("field = 'student.critic_lr'\nlow = 0.1\nhigh = inf"), &["must be finite numbers"]),
        (
            range("field = 'student.critic_lr'\nlow = 0.1"),
            &["no clear range", "accepted: `values`, or `low` and `high`"],
        ),
        (range("field = 'curriculum.teach.window'\nvalues = []"), &["is empty; name at least one"]),
        (
            range("field = 'curriculum.teach.windw'\nvalues = [3]"),
            &["protocol.toml:14:", "did you mean `window`?"],
        ),
        (range("field = 'curriculum.teech.window'\nvalues = [3]"), &["did you mean `teach`?"]),
        (range("field = 'student'\nvalues = [3]"), &["is no path of a setting"]),
        (
            range("field = 'budget.steps'\nvalues = [3]"),
            &["all runs of an experiment have the same `budget`"],
        ),
        (
            range("curricula = ['plr']\nfield = 'curriculum.teach.window'\nvalues = [3]"),
            &["is a setting of `teach`, which runs of `plr` do not use"],
        ),
        (range("curricula = ['tech']\nfield = 'student.polyak'\nvalues = [0.5]"), &["did you mean `teach`?"]),
        // Outside of what the field takes: one of the values, and an end.
        (
            range("field = 'curriculum.teach.window'\nvalues = [3, 1]"),
            &["protocol.toml:14:", "curriculum.teach.window:"],
        ),
        (range("field = 'student.polyak'\nlow = 0.5\nhigh = 1.5"), &["protocol.toml:14:", "student.polyak:"]),
        (range("field = 'curriculum.teach.window'\nlow = 2.5\nhigh = 7"), &["must be a whole number"]),
        (
            range("field = 'curriculum.teach.confidence'\nlow = 1\nhigh = 2"),
            &["curriculum.teach.confidence", "must be one of"],
        ),
        (
            range(&format!("{window}\n[[search.range]]\n{window}")),
            &["protocol.toml:17:", "are ranges of one setting"],
        ),
        (
            range(&format!("{window}\n[[variant]]\nlabel = 'x'")),
            &["a protocol with a search has no variants of its own"],
        ),
        (
            range("field = 'curriculum.vds.polyak'\nvalues = [7]"),
            &["protocol.toml:14:", "curriculum.vds.polyak"],
        ),
        (
            range("field = 'curriculum.vds.polyak'\nvalues = [0.5]"),
            &["no range is one of teach, her-iid, plr"],
        ),
    ];
    for (protocol, expected) in cases {
        let path = write_protocol(folder.path(), &protocol);
        refused(&["run", &path, "--out", text(&out)], expected);
        assert!(!out.exists(), "nothing is written: {expected:?}");
    }
}

#[test]
fn options_that_do_not_fit_a_search_are_refused_and_ranges_without_runs_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let path = write_protocol(folder.path(), &format!("{TOY}{SEARCH}"));
    refused(&["run", &path, "--out", text(&out), "--seeds", "99..101"], &["seed 100 is one of the search"]);
    let fixed = ["run", &path, "--out", text(&out), "--set", "curriculum.teach.window=4"];
    refused(&fixed, &["--set curriculum.teach.window=4", "is searched over"]);
    let baseline = folder.path().join("b.json");
    refused(&["regress", "record", &path, "--out", text(&baseline)], &["leave out [search]"]);
    // Only what no run has is a warning.
    let idle = format!("{TOY}{SEARCH}\n[[search.range]]\nfield = 'curriculum.vds.polyak'\nvalues = [0.5]\n");
    let path = write_protocol(folder.path(), &idle);
    let output = goalbench(&["run", &path, "--out", text(&out), "--print-config"]);
    assert!(
        output.status.success() && stderr(&output).contains("this range changes nothing"),
        "{}",
        stderr(&output)
    );
    let printed = stdout(&output);
    for kind in ["Point/teach/default", "Point/teach/trial-02", "Point/plr/trial-01", "Point/her-iid/default"]
    {
        assert!(printed.contains(kind), "{kind}");
    }
    assert!(!printed.contains("her-iid/trial"), "without a range there is nothing to draw");
}
