//! MEGA asks for what was achieved least often, and OMEGA comes back to the environment's goals.

use agents::{Network, Trajectory};
use curricula::methods::omega::keep_probability;
use curricula::testing::{Class, standing_still};
use curricula::{KernelDensity, ProposedGoal, Scaling, divergence};
use envs::rng::{Purpose, stream, uniform};
use envs::{Goals, Rows};

/// A class whose student remembers episodes that achieved `places`, each for all of its steps.
fn class(id: &str, config: &str, places: &[[f64; 2]], script: fn(usize, u64) -> f64) -> Class {
    let mut class = Class::new(id, config, 1, script);
    class.reset();
    class.student.remembered = places.iter().map(|place| stay(&class, place)).collect();
    class
}

/// An episode spent at `place`.
fn stay(class: &Class, place: &[f64]) -> Trajectory {
    let mut achieved = Rows::new(place.len());
    (0..=class.setting.spec.horizon).for_each(|_| achieved.push(place));
    let agents::Episode { states, actions, goal, .. } = standing_still(&*class.env);
    Trajectory { states, achieved, actions, goal }
}

/// `n` places evenly over the square of this half side.
fn spread(n: usize, half: f64) -> Vec<[f64; 2]> {
    let mut rng = stream(7, Purpose::Pool);
    (0..n).map(|_| [0, 1].map(|_| uniform(&mut rng, -half, half))).collect()
}

