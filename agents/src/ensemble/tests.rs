use envs::rng::{Purpose, Rng, stream};
use envs::{Defaults, Rows, Spec};
use rand::Rng as _;

use super::{Ensemble, EnsembleConfig};
use crate::auto::Auto;
use crate::batch::Batch;
use crate::config::StudentConfig;
use crate::device::far_away;
use crate::episode::Episode;
use crate::error::AgentError;
use crate::normalizer::{Normalizer, NormalizerConfig};
use crate::precision::Precision;

const SPEC: Spec =
    Spec { id: "Tiny", family: "toy", state: 2, goal: 1, action: 1, horizon: 4, defaults: Defaults::TOY };
const BATCH: usize = 32;

fn ensemble(members: usize, gamma: f64, rng: &mut Rng) -> Ensemble {
    in_precision(Precision::F32, members, gamma, rng)
}

fn in_precision(precision: Precision, members: usize, gamma: f64, rng: &mut Rng) -> Ensemble {
    crate::prepare_thread();
    let student =
        StudentConfig { width: 16, gamma: Auto::Value(gamma), precision, ..StudentConfig::default() };
    let config = EnsembleConfig { members, batch: BATCH, lr: 1e-2, polyak: 0.9 };
    Ensemble::new(config, &student, &SPEC, rng).unwrap()
}

/// A small ensemble beside a student with the normalisers of `normalizer`.
fn with_normalizer(normalizer: NormalizerConfig) -> Ensemble {
    crate::prepare_thread();
    let student = StudentConfig { width: 16, normalizer, ..StudentConfig::default() };
    let config = EnsembleConfig { members: 2, batch: BATCH, lr: 1e-2, polyak: 0.9 };
    Ensemble::new(config, &student, &SPEC, &mut stream(1, Purpose::Weights)).unwrap()
}

/// Random transitions; the reward is −1 where the goal is positive.
fn batch(len: usize, rng: &mut Rng) -> Batch {
    let mut batch = Batch::new(&SPEC, len);
    for numbers in [
        &mut batch.states,
        &mut batch.next_states,
        &mut batch.goals,
        &mut batch.actions,
        &mut batch.next_actions,
    ] {
        numbers.fill_with(|| rng.random_range(-1.0..1.0));
    }
    for (reward, goal) in batch.rewards.iter_mut().zip(&batch.goals) {
        *reward = if *goal > 0.0 { -1.0 } else { 0.0 };
    }
    batch
}

fn rows(width: usize, numbers: &[f64]) -> Rows {
    let mut rows = Rows::new(width);
    numbers.chunks(width).for_each(|row| rows.push(row));
    rows
}

/// Values at some fixed points, `[E, 3]`.
fn probe(ensemble: &mut Ensemble) -> Rows {
    let states = rows(2, &[0.1, 0.2, -0.3, 0.4, 0.9, -0.9]);
    ensemble.values(&states, &rows(1, &[-0.5, 0.5, 0.7]), &rows(1, &[0.0, 0.3, -0.3])).unwrap()
}

#[test]
fn members_learn_their_own_transitions_apart_from_each_other() {
    let mut weights = stream(3, Purpose::Weights);
    let mut together = ensemble(2, 0.75, &mut weights);
    let mut weights = stream(3, Purpose::Weights);
    let mut apart = [ensemble(1, 0.75, &mut weights), ensemble(1, 0.75, &mut weights)];
    let mut rng = stream(3, Purpose::Replay);
    for _ in 0..10 {
        let halves = [batch(BATCH, &mut rng), batch(BATCH, &mut rng)];
        let mut whole = Batch::new(&SPEC, 2 * BATCH);
        let join = |field: fn(&Batch) -> &Vec<f32>| halves.iter().flat_map(field).copied().collect();
        whole.states = join(|b| &b.states);
        whole.next_states = join(|b| &b.next_states);
        whole.goals = join(|b| &b.goals);
        whole.actions = join(|b| &b.actions);
        whole.next_actions = join(|b| &b.next_actions);
        whole.rewards = join(|b| &b.rewards);
        together.update(&whole).unwrap();
        for (member, half) in apart.iter_mut().zip(&halves) {
            member.update(half).unwrap();
            member.follow().unwrap();
        }
        together.follow().unwrap();
    }
    let values = probe(&mut together);
    assert_ne!(values.row(0), values.row(1));
    for (e, member) in apart.iter_mut().enumerate() {
        assert_eq!(values.row(e), probe(member).row(0), "member {e}");
    }
}

