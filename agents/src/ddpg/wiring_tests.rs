//! What the student's parts are told to do, and when: each part has tests of its own.

use envs::rng::{Purpose, Rng, stream};
use envs::{Defaults, GoalEnv, Observation, Rows, Spec};

use super::{Ddpg, state};
use crate::agent::{Agent, Critic, Mode, Network};
use crate::auto::Auto;
use crate::batch::Batch;
use crate::config::{PolyakEvery, Preset, StudentConfig};
use crate::ddpg::ROWS_ASKED_AFAR;
use crate::device::far_away;
use crate::draw::{HerStrategy, Hindsight};
use crate::episode::Episode;
use crate::error::AgentError;
use crate::networks::{Parameters, Trained};
use crate::noise::{Noise, NoiseConfig, uniform};
use crate::normalizer::{Normalizer, NormalizerConfig};
use crate::replay::Source;

/// A student of the toy task (S = G = A = 2, H = 20), the task, and a stream for replay.
fn scene(config: &StudentConfig) -> (Ddpg, Box<dyn GoalEnv>, Rng) {
    crate::prepare_thread();
    let env = envs::make("Point", &envs::EnvOptions::default()).unwrap();
    (Ddpg::new(config, env.spec(), 3).unwrap(), env, stream(3, Purpose::Replay))
}

pub(super) fn small() -> StudentConfig {
    StudentConfig { batch: Auto::Value(16), width: 8, updates_per_cycle: 3, ..StudentConfig::default() }
}

/// Episode number e in numbers that say where they belong: at step t the state is (e, t) and the achieved
/// goal (e, t/100); the goal asked for is (−e, 0).
pub(super) fn episode(number: u16) -> Episode {
    let e = f64::from(number);
    let [mut states, mut achieved, mut actions] = [2, 2, 2].map(Rows::new);
    for t in 0..=20 {
        states.push(&[e, f64::from(t)]);
        achieved.push(&[e, f64::from(t) / 100.0]);
        if t < 20 {
            actions.push(&[0.1, -0.1]);
        }
    }
    Episode { states, achieved, actions, goal: vec![-e, 0.0], total_reward: 0.0, success: false }
}

#[test]
fn every_new_episode_feeds_the_normalisers_with_as_many_relabelled_draws_of_it_as_it_has_steps() {
    for (her_k, share) in [(4, 0.8), (1, 0.5), (0, 0.0)] {
        let normalizer = NormalizerConfig { clip_before: 15.0, ..NormalizerConfig::default() };
        let (mut student, env, mut rng) = scene(&StudentConfig { her_k, normalizer, ..small() });
        let [mut states, mut goals] = [2, 2].map(|width| Normalizer::new(normalizer, width));
        let mut relabelled = 0;
        for number in 1..=60 {
            student.observe(&episode(number), env.as_ref(), &mut rng).unwrap();
            let fresh = &student.fresh;
            assert_eq!((fresh.len(), fresh.goals.len()), (20, 40));
            for (state, goal) in fresh.states.chunks_exact(2).zip(fresh.goals.chunks_exact(2)) {
                assert_eq!((state[0], goal[0].abs()), (f32::from(number), f32::from(number)));
                relabelled += u32::from(goal[0] > 0.0);
            }
            states.update(&fresh.states);
            goals.update(&fresh.goals);
            assert_eq!(student.normalizers.state.moments(), states.moments(), "episode {number}");
            assert_eq!(student.normalizers.goal.moments(), goals.moments(), "episode {number}");
        }
        // 1200 draws: a standard deviation is at most 0.015.
        let got = f64::from(relabelled) / 1200.0;
        assert!((got - share).abs() < 0.05, "{share} expected for k = {her_k}, {got} came");
    }
}

