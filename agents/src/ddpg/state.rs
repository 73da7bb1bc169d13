//! Saving and loading a student, except for its replay buffer.
//!
//! The bytes are sealed with magic, version and CRC-32. Hyper-parameters are not part of it: the
//! caller knows them, and parameters of another shape are refused.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Ddpg;
use crate::batch::Dims;
use crate::config::StudentConfig;
use crate::error::AgentError;
use crate::networks::SavedStack;
use crate::normalizer::Moments;
use crate::replay::read_all;
use crate::seal::Seal;

const SEAL: Seal = Seal { magic: *b"GBDH", version: 2, what: "a student's state" };

/// Everything that makes a student, except its config and its replay buffer.
#[derive(Serialize, Deserialize)]
struct Saved {
    environment: String,
    actor: SavedStack,
    critic: SavedStack,
    gradient_steps: u64,
    state_moments: Moments,
    goal_moments: Moments,
    noise: Vec<f64>,
    /// Episodes that had come into the replay buffer.
    episodes: u64,
}

/// The state of `student` as bytes.
///
/// # Errors
/// [`AgentError::Torch`] if the parameters cannot be read.
pub(super) fn encode(student: &Ddpg) -> Result<Vec<u8>, AgentError> {
    let saved = Saved {
        environment: student.spec.id.to_owned(),
        actor: student.networks.actor.save()?,
        critic: student.networks.critic.save()?,
        gradient_steps: student.networks.steps(0),
        state_moments: student.normalizers.state.moments().clone(),
        goal_moments: student.normalizers.goal.moments().clone(),
        noise: student.noise.process().to_vec(),
        episodes: student.replay.stored(),
    };
    Ok(SEAL.close(&saved))
}

/// Makes `student` the one that [`encode`] was given, except for the replay buffer. Returns how many episodes
/// had come into that buffer.
///
/// # Errors
/// [`AgentError::State`] if `state` is damaged or of another student.
pub(super) fn decode(student: &mut Ddpg, state: &[u8]) -> Result<u64, AgentError> {
    let saved: Saved = SEAL.open(state).map_err(|error| AgentError::State { source: error.into() })?;
    if saved.environment != student.spec.id {
        let reason = format!("of a student of {}, not of {}", saved.environment, student.spec.id);
        return Err(AgentError::misfit(reason));
    }
    if saved.noise.len() != student.spec.action {
        return Err(AgentError::misfit(format!("noise of {} components", saved.noise.len())));
    }
    student.networks.actor.load(&saved.actor)?;
    student.networks.critic.load(&saved.critic)?;
    student.inference.forget();
    student.normalizers.state.set_moments(saved.state_moments)?;
    student.normalizers.goal.set_moments(saved.goal_moments)?;
    student.noise.set_process(&saved.noise);
    Ok(saved.episodes)
}

/// What [`AgentRow::check_replay`](crate::registry::AgentRow) does.
pub(crate) fn check_replay(
    config: &StudentConfig,
    state: &[u8],
    steps: u64,
    folder: &Path,
) -> Result<(), AgentError> {
    let saved: Saved = SEAL.open(state).map_err(|error| AgentError::State { source: error.into() })?;
    // Every episode takes as many steps as every other.
    let horizon = steps.checked_div(saved.episodes).filter(|horizon| horizon * saved.episodes == steps);
    let Some(horizon) = horizon.and_then(|horizon| usize::try_from(horizon).ok()).filter(|&n| n > 0) else {
        let reason = format!("of {} episodes, though {steps} steps were taken", saved.episodes);
        return if (saved.episodes, steps) == (0, 0) { Ok(()) } else { Err(AgentError::misfit(reason)) };
    };
    let [state, goal] = [&saved.state_moments, &saved.goal_moments].map(Moments::width);
    let dims = Dims { state, goal, action: saved.noise.len() };
    let kept = (config.replay_capacity / horizon) as u64;
    let oldest = saved.episodes.saturating_sub(kept);
    read_all(folder, dims.episode_len(horizon), oldest..saved.episodes, |_, _| {})
}

#[cfg(test)]
mod tests {
    use std::error::Error as _;

    use envs::rng::{Purpose, Rng, stream};

    use crate::StudentConfig;
    use crate::agent::{Agent, Mode};
    use crate::episode::Episode;
    use crate::error::AgentError;
    use crate::registry::make;

    /// A student, its environment and streams, small enough to train in a blink.
    struct Scene {
        env: Box<dyn envs::GoalEnv>,
        agent: Box<dyn Agent>,
        streams: [Rng; 3],
    }

