//! The example program: all of goalbench with an environment and a suite from outside.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

#[allow(dead_code, reason = "its main is the program")]
#[path = "../examples/own_environment.rs"]
mod own_environment;
mod support;

use std::path::Path;
use std::process::Output;

use envs::EnvOptions;
use envs::rng::{Purpose, stream};
use goalbench::Registry;
use own_environment::ARM;
use reports::schema::{Manifest, Record};

/// Runs the example program.
fn run(args: &[&str]) -> Output {
    support::run_example("own_environment", args)
}

/// What the program prints; it must succeed.
fn printed(args: &[&str]) -> String {
    let output = run(args);
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn it_keeps_the_contract() {
    envs::testing::contract(&ARM);
}

/// Every step turns the joints by at most 0.2 rad, so that the hand of the stretched arm moves by 2·0.45·0.2
/// + 0.45·0.2.
#[test]
fn its_hand_moves_as_far_as_its_joints_turn() {
    let mut env = ARM.make(&EnvOptions::default()).expect("an arm");
    env.reset(&mut stream(0, Purpose::Environment)).expect("a start");
    for action in [[1.0, 1.0], [-1.0, 0.0], [0.0, 1.0]] {
        let before = env.observation().achieved.clone();
        env.step(&action).expect("a step");
        let after = &env.observation().achieved;
        let moved = (after[0] - before[0]).hypot(after[1] - before[1]);
        assert!(moved > 0.01 && moved < 0.27 + 1e-9, "{action:?}: {moved}");
        assert!(after[0].hypot(after[1]) <= 0.9 + 1e-9, "within the arm's length: {after:?}");
    }
}

#[test]
fn it_is_listed_with_its_suite() {
    let environments = printed(&["list", "environments"]);
    assert!(environments.contains("Bring the hand of a planar arm to a place"), "{environments}");
    let suites = printed(&["list", "suites"]);
    assert!(suites.contains("easy         ArmReach, Point\n") && suites.contains("paper-ids"), "{suites}");
    let json: serde_json::Value =
        serde_json::from_str(&printed(&["list", "environments", "--json"])).expect("JSON");
    let row = json.as_array().and_then(|rows| rows.last()).expect("rows");
    assert_eq!((&row["id"], &row["source"]), (&ARM.id().into(), &ARM.source.into()));
}

/// A protocol with the suite, small enough for a second.
const PROTOCOL: &str = r#"
name = "arms"
environments = ["easy"]
curricula = ["teach", "her-iid"]
seeds = "0..1"
budget = { steps = 200 }
evaluation = { every = 100, episodes = 2 }
pool = { size = 20 }
student = { batch = 16, width = 16, updates_per_cycle = 2 }

[[override]]
environments = ["ArmReach"]
set.pool.size = 10
"#;

fn records(run: &Path) -> Vec<Record> {
    let text = std::fs::read_to_string(run.join("records.jsonl")).expect("the run recorded");
    text.lines().map(|line| serde_json::from_str(line).expect("a record")).collect()
}

#[test]
fn a_protocol_trains_on_its_suite_and_what_it_trained_is_drawn() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    std::fs::write(path("arms.toml"), PROTOCOL).expect("the test folder can be written");
    printed(&["run", &path("arms.toml"), "--out", &path("results")]);
    for environment in ["ArmReach", "Point"] {
        for curriculum in ["teach", "her-iid"] {
            let run = folder.path().join(format!("results/runs/{environment}/{curriculum}/default/seed-0"));
            let records = records(&run);
            assert_eq!(records.last().map(|record| record.step), Some(200), "{environment} {curriculum}");
        }
    }
    let arm = path("results/runs/ArmReach/teach/default/seed-0");
    let manifest = std::fs::read_to_string(Path::new(&arm).join("manifest.json")).expect("a manifest");
    let manifest: Manifest = serde_json::from_str(&manifest).expect("a manifest");
    assert_eq!(manifest.config["pool"]["size"], 10, "overrides know it");

    let drawn = printed(&["render", &arm, "--episodes", "1", "--size", "64", "--out", &path("arm.gif")]);
    assert!(drawn.contains("26 pictures of 1 episode,"), "{drawn}");
    let gif = std::fs::read(path("arm.gif")).expect("it is written");
    assert!(gif.starts_with(b"GIF89a"));
}

/// A planned run takes budget, interval and depth from the row.
#[test]
fn it_is_trained_by_its_own_defaults() {
    use goalbench::config;
    let registry = Registry::builtin().with_environment(ARM);
    let method = registry.curriculum("her-iid").expect("a curriculum of the table");
    let config = config::resolve(&registry, &ARM.spec, method, &[]).expect("a valid config");
    assert_eq!((config.budget.steps, config.evaluation.every), (20_000, 1_000));
    assert_eq!(config.student.layers, agents::Auto::Value(2));
}

#[test]
fn its_picture_shows_the_arm_and_its_goal() {
    let mut env = ARM.make(&EnvOptions::default()).expect("an arm");
    env.reset(&mut stream(0, Purpose::Environment)).expect("a start");
    env.set_goal(&[-0.8, 0.8]).expect("a goal");
    let mut renderer = envs::render::Renderer::new(env.as_ref(), 200, 200).expect("a renderer");
    let image = renderer.frame(env.as_ref()).expect("a picture");
    // The first coordinate runs downwards.
    let [red, green, blue] = image.pixel(180, 20);
    assert!(red > green.saturating_add(30) && red > blue.saturating_add(30), "the goal");
    let hand = &env.observation().achieved;
    let [x, y] = [hand[1], hand[0]].map(|part| ((part + 1.0) * 100.0) as u32);
    let ground = image.pixel(5, 195);
    assert_ne!(image.pixel(x, y), ground, "the hand");
    assert_ne!(image.pixel(100, 100), ground, "the base");
}

#[test]
fn names_that_are_taken_or_unknown_are_mistakes_of_the_program() {
    let refused = |registry: fn() -> Registry| std::panic::catch_unwind(registry).is_err();
    assert!(refused(|| Registry::builtin().with_environment(ARM).with_environment(ARM)));
    assert!(refused(|| Registry::builtin().with_suite("paper", &["Point"])));
    assert!(refused(|| Registry::builtin().with_suite("Point", &["MazeA"])));
    assert!(refused(|| Registry::builtin().with_suite("arms", &["ArmReach"])), "not there yet");
    assert!(!refused(|| Registry::builtin().with_environment(ARM).with_suite("arms", &["ArmReach"])));
}

#[test]
fn a_mistyped_name_brings_its_own_into_the_suggestions() {
    let output = run(&["run", "--env", "ArmReech", "--curriculum", "her-iid"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("did you mean `ArmReach`") && message.contains("easy"), "{message}");
}

#[test]
fn the_page_that_walks_through_it_quotes_it() {
    let (page, example) =
        (include_str!("../docs/environments.md"), include_str!("../examples/own_environment.rs"));
    support::assert_quotes(page, "### In a program of your own", example);
}
