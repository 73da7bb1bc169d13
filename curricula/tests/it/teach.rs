//! TEACH samples what moves.

use curricula::testing::{Class, Script};
use curricula::{CurriculumError, Distribution, PoolState, ProposedGoal, snapshot};

use crate::support::{close, entry};

/// A class of TEACH with `config` whose confidence is that at the start of the episode: there is something to
/// measure from the first episode on.
fn teach(config: &str, goals: usize, script: Script) -> Class {
    Class::new("teach", &format!("states = \"initial\"\n{config}"), goals, script)
}

/// What the teacher holds: episodes, whether a curriculum is due, and the probe with its window.
fn held(class: &Class) -> PoolState {
    let bytes = class.teacher.save().expect("plain data");
    snapshot::load::<(u64, bool, PoolState, Vec<f64>)>("teach", 3, &bytes).expect("this layout").2
}

/// Goal 0 swings by 1 around its mean, goal 1 by 2; goals 2 and 3 stand still, one of them mastered.
fn swinging(goal: usize, steps: u64) -> f64 {
    let side = if steps.is_multiple_of(2) { 1.0 } else { -1.0 };
    [-20.0 + side, -30.0 + 2.0 * side, -50.0, 0.0][goal]
}

/// Moves until 5 gradient steps, then stands still.
fn settling(goal: usize, steps: u64) -> f64 {
    -(steps.min(5) as f64) * (goal + 1) as f64
}

#[test]
fn goals_are_drawn_in_proportion_to_their_variance() {
    let mut class = teach("window = 4", 4, swinging);
    class.cycles(4);
    // Variances 1 and 4.
    assert!(close(&class.weights(), &[0.2, 0.8, 0.0, 0.0]));
    let mut counts = [0u32; 4];
    (0..5_000).for_each(|_| counts[class.propose_index()] += 1);
    assert_eq!(counts[2] + counts[3], 0, "goals that stand still are not drawn");
    // Five standard deviations of the count, sqrt(5000 · 0.2 · 0.8) = 28.3.
    assert!((f64::from(counts[0]) - 1_000.0).abs() < 142.0, "{counts:?}");
}

#[test]
fn hand_worked_window_of_two() {
    // Evaluations at 0, 1, 2 steps; goal i is at -(i+1) steps. Window of two: -(i+1)·1 and -(i+1)·2, so that
    // the variance is (i+1)²/4 and the curriculum 1 : 4 : 9.
    let mut class = teach("window = 2", 3, settling);
    class.cycles(3);
    assert!(close(&class.weights(), &[1.0 / 14.0, 4.0 / 14.0, 9.0 / 14.0]));
}

#[test]
fn after_a_window_of_standstill_the_curriculum_is_uniform() {
    let mut class = teach("window = 3", 4, settling);
    // Evaluations at 0..=6 steps; the last two of them at standstill.
    class.cycles(7);
    assert!(!close(&class.weights(), &[0.25; 4]), "one evaluation in the window is still older");
    class.cycles(1);
    assert_eq!(class.weights(), [0.25; 4]);
    assert!((class.statistic("effective_goals") - 4.0).abs() < 1e-12);
}

#[test]
fn before_the_second_evaluation_the_curriculum_is_uniform() {
    let mut class = teach("", 4, swinging);
    assert_eq!(class.weights(), [0.25; 4]);
    class.cycles(1);
    assert_eq!(class.weights(), [0.25; 4]);
    class.cycles(1);
    assert!(close(&class.weights(), &[0.2, 0.8, 0.0, 0.0]));
}

#[test]
fn an_evaluation_decides_already_about_the_episode_it_precedes() {
    // All of 100 goals stand still but goal 7.
    let mut class = teach("", 100, |goal, steps| if goal == 7 { -(steps as f64) } else { -9.0 });
    class.cycles(1);
    assert_eq!(class.propose_index(), 7);
}

#[test]
fn values_that_move_by_rounding_alone_stand_still() {
    // Single precision near -50 comes in steps of 2^-18 = 3.8e-6; a goal that swings by half of it has the
    // variance (1.9e-6)² = 3.6e-12, and one that swings by 1e-4 the variance 1e-8.
    let rounding = |goal: usize, steps: u64| -50.0 + (steps % 2) as f64 * [3.8e-6, 0.0][goal];
    let more = |goal: usize, steps: u64| -50.0 + (steps % 2) as f64 * [2e-4, 0.0][goal];
    for selection in ["proportional", "argmax"] {
        let weights_of = |script| {
            let mut class = teach(&format!("selection = \"{selection}\""), 2, script);
            class.cycles(8);
            class.weights()
        };
        assert_eq!(weights_of(rounding), [0.5; 2], "{selection}");
        assert_eq!(weights_of(more), [1.0, 0.0], "{selection}");
    }
}

