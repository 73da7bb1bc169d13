//! Every preset and every noise, and what "auto" becomes.

use agents::{Auto, HerStrategy, Mode, NoiseConfig, PolyakEvery, Preset, StudentConfig};
use envs::rng::{Purpose, stream};

use crate::toy::{Run, small};

/// Batch, hidden layers, episodes per cycle and γ that a preset means for an environment.
fn resolved(preset: Preset, environment: &str) -> ([Auto<usize>; 3], Auto<f64>) {
    let spec = &envs::find(environment).unwrap().spec;
    let config = StudentConfig::preset(preset).resolve(spec).unwrap();
    ([config.batch, config.layers, config.episodes_per_cycle], config.gamma)
}

/// γ = 1 − 1/H: H is 50 for Fetch and HandReach, 100 for the manipulation tasks.
#[test]
fn auto_becomes_the_numbers_of_preset_and_environment() {
    let numbers = |whole: [usize; 3], gamma| (whole.map(Auto::Value), Auto::Value(gamma));
    for (environment, layers, gamma) in [
        ("FetchReach", 2, 0.98),
        ("FetchPickAndPlace", 2, 0.98),
        ("MazeA", 2, 0.98),
        ("HandReach", 3, 0.98),
        ("HandManipulateBlock", 3, 0.99),
    ] {
        let [harmonised, official] = [Preset::Harmonised, Preset::Official].map(|p| resolved(p, environment));
        assert_eq!(harmonised, numbers([1024, layers, 2], gamma), "{environment}");
        assert_eq!(official, numbers([256, 3, 1], gamma), "{environment}");
    }
}

/// Learning is the same for both, however many episodes it comes after: 40 gradient steps, one Polyak update.
#[test]
fn presets_hold_the_published_values() {
    for preset in [Preset::Harmonised, Preset::Official] {
        let config = StudentConfig::preset(preset);
        assert_eq!((config.updates_per_cycle, config.her_k, config.warmup_episodes), (40, 4, 0));
        assert_eq!((config.polyak_every, config.her_strategy), (PolyakEvery::Cycle, HerStrategy::Future));
        assert_eq!((config.width, config.replay_capacity), (256, 1_000_000));
        assert_eq!((config.actor_lr, config.critic_lr, config.polyak), (1e-3, 1e-3, 0.95));
        assert_eq!(config.action_l2, 1.0);
        assert_eq!(config.noise, NoiseConfig::gaussian(0.2, 0.3));
        let normalizer = config.normalizer;
        assert_eq!((normalizer.std_floor, normalizer.clip_before, normalizer.clip_after), (0.01, 200.0, 5.0));
        assert_eq!((normalizer.pseudo_observations, normalizer.feed_episodes), (1, Auto::Auto));
    }
    for (preset, given, episodes) in [
        (Preset::Harmonised, Auto::Value(7), 7),
        (Preset::Harmonised, Auto::Auto, 2),
        (Preset::Official, Auto::Auto, 1),
    ] {
        let config = StudentConfig { preset, episodes_per_cycle: given, ..small() };
        assert_eq!(Run::new(&config, 0).agent.episodes_per_cycle(), episodes);
    }
}

#[test]
fn given_values_win_over_the_preset() {
    let given = StudentConfig {
        preset: Preset::Official,
        batch: Auto::Value(32),
        layers: Auto::Value(1),
        gamma: Auto::Value(0.9),
        episodes_per_cycle: Auto::Value(3),
        ..StudentConfig::default()
    };
    let spec = &envs::find("HandReach").unwrap().spec;
    assert_eq!(given.clone().resolve(spec).unwrap(), given);
}

#[test]
fn every_preset_trains_with_every_noise() {
    let noises = [NoiseConfig::gaussian(0.2, 0.3), NoiseConfig::ornstein_uhlenbeck(0.15, 0.2, 1.0)];
    for preset in [Preset::Harmonised, Preset::Official] {
        for noise in noises {
            let config = StudentConfig { noise, updates_per_cycle: 3, ..StudentConfig::preset(preset) };
            let run = Run::trained(&config, 0, 3);
            assert_eq!(run.agent.gradient_steps(), 9, "{preset:?}, {noise:?}");
        }
    }
}

/// A correlated process must start anew with every episode, or the first action depends on the episode
/// before.
#[test]
fn exploration_starts_anew_with_the_episode() {
    let noise = NoiseConfig::ornstein_uhlenbeck(0.15, 0.2, 1.0);
    let mut run = Run::new(&StudentConfig { noise, ..small() }, 0);
    let first_action = |run: &mut Run| {
        let mut action = [0.0; 2];
        let mode = Mode::Explore(&mut stream(0, Purpose::Exploration));
        run.agent.act(run.env.observation(), &[0.5, 0.5], mode, &mut action).unwrap();
        action
    };
    let first = first_action(&mut run);
    assert_ne!(first_action(&mut run), first, "the process has moved on");
    run.agent.begin_episode();
    assert_eq!(first_action(&mut run), first);
}
