//! No teacher of the table sees evaluation goals, at any index.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

mod marked;
mod watched;

use curricula::{CURRICULA, Entry};
use envs::{Environment, Spec};
use goalbench::Registry;
use goalbench::config::{self, layer::ConfigLayer};
use goalbench::run::observer::Observer;
use goalbench::run::train::Trainer;
use marked::{MARK, SEED};
use reports::schema::{Learning, Record, RunKey, Teaching};

/// A run's records, and nothing kept on disk.
#[derive(Default)]
struct Notes {
    records: Vec<Record>,
    teaching: Vec<Teaching>,
}

impl Observer for Notes {
    fn record(&mut self, record: &Record, teaching: &Teaching, _: &Learning) -> std::io::Result<()> {
        self.records.push(record.clone());
        self.teaching.push(teaching.clone());
        Ok(())
    }
}

/// Ten cycles of a small student on the marked task with the teacher of `entry`, under watch.
fn run(entry: &'static Entry, own: &[&str], evaluation: [&str; 2]) -> Notes {
    agents::prepare_thread();
    let spec = Spec { id: "Marked", ..envs::find("Point").expect("the toy task").spec.clone() };
    let method = watched::watched(entry);
    let registry = Registry::builtin()
        .with_environment(Environment::new(spec.clone(), "A marked point", "A test", marked::make))
        .with_curriculum(method);
    let student = ["student.batch=16", "student.width=16", "student.updates_per_cycle=4"];
    let sizes = ["budget.steps=400", "pool.size=20"];
    let layers: Vec<ConfigLayer> = student
        .iter()
        .chain(&sizes)
        .chain(own)
        .chain(&evaluation)
        .map(|set| ConfigLayer::from_assignment("--set", set).expect("an assignment"))
        .collect();
    let config = config::resolve(&registry, &spec, &method, &layers).expect("a valid config");
    let key = RunKey {
        environment: spec.id.into(),
        curriculum: method.id.into(),
        variant: "default".into(),
        seed: SEED,
    };
    let mut notes = Notes::default();
    Trainer::new(&registry, key, config).expect("a run").run(&mut notes).expect("it ends well");
    notes
}

/// Every teacher with the configs in which it is handed something else.
fn teachers() -> Vec<(&'static Entry, Vec<&'static str>)> {
    let has = |entry: &Entry, field: &str| (entry.defaults)().contains_key(field);
    let mut all = Vec::new();
    for entry in CURRICULA.iter().filter(|entry| entry.needs.is_none()) {
        let small = [
            ("candidates", "curriculum.watched.candidates=20"),
            ("updates_per_cycle", "curriculum.watched.updates_per_cycle=4"),
            ("rollouts", "curriculum.watched.rollouts=2"),
            ("kept", "curriculum.watched.kept=3"),
            // Nothing of a run's few steps is spent on rollouts, so that all have as many episodes.
            ("charge", "curriculum.watched.charge=false"),
            // At the default of 2048 steps nothing would be measured in these runs.
            ("update_steps", "curriculum.watched.update_steps=20"),
            // Likewise for the first mixture and for the second matching.
            ("fit_every", "curriculum.watched.fit_every=20"),
            ("goals", "curriculum.watched.goals=2"),
            ("samples", "curriculum.watched.samples=50"),
        ];
        let small: Vec<&str> =
            small.into_iter().filter(|(field, _)| has(entry, field)).map(|(_, set)| set).collect();
        if has(entry, "states") {
            for states in [
                "curriculum.watched.states=reference",
                "curriculum.watched.states=replay",
                "curriculum.watched.states=initial",
            ] {
                all.push((entry, small.iter().copied().chain([states]).collect()));
            }
        } else {
            all.push((entry, small));
        }
    }
    all
}

#[test]
fn nothing_of_an_evaluation_is_ever_handed_to_a_teacher() {
    for (entry, own) in teachers() {
        let notes = run(entry, &own, ["evaluation.every=80", "evaluation.episodes=3"]);
        assert_eq!(notes.records.len(), 6, "the untrained student, then every other cycle");
        assert_eq!(marked::take_evaluation_episodes(), 6 * 3, "evaluations are marked");
        let handed = watched::take_handed();
        assert!(handed.times >= 20 * 3, "{} {own:?}: {handed:?}", entry.id);
        assert!(handed.largest < MARK / 2.0, "{} {own:?}: {handed:?}", entry.id);
        let goals = notes.teaching.iter().flat_map(|teaching| &teaching.goals);
        assert!(goals.flatten().all(|x| x.abs() <= 1.0), "{} {own:?}: a goal beyond the square", entry.id);
    }
}

#[test]
fn how_often_and_how_long_is_evaluated_changes_nothing_that_a_teacher_does() {
    for (entry, own) in teachers() {
        let often = run(entry, &own, ["evaluation.every=40", "evaluation.episodes=7"]);
        let seldom = run(entry, &own, ["evaluation.every=400", "evaluation.episodes=1"]);
        assert_eq!((often.records.len(), seldom.records.len()), (11, 2));
        let proposed = |notes: &Notes| -> Vec<Vec<f32>> {
            notes.teaching.iter().flat_map(|teaching| teaching.goals.clone()).collect()
        };
        assert_eq!(proposed(&often).len(), 20, "{}", entry.id);
        assert_eq!(proposed(&often), proposed(&seldom), "{} {own:?}", entry.id);
        let last = |notes: &Notes| {
            let (record, teaching) = (notes.records.last(), notes.teaching.last());
            let mut told = record.expect("a record").teacher.clone();
            // These count since the evaluation before.
            told.retain(|name, _| !name.contains("pick") && name != "score_success_correlation");
            (told, teaching.expect("a line").weights.clone())
        };
        assert_eq!(last(&often), last(&seldom), "{} {own:?}", entry.id);
    }
}