/// With γ = 0 the values are the rewards.
#[test]
fn every_member_learns_the_rewards() {
    let mut ensemble = ensemble(3, 0.0, &mut stream(0, Purpose::Weights));
    let mut rng = stream(0, Purpose::Replay);
    let first = ensemble.update(&batch(3 * BATCH, &mut rng)).unwrap();
    let mut loss = first;
    for _ in 0..300 {
        loss = ensemble.update(&batch(3 * BATCH, &mut rng)).unwrap();
    }
    assert!(loss < 0.1 * first, "{first} to {loss}");
    let values = probe(&mut ensemble);
    for member in values.iter() {
        for (value, reward) in member.iter().zip([0.0, -1.0, -1.0]) {
            assert!((value - reward).abs() < 0.2, "{member:?}");
        }
    }
}

/// The operations that a GPU would do, on the CPU: all members in one batched product.
#[test]
fn an_ensemble_on_another_device_learns_the_same_values() {
    let trained = || {
        let mut ensemble = ensemble(3, 0.75, &mut stream(2, Purpose::Weights));
        let mut rng = stream(2, Purpose::Replay);
        for _ in 0..10 {
            ensemble.update(&batch(3 * BATCH, &mut rng)).unwrap();
            ensemble.follow().unwrap();
        }
        probe(&mut ensemble)
    };
    let (near, far) = (trained(), far_away(trained));
    assert_ne!(near.as_slice(), far.as_slice(), "sums are taken in another order");
    for (near, far) in near.as_slice().iter().zip(far.as_slice()) {
        assert!((near - far).abs() < 1e-4, "{near} against {far}");
    }
}

#[test]
fn what_is_not_finite_is_divergence_at_its_step() {
    let mut ensemble = ensemble(2, 0.75, &mut stream(4, Purpose::Weights));
    let mut poisoned = batch(2 * BATCH, &mut stream(4, Purpose::Replay));
    poisoned.rewards[BATCH] = f32::NAN;
    let loss = ensemble.update(&poisoned);
    let named = matches!(loss, Err(AgentError::Diverged { what: "ensemble's loss", gradient_steps: 1 }));
    assert!(named, "{loss:?}");
    let cycle = ensemble.follow();
    assert!(matches!(cycle, Err(AgentError::Diverged { what: "ensemble", gradient_steps: 1 })), "{cycle:?}");
    let row = |width| rows(width, &[0.1, 0.2][..width]);
    let values = ensemble.values(&row(2), &row(1), &row(1));
    let named = matches!(values, Err(AgentError::NotFinite { what: "ensemble's value", gradient_steps: 1 }));
    assert!(named, "{values:?}");
}

/// With γ = 1/2 and reward −1 everywhere all values tend to −2, but only if the targets follow.
#[test]
fn values_build_on_the_targets() {
    let settled = |follow: bool| {
        let mut ensemble = ensemble(1, 0.5, &mut stream(0, Purpose::Weights));
        let mut rng = stream(0, Purpose::Replay);
        for step in 0..600 {
            let mut batch = batch(BATCH, &mut rng);
            batch.rewards.fill(-1.0);
            ensemble.update(&batch).unwrap();
            if follow && step % 5 == 4 {
                ensemble.follow().unwrap();
            }
        }
        probe(&mut ensemble).row(0).iter().sum::<f64>() / 3.0
    };
    let value = settled(true);
    assert!((value + 2.0).abs() < 0.1, "{value}");
    assert!(settled(false) > -1.8, "without targets that follow, values stay near the first ones");
}

fn episode() -> Episode {
    Episode {
        states: rows(2, &[0.1, 0.5, 0.3, 0.1, 0.2, 0.2, 0.4, 0.9, 0.0, 0.0]),
        achieved: rows(1, &[0.0; 5]),
        actions: rows(1, &[0.5; 4]),
        goal: vec![0.7],
        total_reward: 0.0,
        success: false,
    }
}