#[test]
fn a_curriculum_that_fell_due_before_there_were_states_is_made_up_for() {
    // Goal 1 alone moves. Due at episode 0, when nothing is replayed yet; the two values it takes are there
    // at episode 2.
    let config = "interplay = 2\nstates = \"replay\"\nrecord = \"evaluation\"";
    let mut class = Class::new("teach", config, 2, |goal, steps| -((goal as u64 * steps) as f64));
    class.cycles(1);
    assert_eq!(class.student.asked.len(), 0);
    class.cycles(1);
    assert_eq!(class.student.asked.len(), 1, "made up for at episode 1");
    class.cycles(1);
    assert_eq!(class.student.asked.len(), 2, "due at episode 2");
    assert_eq!(class.weights(), [0.0, 1.0]);
}

#[test]
fn a_value_is_recorded_whenever_the_networks_have_changed_whatever_the_interplay() {
    let window = |interplay: usize, record: &str| {
        let config = format!("interplay = {interplay}\nrecord = \"{record}\"\nwindow = 4");
        let mut class = Class::new("teach", &config, 4, swinging);
        // Cycles of two episodes.
        for _ in 0..11 {
            class.propose().unwrap();
            class.cycles(1);
        }
        held(&class).probe.window().clone()
    };
    // The first cycle has nothing to measure from, the last one has changed the networks after its episodes:
    // 1 to 10 steps.
    let every = window(1, "cycle");
    assert_eq!(every.iter().map(|values| values[0]).collect::<Vec<_>>(), [-21.0, -19.0, -21.0, -19.0]);
    for interplay in [2, 5, 50] {
        assert_eq!(window(interplay, "cycle"), every, "Δ = {interplay}");
    }
    assert_eq!(window(1, "evaluation"), every, "the same where Δ is due with every change");
    // The former behaviour stretches the window: due at episodes 0, 5, 10, 15 and 20, in cycles 0, 2, 5, 7
    // and 10.
    let stretched = window(5, "evaluation");
    assert_eq!(stretched.iter().map(|values| values[0]).collect::<Vec<_>>(), [-19.0, -21.0, -21.0, -19.0]);
}

#[test]
fn the_interplay_says_how_often_the_curriculum_is_computed() {
    // Until step 4 goal 0 moves, then goal 1.
    let script = |goal: usize, steps: u64| -(if goal == 0 { steps.min(4) } else { steps.max(4) } as f64);
    let mut class = teach("interplay = 5\nwindow = 2", 2, script);
    let weights_after = |class: &mut Class, episodes: usize| {
        class.cycles(episodes);
        class.weights()
    };
    assert_eq!(weights_after(&mut class, 1), [0.5; 2], "one value so far");
    assert_eq!(weights_after(&mut class, 4), [0.5; 2], "not due before episode 5");
    // At episode 5 the window holds the values at 4 and 5 steps.
    assert_eq!(weights_after(&mut class, 1), [0.0, 1.0]);
    assert_eq!(weights_after(&mut class, 4), [0.0, 1.0]);
}

#[test]
fn states_that_are_held_leave_networks_that_stand_still_without_variance() {
    for (states, moves) in [("reference", false), ("replay", true), ("initial", true)] {
        let config = format!("states = \"{states}\"\nwindow = 4\nrenewal = 10");
        let mut class = Class::on("FetchPush", entry("teach"), &config, 6, |goal, _| -(goal as f64)).unwrap();
        // Pushing starts elsewhere in every episode, and every second goal's value depends on the state.
        class.student.by_state = 1.0;
        class.cycles(3);
        for cycle in 0..40 {
            class.cycles(1);
            let still = class.weights() == [1.0 / 6.0; 6];
            assert_eq!(still, !moves, "{states}, cycle {cycle}: {:?}", class.weights());
        }
    }
}

#[test]
fn held_states_are_handed_over_when_the_successors_window_is_full() {
    let mut class = Class::new("teach", "window = 3\nrenewal = 5\nreplay_states = 2", 4, swinging);
    class.cycles(21);
    // Evaluations at 1 to 20 steps. A: 1 to 8, B: 6 to 13 (its 5th is the 10th), C: 11 to 18, D: 16 on.
    let states: Vec<usize> = class
        .student
        .asked
        .iter()
        .map(|question| class.student.replayed.iter().position(|drawn| *drawn == question.states).unwrap())
        .collect();
    let drawn_at_first = states[0];
    let sets: Vec<usize> = states.iter().map(|set| set - drawn_at_first).collect();
    let alone = |set: usize, times: usize| vec![set; times];
    let both = |old: usize| [old, old + 1].repeat(3);
    let expected = [alone(0, 5), both(0), alone(1, 2), both(1), alone(2, 2), both(2), alone(3, 2)].concat();
    assert_eq!(sets, expected);
    assert_eq!(class.student.asked[0].states.len(), 2);
}