/// Mean and deviation are those of the first episodes. Batches are drawn as they would be without a limit.
#[test]
fn later_episodes_than_those_that_feed_leave_the_normalisers_as_they_are() {
    let normalizer = |feed_episodes| NormalizerConfig { feed_episodes, ..NormalizerConfig::default() };
    let (mut free, env, mut rng) = scene(&small());
    let mut limited = [0, 2].map(|limit| {
        let config = StudentConfig { normalizer: normalizer(Auto::Value(limit)), ..small() };
        (limit, scene(&config).0, free.normalizers.clone())
    });
    for number in 1..=4 {
        let before = rng.clone();
        free.observe(&episode(number), env.as_ref(), &mut rng).unwrap();
        for (limit, student, held) in &mut limited {
            let mut same = before.clone();
            student.observe(&episode(number), env.as_ref(), &mut same).unwrap();
            assert_eq!(same, rng);
            if u64::from(number) <= *limit {
                held.clone_from(&free.normalizers);
            }
            assert_eq!(student.normalizers.state.moments(), held.state.moments(), "{limit}, {number}");
            assert_eq!(student.normalizers.goal.moments(), held.goal.moments(), "{limit}, {number}");
        }
    }
    let [(_, never, _), _] = &limited;
    let mut seen = [0.0; 4];
    never.normalizers.write(&[0.5, -9.0], &[1.5, 300.0], &mut seen);
    assert_eq!(seen, [0.5, -5.0, 1.5, 5.0], "as they are, but clipped");
}

/// Parameters of the online and the target network.
fn networks(trained: &Trained) -> [Vec<f32>; 2] {
    [Parameters::Online, Parameters::Target].map(|which| trained.network(which).numbers().unwrap())
}

#[test]
fn targets_follow_once_per_cycle_whatever_the_preset() {
    for preset in [Preset::Harmonised, Preset::Official] {
        for polyak in [0.95, 0.5] {
            let (mut student, env, mut rng) = scene(&StudentConfig { preset, polyak, ..small() });
            student.observe(&episode(1), env.as_ref(), &mut rng).unwrap();
            for cycle in 1..=3 {
                let before = [&student.networks.actor, &student.networks.critic].map(networks);
                student.learn(env.as_ref(), &mut rng).unwrap();
                assert_eq!(student.gradient_steps(), 3 * cycle);
                let after = [&student.networks.actor, &student.networks.critic].map(networks);
                for ([old_online, old_target], [online, target]) in before.into_iter().zip(after) {
                    assert_ne!(old_online, online);
                    let [keep, take] = [polyak as f32, (1.0 - polyak) as f32];
                    let followed: Vec<f32> =
                        old_target.iter().zip(&online).map(|(t, o)| keep * t + take * o).collect();
                    assert_eq!(target, followed, "{preset:?}, α = {polyak}, cycle {cycle}");
                }
            }
        }
    }
}

#[test]
fn a_gradient_step_learns_from_a_fresh_relabelled_batch_of_all_episodes() {
    for strategy in [HerStrategy::Future, HerStrategy::Final, HerStrategy::Episode] {
        check_batches(Hindsight { k: 2, strategy });
    }
}

fn check_batches(hindsight: Hindsight) {
    let config = StudentConfig { her_k: hindsight.k, her_strategy: hindsight.strategy, ..small() };
    let [(mut whole, env, mut rng), (mut by_hand, ..)] = [scene(&config), scene(&config)];
    for number in 1..=4 {
        let mut same = rng.clone();
        whole.observe(&episode(number), env.as_ref(), &mut rng).unwrap();
        by_hand.observe(&episode(number), env.as_ref(), &mut same).unwrap();
    }
    let mut draws = rng.clone();
    whole.learn(env.as_ref(), &mut rng).unwrap();
    let mut batch = Batch::new(env.spec(), 16);
    for _ in 0..3 {
        by_hand.replay.sample(Source::All, hindsight, env.as_ref(), &mut draws, &mut batch).unwrap();
        by_hand.learner.inputs.fill(&batch, &by_hand.normalizers).unwrap();
        by_hand.learner.update(&mut by_hand.networks).unwrap();
    }
    by_hand.networks.follow(0.95).unwrap();
    assert!(state::encode(&whole).unwrap() == state::encode(&by_hand).unwrap());
    assert_eq!(rng, draws);
}

