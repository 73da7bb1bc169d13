//! The built-in protocols.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

use goalbench::Registry;
use goalbench::protocol::plan::{Plan, PlannedRun};
use goalbench::protocol::presets::PRESETS;
use reports::analysis::group::GroupKey;
use reports::render::figure::Palette;

#[test]
fn every_preset_is_a_plan() {
    let registry = Registry::builtin();
    for preset in &PRESETS {
        let protocol = preset.protocol(&registry).expect(preset.id);
        assert_eq!(protocol.name, preset.id);
        assert_eq!(protocol.description, preset.title);
        Plan::new(&protocol, &registry).expect(preset.id);
    }
}

/// Colour, dashes and marker.
type Looks = std::collections::BTreeMap<String, looks::Look>;

#[test]
fn no_two_curves_of_a_preset_look_alike() {
    let registry = Registry::builtin();
    let catalogue = goalbench::paper::catalogue(&registry);
    for preset in &PRESETS {
        let plan = Plan::new(&preset.protocol(&registry).expect(preset.id), &registry).expect(preset.id);
        let key = |run: &PlannedRun| {
            GroupKey::new(&catalogue, &run.key.environment, &run.key.curriculum, &run.key.variant)
        };
        let keys: Vec<GroupKey> = plan.runs.iter().map(key).collect();
        let palette = Palette::new(&keys);
        let mut found = Looks::new();
        for key in &keys {
            let method = format!("{}/{}", key.curriculum.id, key.variant);
            let look = palette.look(key);
            let before = found.insert(method.clone(), look).unwrap_or(look);
            assert_eq!(before, look, "{}: {method} looks the same in every figure", preset.id);
        }
        for (method, look) in &found {
            let alike = found.iter().find(|(other, its)| *other != method && *its == look);
            assert!(alike.is_none(), "{}: {method} looks like {alike:?}", preset.id);
        }
        assert!(!found.is_empty(), "{}", preset.id);
    }
}

#[test]
fn the_papers_protocol_has_its_size() {
    let registry = Registry::builtin();
    let protocol =
        PRESETS.iter().find(|preset| preset.id == "paper").expect("it is there").protocol(&registry);
    let plan = Plan::new(&protocol.expect("valid"), &registry).expect("valid");
    assert_eq!(plan.runs.len(), 11 * 6 * 7);
    let steps =
        |id: &str| plan.runs.iter().find(|run| run.key.environment == id).map(|run| run.config.budget.steps);
    assert_eq!((steps("MazeA"), steps("FetchPush")), (Some(400_000), Some(1_000_000)));
}

#[test]
fn one_preset_has_every_curriculum_and_its_runs_of_the_papers_methods_are_the_papers() {
    let registry = Registry::builtin();
    let plan = |name: &str| {
        let preset = PRESETS.iter().find(|preset| preset.id == name).expect(name);
        Plan::new(&preset.protocol(&registry).expect(name), &registry).expect(name)
    };
    let (methods, paper) = (plan("methods"), plan("paper"));
    for entry in registry.curricula().iter().filter(|entry| entry.needs.is_none()) {
        let runs = methods.runs.iter().filter(|run| run.key.curriculum == entry.id).count();
        assert_eq!(runs, 11 * 7, "{}", entry.id);
    }
    for run in &paper.runs {
        assert!(methods.runs.iter().any(|other| (&other.key, &other.config) == (&run.key, &run.config)));
    }
}

#[test]
fn the_open_readings_each_have_baselines_of_the_same_evaluation() {
    let registry = Registry::builtin();
    let preset = PRESETS.iter().find(|preset| preset.id == "ambiguity").expect("it is there");
    let plan = Plan::new(&preset.protocol(&registry).expect("valid"), &registry).expect("valid");
    let first = |run: &&PlannedRun| run.key.environment == "MazeA" && run.key.seed == 0;
    let (teach, baselines): (Vec<_>, Vec<_>) =
        plan.runs.iter().filter(first).partition(|run| run.key.curriculum == "teach");
    // States × selection × goals of evaluations, and two ways to record at Δ = 10.
    assert_eq!((teach.len(), baselines.len()), (3 * 2 * 2 + 2, 2 * 2));
    for (index, run) in teach.iter().enumerate() {
        assert!(teach[..index].iter().all(|other| other.config != run.config), "{}", run.key);
        let alike = baselines.iter().filter(|other| other.config.evaluation == run.config.evaluation);
        assert_eq!(alike.count(), 2, "{}", run.key);
    }
}

#[test]
fn the_laptop_study_has_the_size_that_its_page_says() {
    let registry = Registry::builtin();
    let plan = |name: &str| {
        let preset = PRESETS.iter().find(|preset| preset.id == name).expect(name);
        Plan::new(&preset.protocol(&registry).expect(name), &registry).expect(name)
    };
    let (study, ablations) = (plan("laptop"), plan("laptop-ablations"));
    assert_eq!((study.runs.len(), ablations.runs.len()), (4 * 6 * 36, 3 * (17 + 2 * 2) * 12));
    // One student everywhere, so that no difference is the student's.
    let student = &study.runs[0].config.student;
    assert!(study.runs.iter().chain(&ablations.runs).all(|run| run.config.student == *student));
    // The runs that both presets have are the same, and every variant differs from all others.
    for (index, run) in ablations.runs.iter().enumerate() {
        let twin = study.runs.iter().find(|other| other.key == run.key);
        assert_eq!(twin.is_some(), run.key.variant == "default", "{}", run.key);
        assert!(twin.is_none_or(|twin| twin.config == run.config), "{}", run.key);
        let same = |other: &&PlannedRun| {
            let (one, other) = (&run.key, &other.key);
            (&one.environment, &one.curriculum, one.seed)
                == (&other.environment, &other.curriculum, other.seed)
        };
        let mut earlier = ablations.runs[..index].iter().filter(same);
        assert!(earlier.all(|other| other.config != run.config), "{}", run.key);
    }
}

#[test]
fn the_ablations_have_the_grids_of_the_specification() {
    let registry = Registry::builtin();
    let values = |name: &str, field: &str| {
        let preset = PRESETS.iter().find(|preset| preset.id == name).expect(name);
        let plan = Plan::new(&preset.protocol(&registry).expect(name), &registry).expect(name);
        let in_first = plan.runs.iter().filter(|run| run.key.environment == "MazeA" && run.key.seed == 0);
        in_first.map(|run| run.config.curriculum["teach"][field].to_string()).collect::<Vec<_>>()
    };
    assert_eq!(values("ablation-window", "window"), ["3", "5", "10", "20"]);
    assert_eq!(values("ablation-interplay", "interplay"), ["1", "2", "5", "10", "50"]);
    assert_eq!(values("ablation-polyak", "confidence"), ["\"online\"", "\"target-critic\""]);
    assert_eq!(values("ablation-polyak", "window"), ["3", "3"]);
}
