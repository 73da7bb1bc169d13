//! TEACH samples what moves.

use curricula::{CurriculumError, Distribution, PoolState, snapshot};

use crate::support::{Class, close};

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
    let mut class = Class::new("teach", "window = 4", 4, swinging);
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
    let mut class = Class::new("teach", "window = 2", 3, settling);
    class.cycles(3);
    assert!(close(&class.weights(), &[1.0 / 14.0, 4.0 / 14.0, 9.0 / 14.0]));
}

#[test]
fn after_a_window_of_standstill_the_curriculum_is_uniform() {
    let mut class = Class::new("teach", "window = 3", 4, settling);
    // Evaluations at 0..=6 steps; the last two of them at standstill.
    class.cycles(7);
    assert!(!close(&class.weights(), &[0.25; 4]), "one evaluation in the window is still older");
    class.cycles(1);
    assert_eq!(class.weights(), [0.25; 4]);
    assert!((class.statistic("effective_goals") - 4.0).abs() < 1e-12);
}

#[test]
fn before_the_second_evaluation_the_curriculum_is_uniform() {
    let mut class = Class::new("teach", "", 4, swinging);
    assert_eq!(class.weights(), [0.25; 4]);
    class.cycles(1);
    assert_eq!(class.weights(), [0.25; 4]);
    class.cycles(1);
    assert!(close(&class.weights(), &[0.2, 0.8, 0.0, 0.0]));
}

#[test]
fn an_evaluation_decides_already_about_the_episode_it_precedes() {
    // All of 100 goals stand still but goal 7.
    let mut class =
        Class::new("teach", "", 100, |goal, steps| if goal == 7 { -(steps as f64) } else { -9.0 });
    class.cycles(1);
    assert_eq!(class.propose_index(), 7);
}

#[test]
fn values_that_move_by_rounding_alone_stand_still() {
    // Single precision near -50 comes in steps of 2^-18 = 3.8e-6; a goal that swings by half of it has the variance
    // (1.9e-6)² = 3.6e-12, and one that swings by 1e-4 the variance 1e-8.
    let rounding = |goal: usize, steps: u64| -50.0 + (steps % 2) as f64 * [3.8e-6, 0.0][goal];
    let more = |goal: usize, steps: u64| -50.0 + (steps % 2) as f64 * [2e-4, 0.0][goal];
    for selection in ["proportional", "argmax"] {
        let weights_of = |script| {
            let mut class = Class::new("teach", &format!("selection = \"{selection}\""), 2, script);
            class.cycles(8);
            class.weights()
        };
        assert_eq!(weights_of(rounding), [0.5; 2], "{selection}");
        assert_eq!(weights_of(more), [1.0, 0.0], "{selection}");
    }
}

#[test]
fn an_evaluation_that_had_no_states_yet_is_made_up_for() {
    let mut class = Class::new("teach", "interplay = 5\nstates = \"replay\"", 4, swinging);
    let asked_after = |class: &mut Class, episodes: usize| {
        class.cycles(episodes);
        class.student.asked.len()
    };
    assert_eq!(asked_after(&mut class, 1), 0, "due at episode 0, but nothing is replayed yet");
    assert_eq!(asked_after(&mut class, 1), 1, "made up for at episode 1");
    assert_eq!(asked_after(&mut class, 3), 1);
    assert_eq!(asked_after(&mut class, 1), 2, "due at episode 5");
}

#[test]
fn an_evaluation_that_unchanged_networks_made_needless_is_left_out() {
    let mut class = Class::new("teach", "interplay = 2", 4, swinging);
    // A long cycle: the evaluation at episode 2 would find what that at episode 0 found.
    (0..3).for_each(|_| assert!(class.propose().is_ok()));
    class.learn();
    class.propose_index();
    assert_eq!(class.student.asked.len(), 1, "nothing is due at episode 3");
    class.propose_index();
    assert_eq!(class.student.asked.len(), 2);
}

#[test]
fn interplay_is_counted_in_episodes() {
    let mut class = Class::new("teach", "interplay = 5", 4, swinging);
    class.cycles(11);
    // Episodes 0, 5 and 10.
    assert_eq!(class.student.asked.len(), 3);
    assert!(close(&class.weights(), &[0.2, 0.8, 0.0, 0.0]));
}

#[test]
fn argmax_takes_the_goal_that_moves_most() {
    let mut class = Class::new("teach", "selection = \"argmax\"", 4, swinging);
    class.cycles(2);
    assert_eq!(class.weights(), [0.0, 1.0, 0.0, 0.0]);
    assert!(class.cycles(20).iter().all(|&goal| goal == 1));
}

#[test]
fn argmax_of_standstill_is_a_uniform_draw() {
    let mut class = Class::new("teach", "selection = \"argmax\"", 4, |_, _| -50.0);
    class.cycles(20);
    assert_eq!(class.weights(), [0.25; 4]);
}

#[test]
fn a_state_that_contradicts_itself_or_its_config_is_refused() {
    let load = |config: &str, evaluations: Vec<Vec<f64>>| {
        let common = PoolState::new(Distribution::uniform(4));
        // Episodes, whether an evaluation is due, and the window's capacity and content.
        let bytes = snapshot::save("teach", 2, &(7u64, false, (3usize, evaluations), common));
        Class::new("teach", config, 4, swinging).teacher.load(&bytes)
    };
    let refusal = |config: &str, evaluations| match load(config, evaluations) {
        Err(CurriculumError::State { reason }) => reason,
        other => panic!("{other:?}"),
    };
    assert!(load("window = 3", vec![vec![-1.0; 4]; 3]).is_ok());
    assert!(
        refusal("window = 4", vec![vec![-1.0; 4]; 3])
            .contains("3 evaluations in a window of 3; its config says 4")
    );
    assert!(refusal("window = 3", vec![vec![-1.0; 4]; 4]).contains("4 evaluations in a window of 3"));
    assert!(refusal("window = 3", vec![vec![-1.0; 5]]).contains("written for 5 goals; the pool has 4"));
}