/// Both take the same draws and steps, but the targets of `apart`, whose cycles have one step, also move
/// between the steps of one cycle of `together`.
#[test]
fn targets_follow_every_update_if_asked_to() {
    let polyak_every = PolyakEvery::Update;
    let together = StudentConfig { polyak_every, ..small() };
    let apart = StudentConfig { updates_per_cycle: 1, ..small() };
    let taught = |config: &StudentConfig, cycles: usize| {
        let (mut student, env, mut rng) = scene(config);
        student.observe(&episode(1), env.as_ref(), &mut rng).unwrap();
        (0..cycles).for_each(|_| student.learn(env.as_ref(), &mut rng).unwrap());
        (state::encode(&student).unwrap(), rng)
    };
    assert!(taught(&together, 2) == taught(&apart, 6));
    assert!(taught(&together, 2) != taught(&small(), 2));
    assert_eq!(taught(&together, 2).1, taught(&small(), 2).1, "as many draws");
}

#[test]
fn teachers_see_all_episodes_with_the_goals_that_were_asked_for() {
    let (mut student, env, mut rng) = scene(&small());
    for number in 1..=3 {
        student.observe(&episode(number), env.as_ref(), &mut rng).unwrap();
    }
    let mut batch = Batch::new(env.spec(), 300);
    student.replay_batch(env.as_ref(), &mut rng, &mut batch).unwrap();
    let states = student.replay_states(300, &mut rng);
    for number in 1u16..=3 {
        let of_this = |e: f32| e == f32::from(number);
        assert!((70..130).contains(&batch.states.chunks_exact(2).filter(|state| of_this(state[0])).count()));
        assert!((70..130).contains(&states.iter().filter(|state| of_this(state[0] as f32)).count()));
    }
    for (state, goal) in batch.states.chunks_exact(2).zip(batch.goals.chunks_exact(2)) {
        assert_eq!(goal, [-state[0], 0.0]);
    }
}

#[test]
fn exploration_adds_the_configured_noise_to_the_greedy_action() {
    for noise in [NoiseConfig::gaussian(0.3, 0.5), NoiseConfig::ornstein_uhlenbeck(0.2, 0.4, 0.5)] {
        let (mut student, ..) = scene(&StudentConfig { noise, ..small() });
        let mut rng = stream(0, Purpose::Exploration);
        let (mut same, mut reference) = (rng.clone(), Noise::new(noise, 2));
        for step in 0..10 {
            let observation = Observation { state: vec![0.1 * f64::from(step), 0.5], achieved: vec![0.0; 2] };
            let (mut expected, mut action) = ([0.0; 2], [0.0; 2]);
            student.act(&observation, &[0.3, -0.3], Mode::Greedy, &mut expected).unwrap();
            reference.apply(&mut expected, 0, &mut same);
            student.act(&observation, &[0.3, -0.3], Mode::Explore(&mut rng), &mut action).unwrap();
            assert_eq!(action, expected, "{noise:?}, step {step}");
        }
    }
}

/// The action that a student takes in state (0.1, 0.5) for goal (0.3, −0.3), greedily and exploring.
fn actions(student: &mut Ddpg, rng: &mut Rng) -> [[f64; 2]; 2] {
    let observation = Observation { state: vec![0.1, 0.5], achieved: vec![0.0; 2] };
    [Mode::Greedy, Mode::Explore(rng)].map(|mode| {
        let mut action = [0.0; 2];
        student.act(&observation, &[0.3, -0.3], mode, &mut action).unwrap();
        action
    })
}

#[test]
fn noise_is_annealed_by_the_episodes_that_came_in() {
    let (final_scale, anneal_episodes) = (0.0, 3);
    for noise in [
        NoiseConfig::Gaussian { std: 0.3, random_epsilon: 0.5, final_scale, anneal_episodes },
        NoiseConfig::OrnsteinUhlenbeck { theta: 0.2, sigma: 0.4, dt: 0.5, final_scale, anneal_episodes },
    ] {
        let (mut student, env, mut replay) = scene(&StudentConfig { noise, ..small() });
        let (mut rng, mut reference) = (stream(0, Purpose::Exploration), Noise::new(noise, 2));
        for before in 0..=5 {
            student.begin_episode();
            reference.begin_episode();
            for _ in 0..10 {
                let mut same = rng.clone();
                let [mut greedy, exploring] = actions(&mut student, &mut rng);
                assert_eq!(greedy == exploring, before >= 3, "{noise:?}, {before} episodes before");
                reference.apply(&mut greedy, before, &mut same);
                assert_eq!(exploring, greedy, "{noise:?}, {before} episodes before");
            }
            student.observe(&episode(1), env.as_ref(), &mut replay).unwrap();
        }
    }
}

