//! What a method chooses, and what it tells of that.

use envs::GoalEnv;

use super::{ENOUGH_CYCLES, GOALS, Subject, proposals, restless, unsteady};
use crate::curriculum::{Proposal, ProposedGoal};
use crate::judgement::Judgement;
use crate::registry::Entry;
use crate::testing::Class;

pub(super) fn chooses_the_only_goal_of_a_pool(entry: &Entry) {
    if !entry.uses_pool {
        return;
    }
    let subject = Subject { entry, config: "" };
    let mut class = subject.class(1);
    for Proposal { goal, .. } in proposals(&mut class, 5) {
        assert_eq!(goal, ProposedGoal::Pool(0), "{subject}: the only goal of the pool");
    }
    let weights = class.teacher.summary().weights;
    assert!(weights.is_none_or(|weights| weights == [1.0]), "{subject}: {weights:?}");
}

pub(super) fn stays_in_the_goal_space(entry: &Entry) {
    for environment in ["Point", "MazeA", "MazeB", "MazeC", "FetchReach"] {
        let mut class = Class::on(environment, entry, "", GOALS, restless).expect("valid defaults");
        class.mastery = unsteady;
        for _ in 0..30 {
            let goal = class.propose_goal();
            let inside = in_goal_space(&*class.env, &goal);
            assert!(inside, "{}: {goal:?} is no goal of {environment}", entry.id);
            class.learn();
        }
    }
}

/// Whether `goal` is one that the environment could ask for.
fn in_goal_space(env: &dyn GoalEnv, goal: &[f64]) -> bool {
    match env.spec().id {
        "Point" => goal.len() == 2 && goal.iter().all(|x| (-1.0..=1.0).contains(x)),
        // Gripper positions up to 0.15 m from where the gripper starts.
        "FetchReach" => {
            let start = &env.observation().achieved;
            goal.len() == 3 && goal.iter().zip(start).all(|(x, start)| (x - start).abs() <= 0.15)
        }
        maze => {
            let walls = envs::find(maze).expect("an environment").walls.expect("a maze");
            // The square [-1, 1]² in 13 × 13 cells.
            let [row, column] = [goal[0], goal[1]].map(|x| ((x + 1.0) / 2.0 * 13.0) as usize);
            goal.len() == 2 && walls.get(row).is_some_and(|row| matches!(row.as_bytes()[column], b'.' | b'S'))
        }
    }
}

pub(super) fn is_repeatable(subject: Subject<'_>) {
    let [mut one, mut other] = [subject.class(GOALS), subject.class(GOALS)];
    assert_eq!(proposals(&mut one, 15), proposals(&mut other, 15), "{subject}: the same seed");
    let saved = |class: &Class| class.teacher.save().expect("plain data and networks");
    assert!(saved(&one) == saved(&other), "{subject}: the same seed gives another state");
}

pub(super) fn uses_the_pool_as_it_says(subject: Subject<'_>) {
    for Proposal { goal, .. } in proposals(&mut subject.class(GOALS), 5) {
        let from_pool = matches!(goal, ProposedGoal::Pool(index) if index < GOALS);
        assert_eq!(from_pool, subject.entry.uses_pool, "{subject}: {goal:?}");
    }
}

pub(super) fn asks_for_rollouts_that_can_be_played(subject: Subject<'_>) {
    let mut class = subject.class(GOALS);
    for _ in 0..ENOUGH_CYCLES {
        (0..2).for_each(|_| drop(class.propose().expect("a proposal")));
        class.learn_alone();
        let Some(request) = class.request() else { continue };
        assert!(request.all_episodes() > 0, "{subject}: asks for rollouts and for none");
        assert!(request.goals.iter().all(|goal| in_goal_space(&*class.env, goal)), "{subject}: {request:?}");
        class.play(&request);
    }
}

pub(super) fn leaves_the_environment_alone(subject: Subject<'_>) {
    let [mut class, mut untouched] = [subject.class(GOALS), subject.class(GOALS)];
    for _ in 0..5 {
        class.propose().expect("a proposal");
        untouched.reset();
        assert_eq!(class.env.goal(), untouched.env.goal(), "{subject}: the goal of the reset");
        assert_eq!(class.env.observation(), untouched.env.observation(), "{subject}: the start");
        class.learn();
    }
}

pub(super) fn tells_weights_that_are_a_distribution(subject: Subject<'_>) {
    let mut class = subject.class(GOALS);
    for _ in 0..6 {
        proposals(&mut class, 1);
        let summary = class.teacher.summary();
        let Some(weights) = summary.weights else { continue };
        assert!(subject.entry.uses_pool, "{subject}: weighs a pool that it does not use");
        assert_eq!(weights.len(), GOALS, "{subject}: one weight per goal");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{subject}: the sum of {weights:?}");
        let entropy: f64 = weights.iter().filter(|&&p| p > 0.0).map(|p| -p * p.ln()).sum();
        for (name, expected) in [(names::ENTROPY, entropy), (names::EFFECTIVE_GOALS, entropy.exp())] {
            if let Some((_, told)) = summary.statistics.iter().find(|(known, _)| *known == name) {
                assert!((told - expected).abs() < 1e-9, "{subject}: {name} is {told}, not {expected}");
            }
        }
    }
}

pub(super) fn believes_something_of_goals_or_has_no_list(subject: Subject<'_>) {
    let mut class = subject.class(GOALS);
    for _ in 0..6 {
        let Judgement { success, scores } = class.teacher.judge(&class.student);
        for beliefs in [&success, &scores].into_iter().flatten() {
            assert!(subject.entry.uses_pool, "{subject}: judges a pool that it does not use");
            assert_eq!(beliefs.len(), GOALS, "{subject}: an entry for each goal");
            let mut told = beliefs.iter().flatten().peekable();
            assert!(told.peek().is_some(), "{subject}: a list that tells of no goal is none");
            assert!(told.all(|belief| belief.is_finite()), "{subject}: {beliefs:?}");
        }
        let mut estimates = success.iter().flatten().flatten();
        assert!(estimates.all(|p| (0.0..=1.0).contains(p)), "{subject}: {success:?}");
        proposals(&mut class, 1);
    }
}

pub(super) fn tells_the_same_numbers_in_the_same_order(subject: Subject<'_>) {
    let mut class = subject.class(GOALS);
    let names = |class: &Class| -> Vec<String> {
        class.teacher.summary().statistics.into_iter().map(|(name, _)| name.to_owned()).collect()
    };
    let before = names(&class);
    proposals(&mut class, 4);
    assert_eq!(before, names(&class), "{subject}: the numbers have other names now");
    let snake_case =
        |name: &String| name.bytes().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_');
    assert!(before.iter().all(snake_case), "{subject}: {before:?}");
    for (index, name) in before.iter().enumerate() {
        assert!(!before[..index].contains(name), "{subject}: tells two numbers called {name}");
        assert!(!names::OF_PICKS.contains(&name.as_str()), "{subject}: goalbench itself records {name}");
    }
}
