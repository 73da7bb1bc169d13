//! Teachers that watch: without a trace in anything else that a run records, and never in its way.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod support;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::Duration;

use reports::schema::{Manifest, Shadowing};
use reports::store::{RunFolder, layout};
use support::children::{files, kill_again_and_again, start};
use support::{goalbench, refused, stderr, toy, toy_args};

/// Long enough to be killed in. A teacher of the pool, one whose rollouts lie between evaluations and one
/// whose goals are the environment's own.
const LONGER: [&str; 22] = [
    "--curriculum",
    "teach,sfl,her-iid",
    "--set",
    "curriculum.sfl.interval=10",
    "--set",
    "curriculum.sfl.candidates=10",
    "--set",
    "curriculum.sfl.kept=3",
    "--set",
    "curriculum.alp-gmm.fit_every=20",
    "--set",
    "curriculum.vds.batch=16",
    "--set",
    "curriculum.vds.members=2",
    "--set",
    "frontier.every=4",
    "--steps",
    "1600",
    "--set",
    "evaluation.every=200",
    "--seeds",
    "0",
];

const OTHERS: [&str; 5] =
    [layout::RECORDS, layout::TEACHING, layout::STUDENT, layout::FRONTIER, layout::OUTCOME];
const ALL: [&str; 6] =
    [layout::RECORDS, layout::TEACHING, layout::STUDENT, layout::FRONTIER, layout::SHADOW, layout::OUTCOME];

fn longer(more: &[&'static str]) -> Vec<&'static str> {
    LONGER.iter().chain(more).copied().collect()
}

fn run_of(folder: &Path, curriculum: &str) -> RunFolder {
    RunFolder::new(folder.join(format!("runs/Point/{curriculum}/default/seed-0")))
}

fn shadows(folder: &Path, curriculum: &str) -> Vec<Shadowing> {
    run_of(folder, curriculum).shadowing().expect("sound records of shadows")
}

fn manifest(folder: &Path, curriculum: &str) -> Manifest {
    run_of(folder, curriculum).manifest().expect("sound").expect("a manifest")
}

#[test]
fn shadows_change_nothing_else_and_come_out_the_same_killed_or_in_lanes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name);
    toy(&place("plain"), &longer(&[]));
    toy(&place("watched"), &longer(&["--shadow", "all"]));
    assert_eq!(files(&place("watched"), &OTHERS), files(&place("plain"), &OTHERS));
    for curriculum in ["teach", "sfl", "her-iid"] {
        assert!(!run_of(&place("plain"), curriculum).has(layout::SHADOW).expect("it can be asked"));
        check(&shadows(&place("watched"), curriculum), curriculum);
    }

    let expected = files(&place("watched"), &ALL);
    toy(&place("lanes"), &longer(&["--shadow", "all", "--lanes", "3", "--jobs", "1"]));
    assert_eq!(files(&place("lanes"), &ALL), expected, "as lanes of a cohort");

    let (killed, args) = (place("killed"), longer(&["--shadow", "all"]));
    let run = run_of(&killed, "teach");
    let names = [layout::RECORDS, layout::SHADOW];
    kill_again_and_again(&toy_args(&killed, &args), (&run, &names), 6, Duration::from_millis(23));
    toy(&killed, &longer(&["--shadow", "all"]));
    assert_eq!(files(&killed, &ALL), expected, "killed and gone on with");

    // Whoever else watches, a shadow does the same.
    toy(&place("two"), &longer(&["--curriculum", "teach", "--shadow", "plr,vds,teach"]));
    let two = shadows(&place("two"), "teach");
    for (line, of_all) in two.iter().zip(shadows(&place("watched"), "teach")) {
        let ids: Vec<&str> = line.shadows.iter().map(|shadow| shadow.id.as_str()).collect();
        assert_eq!(ids, ["vds", "plr"], "in the order of the registry, without the teacher that acts");
        assert!(line.shadows.iter().all(|shadow| of_all.shadows.contains(shadow)), "at step {}", line.step);
    }
}