/// A warm-up of 3 episodes ends within the second cycle of 2, which then learns as if there had been none.
#[test]
fn a_warm_up_acts_at_random_and_learns_nothing_until_it_is_over() {
    let warm = StudentConfig { warmup_episodes: 3, ..small() };
    let [(mut student, env, mut rng), (mut cold, _, mut same)] = [scene(&warm), scene(&small())];
    let [mut exploration, mut draws, mut noise] = [(); 3].map(|()| stream(0, Purpose::Exploration));
    student.learn(env.as_ref(), &mut rng).unwrap();
    for before in 0..5 {
        let [greedy, exploring] = actions(&mut student, &mut exploration);
        if before < 3 {
            let mut random = [0.0; 2];
            uniform(&mut random, &mut draws);
            assert_eq!((exploring, &exploration), (random, &draws), "{before}");
            noise.clone_from(&draws);
        } else {
            let mut expected = greedy;
            student.noise.clone().apply(&mut expected, before, &mut noise);
            assert_eq!((exploring, &exploration), (expected, &noise), "{before}");
        }
        student.observe(&episode(1), env.as_ref(), &mut rng).unwrap();
        cold.observe(&episode(1), env.as_ref(), &mut same).unwrap();
        if before == 1 {
            let idle = state::encode(&student).unwrap();
            student.learn(env.as_ref(), &mut rng).unwrap();
            assert!(state::encode(&student).unwrap() == idle && student.gradient_steps() == 0);
        } else if before == 3 {
            student.learn(env.as_ref(), &mut rng).unwrap();
            cold.learn(env.as_ref(), &mut same).unwrap();
        }
        assert_eq!(rng, same, "{before}");
        assert!(state::encode(&student).unwrap() == state::encode(&cold).unwrap(), "{before}");
    }
    assert_eq!(student.gradient_steps(), 3);
}

/// A step size beyond single precision makes parameters infinite although the loss before the step was
/// finite. A later step of the same cycle finds out by its loss; after the cycle's last step the check of
/// parameters must.
#[test]
fn what_is_not_finite_ends_the_cycle_as_divergence() {
    let check = || {
        for (name, actor_lr, critic_lr, steps) in [
            ("actor", 1e39, 1e-3, 1),
            ("critic", 1e-3, 1e39, 1),
            ("actor's loss", 1e39, 1e-3, 2),
            ("critic's loss", 1e-3, 1e39, 2),
        ] {
            let config = StudentConfig { actor_lr, critic_lr, updates_per_cycle: steps, ..small() };
            let (mut student, env, mut rng) = scene(&config);
            student.observe(&episode(1), env.as_ref(), &mut rng).unwrap();
            match student.learn(env.as_ref(), &mut rng) {
                Err(AgentError::Diverged { what, gradient_steps }) => {
                    assert_eq!((what, gradient_steps), (name, steps as u64));
                }
                other => panic!("{name}: {other:?}"),
            }
        }
    };
    check();
    far_away(check);
}

/// Weights and biases of every layer, each rounded up to a multiple of 16 numbers.
#[test]
fn networks_have_the_shape_of_preset_and_task() {
    crate::prepare_thread();
    let parameters = |preset, layers| {
        let defaults = Defaults { layers, ..Defaults::TOY };
        let spec = Spec { id: "Shapes", family: "toy", state: 25, goal: 3, action: 4, horizon: 50, defaults };
        let student = Ddpg::new(&StudentConfig::preset(preset), &spec, 0).unwrap();
        assert_eq!(student.fresh.len(), 50);
        assert_eq!(Auto::Value(student.batch.len()), student.config.batch);
        [&student.networks.actor, &student.networks.critic].map(|trained| networks(trained)[0].len())
    };
    let middle = 256 * 256 + 256;
    let actor = (28 * 256 + 256) + middle + (256 * 4 + 16);
    let critic = (32 * 256 + 256) + middle + (256 + 16);
    let deeper = [actor + middle, critic + middle];
    assert_eq!(parameters(Preset::Harmonised, 2), [actor, critic]);
    assert_eq!(parameters(Preset::Harmonised, 3), deeper);
    assert_eq!(parameters(Preset::Official, 2), deeper);
}

