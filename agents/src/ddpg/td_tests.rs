//! Temporal-difference errors of whole episodes.

use envs::rng::{Purpose, stream, uniform};
use envs::{GoalEnv, Rows};

use super::Ddpg;
use crate::agent::{Agent, Critic, Network};
use crate::auto::Auto;
use crate::config::StudentConfig;
use crate::episode::{Episode, Trajectory};
use crate::error::AgentError;

/// A student of the toy task (S = G = A = 2, H = 20, γ = 0.5) that has learned from some random episodes.
fn taught() -> (Ddpg, Box<dyn GoalEnv>) {
    crate::prepare_thread();
    let env = envs::make("Point", &envs::EnvOptions::default()).unwrap();
    let config = StudentConfig {
        batch: Auto::Value(16),
        width: 8,
        updates_per_cycle: 30,
        gamma: Auto::Value(0.5),
        ..StudentConfig::default()
    };
    let mut student = Ddpg::new(&config, env.spec(), 3).unwrap();
    let mut rng = stream(3, Purpose::Replay);
    for _ in 0..6 {
        let mut rows = |n| {
            let mut rows = Rows::new(2);
            (0..n).for_each(|_| rows.push(&[(); 2].map(|()| uniform(&mut rng, -1.0, 1.0))));
            rows
        };
        let (states, achieved, actions) = (rows(21), rows(21), rows(20));
        let goal = achieved.row(7).to_vec();
        let episode = Episode { states, achieved, actions, goal, total_reward: 0.0, success: false };
        student.observe(&episode, env.as_ref(), &mut rng).unwrap();
        student.learn(env.as_ref(), &mut rng).unwrap();
    }
    (student, env)
}

/// Q(s, g, π(s, g)) at every state.
fn values(student: &mut Ddpg, states: &Rows, goal: &[f64], network: Network) -> Vec<f64> {
    let mut goals = Rows::new(goal.len());
    goals.push(goal);
    let one = |state: &[f64]| {
        let mut states = Rows::new(state.len());
        states.push(state);
        student.confidence(&goals, &states, network).unwrap()[0]
    };
    states.iter().map(one).collect()
}

/// With the policy's own actions, both terms of the error can be asked for one by one.
#[test]
fn errors_lie_between_the_critics_target_and_its_value_of_the_action_taken() {
    let (mut student, env) = taught();
    let mut trajectory = student.replay_trajectory(2).unwrap();
    let Trajectory { ref states, ref achieved, ref goal, .. } = trajectory;
    let mut goals = Rows::new(2);
    states.iter().for_each(|_| goals.push(goal));
    let policy = student.policy(states, &goals, Network::Online).unwrap();
    let now = values(&mut student, states, goal, Network::Online);
    let next = values(&mut student, states, goal, Network::Target);
    let rewards: Vec<f64> = achieved.iter().map(|reached| env.reward(reached, goal)).collect();
    assert!(rewards.contains(&0.0) && rewards.contains(&-1.0), "the goal was achieved once");
    let mut actions = Rows::new(2);
    (0..20).for_each(|step| actions.push(policy.row(step)));
    let taken = std::mem::replace(&mut trajectory.actions, actions);

    let errors = student.td_errors(&trajectory, env.as_ref()).unwrap();
    assert_eq!(errors.len(), 20);
    for (step, &error) in errors.iter().enumerate() {
        let target = (rewards[step + 1] + 0.5 * next[step + 1]).clamp(-2.0, 0.0);
        assert!((error - (target - now[step])).abs() < 1e-5, "step {step}: {error}");
    }
    trajectory.actions = taken;
    let others = student.td_errors(&trajectory, env.as_ref()).unwrap();
    assert!(errors.iter().zip(&others).all(|(a, b)| a != b), "the action taken is the one that is judged");
}

#[test]
fn asking_changes_nothing_and_episodes_of_other_tasks_are_refused() {
    let (mut student, env) = taught();
    let trajectory = student.replay_trajectory(0).unwrap();
    let before = super::state::encode(&student).unwrap();
    let errors = student.td_errors(&trajectory, env.as_ref()).unwrap();
    assert_eq!(student.td_errors(&trajectory, env.as_ref()).unwrap(), errors);
    assert!(super::state::encode(&student).unwrap() == before);
    let mut other = trajectory.clone();
    other.goal.push(0.0);
    assert!(matches!(student.td_errors(&other, env.as_ref()), Err(AgentError::Shape { .. })));
    let mut short = trajectory;
    short.actions = Rows::new(2);
    assert!(matches!(student.td_errors(&short, env.as_ref()), Err(AgentError::Shape { .. })));
}
