//! SPaCE's set grows exactly when its rule says so.

use curricula::testing::{Class, Script};
use curricula::{CurriculumError, Distribution, PoolState, ProposedGoal, snapshot};

use crate::support::entry;

/// A class of SPaCE that updates its set before every episode but the first.
fn space(config: &str, goals: usize, script: Script) -> Class {
    let mut class =
        Class::new("space", &format!("states = \"initial\"\nupdate_steps = 1\n{config}"), goals, script);
    assert_eq!(class.propose_index(), 0, "the first goal of the pool, before any update");
    class
}

/// All goals move together, by more than a tenth at steps 1 to 3 and by less from there on.
fn levelling_off(_goal: usize, steps: u64) -> f64 {
    [-40.0, -30.0, -20.0, -10.0, -9.5, -9.2, -9.0][(steps as usize).min(6)]
}

fn sizes(config: &str, goals: usize, updates: usize) -> Vec<f64> {
    let mut class = space(config, goals, levelling_off);
    let mut update = || {
        class.cycles(1);
        class.statistic("set_size")
    };
    (0..updates).map(|_| update()).collect()
}

#[test]
fn the_set_grows_when_progress_stagnates_and_only_then() {
    // Relative changes: 1/4, 1/3, 1/2, then 1/20, 3/95, 2/92, 0.
    assert_eq!(sizes("", 10, 8), [1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    // With eta 0.3 the first change stagnates too.
    assert_eq!(sizes("eta = 0.3", 10, 5), [1.0, 2.0, 2.0, 2.0, 3.0]);
    // With eta 0 only an exact standstill does.
    assert_eq!(sizes("eta = 0.0", 10, 8), [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0]);
    assert_eq!(sizes("kappa = 4", 20, 7), [1.0, 1.0, 1.0, 1.0, 5.0, 9.0, 13.0]);
}

#[test]
fn the_set_never_leaves_the_pool() {
    assert_eq!(sizes("kappa = 2", 3, 8), [1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0]);
    assert_eq!(sizes("kappa = 9223372036854775807", 3, 8)[7], 3.0);
    assert_eq!(sizes("", 1, 8), [1.0; 8]);
}

/// Goal i improves by 0.3 i per step, from the bottom.
fn fanning(goal: usize, steps: u64) -> f64 {
    -50.0 + 0.3 * (goal as u64 * steps) as f64
}

#[test]
fn the_set_holds_the_goals_that_rank_first() {
    // From -50 the mean of the set moves by at most 1.5, that is 3 %, so the set grows by one at every update
    // but the first.
    let mut class = space("", 4, fanning);
    class.cycles(3);
    assert_eq!(class.weights(), [0.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0], "most improved first");
    let mut class = space("order = \"absolute\"", 4, fanning);
    class.cycles(3);
    assert_eq!(class.weights(), [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0], "lowest value first");
}

#[test]
fn the_first_update_ranks_as_if_all_values_had_been_zero_and_does_not_grow() {
    let first = |config: &str| {
        let mut class = space(config, 4, |goal, _| -[40.0, 50.0, 10.0, 30.0][goal]);
        (class.propose_index(), class.weights())
    };
    // Improvements -40, -50, -10, -30, which relative to 0 would all be the same.
    assert_eq!(first(""), (2, vec![0.0, 0.0, 1.0, 0.0]));
    assert_eq!(first("order = \"relative\""), (2, vec![0.0, 0.0, 1.0, 0.0]));
    assert_eq!(first("order = \"absolute\""), (1, vec![0.0, 1.0, 0.0, 0.0]));

    // A mean of 0 does not differ from 0, but there is no last mean that it could stagnate at.
    let mut class = space("", 4, |_, _| 0.0);
    class.cycles(1);
    assert_eq!(class.statistic("set_size"), 1.0);
    class.cycles(1);
    assert_eq!(class.statistic("set_size"), 2.0);
}

#[test]
fn the_relative_order_prefers_the_larger_share_of_the_last_value() {
    // From -40 to -30 is a quarter, from -8 to -4 a half.
    let script = |goal: usize, steps: u64| [[-40.0, -30.0], [-8.0, -4.0]][goal][steps.min(1) as usize];
    let chosen = |order: &str| space(&format!("order = \"{order}\""), 2, script).cycles(2)[1];
    assert_eq!(chosen("relative"), 1);
    assert_eq!(chosen("signed"), 0);
}

#[test]
fn the_new_set_is_trained_on_at_once() {
    // From the first update to the second goal 7 improves; all others decline by 15 %, too much to stagnate.
    let script =
        |goal: usize, steps: u64| [-20.0 - 3.0 * steps as f64, -50.0 + steps as f64][usize::from(goal == 7)];
    assert_eq!(space("", 9, script).cycles(2)[1], 7);
}

#[test]
fn goals_of_the_set_take_turns() {
    let mut class = space("kappa = 2", 4, fanning);
    assert_eq!(class.cycles(1), [0], "all stand at -50: the first goal of the pool");
    // At the second update the set becomes 3, 2, 1. Place 0 had the last turn.
    let turns: Vec<usize> = (0..6).map(|_| class.propose_index()).collect();
    assert_eq!(turns, [2, 1, 3, 2, 1, 3]);
    assert_eq!(class.weights(), [0.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0]);
}

#[test]
fn stagnation_is_that_of_the_set_not_of_the_pool() {
    // The lowest goal stands still, the others improve by more than a tenth.
    let script = |goal, steps: u64| if goal == 0 { -50.0 } else { -40.0 * 0.5f64.powi(steps as i32) };
    let mut class = space("order = \"absolute\"", 3, script);
    class.cycles(2);
    assert_eq!(class.statistic("set_size"), 2.0);
}

#[test]
fn a_mean_is_compared_with_the_mean_of_the_set_before() {
    // Nothing moves, but the set moves on from goal 0 at -10 to goal 1 at -40, which is no stagnation.
    let mut class = space("order = \"absolute\"", 2, |goal, _| if goal == 0 { -10.0 } else { -40.0 });
    class.cycles(2);
    assert_eq!(class.statistic("set_size"), 1.0);
    assert_eq!(class.statistic("set_confidence"), -40.0);
    class.cycles(1);
    assert_eq!(class.statistic("set_size"), 2.0);
}

/// A set that grows by one goal per cycle of two episodes: turns counted over all episodes, modulo a size
/// that grows while it counts two, would only ever fall on some places.
#[test]
fn every_place_of_a_growing_set_gets_its_turns() {
    for (goals, cycles) in [(40, 400), (1000, 900)] {
        let mut class = space("", goals, |goal, steps| -50.0 + 1e-4 * (goal as u64 * steps) as f64);
        let (mut turns, mut fair) = (vec![0.0; goals], vec![0.0; goals]);
        let mut last_of_the_pool = 0;
        for cycle in 0..cycles {
            for _ in 0..2 {
                let proposal = class.propose().unwrap();
                let rank = proposal.rank.expect("a place in the set");
                assert_eq!(rank.of as f64, class.statistic("set_size"));
                turns[rank.place] += 1.0;
                (0..rank.of).for_each(|place| fair[place] += 1.0 / rank.of as f64);
                if proposal.goal == ProposedGoal::Pool(goals - 1) && cycle > 20 {
                    last_of_the_pool += 1;
                }
            }
            class.learn();
        }
        assert!(last_of_the_pool > 4, "the goal that improves most is trained on {last_of_the_pool} times");
        for place in 0..goals {
            // Places that had less than two turns to expect may have had one or four.
            if fair[place] >= 2.0 {
                let share = turns[place] / fair[place];
                assert!((0.5..=2.0).contains(&share), "place {place} of {goals}: {share} of its share");
            }
        }
    }
}

#[test]
fn an_update_falls_due_every_so_many_steps() {
    // Episodes of the point task have 20 steps.
    for (steps, episodes) in [(1, 1), (20, 1), (21, 2), (50, 3)] {
        let config = format!("states = \"initial\"\nupdate_steps = {steps}");
        let mut class = Class::new("space", &config, 4, levelling_off);
        let updates = |class: &Class| class.statistic("evaluations");
        class.cycles(episodes);
        assert_eq!(updates(&class), 0.0, "{steps}: before an episode, after the steps");
        class.cycles(1);
        assert_eq!(updates(&class), 1.0, "{steps}");
    }
    // Steps beyond an interval count towards the next: of 50, due after 3, 5, 8 and 10 episodes.
    let mut class = Class::new("space", "states = \"initial\"\nupdate_steps = 50", 4, levelling_off);
    let due: Vec<usize> = (0..12)
        .filter(|_| {
            let before = class.statistic("evaluations");
            class.cycles(1);
            class.statistic("evaluations") > before
        })
        .collect();
    assert_eq!(due, [3, 5, 8, 10]);
    // By default some 2048 steps, the authors' fixed interval.
    let mut class = Class::new("space", "states = \"initial\"", 4, levelling_off);
    class.cycles(103);
    assert_eq!(class.statistic("evaluations"), 0.0);
    class.cycles(1);
    assert_eq!(class.statistic("evaluations"), 1.0);
}

#[test]
fn with_initial_states_an_update_is_measured_from_the_start_at_hand() {
    let config = "states = \"initial\"\nupdate_steps = 1";
    let mut class = Class::on("FetchPush", entry("space"), config, 4, |_, _| -1.0).unwrap();
    for update in 0..3 {
        class.cycles(1);
        assert_eq!(class.student.asked.len(), update);
        if let Some(question) = class.student.asked.last() {
            assert_eq!(question.states.as_slice(), class.start.state);
        }
    }
    assert_ne!(class.student.asked[0].states, class.student.asked[1].states, "another start");
}

#[test]
fn improvements_are_measured_from_states_that_stay_the_same() {
    // Nothing improves, but every second goal's value depends on the state.
    let mut class = Class::new("space", "update_steps = 1\nrenewal = 3", 10, |goal, _| -10.0 - goal as f64);
    class.student.by_state = 5.0;
    class.cycles(30);
    // All improvements are 0, so goals rank in the pool's order.
    let size = class.statistic("set_size") as usize;
    assert!((5..=10).contains(&size), "{size}");
    let weights = class.weights();
    assert!(weights[..size].iter().all(|&weight| weight > 0.0), "{weights:?}");
}

#[test]
fn a_state_whose_set_or_values_do_not_fit_the_pool_is_refused() {
    let load = |set: Vec<(usize, f64)>, compared: Vec<usize>| {
        let common = PoolState::new(Distribution::uniform(3), 2);
        let bytes = snapshot::save("space", 3, &(common, set, compared, Some(0usize), 5u64, -1.0));
        space("", 3, levelling_off).teacher.load(&bytes)
    };
    assert!(load(vec![(2, 1.0), (0, 0.5)], vec![]).is_ok());
    for (set, compared) in [
        (vec![], vec![]),
        (vec![(0, 1.0), (3, 0.0)], vec![]),
        (vec![(0, f64::NAN)], vec![]),
        (vec![(0, 1.0)], vec![1]),
    ] {
        let result = load(set.clone(), compared.clone());
        assert!(matches!(result, Err(CurriculumError::State { .. })), "{set:?}, {compared:?}: {result:?}");
    }
}
