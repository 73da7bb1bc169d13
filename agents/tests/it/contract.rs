//! What does not fit is refused with a typed error that says what was wrong.

use agents::{Agent, AgentError, Auto, Batch, Episode, Mode, Network, NoiseConfig, StudentConfig};
use envs::rng::{Purpose, stream};
use envs::{Observation, Rows};

use crate::support::{FETCH, Still, random_episode, random_rows};
use crate::toy::{Run, small};

fn fetch_student() -> Box<dyn Agent> {
    agents::prepare_thread();
    agents::make(&small(), &FETCH, 0).unwrap()
}

fn assert_shape<T: std::fmt::Debug>(outcome: Result<T, AgentError>, wrong: &str) {
    match outcome {
        Err(AgentError::Shape { what, expected, got }) => {
            assert!(what.contains(wrong) && expected != got, "{what}: {expected}, {got}");
        }
        other => panic!("a wrong {wrong} gave {other:?}"),
    }
}

#[test]
fn wrong_lengths_are_refused_by_act() {
    let mut agent = fetch_student();
    let mut act = |state: usize, goal: usize, action: usize| {
        let observation = Observation { state: vec![0.0; state], achieved: vec![0.0; 3] };
        agent.act(&observation, &vec![0.0; goal], Mode::Greedy, &mut vec![0.0; action])
    };
    act(25, 3, 4).unwrap();
    for (wrong, state, goal, action) in [
        ("state", 24, 3, 4),
        ("state", 26, 3, 4),
        ("goal", 25, 2, 4),
        ("goal", 25, 4, 4),
        ("action", 25, 3, 3),
    ] {
        assert_shape(act(state, goal, action), wrong);
    }
}

#[test]
fn wrong_shapes_are_refused_by_questions() {
    let mut agent = fetch_student();
    let rng = &mut stream(0, Purpose::Pool);
    let mut rows = |n, width| random_rows(n, width, rng);
    let (states, goals) = (rows(5, 25), rows(5, 3));
    let (narrow_states, narrow_goals, wide_goals) = (rows(5, 24), rows(5, 2), rows(5, 4));
    for network in [Network::Online, Network::Target] {
        agent.policy(&states, &goals, network).unwrap();
        assert_shape(agent.policy(&narrow_states, &goals, network), "state");
        assert_shape(agent.policy(&states, &narrow_goals, network), "goal");
        assert_shape(agent.policy(&states, &wide_goals, network), "goal");
        assert_shape(agent.policy(&states, &rows(4, 3), network), "goals");
        assert_shape(agent.confidence(&goals, &narrow_states, network), "state");
        assert_shape(agent.confidence(&wide_goals, &states, network), "goal");
        assert_shape(agent.confidence(&goals, &Rows::new(25), network), "states");
        assert_eq!(agent.confidence(&Rows::new(3), &states, network).unwrap(), [0.0; 0]);
    }
}

/// A batch of another task, for both methods that take one.
#[test]
fn wrong_batches_are_refused() {
    let mut run = Run::trained(&small(), 0, 1);
    let mut batch = Batch::new(&FETCH, 8);
    assert_shape(run.agent.label_next_actions(&mut batch, Network::Online), "state");
    let outcome = run.agent.replay_batch(run.env.as_ref(), &mut stream(0, Purpose::Teacher), &mut batch);
    assert_shape(outcome, "state");
}

#[test]
fn wrong_episodes_are_refused_and_leave_no_trace() {
    let rng = &mut stream(0, Purpose::Replay);
    let good = random_episode(&FETCH, rng);
    let mut rows = |n, width| random_rows(n, width, rng);
    let wrong = [
        ("states", Episode { states: rows(50, 25), ..good.clone() }),
        ("states", Episode { states: rows(51, 24), ..good.clone() }),
        ("achieved", Episode { achieved: rows(52, 3), ..good.clone() }),
        ("actions", Episode { actions: rows(51, 4), ..good.clone() }),
        ("actions", Episode { actions: rows(50, 3), ..good.clone() }),
        ("goal", Episode { goal: vec![0.0; 2], ..good.clone() }),
    ];
    let (mut agent, env) = (fetch_student(), Still::new(FETCH));
    for (part, episode) in wrong {
        assert_shape(agent.observe(&episode, &env, &mut stream(0, Purpose::Replay)), part);
    }
    let outcome = agent.learn(&env, &mut stream(0, Purpose::Replay));
    assert!(matches!(outcome, Err(AgentError::EmptyReplay)), "{outcome:?}");
    assert!(agent.replay_states(3, &mut stream(0, Purpose::Teacher)).is_empty());
    agent.observe(&good, &env, &mut stream(0, Purpose::Replay)).unwrap();
    agent.learn(&env, &mut stream(0, Purpose::Replay)).unwrap();
    assert_eq!(agent.replay_states(3, &mut stream(0, Purpose::Teacher)).len(), 3);
}

#[test]
fn nan_in_the_replay_is_divergence_at_the_first_gradient_step() {
    let rng = &mut stream(0, Purpose::Replay);
    let mut poisoned = random_episode(&FETCH, rng);
    let mut states = Rows::new(25);
    poisoned.states.iter().for_each(|_| states.push(&[f64::NAN; 25]));
    poisoned.states = states;
    let (mut agent, env) = (fetch_student(), Still::new(FETCH));
    agent.observe(&poisoned, &env, rng).unwrap();
    let outcome = agent.learn(&env, rng);
    assert!(matches!(outcome, Err(AgentError::Diverged { gradient_steps: 1, .. })), "{outcome:?}");
}

