//! Curricula with one seed are compared on the same ground: initial weights, goal pool, start states,
//! evaluation episodes.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

use std::cell::RefCell;

use envs::rng::{Purpose, Rng, stream};
use envs::{EnvError, EnvOptions, Environment, GoalEnv, GoalSource, Observation, Reward, Spec};
use goalbench::Registry;
use goalbench::config::{self, layer::ConfigLayer};
use goalbench::run::observer::Observer;
use goalbench::run::train::Trainer;
use reports::schema::{Learning, Record, RunKey, Teaching};

const SEED: u64 = 11;

/// An episode as the environment saw it.
#[derive(Clone, Debug, PartialEq)]
struct Episode {
    /// Seed of the stream that it was drawn from.
    stream: [u8; 32],
    start: Vec<f64>,
    /// As drawn; teachers replace it later.
    goal: Vec<f64>,
    /// What it was replaced by.
    set: Option<Vec<f64>>,
    /// Every achieved goal after the start.
    path: Vec<Vec<f64>>,
}

thread_local! {
    static EPISODES: RefCell<Vec<Episode>> = const { RefCell::new(Vec::new()) };
}

/// The point task, noting every episode.
struct Noted {
    point: Box<dyn GoalEnv>,
    spec: Spec,
    episode: usize,
}

/// An [`envs::registry::Constructor`].
fn make(spec: Spec, options: &EnvOptions) -> Result<Box<dyn GoalEnv>, EnvError> {
    Ok(Box::new(Noted { point: envs::make("Point", options)?, spec, episode: 0 }))
}

impl Reward for Noted {
    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        self.point.reward(achieved, goal)
    }

    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        self.point.success(achieved, goal)
    }
}

impl GoalSource for Noted {
    fn sample_goal(&mut self, rng: &mut Rng, goal: &mut [f64]) {
        self.point.sample_goal(rng, goal);
    }
}

impl GoalEnv for Noted {
    fn spec(&self) -> &Spec {
        &self.spec
    }

    fn reset(&mut self, rng: &mut Rng) -> Result<(), EnvError> {
        self.point.reset(rng)?;
        let start = self.point.observation().state.clone();
        let goal = self.point.goal().to_vec();
        EPISODES.with_borrow_mut(|episodes| {
            self.episode = episodes.len();
            episodes.push(Episode { stream: rng.get_seed(), start, goal, set: None, path: Vec::new() });
        });
        Ok(())
    }

    fn set_goal(&mut self, goal: &[f64]) -> Result<(), EnvError> {
        EPISODES.with_borrow_mut(|episodes| episodes[self.episode].set = Some(goal.to_vec()));
        self.point.set_goal(goal)
    }

    fn step(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.point.step(action)?;
        let achieved = self.point.observation().achieved.clone();
        EPISODES.with_borrow_mut(|episodes| episodes[self.episode].path.push(achieved));
        Ok(())
    }

    fn observation(&self) -> &Observation {
        self.point.observation()
    }

    fn goal(&self) -> &[f64] {
        self.point.goal()
    }
}

/// Steps of a run: ten cycles of two episodes.
const STEPS: u64 = 400;
/// Episodes per evaluation.
const EPISODES_EACH: usize = 3;

/// Every episode of a small run with `curriculum`.
fn episodes(curriculum: &str) -> Vec<Episode> {
    episodes_of(curriculum, SEED, &[])
}

/// The same of the run with `seed`, with further settings.
fn episodes_of(curriculum: &str, seed: u64, more: &[&str]) -> Vec<Episode> {
    observed(curriculum, seed, more, &mut ())
}

