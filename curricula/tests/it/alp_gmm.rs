//! ALP-GMM goes where results change.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use agents::{Episode, Trajectory};
use curricula::testing::{Class, standing_still};
use curricula::{Lesson, Proposal, ProposedGoal};
use envs::{GoalEnv, Rows};

use crate::support::entry;

/// A class on `environment` with this config.
fn class(environment: &str, config: &str) -> Class {
    Class::on(environment, entry("alp-gmm"), config, 1, |_, _| 0.0).unwrap()
}

/// A cycle of one episode that is at its goal for `share` of its steps, by the goal and the episode's number.
fn cycle(class: &mut Class, number: usize, share: impl Fn(&[f64], usize) -> f64) -> Proposal {
    class.reset();
    let Class { teacher, student, start, env, rng, .. } = class;
    let proposal = teacher.propose(&mut Lesson { student, start, goals: &mut **env, rng }).unwrap();
    let goal = match &proposal.goal {
        ProposedGoal::Other(goal) => goal.clone(),
        _ => env.goal().to_vec(),
    };
    let episode = episode(&**env, &goal, share(&goal, number));
    teacher.observe(&episode).unwrap();
    let Episode { states, achieved, actions, goal, .. } = episode;
    student.remembered.push(Trajectory { states, achieved, actions, goal });
    class.learn();
    proposal
}

/// An episode that is at `goal` for the last `share` of its steps, and far away before.
fn episode(env: &dyn GoalEnv, goal: &[f64], share: f64) -> Episode {
    let mut episode = standing_still(env);
    let away: Vec<f64> = goal.iter().map(|x| x + 10.0).collect();
    let steps = env.spec().horizon;
    let arrival = steps - (share * steps as f64).round() as usize;
    let mut achieved = Rows::new(goal.len());
    (0..=steps).for_each(|step| achieved.push(if step > arrival { goal } else { &away }));
    episode.achieved = achieved;
    episode.goal = goal.to_vec();
    episode
}

/// The goals of 250 episodes and of 100 more: those that a mixture was fitted to, and those drawn from it.
fn taught(share: impl Fn(&[f64], usize) -> f64 + Copy) -> (Class, Vec<Proposal>) {
    let mut class = class("Point", "random = 0.0");
    (0..250).for_each(|number| drop(cycle(&mut class, number, share)));
    let drawn = (250..350).map(|number| cycle(&mut class, number, share)).collect();
    (class, drawn)
}

/// How many of the goals drawn from a mixture are such.
fn count(drawn: &[Proposal], is: impl Fn(&[f64]) -> bool) -> usize {
    let is = |proposal: &&Proposal| match &proposal.goal {
        ProposedGoal::Other(goal) => is(goal),
        other => panic!("{other:?}"),
    };
    drawn.iter().filter(is).count()
}

#[test]
fn goals_are_asked_for_where_results_change() {
    for side in [1.0, -1.0] {
        // On one side every other episode succeeds, for longer the farther away; on the other side none.
        let share = |goal: &[f64], number: usize| (goal[0] * side).max(0.0) * (number % 2) as f64;
        let (class, drawn) = taught(share);
        let there = count(&drawn, |goal| goal[0] * side > 0.0);
        assert!(there >= 85, "{there} of 100 on side {side}");
        assert!(drawn.iter().all(|proposal| proposal.score.is_some()));
        assert!((2.0..=10.0).contains(&class.statistic("mixture_components")));
        assert!(class.statistic("alp_mean") > 0.0);
    }
}

#[test]
fn steady_success_and_steady_failure_are_no_progress() {
    // From steady failure on the left to steady success on the right; near the lower edge now this, now that.
    let share = |goal: &[f64], number: usize| {
        let unsteady = ((-0.5 - goal[1]) / 0.5).clamp(0.0, 1.0);
        (0.5 + 0.5 * goal[0]) * (1.0 - unsteady) + (number % 2) as f64 * unsteady
    };
    let (_, drawn) = taught(share);
    let low = count(&drawn, |goal| goal[1] < -0.4);
    // A draw over the whole square would be there 30 times.
    assert!(low >= 55, "{low} of 100");
}

