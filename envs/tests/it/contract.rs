//! What every environment of the registry must keep to.

use std::collections::BTreeSet;

use envs::rng::{Purpose, Rng, stream};
use envs::{ENVIRONMENTS, EnvError, Family, GoalEnv, Options, find, make, registry, suite};
use proptest::prelude::*;
use rand::Rng as _;

/// One of each kind of environment; tests that step a lot look at these alone.
const KINDS: [&str; 9] = [
    "Point",
    "MazeA",
    "FetchReach",
    "FetchPush",
    "FetchPickAndPlace",
    "HandReach",
    "HandManipulateBlockRotateParallel",
    "HandManipulatePen",
    "HandManipulateEggRotate",
];

fn build(id: &str) -> Box<dyn GoalEnv> {
    make(id, &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn random_action(env: &dyn GoalEnv, rng: &mut Rng) -> Vec<f64> {
    (0..env.spec().action).map(|_| rng.random_range(-1.0..1.0)).collect()
}

/// Everything an episode shows: start, goal, and all of `steps` random steps.
fn episode(env: &mut dyn GoalEnv, seed: u64, steps: usize) -> Vec<Vec<f64>> {
    env.reset(&mut stream(seed, Purpose::Environment)).unwrap();
    let mut shown = vec![env.goal().to_vec(), env.observation().state.clone()];
    let mut actions = stream(seed, Purpose::Exploration);
    for _ in 0..steps {
        let action = random_action(env, &mut actions);
        env.step(&action).unwrap();
        shown.extend([env.observation().state.clone(), env.observation().achieved.clone()]);
    }
    shown
}

#[test]
fn ids_are_unique_and_dimensions_are_those_of_the_reference() {
    let ids: BTreeSet<_> = ENVIRONMENTS.iter().map(|row| row.spec.id).collect();
    assert_eq!((ids.len(), ENVIRONMENTS.len()), (16, 16));
    for row in ENVIRONMENTS {
        let spec = &row.spec;
        let expected = match spec.id {
            "Point" => (Family::Toy, 2, 2, 2, 20),
            "MazeA" | "MazeB" | "MazeC" => (Family::Maze, 2, 2, 2, 50),
            "FetchReach" => (Family::Fetch, 10, 3, 4, 50),
            "FetchPush" | "FetchSlide" | "FetchPickAndPlace" => (Family::Fetch, 25, 3, 4, 50),
            "HandReach" => (Family::Hand, 63, 15, 20, 50),
            id if id.starts_with("HandManipulate") => (Family::Hand, 61, 7, 20, 100),
            id => panic!("{id} has no expected dimensions"),
        };
        assert_eq!((spec.family, spec.state, spec.goal, spec.action, spec.horizon), expected, "{}", spec.id);
        let env = build(spec.id);
        assert_eq!(env.spec(), spec);
        assert_eq!(env.observation().state.len(), spec.state);
        assert_eq!(env.observation().achieved.len(), spec.goal);
        assert_eq!(env.goal().len(), spec.goal);
        assert!(!row.title.is_empty());
        assert_eq!(row.paper.map(|paper| paper.action), (spec.family == Family::Fetch).then_some(3));
    }
}

#[test]
fn suites_hold_the_papers_eleven_tasks() {
    for name in ["paper", "paper-ids"] {
        let ids = suite(name).unwrap();
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), 11, "{name}");
        assert!(ids.iter().all(|id| find(id).is_ok()), "{name}");
    }
    let rotating = suite("paper").unwrap().iter().filter(|id| id.contains("Rotate")).count();
    assert_eq!(rotating, 3, "appendix B describes rotation tasks");
}

#[test]
fn unknown_names_are_errors_that_list_the_known_ones() {
    let unknown = make("FetchFly", &Options::default()).err().unwrap().to_string();
    assert!(unknown.contains("`FetchFly`") && unknown.contains("HandManipulateEggRotate"), "{unknown}");
    let unknown = suite("papers").unwrap_err().to_string();
    assert!(unknown.contains("`papers`") && unknown.contains("paper-ids"), "{unknown}");
    assert_eq!(registry::SUITES.len(), 2);
}