/// The same of a run that `observer` hears of.
fn observed(
    curriculum: &str,
    seed: u64,
    more: &[&str],
    observer: &mut (dyn Observer + Send),
) -> Vec<Episode> {
    agents::prepare_thread();
    let spec = Spec { id: "Noted", ..envs::find("Point").expect("the toy task").spec.clone() };
    let registry =
        Registry::builtin().with_environment(Environment::new(spec.clone(), "A noted point", "A test", make));
    let method = *registry.curriculum(curriculum).expect("a curriculum of the table");
    let settings = [
        "student.batch=16",
        "student.width=16",
        "student.updates_per_cycle=4",
        "budget.steps=400",
        "evaluation.every=80",
        "evaluation.episodes=3",
        "pool.size=20",
    ];
    let layers: Vec<ConfigLayer> = settings
        .iter()
        .chain(more)
        .map(|set| ConfigLayer::from_assignment("--set", set).expect("an assignment"))
        .collect();
    let config = config::resolve(&registry, &spec, &method, &layers).expect("a valid config");
    let key = RunKey {
        environment: spec.id.into(),
        curriculum: curriculum.into(),
        variant: "default".into(),
        seed,
    };
    EPISODES.with_borrow_mut(Vec::clear);
    Trainer::new(&registry, key, config).expect("a run").run(observer).expect("it ends well");
    EPISODES.take()
}

/// Those drawn from the stream of `purpose`.
fn of(episodes: &[Episode], purpose: Purpose) -> Vec<Episode> {
    drawn_from(episodes, SEED, purpose)
}

/// Those drawn from the stream of `seed` and `purpose`.
fn drawn_from(episodes: &[Episode], seed: u64, purpose: Purpose) -> Vec<Episode> {
    let seed = stream(seed, purpose).get_seed();
    episodes.iter().filter(|episode| episode.stream == seed).cloned().collect()
}

#[test]
fn two_curricula_share_everything_that_is_not_theirs() {
    let drawn = |episode: &Episode| (episode.start.clone(), episode.goal.clone());
    let (teach, pool) = (episodes("teach"), episodes("her-iid-pool"));

    for index in 0..=STEPS / 80 {
        let [a, b] = [&teach, &pool].map(|all| of(all, Purpose::Evaluation(index)));
        assert_eq!(a.len(), EPISODES_EACH, "evaluation {index}");
        assert_eq!(
            a.iter().map(drawn).collect::<Vec<_>>(),
            b.iter().map(drawn).collect::<Vec<_>>(),
            "evaluation {index}"
        );
        // The untrained students act alike, to the last bit: they have the same weights. Trained ones do not.
        assert_eq!(a.iter().map(|e| &e.path).eq(b.iter().map(|e| &e.path)), index == 0, "evaluation {index}");
    }
    let evaluation = |index| of(&teach, Purpose::Evaluation(index)).iter().map(drawn).collect::<Vec<_>>();
    assert_ne!(evaluation(0), evaluation(1), "every evaluation has episodes of its own");

    let [a, b] = [&teach, &pool].map(|all| of(all, Purpose::Pool).iter().map(drawn).collect::<Vec<_>>());
    assert!(a.len() >= 20 && a == b, "the pools of candidate goals");

    let [a, b] =
        [&teach, &pool].map(|all| of(all, Purpose::Environment).iter().map(drawn).collect::<Vec<_>>());
    assert!(a.len() == 20 && a == b, "starts of training episodes, and the goals that teachers replace");
}

