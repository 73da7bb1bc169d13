//! Probe rollouts are played apart from training, counted, charged, and exactly resumed.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

use std::path::{Path, PathBuf};

use curricula::{
    CurriculumError, Entry, Lesson, Method, PlainState, Proposal, RolloutPolicy, RolloutRequest, Rollouts,
    Setting,
};
use envs::rng::Rng;
use envs::{GoalSource, Goals};
use goalbench::Registry;
use goalbench::config::{self, layer::ConfigLayer};
use goalbench::run::observer::{Checkpointer, Observer, Wish};
use goalbench::run::state::TrainerState;
use goalbench::run::train::{End, Trainer};
use reports::schema::{Learning, Record, RunKey, Teaching};
use serde::{Deserialize, Serialize};

/// Keeps the environment's goals, and asks for three others to be tried after every third cycle.
struct Curious(CuriousConfig);

#[derive(Serialize, Deserialize)]
struct CuriousConfig {
    episodes: usize,
    charge: bool,
    noisy: bool,
}

impl Default for CuriousConfig {
    fn default() -> Self {
        Self { episodes: 4, charge: true, noisy: true }
    }
}

#[derive(Default, Serialize, Deserialize)]
struct CuriousState {
    cycles: u64,
    asked: Option<Goals>,
    successes: Vec<usize>,
}

impl PlainState for CuriousState {
    const VERSION: u32 = 1;
}

impl Method for Curious {
    type Config = CuriousConfig;
    type State = CuriousState;
    const ID: &'static str = "curious";
    const TITLE: &'static str = "Curious";
    const SOURCE: &'static str = "A test";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn build(config: CuriousConfig, _setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self(config))
    }

    fn begin(&self, _setting: &Setting) -> Result<CuriousState, CurriculumError> {
        Ok(CuriousState::default())
    }

    /// The score is what the rollouts came to, so that records tell of every one of them.
    fn propose(
        &self,
        state: &mut CuriousState,
        _lesson: &mut Lesson<'_>,
    ) -> Result<Proposal, CurriculumError> {
        let found = state.successes.iter().fold(1.0, |all, &successes| 10.0 * all + successes as f64);
        Ok(Proposal::native().scored(found))
    }

    fn request_rollouts(
        &self,
        state: &mut CuriousState,
        goals: &mut dyn GoalSource,
        rng: &mut Rng,
    ) -> Result<Option<RolloutRequest>, CurriculumError> {
        state.cycles += 1;
        if !state.cycles.is_multiple_of(3) {
            return Ok(None);
        }
        let (mut fresh, mut goal) = (Goals::new(2), [0.0; 2]);
        for _ in 0..3 {
            goals.sample_goal(rng, &mut goal);
            // Corners of the square, where untrained students end up now and then.
            fresh.push(&goal.map(f64::signum));
        }
        state.asked = Some(fresh.clone());
        let CuriousConfig { episodes, charge, noisy } = self.0;
        let policy = if noisy { RolloutPolicy::Noisy } else { RolloutPolicy::Greedy };
        Ok(Some(RolloutRequest { goals: fresh, episodes, policy, charge }))
    }

    fn hear_rollouts(&self, state: &mut CuriousState, rollouts: &Rollouts) -> Result<(), CurriculumError> {
        assert_eq!(state.asked.as_ref(), Some(&rollouts.goals), "what was asked for is what is heard of");
        assert_eq!((rollouts.episodes, rollouts.successes.len()), (self.0.episodes, 3));
        state.successes.clone_from(&rollouts.successes);
        Ok(())
    }
}

/// Keeps all lines; stops after `turns` turns, if that is set, and keeps the state.
#[derive(Default)]
struct Notes {
    lines: Vec<(Record, Teaching)>,
    folder: PathBuf,
    turns: Option<u64>,
    state: Option<TrainerState>,
}

impl Observer for Notes {
    fn record(&mut self, record: &Record, teaching: &Teaching, _: &Learning) -> std::io::Result<()> {
        self.lines.push((record.clone(), teaching.clone()));
        Ok(())
    }

    fn checkpointer(&mut self) -> Option<&mut dyn Checkpointer> {
        Some(self)
    }
}

impl Checkpointer for Notes {
    fn wish(&mut self, _: bool) -> Wish {
        match &mut self.turns {
            Some(0 | 1) => Wish::SaveAndStop,
            Some(turns) => {
                *turns -= 1;
                Wish::GoOn
            }
            None => Wish::GoOn,
        }
    }

    fn replay_folder(&self) -> &Path {
        &self.folder
    }

    fn save(&mut self, state: TrainerState) -> std::io::Result<()> {
        self.state = Some(state);
        Ok(())
    }
}

/// A run of 1,000 steps, in cycles of two episodes of 20 steps, evaluated every 200, with these settings.
fn trainer(entry: Entry, settings: &[&str]) -> Trainer {
    agents::prepare_thread();
    let registry = Registry::builtin().with_curriculum(Entry::of::<Curious>());
    let spec = &envs::find("Point").expect("the toy task").spec;
    let small = ["student.batch=16", "student.width=16", "student.updates_per_cycle=4"];
    let sizes = ["budget.steps=1000", "evaluation.every=200", "evaluation.episodes=3"];
    let layers: Vec<ConfigLayer> = small
        .iter()
        .chain(&sizes)
        .chain(settings)
        .map(|set| ConfigLayer::from_assignment("--set", set).expect("an assignment"))
        .collect();
    let config = config::resolve(&registry, spec, &entry, &layers).expect("a valid config");
    let key = RunKey {
        environment: "Point".into(),
        curriculum: entry.id.into(),
        variant: "default".into(),
        seed: 5,
    };
    Trainer::new(&registry, key, config).expect("a run")
}