#[test]
fn the_first_goals_and_one_in_five_are_the_environments_own() {
    let mut class = class("Point", "fit_every = 20");
    let share = |_: &[f64], number: usize| f64::from(u8::from(number.is_multiple_of(3)));
    let natives = |class: &mut Class, range: std::ops::Range<usize>| {
        let own = |number| cycle(class, number, share).goal == ProposedGoal::Native;
        range.map(own).filter(|own| *own).count()
    };
    assert_eq!(natives(&mut class, 0..20), 20);
    assert_eq!(class.statistic("mixture_components").min(2.0), 2.0, "fitted by now");
    let later = natives(&mut class, 20..420);
    // 80 ± 8.
    assert!((52..=108).contains(&later), "{later} of 400");
}

#[test]
fn without_any_progress_all_gaussians_are_as_likely() {
    let mut class = class("Point", "fit_every = 50\nrandom = 0.0");
    (0..50).for_each(|number| drop(cycle(&mut class, number, |_, _| 0.0)));
    assert_eq!(class.statistic("alp_mean"), 0.0);
    let right = (50..150).filter(|&number| {
        matches!(cycle(&mut class, number, |_, _| 0.0).goal, ProposedGoal::Other(goal) if goal[0] > 0.0)
    });
    let right = right.count();
    assert!((15..=85).contains(&right), "{right} of 100");
}

#[test]
fn goals_lie_in_the_goal_space_whatever_its_shape() {
    for environment in ["MazeA", "FetchReach", "HandManipulateBlockRotateZ"] {
        let mut class = class(environment, "fit_every = 20\nrandom = 0.0\ncandidates = 50");
        let share = |_: &[f64], number: usize| (number % 7) as f64 / 7.0;
        let mut seen = 0;
        for number in 0..45 {
            if let ProposedGoal::Other(goal) = cycle(&mut class, number, share).goal {
                assert!(is_goal(&*class.env, &goal), "{goal:?} is no goal of {environment}");
                seen += 1;
            }
        }
        assert_eq!(seen, 25, "{environment}");
    }
}

/// Whether `goal` is one that the environment could ask for at its start.
fn is_goal(env: &dyn GoalEnv, goal: &[f64]) -> bool {
    match env.spec().id {
        "MazeA" => {
            let walls = envs::find("MazeA").unwrap().walls.unwrap();
            let [row, column] = [goal[0], goal[1]].map(|x| ((x + 1.0) / 2.0 * 13.0) as usize);
            walls[row].as_bytes()[column] != b'#'
        }
        "FetchReach" => {
            let start = &env.observation().achieved;
            goal.iter().zip(start).all(|(x, start)| (x - start).abs() <= 0.15)
        }
        // A turn about the vertical axis: a unit quaternion without parts along the other two.
        _ => {
            let norm = goal[3..].iter().map(|x| x * x).sum::<f64>();
            (norm - 1.0).abs() < 1e-12 && goal[4].abs() < 1e-12 && goal[5].abs() < 1e-12
        }
    }
}

#[test]
fn a_state_that_does_not_belong_together_is_refused() {
    let mut taught = class("Point", "fit_every = 20");
    (0..30).for_each(|number| drop(cycle(&mut taught, number, |_, number| (number % 2) as f64)));
    let saved = taught.teacher.save().unwrap();
    class("Point", "fit_every = 20").teacher.load(&saved).unwrap();
    // Of goals with three numbers, and of more episodes in the last mixture.
    let error = class("FetchReach", "fit_every = 20").teacher.load(&saved).unwrap_err();
    assert!(error.to_string().contains("do not belong together"), "{error}");
    let error = class("Point", "fit_every = 25").teacher.load(&saved).unwrap_err();
    assert!(error.to_string().contains("do not belong together"), "{error}");
}
