//! HGG asks for what was achieved on the way to the environment's goals.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use agents::{Network, Trajectory};
use curricula::methods::hgg::price;
use curricula::testing::{Class, LOWEST};
use curricula::{Proposal, ProposedGoal};
use envs::{Goals, Rows};

use crate::support::entry;

/// An episode on the point task that walks evenly from one place to another.
fn walk(from: [f64; 2], to: [f64; 2]) -> Trajectory {
    let mut places = Rows::new(2);
    for step in 0..=20 {
        let share = f64::from(step) / 20.0;
        places.push(&[0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])));
    }
    let mut actions = Rows::new(2);
    (0..20).for_each(|_| actions.push(&[0.0, 0.0]));
    Trajectory { states: places.clone(), achieved: places, actions, goal: to.to_vec() }
}

fn class(config: &str, remembered: &[Trajectory], script: fn(usize, u64) -> f64) -> Class {
    let mut class = Class::on("Point", entry("hgg"), config, 1, script).unwrap();
    class.student.remembered = remembered.to_vec();
    class
}

/// One proposal; what the student remembers stays as it was.
fn propose(class: &mut Class) -> Proposal {
    let proposal = class.propose().unwrap();
    class.student.remembered.pop();
    proposal
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Four walks from near the origin to the corners and edges of the square.
fn four() -> [Trajectory; 4] {
    [[0.9, 0.9], [-0.8, 0.7], [0.0, -0.9], [0.6, -0.2]].map(|to| walk([0.05, 0.0], to))
}

/// Value falls with every step of a walk.
fn falling(step: usize, _steps: u64) -> f64 {
    -(step as f64)
}

#[test]
fn three_goals_are_matched_at_the_least_cost_of_all_pairs() {
    for seed in 0..10 {
        let config = "goals = 3\ntrajectories = 4\nc = 2.0\nlipschitz = 4.0";
        let mut class = class(config, &four(), falling);
        class.rng = envs::rng::stream(seed, envs::rng::Purpose::Teacher);
        let mut rng = class.rng.clone();
        let first = propose(&mut class);
        let start = class.start.achieved.clone();

        // The environment's goals and the diameter of its goal space, from the same stream.
        let (mut wanted, mut goal, mut diameter) = (Goals::new(2), [0.0; 2], 0.0_f64);
        for draw in 0..1000 {
            class.env.sample_goal(&mut rng, &mut goal);
            diameter = diameter.max(distance(&goal, &start));
            if draw < 3 {
                wanted.push(&goal);
            }
        }
        assert_eq!(class.statistic("diameter"), diameter);
        let effort: Vec<f64> = (0..=20).map(|step| f64::from(step) / -LOWEST * diameter / 4.0).collect();
        // The newest first.
        let newest: Vec<Trajectory> = four().into_iter().rev().collect();
        let cost = |goal: usize, walk: usize| {
            let achieved = &newest[walk].achieved;
            let (step, cost) = price(achieved, &effort, wanted.row(goal));
            (achieved.row(step).to_vec(), cost + 2.0 * distance(achieved.row(0), &start))
        };
        let all = (0..4).flat_map(|a| (0..4).flat_map(move |b| (0..4).map(move |c| [a, b, c])));
        let pairs = all.filter(|[a, b, c]| a != b && b != c && a != c);
        let sum = |pairs: &[usize; 3]| (0..3).map(|goal| cost(goal, pairs[goal]).1).sum::<f64>();
        let best = pairs.min_by(|a, b| sum(a).total_cmp(&sum(b))).unwrap();

        let proposals = [first, propose(&mut class), propose(&mut class)];
        for (goal, proposal) in proposals.iter().enumerate() {
            let (hindsight, cost) = cost(goal, best[goal]);
            assert_eq!(proposal.goal, ProposedGoal::Other(hindsight), "{seed}, {goal}");
            assert!((proposal.score.unwrap() + cost).abs() < 1e-12, "{seed}, {goal}");
        }
        assert!((class.statistic("mean_cost") - sum(&best) / 3.0).abs() < 1e-12);
        assert!(class.rng == rng, "nothing else is drawn");
    }
}

#[test]
fn values_are_those_of_every_achieved_goal_from_the_trajectorys_own_start() {
    let mut class = class("goals = 2\ntrajectories = 3", &four(), falling);
    propose(&mut class);
    assert_eq!(class.statistic("trajectories"), 3.0);
    assert_eq!(class.student.asked.len(), 3, "of the newest three");
    let remembered = four();
    for (question, walk) in class.student.asked.iter().zip(remembered.iter().rev()) {
        assert_eq!((question.network, &question.goals), (Network::Online, &walk.achieved));
        assert_eq!(question.states.as_slice(), walk.states.row(0));
    }
    propose(&mut class);
    assert_eq!(class.student.asked.len(), 3, "the second goal is of the same matching");
    propose(&mut class);
    assert_eq!(class.student.asked.len(), 6, "the third one is not");
}

#[test]
fn values_count_within_their_bounds_alone() {
    let goals = |script: fn(usize, u64) -> f64| {
        let mut class = class("goals = 4\ntrajectories = 4", &four(), script);
        (0..4).map(|_| propose(&mut class)).collect::<Vec<_>>()
    };
    assert_eq!(goals(|_, _| 5.0), goals(|_, _| 0.0));
    assert_eq!(goals(|_, _| -80.0), goals(|_, _| LOWEST));
    assert_ne!(goals(|_, _| -80.0), goals(|_, _| 0.0), "the cost is another");
}

#[test]
fn trajectories_from_a_start_like_this_one_are_preferred() {
    // Both kinds go to the same places. The point task starts within 0.2 of the origin.
    let to = [[0.9, 0.9], [-0.9, 0.9], [0.9, -0.9], [-0.9, -0.9]];
    let near = to.map(|to| walk([0.0, 0.0], to));
    let far = to.map(|to| walk([0.95, 0.0], to));
    let remembered = [far.clone(), near.clone(), far].concat();
    let asked_of_near = |c: &str| {
        let mut class = class(&format!("goals = 4\ntrajectories = 12\n{c}"), &remembered, falling);
        let mut of_near = 0;
        for _ in 0..40 {
            let ProposedGoal::Other(goal) = propose(&mut class).goal else { panic!("matched") };
            of_near += usize::from(near.iter().any(|walk| walk.achieved.iter().any(|place| place == goal)));
        }
        of_near
    };
    assert_eq!(asked_of_near("c = 1000.0"), 40);
    assert!(asked_of_near("c = 0.0") < 40);
}

#[test]
fn trajectories_that_stand_still_are_passed_over() {
    let still = walk([0.5, 0.5], [0.5, 0.509]);
    let mut class =
        class("goals = 1\ntrajectories = 2", &[four().to_vec(), vec![still.clone(); 5]].concat(), falling);
    propose(&mut class);
    assert_eq!(class.statistic("trajectories"), 2.0);
    assert!(class.student.asked.iter().all(|question| question.goals != still.achieved));
    // Unless there are no others: then goals are the environment's own, as many as would be matched.
    let mut class = self::class("goals = 3\ntrajectories = 4", &vec![still; 5], falling);
    for _ in 0..3 {
        assert_eq!(propose(&mut class).goal, ProposedGoal::Native);
    }
    class.student.remembered = four().to_vec();
    assert!(matches!(propose(&mut class).goal, ProposedGoal::Other(_)));
}

#[test]
fn a_single_trajectory_serves_all_goals() {
    let one = walk([0.0, 0.0], [1.0, 1.0]);
    let mut class = class("", std::slice::from_ref(&one), falling);
    for _ in 0..50 {
        let ProposedGoal::Other(goal) = propose(&mut class).goal else { panic!("matched") };
        assert!(one.achieved.iter().any(|place| place == goal));
    }
    assert_eq!(class.student.asked.len(), 1, "one episode, asked once for fifty goals");
    propose(&mut class);
    assert_eq!(class.student.asked.len(), 2);
}

#[test]
fn goals_come_nearer_to_the_environments_as_trajectories_do() {
    let reach = |length: f64| {
        let directions = (0..40).map(|i| f64::from(i) * std::f64::consts::TAU / 40.0);
        let walks: Vec<Trajectory> =
            directions.map(|angle| walk([0.0, 0.0], [length * angle.cos(), length * angle.sin()])).collect();
        let mut class = class("goals = 20\ntrajectories = 40", &walks, falling);
        let norms = (0..20).map(|_| match propose(&mut class).goal {
            ProposedGoal::Other(goal) => distance(&goal, &[0.0, 0.0]),
            other => panic!("{other:?}"),
        });
        norms.sum::<f64>() / 20.0
    };
    let (short, long) = (reach(0.2), reach(0.9));
    assert!(short < 0.21 && long > 2.0 * short, "{short}, then {long}");
}

#[test]
fn goals_of_another_task_are_refused() {
    let mut taught = class("goals = 3\ntrajectories = 4", &four(), falling);
    propose(&mut taught);
    let saved = taught.teacher.save().unwrap();
    class("goals = 3\ntrajectories = 4", &[], falling).teacher.load(&saved).unwrap();
    let hgg =
        |environment: &str, config: &str| Class::on(environment, entry("hgg"), config, 1, falling).unwrap();
    for mut other in [hgg("FetchReach", "goals = 3"), hgg("Point", "goals = 2")] {
        let error = other.teacher.load(&saved).unwrap_err();
        assert!(error.to_string().contains("too many, or of another task"), "{error}");
    }
}
