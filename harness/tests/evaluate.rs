//! `evaluate` from the command line.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use agents::Mode;
use envs::rng::{Purpose, stream};
use goalbench::run::{checkpoint, folder};
use reports::store::checksums::manifest_hash;
use reports::store::layout;
use serde_json::Value;
use support::{goalbench, stderr, stdout, toy};

fn text(path: &Path) -> &str {
    path.to_str().expect("a test path is UTF-8")
}

fn run(results: &Path, curriculum: &str, seed: u64) -> PathBuf {
    results.join(format!("runs/Point/{curriculum}/default/seed-{seed}"))
}

/// The JSON lines that `evaluate` prints for `path` with further options; it must succeed.
fn lines(path: &Path, more: &[&str]) -> Vec<Value> {
    let output = goalbench(&[&["evaluate", text(path), "--json"], more].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output).lines().map(|line| serde_json::from_str(line).expect("every line is JSON")).collect()
}

/// Every file below `folder` with its bytes and the time of its last change.
fn files(folder: &Path) -> BTreeMap<PathBuf, (Vec<u8>, std::time::SystemTime)> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            let changed = fs::metadata(&path).and_then(|file| file.modified()).expect("a time");
            found.insert(path.clone(), (fs::read(&path).expect("a file"), changed));
        }
    }
    found
}

/// Successes and mean return of the student in `folder` over the episodes of `seed`, one after the other.
fn one_by_one(folder: &Path, episodes: u64, seed: u64) -> (u64, f64) {
    agents::prepare_thread();
    let (manifest, config) = folder::read_manifest(folder).expect("a manifest");
    let saved = checkpoint::read(folder, &manifest).expect("a sound checkpoint").expect("a checkpoint");
    let mut env = envs::make("Point", &envs::EnvOptions::default()).expect("a built-in environment");
    // Weights of another seed: none of them may be left.
    let mut agent = agents::make(&config.student, env.spec(), 77).expect("a student");
    agent.load_policy(saved.trainer.student()).expect("its state");
    let mut rng = stream(seed, Purpose::FinalEvaluation);
    let (mut successes, mut total_return) = (0, 0.0);
    let mut action = vec![0.0; env.spec().action];
    for _ in 0..episodes {
        env.reset(&mut rng).expect("a stable start");
        for _ in 0..env.spec().horizon {
            agent.act(env.observation(), env.goal(), Mode::Greedy, &mut action).expect("finite actions");
            env.step(&action).expect("a stable step");
            total_return += env.reward(&env.observation().achieved, env.goal());
        }
        successes += u64::from(env.success(&env.observation().achieved, env.goal()));
    }
    (successes, total_return / episodes as f64)
}

#[test]
fn numbers_are_those_of_the_greedy_policy_whatever_the_number_of_jobs() {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let results = temporary.path();
    toy(results, &[]);
    let before = files(results);
    let with =
        |jobs| goalbench(&["evaluate", text(results), "--episodes", "250", "--seed", "5", "--jobs", jobs]);
    let (one, three) = (with("1"), with("3"));
    assert!(one.status.success(), "{}", stderr(&one));
    assert_eq!((stdout(&one), stderr(&one)), (stdout(&three), String::new()));

    let options = ["--episodes", "250", "--seed", "5", "--jobs"];
    let found = lines(results, &[&options[..], &["1"]].concat());
    assert_eq!(found, lines(results, &[&options[..], &["3"]].concat()));
    let runs = [("her-iid", 0), ("her-iid", 1), ("teach", 0), ("teach", 1)];
    assert_eq!(found.len(), runs.len());
    for (line, (curriculum, seed)) in found.iter().zip(runs) {
        assert_eq!((&line["curriculum"], &line["seed"]), (&curriculum.into(), &seed.into()), "{line}");
        assert_eq!((&line["step"], &line["steps"]), (&400.into(), &400.into()), "{line}");
        assert_eq!((&line["episodes"], &line["episode_seed"]), (&250.into(), &5.into()), "{line}");
        let folder = run(results, curriculum, seed);
        assert_eq!(line["folder"], text(&folder));
        let (successes, mean_return) = one_by_one(&folder, 250, 5);
        assert_eq!((&line["successes"], &line["mean_return"]), (&successes.into(), &mean_return.into()));
        let rate = successes as f64 / 250.0;
        assert_eq!(line["success_rate"], rate);
        let bound = |name: &str| line[name].as_f64().expect("a number");
        assert!(0.0 <= bound("ci_low") && bound("ci_low") <= rate && rate <= bound("ci_high"), "{line}");
        let row = format!("{:>17} {:>8} {successes:>9} {rate:>8.4}", "400/400", 250);
        assert!(stdout(&one).contains(&row), "{row} in\n{}", stdout(&one));
    }
    let scores = |lines: &[Value]| lines.iter().map(|line| line["mean_return"].clone()).collect::<Vec<_>>();
    let other_seed = lines(results, &["--episodes", "250", "--seed", "6"]);
    assert_ne!(scores(&found), scores(&other_seed), "other starts and goals");
    assert!(files(results) == before, "results are read only");
}