#[test]
fn with_initial_states_the_newest_value_is_that_of_the_start_at_hand() {
    let mut class =
        Class::on("FetchPush", entry("teach"), "states = \"initial\"", 4, |_, steps| steps as f64).unwrap();
    class.student.by_state = 1.0;
    for cycle in 0..3 {
        for _ in 0..2 {
            class.propose().unwrap();
            let probe = held(&class).probe;
            let newest = probe.window().last().unwrap()[0];
            assert_eq!(newest, cycle as f64 + class.start.state.iter().sum::<f64>());
            assert_eq!(probe.window().len(), cycle + 1, "one value per state of the networks");
        }
        class.learn();
    }
}

#[test]
fn the_control_goes_by_the_last_change_alone() {
    // At 2 steps goal 0 has changed by 6 and then 2, goal 1 by 2 and then 6. Variances are 104/9 of both.
    let script =
        |goal: usize, steps: u64| [[0.0, -6.0, -8.0], [0.0, -2.0, -8.0]][goal][steps.min(2) as usize];
    let weights_of = |signal: &str| {
        let mut class = teach(&format!("signal = \"{signal}\"\nwindow = 3"), 2, script);
        class.cycles(3);
        class.weights()
    };
    assert!(close(&weights_of("variance"), &[0.5, 0.5]));
    assert!(close(&weights_of("difference"), &[0.25, 0.75]));
}

#[test]
fn a_long_window_needs_a_long_renewal_where_states_are_held_alone() {
    let accepted = |config: &str| entry("teach").resolve(config.parse().unwrap()).is_ok();
    assert!(!accepted("window = 200"));
    assert!(accepted("window = 200\nrenewal = 200"));
    assert!(accepted("window = 200\nstates = \"replay\"") && accepted("window = 200\nstates = \"initial\""));
}

#[test]
fn values_beyond_any_return_are_as_good_as_others() {
    // An untrained critic above 0: clipped to 0 all goals would stand still.
    let mut class = teach("window = 2", 3, |goal, steps| 5.0 + (goal as u64 * steps) as f64);
    class.cycles(2);
    assert!(close(&class.weights(), &[0.0, 0.2, 0.8]));
}

#[test]
fn a_choice_is_told_with_its_progress() {
    for selection in ["proportional", "argmax"] {
        let mut class = teach(&format!("window = 4\nselection = \"{selection}\""), 4, swinging);
        class.cycles(4);
        let proposal = class.propose().unwrap();
        let ProposedGoal::Pool(goal) = proposal.goal else { panic!("{proposal:?}") };
        // Variances 1, 4, 0 and 0.
        let expected = (Some([1.0, 4.0, 0.0, 0.0][goal]), None);
        assert_eq!((proposal.score, proposal.rank), expected, "{selection}");
    }
}

#[test]
fn argmax_takes_the_goal_that_moves_most() {
    let mut class = teach("selection = \"argmax\"", 4, swinging);
    class.cycles(2);
    assert_eq!(class.weights(), [0.0, 1.0, 0.0, 0.0]);
    assert!(class.cycles(20).iter().all(|&goal| goal == 1));
}

#[test]
fn argmax_of_standstill_is_a_uniform_draw() {
    let mut class = teach("selection = \"argmax\"", 4, |_, _| -50.0);
    class.cycles(20);
    assert_eq!(class.weights(), [0.25; 4]);
}

#[test]
fn a_state_that_contradicts_its_config_is_refused() {
    let saved = |config: &str, cycles: usize| {
        let mut class = teach(config, 4, swinging);
        class.cycles(cycles);
        class.teacher.save().unwrap()
    };
    let refusal = |config: &str, bytes: &[u8]| match teach(config, 4, swinging).teacher.load(bytes) {
        Err(CurriculumError::State { reason, .. }) => reason,
        other => panic!("{other:?}"),
    };
    let three = saved("window = 3", 3);
    assert!(teach("window = 3", 4, swinging).teacher.load(&three).is_ok());
    assert!(refusal("window = 4", &three).contains("3 evaluations in a window of 3; its config says 4"));
    let other_pool = PoolState::new(Distribution::uniform(5), 3);
    let bytes = snapshot::save("teach", 3, &(7u64, false, other_pool, Vec::<f64>::new()));
    assert!(refusal("window = 3", &bytes).contains("written for 5 goals; the pool has 4"));
}