#[test]
fn going_on_from_a_save_gives_the_same_bytes_as_never_having_stopped() {
    let train = |ensemble: &mut Ensemble, rng: &mut Rng| {
        ensemble.observe(&episode()).unwrap();
        for _ in 0..3 {
            ensemble.update(&batch(2 * BATCH, rng)).unwrap();
        }
        ensemble.follow().unwrap();
    };
    for precision in Precision::ALL {
        let mut rng = stream(1, Purpose::Replay);
        let mut first = in_precision(precision, 2, 0.75, &mut stream(1, Purpose::Weights));
        train(&mut first, &mut rng);
        let saved = first.save().unwrap();
        let mut resumed = in_precision(precision, 2, 0.75, &mut stream(9, Purpose::Weights));
        resumed.load(&saved).unwrap();
        train(&mut first, &mut rng.clone());
        train(&mut resumed, &mut rng);
        assert!(first.save().unwrap() == resumed.save().unwrap(), "{precision:?}");
        assert_eq!(resumed.gradient_steps(), 6);

        let mut other = ensemble(3, 0.75, &mut stream(1, Purpose::Weights));
        let AgentError::State { source } = other.load(&saved).unwrap_err() else {
            panic!("of another width")
        };
        assert!(source.to_string().contains("parameters"), "{source}");
        assert!(other.load(&saved[..10]).is_err());
    }
}

/// An ensemble in bf16 learns nearly what one in f32 learns from the same batches, on either kind of device.
#[test]
fn rounded_products_teach_nearly_the_same_values() {
    let trained = |precision| {
        let mut ensemble = in_precision(precision, 3, 0.75, &mut stream(2, Purpose::Weights));
        let mut rng = stream(2, Purpose::Replay);
        for _ in 0..10 {
            ensemble.update(&batch(3 * BATCH, &mut rng)).unwrap();
        }
        ensemble.follow().unwrap();
        probe(&mut ensemble)
    };
    let single = trained(Precision::F32);
    for rounded in [trained(Precision::Bf16), far_away(|| trained(Precision::Bf16))] {
        assert_ne!(rounded.as_slice(), single.as_slice());
        for (rounded, single) in rounded.as_slice().iter().zip(single.as_slice()) {
            assert!((rounded - single).abs() < 0.02, "{rounded} against {single}");
        }
    }
}

/// The ensemble's normalisers follow the student's config: besides the pseudo-observations they count 4
/// states and 4 times the goal.
#[test]
fn normalisers_start_with_the_pseudo_observations_of_the_student() {
    for pseudo_observations in [0, 1, 3] {
        let normalizer = NormalizerConfig { pseudo_observations, ..NormalizerConfig::default() };
        let mut ensemble = with_normalizer(normalizer);
        ensemble.observe(&episode()).unwrap();
        let mut expected = Normalizer::new(normalizer, 1);
        expected.update(&[0.7; 4]);
        assert_eq!(ensemble.normalizers.goal.moments(), expected.moments());
    }
}

#[test]
fn only_the_first_episodes_feed_the_normalisers_also_across_a_save() {
    let limited =
        |episodes| NormalizerConfig { feed_episodes: Auto::Value(episodes), ..NormalizerConfig::default() };
    let fed = |episodes: usize| {
        let mut ensemble = with_normalizer(NormalizerConfig::default());
        (0..episodes).for_each(|_| ensemble.observe(&episode()).unwrap());
        ensemble.normalizers.state.moments().clone()
    };
    for limit in [0, 1, 3] {
        let mut ensemble = with_normalizer(limited(limit));
        for episodes in 1..=5 {
            ensemble.observe(&episode()).unwrap();
            assert_eq!(*ensemble.normalizers.state.moments(), fed(episodes.min(limit as usize)));
            let mut resumed = with_normalizer(limited(limit));
            resumed.load(&ensemble.save().unwrap()).unwrap();
            ensemble = resumed;
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut two = ensemble(2, 0.75, &mut stream(0, Purpose::Weights));
    let error = two.update(&Batch::new(&SPEC, BATCH)).unwrap_err().to_string();
    assert!(error.contains("64"), "{error}");
    let other = Spec { state: 3, ..SPEC };
    assert!(two.update(&Batch::new(&other, 2 * BATCH)).is_err());
    assert!(two.values(&rows(2, &[0.0; 4]), &rows(1, &[0.0]), &rows(1, &[0.0; 2])).is_err());
    let config = EnsembleConfig { members: 0, batch: 1, lr: 1e-3, polyak: 0.95 };
    assert!(
        Ensemble::new(config, &StudentConfig::default(), &SPEC, &mut stream(0, Purpose::Weights)).is_err()
    );
}