/// What every record of all shadows beside `own` must keep.
fn check(lines: &[Shadowing], own: &str) {
    let of_pool: BTreeSet<&str> =
        curricula::CURRICULA.iter().filter(|entry| entry.uses_pool).map(|entry| entry.id).collect();
    let watching: Vec<&str> = curricula::CURRICULA
        .iter()
        .map(|entry| entry.id)
        .filter(|id| *id != own && *id != "process")
        .collect();
    assert_eq!(lines.len(), 9, "the untrained student's evaluation, too");
    for line in lines {
        let ids: Vec<&str> = line.shadows.iter().map(|shadow| shadow.id.as_str()).collect();
        assert_eq!(ids, watching);
        for shadow in &line.shadows {
            assert_eq!(shadow.failed, None, "{}", shadow.id);
            let proposals: u64 = shadow.picks.iter().map(|(_, times)| u64::from(*times)).sum();
            // While rollouts are played for the teacher that acts, there are no episodes.
            assert_eq!(proposals, line.episodes, "{}", shadow.id);
            let is_of_pool = of_pool.contains(shadow.id.as_str());
            assert_eq!(shadow.elsewhere, if is_of_pool { 0 } else { line.episodes }, "{}", shadow.id);
            assert_eq!(shadow.weights.is_some(), is_of_pool, "{}", shadow.id);
            let sum: f32 = shadow.weights.iter().flatten().sum();
            assert!(!is_of_pool || (sum - 1.0).abs() < 1e-5, "{}: {sum}", shadow.id);
            // Where the student was measured, those tell what they believe that have a belief by then.
            let tells = line.eval_index % 4 == 0
                && match shadow.id.as_str() {
                    "lp" => true,
                    "teach" | "procurl" | "plr" | "goid" => line.step > 0,
                    _ => continue,
                };
            let told = shadow.beliefs.as_ref().and_then(|beliefs| Some(beliefs.scores.as_ref()?.len()));
            assert_eq!(told, tells.then_some(20), "{} at {}", shadow.id, line.step);
        }
    }
    let is_even = |weights: &[f32]| weights.iter().all(|weight| (weight - weights[0]).abs() < 1e-6);
    let last = lines.last().expect("evaluations");
    let even: Vec<&str> = last
        .shadows
        .iter()
        .filter(|shadow| shadow.weights.as_deref().is_some_and(is_even))
        .map(|shadow| shadow.id.as_str())
        .collect();
    // Whoever goes by success makes no difference as long as there is none.
    let may_be = ["her-iid-pool", "lp", "goid"];
    assert!(even.contains(&"her-iid-pool") && even.iter().all(|id| may_be.contains(id)), "{own}: {even:?}");
}

#[test]
fn runs_without_shadows_keep_their_hashes_and_wrong_names_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let short = ["--curriculum", "her-iid", "--seeds", "0", "--steps", "100"];
    let out = folder.path().join("out");
    // The teacher that acts does not watch itself.
    toy(&out, &[&short[..], &["--shadow", "her-iid"]].concat());
    assert_eq!(manifest(&out, "her-iid").config.get("shadow"), None);
    assert!(!run_of(&out, "her-iid").has(layout::SHADOW).expect("it can be asked"));
    let watched = folder.path().join("watched");
    let settings = [&short[..], &["--shadow", "plr,her-iid", "--set", "curriculum.plr.beta=0.5"]].concat();
    toy(&watched, &settings);
    let Manifest { config, versions, .. } = manifest(&watched, "her-iid");
    assert_eq!(config["shadow"], serde_json::json!(["plr"]));
    assert_eq!(config["curriculum"]["plr"]["beta"], 0.5);
    assert_eq!(versions.get("shadow plr").map(String::as_str), Some("1"));
    // A run that is watched is another run than one that is not.
    refused(&toy_args(&out, &settings), &["shadow"]);
    for (shadow, expected) in [
        (["--shadow", "vsd"], ["--shadow vsd", "did you mean `vds`"]),
        (["--shadow", "process"], ["curriculum.process.command", "must be set"]),
        (["--set", "shadow=3"], ["shadow", "list"]),
    ] {
        let wrong = folder.path().join("wrong");
        refused(&toy_args(&wrong, &shadow), &expected);
        assert!(!wrong.exists());
    }
}

/// A program that proposes the first goal always. `begins` and `hears` are what it does when it starts, and
/// when it has heard of an episode.
fn first_goal(begins: &str, hears: &str) -> String {
    format!(
        r#"#!/bin/sh
{begins}
while read -r line; do
  case "$line" in
    *'"type":"hello"'*) echo '{{"type":"ready","protocol":1}}' ;;
    *'"type":"propose"'*) echo '{{"type":"goal","goal":0}}' ;;
    *'"type":"save"'*) echo '{{"type":"saved","state":""}}' ;;
    *) {hears}; echo '{{"type":"heard"}}' ;;
  esac
done
"#
    )
}

