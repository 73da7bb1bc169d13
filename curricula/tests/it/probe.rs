//! How the teachers that go by confidence ask for it.

use agents::{AgentError, Network};
use curricula::{CURRICULA, CurriculumError, Entry};

use crate::support::Class;

const GOALS: usize = 5;

/// The teachers that go by confidence.
fn measuring() -> impl Iterator<Item = &'static Entry> {
    CURRICULA.iter().filter(|entry| (entry.defaults)().contains_key("confidence"))
}

#[test]
fn by_default_the_online_networks_answer_for_the_whole_pool_at_the_start_at_hand() {
    for entry in measuring() {
        // Pushing starts elsewhere in every episode.
        let mut class = Class::on("FetchPush", entry, "", GOALS, |goal, _| -(goal as f64)).unwrap();
        for cycle in 0..3 {
            class.propose().unwrap();
            let question = &class.student.asked[cycle];
            assert_eq!(question.network, Network::Online, "{}", entry.id);
            assert_eq!(question.goals, *class.setting.pool, "{}", entry.id);
            assert_eq!(question.states.as_slice(), class.start.state, "{}", entry.id);
            class.learn();
        }
        assert_ne!(class.student.asked[0].states, class.student.asked[1].states, "starts differ");
    }
}

#[test]
fn target_networks_and_replayed_states_are_asked_for_by_config() {
    let config = "confidence = \"target\"\nstates = \"replay\"\nreplay_states = 4";
    for entry in measuring() {
        let mut class = Class::with(entry, config, GOALS, |goal, _| -(goal as f64)).unwrap();
        for _ in 0..3 {
            class.propose().unwrap();
            class.learn();
        }
        // Not in the first cycle: the buffer is still empty.
        assert_eq!(class.student.asked.len(), 2, "{}", entry.id);
        for (question, states) in class.student.asked.iter().zip(&class.student.replayed[1..]) {
            assert_eq!(question.network, Network::Target, "{}", entry.id);
            assert_eq!((&question.states, states.len()), (states, 4), "{}", entry.id);
        }
    }
}

#[test]
fn unchanged_networks_are_not_asked_again() {
    for entry in measuring() {
        let mut class = Class::with(entry, "", GOALS, |goal, _| -(goal as f64)).unwrap();
        for _ in 0..3 {
            // A cycle of two episodes.
            class.propose().unwrap();
            class.propose().unwrap();
            class.learn();
        }
        assert_eq!(class.student.asked.len(), 3, "{}", entry.id);
        assert_eq!(class.statistic("evaluations"), 3.0, "{}", entry.id);
    }
}

#[test]
fn confidence_is_summarised_for_the_records() {
    for entry in measuring() {
        let mut class = Class::with(entry, "", GOALS, |goal, _| -[1.0, 7.0, 0.0, 3.0, 4.0][goal]).unwrap();
        assert!(class.statistic("confidence_mean").is_nan(), "{}: not defined yet", entry.id);
        class.propose().unwrap();
        assert_eq!(class.statistic("confidence_mean"), -3.0, "{}", entry.id);
        assert_eq!(class.statistic("confidence_min"), -7.0, "{}", entry.id);
        assert_eq!(class.statistic("confidence_max"), 0.0, "{}", entry.id);
    }
}

#[test]
fn confidence_that_is_no_number_is_an_error_that_names_the_goal() {
    for entry in measuring() {
        let script = |goal, _| if goal == 2 { f64::NAN } else { 0.0 };
        let error = Class::with(entry, "", GOALS, script).unwrap().propose().unwrap_err();
        let named = matches!(error, CurriculumError::NotFinite { what: "confidence", index: 2, .. });
        assert!(named, "{}: {error}", entry.id);
    }
}

#[test]
fn an_answer_that_leaves_goals_out_is_refused() {
    for entry in measuring() {
        let mut class = Class::with(entry, "", GOALS, |_, _| -1.0).unwrap();
        class.student.unanswered = 1;
        let error = class.propose().unwrap_err();
        let expected = CurriculumError::Student(AgentError::Shape {
            what: "confidence",
            expected: GOALS,
            got: GOALS - 1,
        });
        assert_eq!(error.to_string(), expected.to_string(), "{}", entry.id);
    }
}