fn curious(settings: &[&str]) -> Trainer {
    trainer(Entry::of::<Curious>(), settings)
}

/// All lines of a run to its end.
fn lines(mut trainer: Trainer) -> Vec<(Record, Teaching)> {
    let mut notes = Notes::default();
    assert_eq!(trainer.run(&mut notes).expect("it ends well"), End::Finished);
    notes.lines
}

fn her_iid() -> Vec<(Record, Teaching)> {
    let entry = curricula::CURRICULA.iter().find(|entry| entry.id == "her-iid").expect("there");
    lines(trainer(*entry, &[]))
}

/// The goals of all training episodes, in order.
fn goals(lines: &[(Record, Teaching)]) -> Vec<&Vec<f32>> {
    lines.iter().flat_map(|(_, teaching)| &teaching.goals).collect()
}

#[test]
fn charged_rollouts_use_up_the_budget_and_evaluations_stay_on_the_same_steps() {
    let probed = lines(curious(&[]));
    let steps =
        |lines: &[(Record, Teaching)]| -> Vec<u64> { lines.iter().map(|(record, _)| record.step).collect() };
    assert_eq!(steps(&probed), [0, 200, 400, 600, 800, 1000]);
    assert_eq!(steps(&probed), steps(&her_iid()));
    // 3 cycles, then 12 episodes of 20 steps, then again: 120 and 240 steps of every 360.
    let probe_steps: Vec<u64> = probed.iter().map(|(record, _)| record.probe_steps).collect();
    assert_eq!(probe_steps, [0, 80, 240, 360, 480, 640]);
    assert!(probed.iter().all(|(record, _)| record.uncharged_steps == 0));
    // The budget ends in the middle of what was asked for; 360 steps are left for 18 episodes of training.
    assert_eq!(goals(&probed).len(), 18);
    let updates: Vec<u64> = probed.iter().map(|(record, _)| record.gradient_steps).collect();
    assert_eq!(updates, [0, 12, 16, 24, 32, 36], "4 per cycle of training");
}

#[test]
fn rollouts_that_are_not_charged_change_nothing_but_what_the_teacher_knows() {
    let (probed, iid) = (lines(curious(&["curriculum.curious.charge=false"])), her_iid());
    assert_eq!(goals(&probed), goals(&iid));
    for ((probed, taught), (iid, _)) in probed.iter().zip(&iid) {
        let own =
            |record: &Record| (record.step, record.success_rate, record.mean_return, record.gradient_steps);
        assert_eq!(own(probed), own(iid));
        assert_eq!(probed.probe_steps, probed.uncharged_steps);
        assert_eq!(probed.all_steps(), probed.step + probed.probe_steps);
        let found = taught.scores.iter().flatten().flatten().filter(|&&score| score > 1.0).count();
        assert_eq!(found > 0, probed.step > 0, "it has heard of its rollouts");
    }
    // After every third of 25 cycles 240 steps.
    assert_eq!(probed.last().expect("records").0.probe_steps, 8 * 240);
}

#[test]
fn a_run_goes_on_to_the_same_records_wherever_it_was_stopped_rollouts_pending_or_not() {
    for noise in ["student.noise={ kind = 'gaussian' }", "student.noise={ kind = 'ornstein-uhlenbeck' }"] {
        let settings = [noise, "curriculum.curious.episodes=3"];
        let expected = lines(curious(&settings));
        // Where neither policy reaches a corner nothing tells them apart, so some students are asked.
        let tells_apart = |weights: u64| {
            let weights = format!("seed.weights={weights}");
            let with = |noisy: &str| lines(curious(&[noise, &weights, noisy]));
            with("curriculum.curious.noisy=true") != with("curriculum.curious.noisy=false")
        };
        assert!((0..30).any(tells_apart), "noise is noise");
        for turns in 1..25 {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let mut first =
                Notes { folder: folder.path().to_owned(), turns: Some(turns), ..Notes::default() };
            assert_eq!(curious(&settings).run(&mut first).expect("it stops well"), End::Stopped);
            let mut resumed = curious(&settings);
            resumed.resume(&first.state.expect("saved"), folder.path()).expect("its own state");
            let mut rest = Notes::default();
            assert_eq!(resumed.run(&mut rest).expect("it ends well"), End::Finished);
            let all: Vec<_> = first.lines.into_iter().chain(rest.lines).collect();
            assert_eq!(all, expected, "stopped after {turns} turns");
        }
    }
}

#[test]
fn records_without_rollouts_do_not_speak_of_them() {
    let (record, _) = her_iid().pop().expect("records");
    let line = serde_json::to_string(&record).expect("plain data");
    assert!(!line.contains("probe") && !line.contains("charged"), "{line}");
    let read: Record = serde_json::from_str(&line).expect("a record");
    assert_eq!(read, record);
    let (record, _) = lines(curious(&["curriculum.curious.charge=false"])).pop().expect("records");
    let line = serde_json::to_string(&record).expect("plain data");
    assert!(line.contains("\"probe_steps\":1920,\"uncharged_steps\":1920"), "{line}");
}
