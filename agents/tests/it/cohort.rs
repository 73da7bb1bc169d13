//! Students that learn side by side are, to the byte, what each would have become alone.

use std::path::Path;

use agents::{AgentError, Cohort, CohortLane, HerStrategy, NoiseConfig, StudentConfig, make_cohort};

use crate::toy::{Run, small};

/// A run of a cohort: its lanes may differ in all that is a student's own.
fn config(lane: u64) -> StudentConfig {
    let base = StudentConfig { width: 32, updates_per_cycle: 5, replay_capacity: 100, ..small() };
    match lane % 4 {
        1 => StudentConfig { noise: NoiseConfig::ornstein_uhlenbeck(0.15, 0.2, 1.0), ..base },
        2 => StudentConfig { her_strategy: HerStrategy::Final, her_k: 2, ..base },
        3 => StudentConfig { warmup_episodes: 3, replay_capacity: 60, ..base },
        _ => base,
    }
}

fn runs(lanes: u64) -> Vec<Run> {
    (0..lanes).map(|lane| Run::new(&config(lane), 20 + lane)).collect()
}

/// Cycles of all `runs` in lockstep.
fn together(runs: &mut [&mut Run], cycles: usize) -> Vec<Result<(), AgentError>> {
    let mut cohort = make_cohort(&small(), runs.len()).unwrap();
    let mut outcomes = Vec::new();
    for _ in 0..cycles {
        runs.iter_mut().for_each(|run| run.episodes().unwrap());
        outcomes = learn(cohort.as_mut(), runs);
    }
    outcomes
}

fn learn(cohort: &mut dyn Cohort, runs: &mut [&mut Run]) -> Vec<Result<(), AgentError>> {
    let mut lanes: Vec<CohortLane<'_>> = runs.iter_mut().map(|run| run.lane()).collect();
    cohort.learn(&mut lanes)
}

fn saved(run: &mut Run, folder: &Path) -> Vec<u8> {
    run.agent.save(folder).unwrap()
}

#[test]
fn lanes_are_students_alone() {
    for lanes in [1, 3, 8] {
        let folder = tempfile::tempdir().unwrap();
        let (mut cohort, mut alone) = (runs(lanes), runs(lanes));
        together(&mut cohort.iter_mut().collect::<Vec<_>>(), 3).into_iter().for_each(|lane| lane.unwrap());
        for (lane, (of_cohort, run)) in cohort.iter_mut().zip(&mut alone).enumerate() {
            run.cycles(3).unwrap();
            let [here, there] = ["here", "there"].map(|name| folder.path().join(format!("{name}-{lane}")));
            assert!(saved(of_cohort, &here) == saved(run, &there), "lane {lane} of {lanes}");
            assert_eq!(of_cohort.lane().rng, run.lane().rng, "lane {lane} of {lanes}");
        }
    }
}

/// Whatever a pool of threads does in what order.
#[test]
fn any_number_of_threads_gives_the_same_students() {
    let folder = tempfile::tempdir().unwrap();
    let trained = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut cohort = runs(5);
        pool.install(|| together(&mut cohort.iter_mut().collect::<Vec<_>>(), 2));
        let states = cohort.iter_mut().enumerate();
        states
            .map(|(lane, run)| saved(run, &folder.path().join(format!("{threads}-{lane}"))))
            .collect::<Vec<_>>()
    };
    let one = trained(1);
    assert!(one == trained(2) && one == trained(5));
}

/// One leaves after the first cycle and goes on alone, one is saved and goes on in another cohort, one
/// comes in late.
#[test]
fn lanes_may_leave_move_and_come() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let mut alone = runs(4);
    alone.iter_mut().for_each(|run| run.cycles(4).unwrap());

    let [mut leaves, mut moves, mut stays, mut comes] = <[Run; 4]>::try_from(runs(4)).ok().unwrap();
    together(&mut [&mut leaves, &mut moves, &mut stays], 1);
    leaves.cycles(3).unwrap();
    comes.cycles(1).unwrap();
    let state = saved(&mut moves, &place("moving"));
    let mut elsewhere = Run::new(&config(1), 99);
    elsewhere.agent.load(&state, &place("moving")).unwrap();
    elsewhere.take_streams(&moves);
    together(&mut [&mut comes, &mut stays], 1);
    together(&mut [&mut stays], 1);
    together(&mut [&mut stays, &mut elsewhere, &mut comes], 1);
    together(&mut [&mut elsewhere], 2);
    together(&mut [&mut comes], 1);
    // The third cycle of the one that stayed was alone; its fourth was the last together.
    for (name, mut run) in [("leaves", leaves), ("moves", elsewhere), ("stays", stays), ("comes", comes)] {
        let expected = match name {
            "leaves" => &mut alone[0],
            "moves" => &mut alone[1],
            "stays" => &mut alone[2],
            _ => &mut alone[3],
        };
        let state = saved(&mut run, &place(name));
        assert!(state == saved(expected, &place(&format!("{name} alone"))), "{name}");
    }
}

#[test]
fn one_that_diverges_leaves_and_the_others_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut alone = runs(3);
    alone.iter_mut().for_each(|run| run.cycles(3).unwrap());
    let mut cohort = runs(3);
    let [a, b, c] = &mut cohort[..] else { unreachable!() };
    together(&mut [a, b, c], 1);
    let mut poisoned = Run::new(&config(0), 1);
    poisoned.poison();
    [&mut *a, &mut *b, &mut *c].into_iter().for_each(|run| run.episodes().unwrap());
    let mut cohort_of_four = make_cohort(&small(), 4).unwrap();
    let outcomes = learn(cohort_of_four.as_mut(), &mut [a, b, &mut poisoned, c]);
    assert!(matches!(outcomes[2], Err(AgentError::Diverged { gradient_steps: 1, .. })), "{outcomes:?}");
    assert!([0, 1, 3].iter().all(|&lane| outcomes[lane].is_ok()), "{outcomes:?}");
    together(&mut [a, b, c], 1);
    for (lane, (run, expected)) in cohort.iter_mut().zip(&mut alone).enumerate() {
        let [here, there] = ["here", "there"].map(|name| folder.path().join(format!("{name}-{lane}")));
        assert!(saved(run, &here) == saved(expected, &there), "lane {lane}");
    }
}