#[test]
fn seeds_are_summed_up_by_mean_and_sample_deviation() {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let results = temporary.path();
    toy(results, &["--seeds", "0..3"]);
    for seed in [1, 2] {
        fs::remove_dir_all(run(results, "teach", seed)).expect("a run");
    }
    let options = ["--episodes", "40"];
    let returns: Vec<f64> = lines(results, &options)
        .iter()
        .filter(|line| line["curriculum"] == "her-iid")
        .map(|line| line["mean_return"].as_f64().expect("a number"))
        .collect();
    let mean = (returns[0] + returns[1] + returns[2]) / 3.0;
    let deviation = (returns.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 2.0).sqrt();
    assert!(deviation > 0.0, "{returns:?}");
    let output = goalbench(&[&["evaluate", text(results)], &options[..]].concat());
    let (_, summary) = stdout(&output)
        .split_once("mean ± standard deviation over seeds (ddof 1)")
        .map(|(table, summary)| (table.to_owned(), summary.to_owned()))
        .expect("a summary");
    let expected = format!("{mean:.3} ± {deviation:.3}");
    let row = summary.lines().find(|line| line.starts_with("Point/her-iid/default ")).expect("a row");
    assert!(row.ends_with(&expected), "{expected} in {row}");
    assert!(!summary.contains("teach"), "one seed has no deviation: {summary}");
}

/// The policy of one run under the name of another seed and curriculum.
#[test]
fn all_runs_of_an_environment_meet_the_same_episodes() {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let results = temporary.path();
    toy(results, &["--seeds", "0"]);
    let source = run(results, "teach", 0);
    let (mut manifest, _) = folder::read_manifest(&source).expect("a manifest");
    let mut saved = checkpoint::read(&source, &manifest).expect("sound").expect("a checkpoint");
    manifest.run.variant = "copy".into();
    manifest.run.seed = 9;
    manifest.hash = manifest_hash(&manifest.run, &manifest.config);
    saved.run.clone_from(&manifest.hash);
    let copy = results.join("runs/Point/teach/copy/seed-9");
    folder::create(&copy, &manifest).expect("the test folder can be written");
    checkpoint::write(&copy, &saved).expect("the test folder can be written");
    let found = lines(results, &["--episodes", "500"]);
    let [other, copied, original] = &found[..] else { panic!("{found:?}") };
    assert_eq!((&copied["seed"], &original["seed"]), (&9.into(), &0.into()));
    for number in ["successes", "mean_return"] {
        assert_eq!(copied[number], original[number], "{number}");
    }
    assert_ne!(other["mean_return"], original["mean_return"], "scores tell policies apart");
}