/// The operations that a GPU would do, on the CPU: other kernels, inputs that are sent, a batch in one part.
#[test]
fn a_student_on_another_device_learns_and_answers_alike() {
    let answers = || {
        let config = StudentConfig { batch: Auto::Value(1024), updates_per_cycle: 5, ..small() };
        let (mut student, env, mut rng) = scene(&config);
        (0..4).for_each(|e| student.observe(&episode(e), env.as_ref(), &mut rng).unwrap());
        (0..2).for_each(|_| student.learn(env.as_ref(), &mut rng).unwrap());
        let [mut states, mut goals] = [2, 2].map(Rows::new);
        for i in 0..3 {
            states.push(&[0.5 * f64::from(i), 1.0]);
            goals.push(&[1.0, 0.3 * f64::from(i)]);
        }
        let mut many = Rows::new(2);
        (0..3000).for_each(|i| many.push(&[0.001 * f64::from(i), -0.5]));
        let observation = Observation { state: vec![1.0, 2.0], achieved: vec![0.0, 0.0] };
        let mut answers = vec![0.0; 2];
        student.act(&observation, &[1.0, -1.0], Mode::Greedy, &mut answers).unwrap();
        assert!(states.len() * many.len() > ROWS_ASKED_AFAR, "more than go through the networks at once");
        answers.extend(student.confidence(&many, &states, Network::Online).unwrap());
        for network in [Network::Online, Network::Target, Network::TargetCritic] {
            answers.extend(student.confidence(&goals, &states, network).unwrap());
            answers.extend(student.policy(&states, &goals, network).unwrap().as_slice());
        }
        let mut batch = Batch::new(&student.spec, 3);
        batch.next_states.fill(0.7);
        student.label_next_actions(&mut batch, Network::Online).unwrap();
        answers.extend(batch.next_actions.iter().map(|&a| f64::from(a)));
        answers
    };
    let (near, far) = (answers(), far_away(answers));
    assert_eq!(near.len(), far.len());
    assert_ne!(near, far, "sums are taken in another order");
    for (near, far) in near.iter().zip(&far) {
        assert!((near - far).abs() < 1e-4, "{near} against {far}");
    }
}

/// Asked at any moment, with a stream of the asker's own, the student learns what it would have learned.
#[test]
fn a_diagnosis_changes_nothing_that_is_learned() {
    for near in [true, false] {
        let learned = |asked: bool| {
            let (mut student, env, mut rng) = scene(&small());
            let mut other = stream(3, Purpose::Diagnosis(0));
            let mut ask =
                |student: &mut Ddpg| asked.then(|| student.diagnose(env.as_ref(), &mut other).unwrap());
            let before = ask(&mut student);
            assert!(before.is_none_or(|found| found.dry_step.is_none() && found.replay_episodes == 0));
            for number in 0..4 {
                student.observe(&episode(number), env.as_ref(), &mut rng).unwrap();
                ask(&mut student);
                student.learn(env.as_ref(), &mut rng).unwrap();
                let found = ask(&mut student);
                let sizes = found.map(|found| (found.replay_episodes, found.replay_transitions));
                let expected = u64::from(number) + 1;
                assert!(sizes.is_none_or(|sizes| sizes == (expected, 20 * expected)), "{sizes:?}");
            }
            (state::encode(&student).unwrap(), rng)
        };
        let both = || (learned(true), learned(false));
        let (asked, undisturbed) = if near { both() } else { far_away(both) };
        assert!(asked == undisturbed);
    }
}