#[test]
fn a_shadow_that_fails_is_silent_and_in_nobodys_way() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("leaves.sh");
    // It goes away when it has heard of five episodes.
    let leaves = first_goal("heard=0", "heard=$((heard + 1)); [ $heard -gt 5 ] && exit 0");
    fs::write(&program, leaves).expect("it can be written");
    let settings = ["--curriculum", "teach", "--seeds", "0"];
    toy(&folder.path().join("plain"), &settings);
    let expected = files(&folder.path().join("plain"), &OTHERS[..3]);
    let leaves = format!("curriculum.process.command=sh {}", program.display());
    for (name, command) in [("leaves", leaves.as_str()), ("nothing", "curriculum.process.command=\"false\"")]
    {
        let out = folder.path().join(name);
        toy(&out, &[&settings[..], &["--shadow", "process,plr", "--set", command]].concat());
        assert_eq!(files(&out, &OTHERS[..3]), expected, "{name}");
        let lines = shadows(&out, "teach");
        let last = lines.last().expect("evaluations");
        let [plr, process] = &last.shadows[..] else { panic!("two shadows: {last:?}") };
        assert!(plr.failed.is_none() && plr.weights.is_some());
        let reason = process.failed.as_deref().expect("it has failed");
        assert!(process.weights.is_none() && process.picks.is_empty(), "{process:?}");
        let proposed: u32 =
            lines.iter().flat_map(|line| &line.shadows[1].picks).map(|(_, times)| *times).sum();
        match name {
            // Five episodes of 20 steps were heard; the sixth was proposed for.
            "leaves" => assert!(reason.starts_with("step 120: ") && proposed == 6, "{proposed}: {reason}"),
            _ => assert!(reason.starts_with("step 0: ") && proposed == 0, "{proposed}: {reason}"),
        }
        let output = goalbench(&["report", out.to_str().expect("UTF-8")]);
        assert!(output.status.success(), "{}", stderr(&output));
        let summary = fs::read_to_string(layout::report_dir(&out).join("summary.md")).expect("a report");
        assert!(summary.contains("fell silent in 1 of 1 run"), "{name}");
    }
}

#[test]
fn a_shadow_that_cannot_be_built_again_is_silent_from_the_step_of_the_checkpoint_on() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (out, program) = (folder.path().join("out"), folder.path().join("slow.sh"));
    // It hears of episodes slowly, and does not start beside a file called `gone`.
    let slow = first_goal(r#"[ -e "$(dirname "$0")/gone" ] && exit 1"#, "sleep 0.02");
    fs::write(&program, slow).expect("it can be written");
    let command = format!("curriculum.process.command=sh {}", program.display());
    let settings = ["--curriculum", "teach", "--seeds", "0", "--steps", "4000", "--shadow", "process"];
    let args = [&settings[..], &["--set", "evaluation.every=200", "--set", &command]].concat();
    let records = run_of(&out, "teach").file(layout::RECORDS);
    let mut parent = start(&toy_args(&out, &args));
    while fs::read_to_string(&records).map_or(0, |text| text.lines().count()) < 4 {
        assert!(parent.try_wait().expect("it can be asked").is_none(), "it has ended already");
        std::thread::sleep(Duration::from_millis(1));
    }
    parent.kill().expect("it can be killed");
    parent.wait().expect("it was started here");
    fs::write(folder.path().join("gone"), "").expect("it can be written");
    toy(&out, &args);
    let lines = shadows(&out, "teach");
    let failed = |line: &Shadowing| line.shadows[0].failed.clone();
    let (well, silent): (Vec<_>, Vec<_>) = lines.iter().partition(|line| failed(line).is_none());
    let last = well.last().expect("it watched before it was killed");
    assert!(last.step >= 400 && !silent.is_empty(), "{lines:?}");
    let reasons: BTreeSet<String> = silent.iter().filter_map(|line| failed(line)).collect();
    let reason = reasons.first().expect("it is silent");
    let step = reason.strip_prefix("step ").and_then(|rest| rest.split_once(':')?.0.parse::<u64>().ok());
    // A worker whose sweep was killed saves a checkpoint at the end of its cycle.
    let within = step.is_some_and(|step| last.step <= step && step < silent[0].step);
    assert!(within && reasons.len() == 1, "{reasons:?}");
}

#[test]
fn shadows_of_a_finished_run_that_were_altered_or_lost_are_noticed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    toy(&out, &["--curriculum", "teach", "--seeds", "0", "--steps", "100", "--shadow", "plr"]);
    let merged = folder.path().join("merged");
    let text = |path: &Path| path.to_str().expect("UTF-8").to_owned();
    let output = goalbench(&["merge", &text(&out), "--out", &text(&merged)]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(files(&merged, &ALL[4..]), files(&out, &ALL[4..]));
    let packed = folder.path().join("packed.tar.zst");
    let output = goalbench(&["pack", &text(&out), "--out", &text(&packed)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let path = run_of(&out, "teach").file(layout::SHADOW);
    let good = fs::read_to_string(&path).expect("records of shadows");
    for bad in [Some(good.replacen("\"elsewhere\":0", "\"elsewhere\":1", 1)), None] {
        match bad {
            Some(bad) => fs::write(&path, bad).expect("it can be written"),
            None => fs::remove_file(&path).expect("it can be removed"),
        }
        let output = goalbench(&["report", &text(&out)]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains(layout::SHADOW), "{}", stderr(&output));
    }
}