#[test]
fn an_episode_depends_on_its_stream_alone() {
    for row in ENVIRONMENTS {
        let mut used = build(row.spec.id);
        episode(used.as_mut(), 1, 12);
        used.set_goal(&vec![0.25; row.spec.goal]).unwrap();
        used.sample_goal(&mut stream(9, Purpose::Teacher), &mut vec![0.0; row.spec.goal]);
        let again = episode(used.as_mut(), 2, 8);
        assert_eq!(again, episode(build(row.spec.id).as_mut(), 2, 8), "{}", row.spec.id);
        assert_ne!(again, episode(used.as_mut(), 3, 8), "{}: another stream, another episode", row.spec.id);
    }
}

/// Evaluations step several instances in turn.
#[test]
fn instances_stepped_in_turn_do_not_disturb_each_other() {
    for id in KINDS {
        let mut pair = [build(id), build(id)];
        let seeds = [4, 5];
        let mut actions = seeds.map(|seed| stream(seed, Purpose::Exploration));
        for (env, seed) in pair.iter_mut().zip(seeds) {
            env.reset(&mut stream(seed, Purpose::Environment)).unwrap();
        }
        for _ in 0..8 {
            for (env, actions) in pair.iter_mut().zip(&mut actions) {
                env.step(&random_action(env.as_ref(), actions)).unwrap();
            }
        }
        for (env, seed) in pair.iter().zip(seeds) {
            let alone = episode(build(id).as_mut(), seed, 8);
            assert_eq!(env.goal(), alone[0], "{id}");
            assert_eq!(Some(&env.observation().achieved), alone.last(), "{id}");
        }
    }
}

#[test]
fn a_goal_is_refused_or_taken_whole() {
    for row in ENVIRONMENTS {
        let (id, width) = (row.spec.id, row.spec.goal);
        let mut env = build(id);
        env.reset(&mut stream(0, Purpose::Environment)).unwrap();
        let before = env.goal().to_vec();
        let short = env.set_goal(&vec![0.5; width - 1]).unwrap_err();
        assert!(matches!(short, EnvError::GoalLength { got, .. } if got == width - 1), "{id}: {short}");
        let mut broken = vec![0.5; width];
        broken[width - 1] = f64::NAN;
        let nan = env.set_goal(&broken).unwrap_err();
        assert!(
            matches!(nan, EnvError::NotFinite { what: "goal", index, .. } if index == width - 1),
            "{id}: {nan}"
        );
        assert_eq!(env.goal(), before, "{id}: the old goal stays");
        env.set_goal(&vec![0.5; width]).unwrap();
        assert_eq!(env.goal(), vec![0.5; width], "{id}");
    }
}

#[test]
fn a_bad_action_is_refused_and_changes_nothing() {
    for row in ENVIRONMENTS {
        let (id, width) = (row.spec.id, row.spec.action);
        let (mut env, mut twin) = (build(id), build(id));
        for env in [&mut env, &mut twin] {
            env.reset(&mut stream(0, Purpose::Environment)).unwrap();
        }
        let long = env.step(&vec![0.0; width + 1]).unwrap_err();
        assert!(matches!(long, EnvError::ActionLength { got, .. } if got == width + 1), "{id}: {long}");
        for bad in [f64::NAN, f64::INFINITY] {
            let mut action = vec![0.0; width];
            action[1] = bad;
            let error = env.step(&action).unwrap_err();
            assert!(matches!(error, EnvError::NotFinite { what: "action", index: 1, .. }), "{id}: {error}");
        }
        assert_eq!(env.observation(), twin.observation(), "{id}");
        for env in [&mut env, &mut twin] {
            env.step(&vec![0.3; width]).unwrap();
        }
        assert_eq!(env.observation(), twin.observation(), "{id}: usable as if nothing had happened");
    }
}

