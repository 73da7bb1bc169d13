//! How the teachers that go by confidence ask for it.

use agents::{AgentError, Network};
use curricula::testing::Class;
use curricula::{CURRICULA, CurriculumError, Entry};

const GOALS: usize = 5;
/// There is a start to measure from before anything is replayed.
const INITIAL: &str = "states = \"initial\"";

/// The teachers that go by confidence.
fn measuring() -> impl Iterator<Item = &'static Entry> {
    CURRICULA.iter().filter(|entry| (entry.defaults)().contains_key("confidence"))
}

/// What makes every one of them measure as often as it can.
fn eager(entry: &Entry, config: &str) -> String {
    let often = if entry.id == "space" { "update_steps = 1\n" } else { "" };
    format!("{often}{config}")
}

#[test]
fn by_default_the_online_networks_answer_for_the_whole_pool() {
    for entry in measuring() {
        // Pushing starts elsewhere in every episode.
        let config = eager(entry, "");
        let mut class = Class::on("FetchPush", entry, &config, GOALS, |goal, _| -(goal as f64)).unwrap();
        for _ in 0..4 {
            class.propose().unwrap();
            let Some(question) = class.student.asked.last() else {
                assert_ne!(entry.id, "procurl", "measures from the first episode on");
                class.learn();
                continue;
            };
            assert_eq!(question.network, Network::Online, "{}", entry.id);
            assert_eq!(question.goals, *class.setting.pool, "{}", entry.id);
            if entry.id == "procurl" {
                assert_eq!(question.states.as_slice(), class.start.state, "the start at hand");
            } else {
                assert_eq!(question.states, class.student.asked[0].states, "{}: states are held", entry.id);
                assert_eq!(question.states.len(), 8, "{}", entry.id);
            }
            class.learn();
        }
    }
}

#[test]
fn other_networks_and_replayed_states_are_asked_for_by_config() {
    for (name, network) in [("target", Network::Target), ("target-critic", Network::TargetCritic)] {
        for entry in measuring() {
            let config = format!("confidence = \"{name}\"\nstates = \"replay\"\nreplay_states = 4");
            let mut class =
                Class::with(entry, &eager(entry, &config), GOALS, |goal, _| -(goal as f64)).unwrap();
            for _ in 0..3 {
                class.propose().unwrap();
                class.learn();
            }
            // Not in the first cycle: the buffer is still empty.
            assert_eq!(class.student.asked.len(), 2, "{}", entry.id);
            let drawn: Vec<_> = class.student.replayed.iter().filter(|states| !states.is_empty()).collect();
            for (question, states) in class.student.asked.iter().zip(drawn) {
                assert_eq!(question.network, network, "{}", entry.id);
                assert_eq!((&question.states, states.len()), (states, 4), "{}", entry.id);
            }
        }
    }
}

#[test]
fn unchanged_networks_are_not_asked_again() {
    for entry in measuring() {
        let config = eager(entry, "states = \"reference\"");
        let mut class = Class::with(entry, &config, GOALS, |goal, _| -(goal as f64)).unwrap();
        class.learn();
        // SPaCE updates its set after an episode.
        class.propose().unwrap();
        class.learn();
        class.student.asked.clear();
        let before = class.statistic("evaluations");
        for _ in 0..3 {
            // A cycle of two episodes.
            class.propose().unwrap();
            class.propose().unwrap();
            class.learn();
        }
        assert_eq!(class.student.asked.len(), 3, "{}", entry.id);
        assert_eq!(class.statistic("evaluations") - before, 3.0, "{}", entry.id);
    }
}

#[test]
fn confidence_is_summarised_for_the_records() {
    for entry in measuring() {
        let script = |goal: usize, _| -[1.0, 7.0, 0.0, 3.0, 4.0][goal];
        let mut class = Class::with(entry, &eager(entry, INITIAL), GOALS, script).unwrap();
        assert!(class.statistic("confidence_mean").is_nan(), "{}: not defined yet", entry.id);
        (0..2).for_each(|_| drop(class.propose().unwrap()));
        assert_eq!(class.statistic("confidence_mean"), -3.0, "{}", entry.id);
        assert_eq!(class.statistic("confidence_min"), -7.0, "{}", entry.id);
        assert_eq!(class.statistic("confidence_max"), 0.0, "{}", entry.id);
    }
}

#[test]
fn confidence_that_is_no_number_is_an_error_that_names_the_goal() {
    for entry in measuring() {
        let script = |goal, _| if goal == 2 { f64::NAN } else { 0.0 };
        let mut class = Class::with(entry, &eager(entry, INITIAL), GOALS, script).unwrap();
        let error = class.propose().and_then(|_| class.propose()).unwrap_err();
        let named = matches!(error, CurriculumError::NotFinite { what: "confidence", index: 2, .. });
        assert!(named, "{}: {error}", entry.id);
    }
}

#[test]
fn an_answer_that_leaves_goals_out_is_refused() {
    for entry in measuring() {
        let mut class = Class::with(entry, &eager(entry, INITIAL), GOALS, |_, _| -1.0).unwrap();
        class.student.unanswered = 1;
        let error = class.propose().and_then(|_| class.propose()).unwrap_err();
        let expected = CurriculumError::Student(AgentError::Shape {
            what: "confidence",
            expected: GOALS,
            got: GOALS - 1,
        });
        assert_eq!(error.to_string(), expected.to_string(), "{}", entry.id);
    }
}
