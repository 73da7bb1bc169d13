//! VDS prefers what its members disagree on, and trains them as configured.

use agents::{AgentError, Auto, Batch, Critic, Ensemble, EnsembleConfig, Network};
use curricula::testing::{Class, scripted_action, standing_still};
use curricula::{CurriculumError, Distribution, Setting, population_variance, snapshot};
use envs::rng::{Purpose, stream};
use envs::{Goals, Rows};

use crate::support::entry;

/// What the default config asks for beside the small student.
const ENSEMBLE: EnsembleConfig = EnsembleConfig { members: 3, batch: 8, lr: 1e-3, polyak: 0.95 };

/// The teacher's ensemble, out of its saved state, as one of `config`.
fn ensemble(class: &Class, config: EnsembleConfig) -> Ensemble {
    let Setting { spec, student, .. } = &class.setting;
    let mut twin =
        Ensemble::new(config, student, spec, &mut stream(9, Purpose::Weights)).expect("a valid config");
    twin.load(&saved_ensemble(class)).expect("the teacher's ensemble has this config");
    twin
}

fn saved_ensemble(class: &Class) -> Vec<u8> {
    let saved = class.teacher.save().expect("plain data");
    // The state is the ensemble's bytes and five numbers for the records.
    let (ensemble, _) = snapshot::load::<(Vec<u8>, [f64; 5])>("vds", 2, &saved).expect("this layout");
    ensemble
}

#[test]
fn goals_that_members_disagree_on_are_preferred() {
    for frontier in [1.0, -1.0] {
        let mut class = Class::new("vds", "candidates = 200\nlearning_rate = 0.01", 1, |_, _| 0.0);
        // One member has reached the goals of this side, the other two never have. All know failure
        // elsewhere.
        class.student.frontier = frontier;
        (0..60).for_each(|_| class.learn());
        let there = (0..300).filter(|_| class.propose_goal()[0] * f64::from(frontier) > 0.0).count();
        assert!(there > 240, "{there} of 300 proposals");
    }
}

#[test]
fn members_train_on_batches_of_their_own_size_and_number() {
    let mut class = Class::new("vds", "", 1, |_, _| 0.0);
    class.learn();
    // Three members, each with the student's batch.
    assert_eq!(*class.student.batches.borrow(), [3 * 8; 40]);
    assert_eq!(class.statistic("ensemble_updates"), 40.0);

    let config = "members = 5\nbatch = 4\nupdates_per_cycle = 7";
    let mut class = Class::new("vds", config, 1, |_, _| 0.0);
    class.learn();
    class.learn();
    assert_eq!(*class.student.batches.borrow(), [5 * 4; 14]);
    assert_eq!(class.statistic("ensemble_updates"), 14.0);
}

#[test]
fn a_cycle_is_steps_on_batches_with_the_online_policys_next_actions_then_one_polyak_update() {
    let explicit = "members = 2\nbatch = 5\nlearning_rate = 0.02\npolyak = 0.25\nupdates_per_cycle = 3";
    for (config, asked, updates) in
        [("", ENSEMBLE, 40), (explicit, EnsembleConfig { members: 2, batch: 5, lr: 0.02, polyak: 0.25 }, 3)]
    {
        let mut class = Class::new("vds", config, 1, |_, _| 0.0);
        // Not the first cycle, in which targets and members are still the same.
        class.learn();
        let (mut twin, mut rng) = (ensemble(&class, asked), class.rng.clone());
        class.learn();

        let mut batch = Batch::new(&class.setting.spec, twin.batch_len());
        let mut loss = 0.0;
        for _ in 0..updates {
            class.student.replay_batch(&*class.env, &mut rng, &mut batch).unwrap();
            class.student.label_next_actions(&mut batch, Network::Online).unwrap();
            loss += twin.update(&batch).unwrap();
        }
        twin.follow().unwrap();
        assert!(twin.save().unwrap() == saved_ensemble(&class), "not the ensemble that `{config}` asks for");
        assert_eq!(class.statistic("ensemble_loss"), loss / f64::from(updates));
        assert!(class.rng == rng, "nothing else is drawn");
    }
}

#[test]
fn values_are_bootstrapped_from_targets_that_follow() {
    // Never a success and γ = 1/2: every value is −1/(1 − 1/2) = −2, and −1 as long as targets stay near 0.
    let value_with = |polyak: &str| {
        let config = format!("learning_rate = 0.01\npolyak = {polyak}");
        let mut class = Class::new("vds", &config, 1, |_, _| 0.0);
        class.student.frontier = 0.0;
        (0..15).for_each(|_| class.learn());
        let mut row = Rows::new(2);
        row.push(&[0.1, 0.2]);
        let values = ensemble(&class, ENSEMBLE).values(&row, &row, &row).unwrap();
        values.as_slice().iter().sum::<f64>() / 3.0
    };
    let (following, frozen) = (value_with("0.5"), value_with("1.0"));
    assert!((following + 2.0).abs() < 0.1, "{following}");
    assert!((frozen + 1.0).abs() < 0.3, "{frozen}");
}

