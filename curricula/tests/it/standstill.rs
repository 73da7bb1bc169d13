//! A real student that cannot learn, on a task with random starts: whatever weighs goals then is noise.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use agents::{Agent, Mode, StudentConfig};
use curricula::{Lesson, ProposedGoal, Setting};
use envs::rng::{Purpose, Rng, stream};
use envs::{GoalEnv, Rows, draw_pool};

use crate::support::entry;

/// The effective number of goals in the end.
fn taught(states: &str, student: &str) -> f64 {
    agents::prepare_thread();
    let mut env = envs::make("FetchPush", &envs::EnvOptions::default()).unwrap();
    let text = format!("width = 16\nbatch = 32\nactor_lr = 1e-30\ncritic_lr = 1e-30\n{student}");
    let config: StudentConfig = toml::from_str(&text).unwrap();
    let config = config.resolve(env.spec()).unwrap();
    let mut student = agents::make(&config, env.spec(), 0).unwrap();
    let pool = draw_pool(&mut *env, 50, &mut stream(0, Purpose::Pool)).unwrap();
    let setting =
        Setting { spec: env.spec().clone(), pool: std::sync::Arc::new(pool), seed: 0, student: config };
    let own = format!("states = \"{states}\"").parse().unwrap();
    let mut teacher = entry("teach").build(own, &setting).unwrap();
    let purposes = [Purpose::Environment, Purpose::Exploration, Purpose::Replay, Purpose::Teacher];
    let mut streams = purposes.map(|purpose| stream(0, purpose));
    for _ in 0..15 {
        for _ in 0..2 {
            let [starts, exploration, replay, rng] = &mut streams;
            env.reset(starts).unwrap();
            let start = env.observation().clone();
            let lesson = &mut Lesson { student: &mut *student, start: &start, goals: &mut *env, rng };
            let ProposedGoal::Pool(goal) = teacher.propose(lesson).unwrap().goal else {
                panic!("not of the pool")
            };
            env.set_goal(setting.pool.row(goal)).unwrap();
            let episode = play(&mut *env, &mut *student, exploration);
            student.observe(&episode, &*env, replay).unwrap();
        }
        student.learn(&*env, &mut streams[2]).unwrap();
    }
    let numbers = teacher.summary().statistics;
    numbers.iter().find(|(name, _)| *name == "effective_goals").unwrap().1
}

fn play(env: &mut dyn GoalEnv, student: &mut dyn Agent, exploration: &mut Rng) -> agents::Episode {
    let spec = env.spec().clone();
    let [mut states, mut achieved, mut actions] = [spec.state, spec.goal, spec.action].map(Rows::new);
    let mut action = vec![0.0; spec.action];
    states.push(&env.observation().state);
    achieved.push(&env.observation().achieved);
    for _ in 0..spec.horizon {
        student.act(env.observation(), env.goal(), Mode::Explore(exploration), &mut action).unwrap();
        env.step(&action).unwrap();
        states.push(&env.observation().state);
        achieved.push(&env.observation().achieved);
        actions.push(&action);
    }
    let goal = env.goal().to_vec();
    agents::Episode { states, achieved, actions, goal, total_reward: 0.0, success: false }
}

#[test]
fn goals_are_chosen_by_noise_unless_states_and_normalisers_are_held() {
    let held = "normalizer = { feed_episodes = 0 }";
    assert!((taught("reference", held) - 50.0).abs() < 1e-9, "all goals alike");
    for (states, student) in [("replay", held), ("initial", held), ("reference", "")] {
        let effective = taught(states, student);
        assert!(effective < 49.9, "{states}, {student}: {effective}");
    }
}