#[test]
fn every_range_is_checked_and_the_field_named() {
    let with = |change: fn(&mut StudentConfig)| {
        let mut config = StudentConfig::default();
        change(&mut config);
        config
    };
    let (gaussian, correlated) = (NoiseConfig::gaussian, NoiseConfig::ornstein_uhlenbeck);
    let annealed = |final_scale, anneal_episodes| NoiseConfig::Gaussian {
        std: 0.2,
        random_epsilon: 0.3,
        final_scale,
        anneal_episodes,
    };
    let noisy = |noise| StudentConfig { noise, ..StudentConfig::default() };
    let wrong = [
        ("batch", with(|c| c.batch = Auto::Value(0))),
        ("width", with(|c| c.width = 0)),
        ("layers", with(|c| c.layers = Auto::Value(0))),
        ("layers", with(|c| c.layers = Auto::Value(9))),
        ("gamma", with(|c| c.gamma = Auto::Value(1.0))),
        ("gamma", with(|c| c.gamma = Auto::Value(-0.1))),
        ("gamma", with(|c| c.gamma = Auto::Value(f64::NAN))),
        ("actor_lr", with(|c| c.actor_lr = 0.0)),
        ("actor_lr", with(|c| c.actor_lr = f64::INFINITY)),
        ("critic_lr", with(|c| c.critic_lr = -1e-3)),
        ("critic_lr", with(|c| c.critic_lr = f64::NAN)),
        ("polyak", with(|c| c.polyak = 1.01)),
        ("polyak", with(|c| c.polyak = f64::NAN)),
        ("episodes_per_cycle", with(|c| c.episodes_per_cycle = Auto::Value(0))),
        ("episodes_per_cycle", with(|c| c.episodes_per_cycle = Auto::Value(1_000_001))),
        ("updates_per_cycle", with(|c| c.updates_per_cycle = 0)),
        ("action_l2", with(|c| c.action_l2 = -1.0)),
        ("replay_capacity", with(|c| c.replay_capacity = FETCH.horizon - 1)),
        ("normalizer.std_floor", with(|c| c.normalizer.std_floor = 0.0)),
        ("normalizer.clip_before", with(|c| c.normalizer.clip_before = -1.0)),
        ("normalizer.clip_after", with(|c| c.normalizer.clip_after = f64::NAN)),
        ("normalizer.pseudo_observations", with(|c| c.normalizer.pseudo_observations = 1_000_001)),
        ("normalizer.feed_episodes", with(|c| c.normalizer.feed_episodes = Auto::Value(1_000_000_001))),
        ("noise.std", noisy(gaussian(-0.1, 0.3))),
        ("noise.random_epsilon", noisy(gaussian(0.2, 1.5))),
        ("noise.theta", noisy(correlated(-1.0, 0.2, 1.0))),
        ("noise.sigma", noisy(correlated(0.15, f64::NAN, 1.0))),
        ("noise.dt", noisy(correlated(0.15, 0.2, 0.0))),
        ("noise.final_scale", noisy(annealed(1.1, 5))),
        ("noise.final_scale", noisy(annealed(f64::NAN, 5))),
        ("warmup_episodes", with(|c| c.warmup_episodes = 1_000_000_001)),
        ("noise.anneal_episodes", noisy(annealed(0.5, 1_000_000_001))),
    ];
    for (name, config) in wrong {
        match agents::make(&config, &FETCH, 0).map(|_| ()) {
            Err(AgentError::Config { field, reason }) => {
                assert!(field == name && reason.contains("accepted"), "{name}: {field}: {reason}");
            }
            other => panic!("a wrong {name} gave {other:?}"),
        }
    }
}

#[test]
fn the_ends_of_the_ranges_are_accepted() {
    agents::prepare_thread();
    let least = StudentConfig {
        batch: Auto::Value(1),
        width: 1,
        layers: Auto::Value(8),
        gamma: Auto::Value(0.0),
        polyak: 1.0,
        episodes_per_cycle: Auto::Value(1),
        updates_per_cycle: 1,
        her_k: 0,
        action_l2: 0.0,
        noise: NoiseConfig::gaussian(0.0, 1.0),
        replay_capacity: FETCH.horizon,
        ..StudentConfig::default()
    };
    let mut agent = agents::make(&least, &FETCH, 0).unwrap();
    let (env, rng) = (Still::new(FETCH), &mut stream(0, Purpose::Replay));
    for _ in 0..2 {
        agent.observe(&random_episode(&FETCH, rng), &env, rng).unwrap();
        agent.learn(&env, rng).unwrap();
    }
    assert_eq!(agent.gradient_steps(), 2);
}

#[test]
fn an_unknown_agent_is_answered_with_the_known_ones() {
    let config = StudentConfig { agent: "ddpg".to_owned(), ..StudentConfig::default() };
    match agents::make(&config, &FETCH, 0).map(|_| ()) {
        Err(AgentError::Unknown { name, known }) => assert_eq!((&*name, &*known), ("ddpg", "ddpg-her")),
        other => panic!("{other:?}"),
    }
}