#[test]
fn goals_of_evaluations_come_from_the_one_pool_of_all_methods_on_request() {
    let [teach, iid] = ["teach", "her-iid"].map(|id| episodes_of(id, SEED, &["evaluation.goals=pool"]));
    let goals = |all: &[Episode], index| -> Vec<Vec<f64>> {
        of(all, Purpose::Evaluation(index))
            .into_iter()
            .map(|one| one.set.expect("a goal of the pool"))
            .collect()
    };
    let [mut pool, of_iid] = [&teach, &iid]
        .map(|all| of(all, Purpose::Pool).into_iter().map(|episode| episode.goal).collect::<Vec<_>>());
    assert_eq!(pool, of_iid, "drawn for a method that does not choose from it, too");
    pool.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let fresh = episodes("her-iid");
    let mut asked: Vec<Vec<f64>> = Vec::new();
    for index in 0..=STEPS / 80 {
        let of_teach = goals(&teach, index);
        assert_eq!(of_teach.len(), EPISODES_EACH);
        assert_eq!(of_teach, goals(&iid, index), "evaluation {index}");
        let starts = |all: &[Episode]| of(all, Purpose::Evaluation(index)).into_iter().map(|one| one.start);
        assert!(starts(&iid).eq(starts(&fresh)), "starts are the same wherever goals come from");
        asked.extend(of_teach);
    }
    assert!(asked.iter().all(|goal| pool.contains(goal)), "{asked:?}");
    asked.sort_by(|a, b| a[0].total_cmp(&b[0]));
    asked.dedup();
    assert!(asked.len() > 5, "only {} of 18 draws from 20 goals differ", asked.len());
    // HER-IID trains on goals of the environment as ever, and by default is evaluated on them.
    assert!(of(&iid, Purpose::Environment).iter().all(|episode| episode.set.is_none()));
    assert!(fresh.iter().all(|episode| episode.set.is_none()));
}

#[test]
fn the_seed_of_one_stream_can_be_held_while_the_run_varies() {
    let pool_of = |seed, held| {
        let more: &[&str] = if held { &["seed.pool=3"] } else { &[] };
        let all = episodes_of("teach", seed, more);
        let drawn = |seed, purpose| drawn_from(&all, seed, purpose);
        (drawn(3, Purpose::Pool), drawn(seed, Purpose::Pool), drawn(seed, Purpose::Environment))
    };
    let ((held, own, starts), (other_held, _, other_starts)) = (pool_of(SEED, true), pool_of(SEED + 1, true));
    assert!(held.len() >= 20 && own.is_empty(), "the pool is that of seed 3");
    let goals = |all: &[Episode]| all.iter().map(|episode| episode.goal.clone()).collect::<Vec<_>>();
    assert_eq!(goals(&held), goals(&other_held), "one pool for both runs");
    assert_ne!(goals(&starts), goals(&other_starts), "all else follows the run's seed");
    // The same weights: both runs' untrained students act alike from the same evaluation episodes.
    let first = |seed, more: &[&str]| {
        let all = episodes_of("her-iid", seed, more);
        drawn_from(&all, 5, Purpose::Evaluation(0)).into_iter().map(|one| one.path).collect::<Vec<_>>()
    };
    let both = &["seed.evaluation=5", "seed.weights=5"];
    assert_eq!(first(SEED, both), first(SEED + 1, both));
    assert_ne!(first(SEED, &["seed.evaluation=5"]), first(SEED + 1, &["seed.evaluation=5"]));
    assert_eq!(pool_of(SEED, false).0, [], "unless it is held, the pool is the run's");
}

/// VDS' ensemble learns with the student, not in its warm-up.
#[test]
fn nobody_learns_in_a_warm_up() {
    struct Updates(Vec<(u64, u64)>);
    impl Observer for Updates {
        fn record(&mut self, record: &Record, _: &Teaching, _: &Learning) -> std::io::Result<()> {
            let updates = record.teacher["ensemble_updates"].as_f64().expect("a number");
            self.0.push((record.gradient_steps, updates as u64));
            Ok(())
        }
    }
    let more =
        ["student.warmup_episodes=6", "curriculum.vds.updates_per_cycle=4", "curriculum.vds.candidates=20"];
    let mut updates = Updates(Vec::new());
    observed("vds", SEED, &more, &mut updates);
    // Cycles of two episodes, 4 steps of both in each from the third on, when 6 episodes are over; evaluated
    // every other cycle.
    assert_eq!(updates.0, [(0, 0), (0, 0), (8, 8), (16, 16), (24, 24), (32, 32)]);
}