#[test]
fn disagreement_is_that_on_fresh_goals_from_the_start_at_hand_under_the_online_policy() {
    // Pushing starts elsewhere in every episode, and its states, goals and actions are of different lengths.
    let mut class = Class::on("FetchPush", entry("vds"), "candidates = 40", 1, |_, _| 0.0).unwrap();
    class.learn();
    class.propose_goal();
    let (mut twin, mut rng, loss) =
        (ensemble(&class, ENSEMBLE), class.rng.clone(), class.statistic("ensemble_loss"));
    let proposed = class.propose_goal();

    let mut goals = Goals::new(3);
    let (mut starts, mut actions) = (Rows::new(25), Rows::new(4));
    let mut goal = [0.0; 3];
    for _ in 0..40 {
        class.env.sample_goal(&mut rng, &mut goal);
        goals.push(&goal);
        starts.push(&class.start.state);
        actions.push(&scripted_action(&class.start.state, &goal, Network::Online, 4));
    }
    let values = twin.values(&starts, &goals, &actions).unwrap();
    let disagreement: Vec<f64> =
        (0..40).map(|i| population_variance(values.iter().map(|member| member[i])).sqrt()).collect();
    let curriculum = Distribution::proportional(&disagreement, 0.0, "disagreement").unwrap();
    assert_eq!(proposed, goals.row(curriculum.draw(&mut rng)));
    assert!(class.rng == rng, "nothing else is drawn");
    assert_eq!(class.statistic("disagreement_mean"), disagreement.iter().sum::<f64>() / 40.0);
    assert_eq!(class.statistic("disagreement_max"), disagreement.into_iter().fold(0.0, f64::max));
    assert_eq!(class.statistic("entropy"), curriculum.entropy());
    assert_eq!(class.statistic("effective_goals"), curriculum.effective_goals());
    assert_eq!(class.statistic("ensemble_loss"), loss, "that of the last cycle stands");
}

#[test]
fn a_single_candidate_is_taken_whatever_the_disagreement() {
    let mut class = Class::new("vds", "candidates = 1", 1, |_, _| 0.0);
    assert_eq!(class.propose_goal().len(), 2);
    assert_eq!(class.statistic("effective_goals"), 1.0);
    assert_eq!(class.statistic("disagreement_mean"), class.statistic("disagreement_max"));
}

#[test]
fn the_configured_disagreement_is_taken() {
    // The same seed gives the same ensemble and the same candidate.
    let of_one_goal = |kind: &str| {
        let config = format!("candidates = 1\ndisagreement = \"{kind}\"");
        let mut class = Class::new("vds", &config, 1, |_, _| 0.0);
        class.propose_goal();
        class.statistic("disagreement_mean")
    };
    let variance = of_one_goal("var");
    assert!(variance > 0.0, "initial weights disagree");
    assert_eq!(of_one_goal("std"), variance.sqrt());
    assert_eq!(of_one_goal("tanh"), variance.tanh());
    assert_eq!(of_one_goal("exp"), variance.sqrt().exp());
}

#[test]
fn episodes_reach_the_ensembles_normalisers() {
    let mut class = Class::new("vds", "", 1, |_, _| 0.0);
    let before = class.teacher.save().unwrap();
    let mut episode = standing_still(&*class.env);
    class.teacher.observe(&episode).unwrap();
    assert_ne!(class.teacher.save().unwrap(), before);
    // Goals of three numbers on a task of two.
    episode.goal.push(0.5);
    let error = class.teacher.observe(&episode).unwrap_err();
    assert!(matches!(error, CurriculumError::Student(AgentError::Shape { .. })), "{error}");
}

#[test]
fn initial_weights_follow_the_runs_seed() {
    let class = Class::new("vds", "", 1, |_, _| 0.0);
    let vds = entry("vds");
    let saved = |seed| {
        let setting = Setting { seed, ..class.setting.clone() };
        vds.build((vds.defaults)(), &setting).unwrap().save().unwrap()
    };
    assert_eq!(saved(3), saved(3));
    assert_ne!(saved(3), saved(4));
}

#[test]
fn initial_weights_share_no_number_with_what_the_teacher_draws_later() {
    let mut class = Class::new("vds", "", 1, |_, _| 0.0);
    let Setting { spec, student, .. } = &class.setting;
    let shared = Ensemble::new(ENSEMBLE, student, spec, &mut class.rng).unwrap();
    assert!(shared.save().unwrap() != saved_ensemble(&class));
}

#[test]
fn what_is_left_at_auto_is_the_students() {
    let taught_with = |config: &str, cycles: usize| {
        let mut class = Class::new("vds", "", 1, |_, _| 0.0);
        class.setting.student.batch = Auto::Value(6);
        class.setting.student.polyak = 1.0;
        class.teacher = entry("vds").build(config.parse().unwrap(), &class.setting).unwrap();
        (0..cycles).for_each(|_| class.learn());
        class
    };
    let class = taught_with("", 2);
    assert_eq!(*class.student.batches.borrow(), [3 * 6; 80]);
    // A Polyak update with 1 leaves targets alone: two cycles are one of twice the steps.
    assert!(saved_ensemble(&class) == saved_ensemble(&taught_with("updates_per_cycle = 80", 1)));
    assert!(saved_ensemble(&class) != saved_ensemble(&taught_with("polyak = 0.9", 2)));
}

#[test]
fn learning_from_an_empty_buffer_is_an_error() {
    let mut class = Class::new("vds", "", 1, |_, _| 0.0);
    let Class { teacher, student, env, rng, .. } = &mut class;
    let error = teacher.learn(student, &**env, rng).unwrap_err();
    assert!(matches!(error, CurriculumError::Student(AgentError::EmptyReplay)), "{error}");
}

#[test]
fn bytes_of_another_ensemble_are_refused() {
    let saved = Class::new("vds", "", 1, |_, _| 0.0).teacher.save().unwrap();
    let error = Class::new("vds", "members = 4", 1, |_, _| 0.0).teacher.load(&saved).unwrap_err();
    assert!(matches!(error, CurriculumError::State { .. }), "{error}");
}