fn goal(proposal: &curricula::Proposal) -> &[f64] {
    match &proposal.goal {
        ProposedGoal::Other(goal) => goal,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_rarest_achieved_goal_is_asked_for() {
    let mut places = spread(50, 0.005);
    places.push([0.9, 0.9]);
    let mut class = class("mega", "samples = 500", &places, |_, _| -1.0);
    let asked = (0..50).filter(|_| {
        // Episodes of the class itself are not to be remembered here.
        let proposal = class.propose().unwrap();
        class.student.remembered.truncate(places.len());
        goal(&proposal) == [0.9, 0.9]
    });
    // It is among 100 candidates of 51 places with a probability of 0.86.
    let asked = asked.count();
    assert!(asked >= 35, "{asked} of 50");
}

#[test]
fn goals_of_low_value_are_left_out_as_long_as_others_pass() {
    let places = spread(500, 1.0);
    let passes: fn(usize, u64) -> f64 = |candidate, _| if candidate.is_multiple_of(2) { -2.9 } else { -3.1 };
    let nobody: fn(usize, u64) -> f64 = |candidate, _| -4.0 - (candidate as f64 - 30.0).abs();
    for (script, passed) in [(passes, 0.5), (nobody, 0.0)] {
        for seed in 0..10 {
            let mut class = class("mega", "samples = 300", &places, script);
            class.rng = stream(seed, Purpose::Teacher);
            let proposal = class.propose().unwrap();
            let question = class.student.asked.last().unwrap();
            assert_eq!((question.network, question.goals.len()), (Network::Online, 100));
            assert_eq!(question.states.as_slice(), class.start.state, "from the start at hand");
            let mut chosen = (0..100).filter(|&i| question.goals.row(i) == goal(&proposal));
            assert_eq!(class.statistic("passed_share"), passed);
            if passed > 0.0 {
                assert!(chosen.any(|i| i.is_multiple_of(2)), "one that passes");
            } else {
                assert!(chosen.any(|i| i == 30), "the one of highest value");
            }
        }
    }
}

#[test]
fn the_density_is_that_of_replayed_goals_on_their_own_scale() {
    // Both components of the goals count alike, though one is a hundred times as wide.
    let places: Vec<[f64; 2]> = spread(200, 1.0).into_iter().map(|[x, y]| [x, 0.01 * y]).collect();
    let mut class = class("mega", "samples = 400\nbandwidth = 0.3", &places, |_, _| -1.0);
    let mut rng = class.rng.clone();
    let proposal = class.propose().unwrap();

    let goals = class.student.remembered[..places.len()].to_vec();
    class.student.remembered = goals;
    let sample = agents::Critic::replay_achieved(&mut class.student, 400, &mut rng);
    let candidates = agents::Critic::replay_achieved(&mut class.student, 100, &mut rng);
    let scaling = Scaling::of(&sample);
    let mut density = KernelDensity::new(&scaling.rows(&sample), 0.3);
    let all: Vec<f64> = candidates.iter().map(|goal| density.log_at(&scaling.row(goal))).collect();
    let least = (0..100).min_by(|&a, &b| all[a].total_cmp(&all[b])).unwrap();
    assert_eq!(goal(&proposal), candidates.row(least));
    assert_eq!(proposal.score, Some(-all[least]));
    assert_eq!(class.statistic("log_density"), all[least]);
    assert!(class.rng == rng, "nothing else is drawn");
}

#[test]
fn the_cutoff_falls_while_goals_are_reached_and_rises_while_they_are_not() {
    // All that was achieved lies at the start, so that standing still reaches it.
    let mut class = Class::new("mega", "samples = 50", 1, |candidate, _| -1.0 - candidate as f64);
    let cycles = |class: &mut Class, n: usize, reached: bool| {
        for _ in 0..n {
            class.reset();
            let place: Vec<f64> =
                class.start.achieved.iter().map(|x| if reached { *x } else { x + 1.0 }).collect();
            // Proposals reset the class once more: on the point task to a start elsewhere.
            class.student.remembered = vec![stay(class, &place)];
            class.propose().unwrap();
            let start = class.start.achieved.clone();
            let asked = if reached { start.clone() } else { start.iter().map(|x| x + 1.0).collect() };
            class.student.remembered.last_mut().unwrap().goal = asked;
            class.learn();
        }
        class.statistic("cutoff")
    };
    assert_eq!(cycles(&mut class, 10, true), -3.0);
    // The eleventh choice hears of ten successes.
    assert_eq!(cycles(&mut class, 1, true), -4.0);
    assert_eq!(cycles(&mut class, 9, true), -4.0);
    assert_eq!(cycles(&mut class, 1, true), -5.0);
    assert_eq!(cycles(&mut class, 9, false), -5.0, "one success is still counted");
    assert_eq!(cycles(&mut class, 1, false), -4.0, "one in ten is hard");
    assert_eq!(cycles(&mut class, 20, false), -3.0, "no higher than at first");
}

#[test]
fn before_anything_is_achieved_goals_are_the_environments_own() {
    for id in ["mega", "omega"] {
        let mut class = Class::new(id, "", 1, |_, _| -1.0);
        assert_eq!(class.propose().unwrap().goal, ProposedGoal::Native, "{id}");
        assert!(class.student.asked.is_empty());
    }
}

#[test]
fn omega_keeps_the_environments_goals_as_often_as_the_divergence_says() {
    // Everywhere, in a part of the square, and in next to no part.
    for (half, range) in [(1.0, 0.99..=1.0), (0.75, 0.15..=0.8), (0.01, 0.0..=0.02)] {
        let places = spread(400, half);
        let mut class = class("omega", "samples = 500\ndesired = 200", &places, |_, _| -1.0);
        let mut keep = 0.0;
        let own = (0..200).filter(|_| {
            let proposal = class.propose().unwrap();
            class.student.remembered.truncate(places.len());
            keep += class.statistic("keep_probability");
            proposal.goal == ProposedGoal::Native
        });
        let own = own.count() as f64 / 200.0;
        let keep = keep / 200.0;
        assert!(range.contains(&keep), "{half}: {keep}");
        // Three standard deviations of a share of 200.
        assert!((own - keep).abs() <= 3.0 * (0.25 / 200.0f64).sqrt(), "{half}: {own}, not {keep}");
    }
}

#[test]
fn the_divergence_is_between_fresh_goals_and_achieved_ones_and_is_renewed() {
    let places = spread(300, 0.5);
    let config = "samples = 400\ndesired = 100\nrenewal = 3";
    let mut class = class("omega", config, &places, |_, _| -1.0);
    let mut rng = class.rng.clone();
    let mut told = Vec::new();
    for _ in 0..7 {
        class.propose().unwrap();
        class.student.remembered.truncate(places.len());
        told.push(class.statistic("divergence"));
    }
    assert!(told[0] == told[2] && told[3] == told[5] && told[6] != told[5], "{told:?}");
    assert_ne!(told[2], told[3], "renewed after three episodes");

    let sample = agents::Critic::replay_achieved(&mut class.student, 400, &mut rng);
    let mut desired = Goals::new(2);
    let mut goal = [0.0; 2];
    for _ in 0..100 {
        class.env.sample_goal(&mut rng, &mut goal);
        desired.push(&goal);
    }
    let scaling = Scaling::of(&sample);
    let at = |points: &Rows| {
        let mut density = KernelDensity::new(&scaling.rows(points), 0.1);
        desired.iter().map(|goal| density.log_at(&scaling.row(goal))).collect::<Vec<f64>>()
    };
    assert_eq!(told[0], divergence(&at(&desired), &at(&sample)));
    assert!(keep_probability(-3.0, told[0]) <= 1.0);
}
