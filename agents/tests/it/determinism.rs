//! The same seed gives the same bytes, whatever runs beside it.

use agents::{Mode, Network};
use envs::Observation;
use envs::rng::{Purpose, stream};

use crate::support::random_rows;
use crate::toy::{Run, small};

/// Bits of what a student of `seed` does and believes after some cycles: exploring actions, greedy actions
/// and confidences.
fn behaviour(seed: u64) -> Vec<u64> {
    let mut run = Run::trained(&small(), seed, 5);
    let mut rng = stream(99, Purpose::Pool);
    let (states, goals) = (random_rows(20, 2, &mut rng), random_rows(20, 2, &mut rng));
    let mut numbers = Vec::new();
    for network in [Network::Online, Network::Target] {
        numbers.extend(run.agent.confidence(&goals, &states, network).unwrap());
        numbers.extend_from_slice(run.agent.policy(&states, &goals, network).unwrap().as_slice());
    }
    let mut action = [0.0; 2];
    for (state, goal) in states.iter().zip(goals.iter()) {
        let observation = Observation { state: state.to_vec(), achieved: state.to_vec() };
        run.agent.act(&observation, goal, Mode::Explore(&mut rng), &mut action).unwrap();
        numbers.extend(action);
    }
    numbers.into_iter().map(f64::to_bits).collect()
}

#[test]
fn a_seed_determines_every_bit() {
    assert_eq!(behaviour(3), behaviour(3));
}

#[test]
fn another_seed_gives_another_student() {
    let (one, other) = (behaviour(3), behaviour(4));
    // Both explore with the same noise, so a few actions agree: those that it replaces by random ones.
    let same = one.iter().zip(&other).filter(|(a, b)| a == b).count();
    assert!(same < one.len() / 4, "{same} of {} numbers agree", one.len());
}

#[test]
fn students_trained_side_by_side_are_those_trained_alone() {
    let alone = [behaviour(3), behaviour(4)];
    let threads = [3, 4].map(|seed| std::thread::spawn(move || behaviour(seed)));
    assert_eq!(threads.map(|thread| thread.join().unwrap()), alone);
}
