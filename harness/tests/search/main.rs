//! A search over settings: what is refused, what it draws, its two phases, and what other commands make of
//! it.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod choice;
mod draws;
mod refusals;
#[path = "../support/mod.rs"]
mod support;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use reports::schema::Tuning;
use reports::store::{Results, Store, layout};
use rustix::process::Signal;
use support::children::{results, signal, start, workers};
use support::{goalbench, refused, stderr, stdout, write_protocol};

/// Runs of a fraction of a second.
const TOY: &str = "
name = 'toy-search'
environments = ['Point']
curricula = ['teach', 'her-iid', 'plr']
seeds = '0..2'
budget.steps = 400
evaluation = { every = 100, episodes = 10 }
pool.size = 20
student = { batch = 32, width = 16, updates_per_cycle = 4 }
";

const SEARCH: &str = "
[search]
trials = 2
seeds = '100..102'
[[search.range]]
field = 'curriculum.teach.window'
values = [3, 5, 10, 20]
[[search.range]]
curricula = ['teach', 'plr']
field = 'student.critic_lr'
low = 1e-4
high = 1e-2
log = true
";

fn text(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

fn search(path: &Path) -> Tuning {
    let bytes = fs::read(layout::choice_file(path)).expect("settings are chosen");
    serde_json::from_slice(&bytes).expect("a choice")
}

/// What both phases recorded, and what was chosen.
fn everything(path: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = results(path);
    let trials = results(&layout::tuning_dir(path)).into_iter();
    found.extend(trials.map(|(name, bytes)| (Path::new(layout::TUNING).join(name), bytes)));
    let choice = layout::choice_file(path);
    found.insert(Path::new(layout::TUNING).join(layout::CHOICE), fs::read(choice).expect("a choice"));
    found
}

#[test]
fn the_trials_come_first_then_the_chosen_settings_beside_the_default_ones() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, dry) = (folder.path().join("out"), folder.path().join("dry"));
    let path = write_protocol(folder.path(), &format!("{TOY}{SEARCH}"));
    let output = goalbench(&["run", &path, "--out", text(&dry), "--dry-run"]);
    let said = stdout(&output);
    assert!(output.status.success() && !dry.exists(), "{}", stderr(&output));
    // (1 + 2) · 2 curricula · 2 seeds; and 3 default and 2 tuned ones on 2 seeds.
    for part in
        ["phase 1 of 2", "12 runs, 4800 training steps", "phase 2 of 2", "10 runs, 4000 training steps"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert_eq!(said.matches("core-hours").count(), 2, "both phases have a price: {said}");
    let output = goalbench(&["run", &path, "--out", text(&out)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let choice = search(&out);
    let ids: Vec<&str> = choice.curricula.iter().map(|one| one.curriculum.as_str()).collect();
    assert_eq!((ids.as_slice(), choice.trials), (&["teach", "her-iid", "plr"][..], 2));
    assert!(choice.curricula[1].tried.is_empty() && choice.curricula[1].reason.contains("no range"));
    let trials = Store::read(&layout::tuning_dir(&out)).expect("results");
    let seeds: BTreeSet<u64> = trials.runs().iter().map(|run| run.key().seed).collect();
    assert_eq!((trials.runs().len(), seeds), (12, BTreeSet::from([100, 101])));
    let fresh = Store::read(&out).expect("results");
    assert!(
        fresh.runs().iter().all(|run| run.key().seed < 2),
        "no seed of the search is one of the experiment"
    );
    for one in choice.curricula.iter().filter(|one| !one.tried.is_empty()) {
        let labels: Vec<&str> = one.tried.iter().map(|trial| trial.variant.as_str()).collect();
        assert_eq!(labels, ["default", "trial-01", "trial-02"]);
        let best = one.tried.iter().map(|trial| trial.score).fold(0.0, f64::max);
        let first = one.tried.iter().find(|trial| trial.score == best).expect("one of them is best");
        assert_eq!(one.chosen, first.variant, "the best, of equal ones the first");
        assert!(one.reason.contains(&format!("{best:.4}")), "{}", one.reason);
        // The runs of the choice have its settings, and no others have.
        let tuned: Vec<_> = fresh
            .runs()
            .iter()
            .filter(|run| run.key().curriculum == one.curriculum && run.key().variant == "tuned")
            .collect();
        assert_eq!(tuned.len(), if one.chosen == "default" { 0 } else { 2 });
        for (run, (field, value)) in
            tuned.iter().flat_map(|run| first.settings.iter().map(move |one| (run, one)))
        {
            let pointer = format!("/{}", field.replace('.', "/"));
            assert_eq!(run.manifest.config.pointer(&pointer), Some(value), "{field}");
        }
        // What the choice says of a run is what the run recorded.
        for trial in &one.tried {
            let scores = trials
                .runs()
                .iter()
                .filter(|run| run.key().curriculum == one.curriculum && run.key().variant == trial.variant);
            let areas: Vec<f64> = scores
                .map(|run| reports::analysis::scores::area_under_curve(&run.records).expect("evaluations"))
                .collect();
            assert_eq!(trial.places[0].by_seed, areas, "{}", trial.variant);
        }
    }
    other_commands_know_both_phases(folder.path(), &out);
}

fn other_commands_know_both_phases(folder: &Path, out: &Path) {
    let output = goalbench(&["status", text(out)]);
    let said = stdout(&output);
    for part in
        ["phase 1 of 2: trials; settings are chosen", "12 runs: 12 finished", "phase 2 of 2", "/tuned/seed-0"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    let output = goalbench(&["status", text(out), "--json"]);
    let json: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(
        (&json["trials"]["chosen"], &json["trials"]["counts"]["finished"]),
        (&true.into(), &12.into())
    );
    assert!(goalbench(&["report", text(out), "-q"]).status.success());
    let csv = fs::read_to_string(layout::report_dir(out).join("trials.csv")).expect("the trials");
    assert_eq!(csv.lines().count(), 1 + 2 * 3, "a row for each of two curricula's settings");
    // Trials are results like any others.
    assert!(goalbench(&["report", text(&layout::tuning_dir(out)), "-q"]).status.success());
    let merged = folder.join("merged");
    let output = goalbench(&["merge", text(out), "--out", text(&merged)]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(everything(&merged), everything(out));
    let archive = folder.join("packed.tar.zst");
    let output = goalbench(&["pack", text(out), "--out", text(&archive), "--policies", "none"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let sums =
        String::from_utf8_lossy(&zstd::decode_all(fs::File::open(&archive).expect("it")).expect("zstd"))
            .into_owned();
    assert!(sums.contains("tuning/choice.json") && !sums.contains("trial-01/seed-100/records"));
    // The same search again changes nothing, and one of other settings is not taken for it.
    let before = everything(out);
    let path = write_protocol(folder, &format!("{TOY}{SEARCH}"));
    assert!(goalbench(&["run", &path, "--out", text(out), "-q"]).status.success());
    assert_eq!(everything(out), before);
    let path = write_protocol(folder, &format!("{TOY}{}", SEARCH.replace("[search]", "[search]\nseed = 1")));
    refused(&["run", &path, "--out", text(out)], &["another seed of draws: 0 there, 1 here"]);
    assert_eq!(everything(out), before);
}

/// Waits until `is_there`, or the program has ended.
fn wait_until(program: &mut std::process::Child, is_there: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_there() && program.try_wait().expect("it was started here").is_none() {
        assert!(begun.elapsed() < Duration::from_secs(120), "waited two minutes");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn killed_in_either_phase_and_between_them_it_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, undisturbed) = (folder.path().join("out"), folder.path().join("undisturbed"));
    let path = write_protocol(folder.path(), &format!("{TOY}{SEARCH}"));
    assert!(goalbench(&["run", &path, "--out", text(&undisturbed), "-q"]).status.success());
    let outcomes = |results: &Path| -> usize {
        let runs = Results::new(results).survey().map(|survey| survey.runs).unwrap_or_default();
        runs.iter().filter(|run| run.file(layout::OUTCOME).is_file()).count()
    };
    let trials = layout::tuning_dir(&out);
    let is_second = || layout::runs_dir(&out).exists();
    let moments: [(&str, &dyn Fn() -> bool); 5] = [
        ("a first trial", &|| outcomes(&trials) >= 1),
        ("half of them", &|| outcomes(&trials) >= 6),
        ("all of them", &|| outcomes(&trials) == 12),
        ("the choice", &|| layout::choice_file(&out).exists()),
        ("a run of the second phase", &|| outcomes(&out) >= 1),
    ];
    let mut kills = 0;
    for (moment, has_come) in moments {
        let mut parent = start(&["run", &path, "--out", text(&out), "--jobs", "2"]);
        wait_until(&mut parent, has_come);
        if is_second() {
            assert_eq!(
                outcomes(&trials),
                12,
                "{moment}: the second phase has begun before the first had ended"
            );
            assert!(layout::choice_file(&out).exists(), "{moment}: and before settings were chosen");
        }
        kills += usize::from(parent.try_wait().expect("it was started here").is_none());
        let children = workers(parent.id());
        signal(parent.id(), Signal::KILL);
        children.into_iter().for_each(|worker| signal(worker, Signal::KILL));
        parent.wait().expect("it was started here");
        if !is_second() {
            refused(&["report", text(&out)], &["holds the trials of a search and nothing else yet"]);
            let said = stdout(&goalbench(&["status", text(&out)]));
            assert!(said.contains("phase 1 of 2") && said.contains("no runs yet"), "{said}");
        }
    }
    assert!(kills >= 3, "{kills} kills came before the end");
    let output = goalbench(&["run", &path, "--out", text(&out), "-q"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(everything(&out), everything(&undisturbed));
    // Lanes are no other search.
    let lanes = folder.path().join("lanes");
    let output = goalbench(&["run", &path, "--out", text(&lanes), "-q", "--lanes", "4"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(everything(&lanes), everything(&undisturbed));
}

#[test]
fn the_example_runs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/search.toml");
    let out = folder.path().join("out");
    let mut args = vec!["run", text(&example), "--out", text(&out), "-q", "--steps", "400"];
    for setting in [
        "evaluation.every=200",
        "evaluation.episodes=4",
        "student.width=8",
        "student.batch=16",
        "pool.size=20",
        "student.updates_per_cycle=2",
    ] {
        args.extend(["--set", setting]);
    }
    let output = goalbench(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    let choice = search(&out);
    assert!(choice.curricula.iter().all(|one| one.tried.len() == 5), "every curriculum has a range");
    assert!(goalbench(&["report", text(&out), "-q"]).status.success());
}