    impl Scene {
        fn new(more: &str) -> Self {
            crate::prepare_thread();
            let env = envs::make("Point", &envs::EnvOptions::default()).unwrap();
            let text =
                format!("width = 16\nbatch = 32\nupdates_per_cycle = 3\nreplay_capacity = 100\n{more}");
            let config: StudentConfig = toml::from_str(&text).unwrap();
            let agent = make(&config, env.spec(), 5).unwrap();
            let purposes = [Purpose::Environment, Purpose::Exploration, Purpose::Replay];
            Self { env, agent, streams: purposes.map(|purpose| stream(5, purpose)) }
        }

        fn cycles(&mut self, count: usize) {
            for _ in 0..count {
                for _ in 0..self.agent.episodes_per_cycle() {
                    self.episode();
                }
                self.agent.learn(self.env.as_ref(), &mut self.streams[2]).unwrap();
            }
        }

        fn episode(&mut self) {
            let Self { env, agent, streams: [starts, exploration, replay] } = self;
            let spec = env.spec().clone();
            env.reset(starts).unwrap();
            agent.begin_episode();
            let [mut states, mut achieved, mut actions] =
                [spec.state, spec.goal, spec.action].map(envs::Rows::new);
            let mut action = vec![0.0; spec.action];
            states.push(&env.observation().state);
            achieved.push(&env.observation().achieved);
            for _ in 0..spec.horizon {
                agent.act(env.observation(), env.goal(), Mode::Explore(exploration), &mut action).unwrap();
                env.step(&action).unwrap();
                states.push(&env.observation().state);
                achieved.push(&env.observation().achieved);
                actions.push(&action);
            }
            let episode = Episode {
                states,
                achieved,
                actions,
                goal: env.goal().to_vec(),
                total_reward: 0.0,
                success: false,
            };
            agent.observe(&episode, env.as_ref(), replay).unwrap();
        }
    }

    /// The first save comes after 4 of 8 episodes, in the middle of every warm-up and annealing below, and
    /// the ring (5 episodes of 20 steps) wraps between the two saves.
    #[test]
    fn going_on_from_a_save_gives_the_same_bytes_as_never_having_stopped() {
        for config in [
            "",
            "noise = { kind = 'ornstein-uhlenbeck' }",
            "noise = { kind = 'gaussian', final_scale = 0.1, anneal_episodes = 6 }",
            "noise = { kind = 'ornstein-uhlenbeck', final_scale = 0.1, anneal_episodes = 6 }",
            "warmup_episodes = 5",
            "normalizer = { pseudo_observations = 0 }",
            "normalizer = { pseudo_observations = 30 }",
            "normalizer = { feed_episodes = 5 }",
            "normalizer = { feed_episodes = 0 }",
            "polyak_every = 'update'",
            "her_strategy = 'final'",
            "her_strategy = 'episode'",
            "precision = 'bf16'",
        ] {
            let (folder, undisturbed) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
            let mut scene = Scene::new(config);
            scene.cycles(2);
            let state = scene.agent.save(folder.path()).unwrap();
            let streams = scene.streams.clone();
            scene.cycles(2);
            let expected = scene.agent.save(undisturbed.path()).unwrap();

            let mut resumed = Scene::new(config);
            resumed.agent.load(&state, folder.path()).unwrap();
            resumed.streams = streams;
            resumed.cycles(2);
            assert!(resumed.agent.save(folder.path()).unwrap() == expected, "{config}");
        }
    }

    #[test]
    fn damaged_and_foreign_states_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut scene = Scene::new("");
        scene.cycles(1);
        let state = scene.agent.save(folder.path()).unwrap();
        let cause = |error: AgentError| error.source().expect("what is wrong").to_string();
        let refusal = |bytes: &[u8]| cause(Scene::new("").agent.load(bytes, folder.path()).unwrap_err());
        let mut altered = state.clone();
        altered[200] ^= 1;
        assert!(refusal(&altered).contains("checksum"));
        assert!(refusal(&state[..state.len() - 9]).contains("checksum"));
        assert!(refusal(&state[..5]).contains("5 bytes"));
        assert!(refusal(b"nonsense, and long").contains("not a student's state"));
        let mut version = state.clone();
        version[4] = 7;
        assert!(refusal(&version).contains("version 7"));
        let mut deeper = Scene::new("layers = 3");
        assert!(cause(deeper.agent.load(&state, folder.path()).unwrap_err()).contains("parameters"));
    }
}