#[test]
fn runs_are_evaluated_once_and_each_results_folder_by_itself() {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let [a, b] = ["a", "b"].map(|name| temporary.path().join(name));
    toy(&a, &[]);
    let apart = b.join("kept/elsewhere");
    fs::create_dir_all(&apart).expect("the test folder can be written");
    for name in [layout::MANIFEST, checkpoint::CHECKPOINT] {
        fs::copy(run(&a, "teach", 0).join(name), apart.join(name)).expect("it can be copied");
    }
    let named = run(&a, "teach", 0);
    let again = a.join("runs/../");
    let paths = [&apart, &named, &a, &again].map(|path| text(path));
    let output = goalbench(&[&["evaluate", "--episodes", "20"], &paths[..]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stdout(&output);
    assert_eq!(said.matches("Point/teach/default/seed-0 ").count(), 2, "{said}");
    assert_eq!(said.matches("Point/teach/default/seed-1 ").count(), 1, "{said}");
    assert_eq!(said.matches("Point/teach/default ").count(), 1, "two seeds of one results folder: {said}");
    for place in [&a, &apart] {
        let place = place.canonicalize().expect("it is there");
        assert!(said.contains(&format!("{}\n", place.display())), "{said}");
    }
}

#[test]
fn runs_that_cannot_be_evaluated_are_left_out_of_a_results_folder_and_refused_by_themselves() {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let results = temporary.path();
    toy(results, &[]);
    let evaluate = |path: &Path| goalbench(&["evaluate", text(path), "--episodes", "20"]);
    let unusable = |folder: &Path, expected: &str, others: usize| {
        let (within, alone) = (evaluate(results), evaluate(folder));
        // A checkpoint that has not come yet is no damage.
        assert_eq!(within.status.code(), Some(if others == 3 { 0 } else { 1 }), "{}", stderr(&within));
        assert_eq!(stdout(&within).matches("/seed-").count(), others, "{}", stdout(&within));
        assert_eq!(alone.status.code(), Some(2), "{}", stderr(&alone));
        assert_eq!(stdout(&alone), "");
        for output in [&within, &alone] {
            let said = stderr(output);
            assert!(said.contains(text(folder)) && said.contains(expected), "{expected} in\n{said}");
        }
        within
    };

    let begun = run(results, "teach", 0);
    fs::remove_file(begun.join(checkpoint::CHECKPOINT)).expect("a checkpoint");
    unusable(&begun, "has not come to its first checkpoint yet", 3);

    let cut = run(results, "teach", 1);
    let whole = fs::read(cut.join(checkpoint::CHECKPOINT)).expect("a checkpoint");
    fs::write(cut.join(checkpoint::CHECKPOINT), &whole[..whole.len() / 2]).expect("it can be written");
    unusable(&cut, "checkpoint.bin: ", 2);

    let altered = run(results, "her-iid", 0);
    let manifest = fs::read_to_string(altered.join(layout::MANIFEST)).expect("a manifest");
    let changed = manifest.replacen("\"width\": 16", "\"width\": 17", 1);
    assert_ne!(changed, manifest);
    fs::write(altered.join(layout::MANIFEST), changed).expect("it can be written");
    unusable(&altered, "altered after it was written", 1);

    let foreign = run(results, "her-iid", 1);
    let manifest = fs::read_to_string(foreign.join(layout::MANIFEST)).expect("a manifest");
    fs::write(foreign.join(layout::MANIFEST), &manifest[..50]).expect("it can be written");
    let nothing = unusable(&foreign, "cut off or altered", 0);
    assert_eq!(stderr(&nothing).matches("left out: ").count(), 4, "{}", stderr(&nothing));
    assert!(stderr(&nothing).contains("no run was evaluated"), "{}", stderr(&nothing));
}

#[test]
fn a_run_in_the_place_of_another_is_left_out() {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let results = temporary.path();
    toy(results, &[]);
    for name in [layout::MANIFEST, checkpoint::CHECKPOINT] {
        fs::copy(run(results, "teach", 0).join(name), run(results, "teach", 1).join(name)).expect("a copy");
    }
    let output = goalbench(&["evaluate", text(results), "--episodes", "20"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert_eq!(stdout(&output).matches("/seed-").count(), 3, "not twice the same: {}", stdout(&output));
    assert!(stderr(&output).contains("belongs to the run Point/teach/default/seed-0"), "{}", stderr(&output));
}

#[test]
fn wrong_input_is_refused() {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let empty = text(temporary.path());
    let file = temporary.path().join("file");
    fs::write(&file, "").expect("the test folder can be written");
    for (args, expected) in [
        (vec!["/nowhere"], "/nowhere: cannot find this folder"),
        (vec![empty], "neither a run's folder, which holds manifest.json, nor a results folder"),
        (vec![text(&file)], "neither a run's folder"),
        (vec![], "<PATH>"),
        (vec![empty, "--episodes", "0"], "from 1 to 1000000"),
        (vec![empty, "--episodes", "1000001"], "from 1 to 1000000"),
        (vec![empty, "--jobs", "0"], "--jobs"),
    ] {
        let output = goalbench(&[&["evaluate"], &args[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(stderr(&output).contains(expected), "{args:?}: {}", stderr(&output));
    }
    fs::create_dir(temporary.path().join("runs")).expect("the test folder can be written");
    let output = goalbench(&["evaluate", empty]);
    assert_eq!(output.status.code(), Some(1), "a results folder without runs");
    assert!(stderr(&output).contains("no run was evaluated"), "{}", stderr(&output));
}