#[test]
fn a_sampled_goal_leaves_the_episode_alone() {
    for row in ENVIRONMENTS {
        let (mut env, mut twin) = (build(row.spec.id), build(row.spec.id));
        for env in [&mut env, &mut twin] {
            env.reset(&mut stream(4, Purpose::Environment)).unwrap();
        }
        let mut goal = vec![f64::NAN; row.spec.goal];
        env.sample_goal(&mut stream(5, Purpose::Teacher), &mut goal);
        assert!(goal.iter().all(|part| part.is_finite()), "{}", row.spec.id);
        assert_ne!(goal, env.goal(), "{}: another draw", row.spec.id);
        assert_eq!((env.goal(), env.observation()), (twin.goal(), twin.observation()), "{}", row.spec.id);
        let mut after_a_step = vec![0.0; row.spec.goal];
        env.step(&vec![1.0; row.spec.action]).unwrap();
        env.sample_goal(&mut stream(5, Purpose::Teacher), &mut after_a_step);
        assert_eq!(after_a_step, goal, "{}: goals belong to the start, not to the moment", row.spec.id);
    }
}

#[test]
fn what_is_achieved_succeeds_as_its_own_goal() {
    for row in ENVIRONMENTS {
        let mut env = build(row.spec.id);
        env.reset(&mut stream(0, Purpose::Environment)).unwrap();
        env.step(&vec![0.2; row.spec.action]).unwrap();
        let achieved = env.observation().achieved.clone();
        assert!(env.success(&achieved, &achieved), "{}", row.spec.id);
        assert_eq!(env.reward(&achieved, &achieved), 0.0, "{}", row.spec.id);
        let far = far_from(&achieved);
        assert!(!env.success(&achieved, &far), "{}", row.spec.id);
        assert_eq!(env.reward(&achieved, &far), -1.0, "{}", row.spec.id);
    }
}

/// A metre away in every coordinate; a pose is also turned by 180°.
fn far_from(achieved: &[f64]) -> Vec<f64> {
    match *achieved {
        [x, y, z, qw, qx, qy, qz] => vec![x + 1.0, y + 1.0, z + 1.0, -qx, qw, -qz, qy],
        _ => achieved.iter().map(|part| part + 1.0).collect(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    #[test]
    fn actions_beyond_the_bounds_equal_clipped_ones(seed: u64, scale in 1.0..1e6_f64) {
        for id in KINDS {
            let (mut env, mut twin) = (build(id), build(id));
            for env in [&mut env, &mut twin] {
                env.reset(&mut stream(seed, Purpose::Environment)).unwrap();
            }
            let mut rng = stream(seed, Purpose::Exploration);
            for _ in 0..3 {
                let action: Vec<f64> = random_action(env.as_ref(), &mut rng).iter().map(|a| a * scale).collect();
                let clipped: Vec<f64> = action.iter().map(|part| part.clamp(-1.0, 1.0)).collect();
                env.step(&action).unwrap();
                twin.step(&clipped).unwrap();
                prop_assert_eq!(env.observation(), twin.observation(), "{}", id);
            }
        }
    }

    #[test]
    fn reward_is_zero_exactly_where_there_is_success(seed: u64, closeness in 0.0..1.0_f64) {
        for id in KINDS {
            let mut env = build(id);
            env.reset(&mut stream(seed, Purpose::Environment)).unwrap();
            let (achieved, goal) = (env.observation().achieved.clone(), env.goal().to_vec());
            let between: Vec<f64> =
                achieved.iter().zip(&goal).map(|(a, g)| a + (g - a) * closeness).collect();
            let reward = if env.success(&achieved, &between) { 0.0 } else { -1.0 };
            prop_assert_eq!(env.reward(&achieved, &between), reward, "{}", id);
        }
    }
}
