//! Teachers that look on while another one acts: what they hear counts for the goal that was played, not for
//! the one that they proposed.

use agents::{Episode, Trajectory};
use curricula::testing::{Class, standing_still};
use curricula::{Lesson, Proposal};
use envs::rng::{Purpose, stream};

/// A class in which the critic errs by the first component of a goal.
fn class(id: &str, config: &str) -> Class {
    let mut class = Class::new(id, config, 12, |_, _| -10.0);
    class.student.surprise = |goal, _| goal[0];
    class
}

/// An episode towards `goal`, whatever the teacher proposes.
fn look_on(class: &mut Class, goal: &[f64], success: bool) -> Proposal {
    class.reset();
    let Class { teacher, student, start, env, rng, .. } = &mut *class;
    let proposal = teacher.propose(&mut Lesson { student, start, goals: &mut **env, rng }).expect("a goal");
    let episode = Episode { goal: goal.to_vec(), success, ..standing_still(&*class.env) };
    class.teacher.observe(&episode).expect("an episode of its task");
    let Episode { states, achieved, actions, goal, .. } = episode;
    class.student.remembered.push(Trajectory { states, achieved, actions, goal });
    proposal
}

#[test]
fn what_a_shadow_hears_counts_for_the_goal_that_was_played() {
    let teachers = [
        ("goid", "goals_per_region = 1\nwindow = 4"),
        ("lp", "regions = 4\nwindow = 10"),
        ("plr", "schedule = \"fixed\"\nreplay = 0.5"),
    ];
    for (id, config) in teachers {
        let [mut one, mut other] = [class(id, config), class(id, config)];
        // The two propose other goals, and hear the same.
        other.rng = stream(7, Purpose::Teacher);
        let (mut differ, mut heard) = (false, false);
        for episode in 0..60usize {
            let mut goal = one.setting.pool.row(episode % 3).to_vec();
            if episode % 2 == 1 {
                // A goal from elsewhere.
                goal[0] += 1e-3;
            }
            let success = episode % 3 == 1 && episode % 4 < 2;
            let proposals = [&mut one, &mut other].map(|class| look_on(class, &goal, success));
            differ |= proposals[0].goal != proposals[1].goal;
            one.learn();
            other.learn();
            let weights = [&one, &other].map(Class::weights);
            assert_eq!(weights[0], weights[1], "{id} after {episode} episodes: by what it proposed itself");
            heard |= weights[0].windows(2).any(|pair| pair[0] != pair[1]);
        }
        assert!(differ, "{id}: the test needs other proposals");
        assert!(heard, "{id} has heard nothing");
    }
}
