//! Every environment of the paper with every curriculum, for a few cycles.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod goal_space;
#[path = "../support/mod.rs"]
mod support;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use curricula::Entry;
use goal_space::GoalSpace;
use goalbench::Registry;
use reports::schema::{Record, RunKey, Teaching};
use reports::store::layout;
use serde::de::DeserializeOwned;
use support::{goalbench, stderr, stdout};

/// Goals in the pool.
const POOL: usize = 5;
/// Training steps: two to four cycles, after every one of which is evaluated.
const STEPS: u64 = 400;

/// Curricula whose goals are achieved ones, which need not be such as the environment would ask for.
const OF_ACHIEVED: [&str; 3] = ["mega", "omega", "hgg"];

/// Runs all of them into `out`.
fn run_all(curricula: &[&str], out: &Path) {
    let (steps, list) = (STEPS.to_string(), curricula.join(","));
    let out = out.to_str().expect("a test path is UTF-8");
    let mut args = vec!["run", "--env", "paper", "--curriculum", &list, "--steps", &steps, "--out", out];
    let pool = format!("pool.size={POOL}");
    let small = [
        "evaluation.every=200",
        "evaluation.episodes=1",
        &pool,
        "student.batch=16",
        "student.width=16",
        "student.updates_per_cycle=2",
        "curriculum.vds.candidates=10",
        "curriculum.vds.updates_per_cycle=2",
        "curriculum.space.update_steps=100",
        "curriculum.sfl.interval=2",
        "curriculum.sfl.candidates=2",
        "curriculum.sfl.kept=1",
        "curriculum.sfl.rollouts=2",
        "curriculum.mega.samples=50",
        "curriculum.omega.samples=50",
        "curriculum.omega.desired=20",
        "curriculum.hgg.goals=2",
        "curriculum.hgg.least_motion=0.0",
    ];
    small.iter().for_each(|set| args.extend(["--set", set]));
    let output = goalbench(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains(&format!("{} runs finished", 11 * curricula.len())),
        "{}",
        stdout(&output)
    );
}

fn lines<T: DeserializeOwned>(run: &Path, file: &str) -> Vec<T> {
    let text = fs::read_to_string(run.join(file)).expect("the run recorded");
    text.lines().map(|line| serde_json::from_str(line).expect("a line of this kind")).collect()
}

#[test]
fn every_environment_runs_with_every_curriculum_and_tells_what_it_taught() {
    let registry = Registry::builtin();
    // A curriculum that needs a program has tests of its own.
    let ready = || registry.curricula().iter().filter(|entry| entry.needs.is_none());
    let curricula: Vec<&str> = ready().map(|entry| entry.id).collect();
    assert!(curricula.len() >= 6, "the paper's five and the control: {curricula:?}");
    let folder = tempfile::tempdir().expect("a temporary folder");
    run_all(&curricula, folder.path());

    let documented = documented_statistics();
    let environments = envs::suite("paper").expect("the paper's suite");
    assert_eq!(environments.len(), 11);
    for environment in environments {
        let space = GoalSpace::of(environment);
        let horizon = registry.environment(environment).expect("of the suite").spec.horizon as u64;
        for entry in ready() {
            let key = RunKey {
                environment: (*environment).into(),
                curriculum: entry.id.into(),
                variant: "default".into(),
                seed: 0,
            };
            let run = layout::run_dir(folder.path(), &key);
            let teaching: Vec<Teaching> = lines(&run, layout::TEACHING);
            let goals: Vec<&Vec<f32>> = teaching.iter().flat_map(|line| &line.goals).collect();
            let records: Vec<Record> = lines(&run, layout::RECORDS);
            let last = records.last().expect("an evaluation");
            let trained = last.all_steps() - last.probe_steps;
            assert_eq!(last.step, STEPS, "{key}");
            assert_eq!(goals.len() as u64, trained / horizon, "{key}: a goal for every training episode");
            assert_eq!(last.probe_steps > 0, entry.id == "sfl", "{key}: probe rollouts");
            let of_achieved = OF_ACHIEVED.contains(&entry.id);
            for goal in goals {
                let fits = if of_achieved { space.can_be_achieved(goal) } else { space.contains(goal) };
                assert!(fits, "{key}: {goal:?} is no goal of this environment");
            }
            assert!(
                records.len() >= 3 && records.len() == teaching.len(),
                "{key}: {} evaluations",
                records.len()
            );
            for (record, line) in records.iter().zip(&teaching) {
                assert!(told(record, line, entry.uses_pool), "{key}: {record:?}, {line:?}");
                let names: BTreeSet<&str> = record.teacher.keys().map(String::as_str).collect();
                let expected = documented_for(entry, &documented);
                assert_eq!(names, expected, "{key}: the page has other numbers");
            }
        }
    }
}

/// Whether an evaluation tells what there is to tell of the teacher: for teachers of the pool its weights,
/// and how spread out they are; for VDS how spread out its last choice was.
fn told(record: &Record, teaching: &Teaching, uses_pool: bool) -> bool {
    let number = |name| record.teacher.get(name).and_then(serde_json::Value::as_f64);
    let spread = |most: usize| {
        number("entropy").is_some_and(|nats| (0.0..=(most as f64).ln() + 1e-9).contains(&nats))
            && number("effective_goals").is_some_and(|n| (1.0..=most as f64 + 1e-9).contains(&n))
    };
    match &teaching.weights {
        Some(weights) => {
            let sum: f32 = weights.iter().sum();
            uses_pool && weights.len() == POOL && (sum - 1.0).abs() < 1e-5 && spread(POOL)
        }
        // The untrained student has not been taught yet.
        None => !uses_pool && (record.curriculum != "vds" || record.eval_index == 0 || spread(10)),
    }
}

/// The numbers that the page promises of a curriculum.
fn documented_for(
    entry: &Entry,
    documented: &BTreeMap<&'static str, BTreeSet<&'static str>>,
) -> BTreeSet<&'static str> {
    let pool = entry.uses_pool.then_some(EVERY_POOL);
    let keys = [Some(entry.id), Some(EVERY), pool].into_iter().flatten();
    keys.filter_map(|key| documented.get(key)).flatten().copied().collect()
}

/// What the page calls all curricula,
const EVERY: &str = "every curriculum";
/// and all those that choose from the pool.
const EVERY_POOL: &str = "every curriculum of the pool";

/// What the page says that each curriculum records: the names in the first column, by those in the second or
/// by what it calls several.
fn documented_statistics() -> BTreeMap<&'static str, BTreeSet<&'static str>> {
    let page = include_str!("../../docs/curricula.md");
    let (_, rest) = page.split_once("### The numbers in `teacher`").expect("the section");
    let (section, _) = rest.split_once("\n### ").expect("the next section");
    let names = |cell: &'static str| cell.split('`').skip(1).step_by(2);
    let mut documented: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
    for line in section.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.split('|').collect();
        let several = [EVERY, EVERY_POOL].into_iter().filter(|several| cells[2].trim() == *several);
        for curriculum in names(cells[2]).chain(several) {
            documented.entry(curriculum).or_default().extend(names(cells[1]));
        }
    }
    documented
}
