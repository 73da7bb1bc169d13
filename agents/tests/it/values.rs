//! What a student answers: confidence, policy, online and target networks.

use agents::{Agent, AgentError, Auto, Mode, Network, StudentConfig};
use envs::rng::{Purpose, stream};
use envs::{Observation, Rows};

use crate::support::random_rows;
use crate::toy::{Run, small};

const NETWORKS: [Network; 2] = [Network::Online, Network::Target];

/// Some states and goals of the toy task.
fn questions(n: usize) -> (Rows, Rows) {
    let mut rng = stream(7, Purpose::Pool);
    (random_rows(n, 2, &mut rng), random_rows(n, 2, &mut rng))
}

fn only(row: &[f64]) -> Rows {
    let mut rows = Rows::new(row.len());
    rows.push(row);
    rows
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// More pairs than go through the networks at once.
#[test]
fn confidence_is_the_mean_over_states() {
    let mut agent = Run::trained(&small(), 0, 5).agent;
    let (states, goals) = (questions(30).0, questions(50).1);
    for network in NETWORKS {
        let together = agent.confidence(&goals, &states, network).unwrap();
        let mut means = vec![0.0; goals.len()];
        for state in states.iter() {
            for (mean, goal) in means.iter_mut().zip(goals.iter()) {
                let alone = agent.confidence(&only(goal), &only(state), network).unwrap();
                *mean += alone[0] / states.len() as f64;
            }
        }
        assert!(largest_difference(&together, &means) < 1e-5, "{network:?}");
        assert!(largest_difference(&together, &vec![together[0]; goals.len()]) > 1e-3, "goals differ");
    }
}

/// With γ = 0 returns lie in [−1, 0]. An untrained critic answers with numbers on both sides of 0, and after
/// some cycles, in which most rewards are −1, with numbers on both sides of −1. TEACH's Eq. 7 does not clip:
/// clipped values would be equal for many goals and would hide the differences that a teacher looks for.
#[test]
fn confidence_is_what_the_critic_says_also_where_no_return_lies() {
    for (cycles, bound) in [(0, 0.0), (20, -1.0)] {
        let config = StudentConfig { gamma: Auto::Value(0.0), ..small() };
        let mut agent = Run::trained(&config, 0, cycles).agent;
        assert_eq!(agent.lowest_value(), -1.0);
        let (states, goals) = questions(100);
        let values = agent.confidence(&goals, &only(states.row(0)), Network::Online).unwrap();
        assert!(values.iter().any(|value| *value > bound), "{values:?}");
        assert!(values.iter().any(|value| *value < bound), "{values:?}");
        assert!(!values.contains(&bound), "{values:?}");
    }
}

#[test]
fn the_target_critic_judges_the_online_policy() {
    let mut agent = Run::trained(&small(), 0, 5).agent;
    let (states, goals) = questions(20);
    let mut ask = |network| agent.confidence(&goals, &only(states.row(0)), network).unwrap();
    let [online, target, mixed] = [Network::Online, Network::Target, Network::TargetCritic].map(&mut ask);
    // The critics differ more than the actions do, so the answer is nearer to the target's than to the online
    // networks'.
    assert!(largest_difference(&mixed, &online) > 1e-3, "another critic");
    assert!(largest_difference(&mixed, &target) > 1e-6, "another policy");
    assert_eq!(
        agent.policy(&states, &goals, Network::TargetCritic).unwrap(),
        agent.policy(&states, &goals, Network::Online).unwrap()
    );
}

#[test]
fn policy_of_many_is_what_act_does_one_by_one() {
    let mut agent = Run::trained(&small(), 0, 5).agent;
    let (states, goals) = questions(1100);
    let many = agent.policy(&states, &goals, Network::Online).unwrap();
    assert_eq!((many.len(), many.width()), (1100, 2));
    let mut action = [0.0; 2];
    for i in 0..many.len() {
        let observation = Observation { state: states.row(i).to_vec(), achieved: vec![0.0; 2] };
        agent.act(&observation, goals.row(i), Mode::Greedy, &mut action).unwrap();
        assert!(largest_difference(&action, many.row(i)) < 1e-6, "{action:?} against {:?}", many.row(i));
    }
}

#[test]
fn next_actions_are_the_policy_of_the_next_states() {
    let mut run = Run::trained(&small(), 0, 5);
    let mut batch = agents::Batch::new(run.agent.spec(), 1100);
    run.agent.replay_batch(run.env.as_ref(), &mut stream(0, Purpose::Teacher), &mut batch).unwrap();
    let rows = |numbers: &[f32]| {
        let mut rows = Rows::new(2);
        numbers.chunks_exact(2).for_each(|row| rows.push(&[row[0].into(), row[1].into()]));
        rows
    };
    for network in NETWORKS {
        run.agent.label_next_actions(&mut batch, network).unwrap();
        let (states, goals) = (rows(&batch.next_states), rows(&batch.goals));
        let policy = run.agent.policy(&states, &goals, network).unwrap();
        assert_eq!(rows(&batch.next_actions), policy, "{network:?}");
    }
}

fn both(agent: &mut dyn Agent) -> [(Vec<f64>, Rows); 2] {
    let (states, goals) = questions(20);
    NETWORKS.map(|network| {
        let confidence = agent.confidence(&goals, &states, network).unwrap();
        (confidence, agent.policy(&states, &goals, network).unwrap())
    })
}

#[test]
fn targets_start_as_copies_and_lag_behind() {
    let mut run = Run::new(&small(), 0);
    let [online, target] = both(run.agent.as_mut());
    assert_eq!(online, target);
    run.cycles(3).unwrap();
    let [online, target] = both(run.agent.as_mut());
    assert!(largest_difference(&online.0, &target.0) > 1e-3, "values");
    assert!(largest_difference(online.1.as_slice(), target.1.as_slice()) > 1e-3, "actions");
}

#[test]
fn a_target_that_keeps_nothing_is_a_copy() {
    let mut run = Run::trained(&StudentConfig { polyak: 0.0, ..small() }, 0, 3);
    let [online, target] = both(run.agent.as_mut());
    assert_eq!(online, target);
}

#[test]
fn questions_change_nothing() {
    let mut asked = Run::trained(&small(), 0, 2);
    let before = both(asked.agent.as_mut());
    asked.agent.replay_states(10, &mut stream(0, Purpose::Teacher));
    assert_eq!(both(asked.agent.as_mut()), before);
    asked.cycles(2).unwrap();
    let mut unasked = Run::trained(&small(), 0, 4);
    assert_eq!(both(asked.agent.as_mut()), both(unasked.agent.as_mut()));
}

#[test]
fn a_loaded_policy_answers_as_the_saved_student_and_remembers_no_episode() {
    let mut saved = Run::trained(&small(), 0, 3);
    let folder = tempfile::tempdir().unwrap();
    let state = saved.agent.save(folder.path()).unwrap();
    let mut loaded = Run::new(&small(), 1);
    assert_ne!(both(loaded.agent.as_mut()), both(saved.agent.as_mut()));
    loaded.agent.load_policy(&state).unwrap();
    assert_eq!(both(loaded.agent.as_mut()), both(saved.agent.as_mut()));
    let outcome = loaded.agent.learn(loaded.env.as_ref(), &mut stream(0, Purpose::Replay));
    assert!(matches!(outcome, Err(AgentError::EmptyReplay)), "{outcome:?}");
}

#[test]
fn an_observation_that_is_not_finite_gives_no_action() {
    let mut agent = Run::trained(&small(), 0, 1).agent;
    let observation = Observation { state: vec![f64::NAN, 0.0], achieved: vec![0.0; 2] };
    let outcome = agent.act(&observation, &[0.0; 2], Mode::Greedy, &mut [0.0; 2]);
    assert!(matches!(outcome, Err(AgentError::NotFinite { gradient_steps: 40, .. })), "{outcome:?}");
    let outcome = agent.confidence(&only(&[0.0; 2]), &only(&[f64::NAN, 0.0]), Network::Online);
    assert!(matches!(outcome, Err(AgentError::NotFinite { gradient_steps: 40, .. })), "{outcome:?}");
}
