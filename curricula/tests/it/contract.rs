//! What holds for every teacher of the table. That none sees evaluation goals is tested where evaluations are: in
//! whole runs, by the harness.

use curricula::{CURRICULA, CurriculumError, Entry, Proposal};
use envs::GoalEnv;

use crate::support::{Class, LOWEST};

const GOALS: usize = 12;

/// Values that move, each goal in its own way, within the bounds.
fn restless(goal: usize, steps: u64) -> f64 {
    0.5 * LOWEST * (1.0 + (goal as f64 * 1.3 + steps as f64 * 0.7 * (1.0 + goal as f64 / 9.0)).sin())
}

/// The configs that a teacher is tested with: the defaults, where it has the choice confidence in replayed states, and
/// whatever else it does in another way.
fn configs(entry: &Entry) -> Vec<&'static str> {
    match entry.id {
        "teach" => vec![
            "",
            "selection = \"argmax\"\nstates = \"initial\"",
            "signal = \"difference\"\nstates = \"replay\"\nreplay_states = 3",
            // States are handed over in the middle of what is tested.
            "window = 3\nrenewal = 4\nreplay_states = 3",
            // A curriculum falls due before there are states to compute it from.
            "interplay = 5\nstates = \"replay\"",
            "interplay = 5\nrecord = \"evaluation\"\nconfidence = \"target-critic\"",
        ],
        // Episodes of the point task have 20 steps; by default no update would fall due in these tests.
        "space" => vec![
            "update_steps = 50",
            "update_steps = 20\nrenewal = 3",
            "update_steps = 20\nstates = \"initial\"\norder = \"absolute\"",
            "update_steps = 1\nstates = \"replay\"\nreplay_states = 3\norder = \"relative\"",
        ],
        "procurl" => vec![
            "",
            "selection = \"argmax\"\nstates = \"reference\"\nrenewal = 3",
            "bounds = \"adaptive\"\nstates = \"replay\"\nreplay_states = 3",
        ],
        "vds" => {
            vec!["", "disagreement = \"var\"", "disagreement = \"tanh\"", "disagreement = \"exp\""]
        }
        _ => vec![""],
    }
}

fn class(entry: &Entry, config: &str) -> Class {
    Class::with(entry, config, GOALS, restless).expect("a valid config")
}

/// Every teacher with each of its configs, and a name for both.
fn classes() -> impl Iterator<Item = (&'static Entry, &'static str, Class)> {
    CURRICULA
        .iter()
        .flat_map(|entry| configs(entry).into_iter().map(move |config| (entry, config, class(entry, config))))
}

/// `n` cycles of two episodes each.
fn proposals(class: &mut Class, n: usize) -> Vec<Proposal> {
    (0..n).flat_map(|_| cycle(class, 2)).collect()
}

/// A cycle of some episodes.
fn cycle(class: &mut Class, episodes: usize) -> Vec<Proposal> {
    let all = (0..episodes).map(|_| class.propose().expect("a proposal")).collect();
    class.learn();
    all
}

#[test]
fn same_seed_same_proposals() {
    for (entry, config, mut one) in classes() {
        let mut other = class(entry, config);
        assert_eq!(proposals(&mut one, 15), proposals(&mut other, 15), "{} {config}", entry.id);
        assert_eq!(one.teacher.save().unwrap(), other.teacher.save().unwrap(), "{} {config}", entry.id);
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

#[test]
fn proposals_lie_in_the_goal_space() {
    for environment in ["Point", "MazeA", "MazeB", "MazeC", "FetchReach"] {
        for entry in CURRICULA {
            let mut class = Class::on(environment, entry, "", GOALS, restless).expect("valid defaults");
            for _ in 0..30 {
                let goal = class.propose_goal();
                assert!(in_goal_space(&*class.env, &goal), "{environment}, {}: {goal:?}", entry.id);
                class.learn();
            }
        }
    }
}

#[test]
fn a_method_says_whether_it_uses_the_pool() {
    for (entry, _, mut class) in classes() {
        for proposal in proposals(&mut class, 5) {
            let from_pool = matches!(proposal, Proposal::Pool(index) if index < GOALS);
            assert_eq!(from_pool, entry.uses_pool, "{}: {proposal:?}", entry.id);
        }
    }
}

#[test]
fn a_proposal_leaves_the_environment_as_the_reset_left_it() {
    for (entry, _, mut class) in classes() {
        let mut resets = Class::with(entry, "", GOALS, restless).unwrap();
        for _ in 0..5 {
            class.propose().unwrap();
            resets.reset();
            assert_eq!(class.env.goal(), resets.env.goal(), "{}", entry.id);
            assert_eq!(class.env.observation(), resets.env.observation(), "{}", entry.id);
            class.learn();
        }
    }
}

/// A teacher that is saved after cycles of so many episodes each, and loaded, goes on as one that was not.
fn continues_identically(entry: &'static Entry, config: &str, before: &[usize]) {
    let name = format!("{} {config} after {before:?}", entry.id);
    let taught = || {
        let mut class = class(entry, config);
        before.iter().for_each(|&episodes| drop(cycle(&mut class, episodes)));
        class
    };
    // Everything but the teacher's own state is the caller's to restore.
    let (mut straight, mut resumed) = (taught(), taught());
    let saved = |class: &Class| class.teacher.save().expect("plain data and networks");
    let config = (entry.resolve)(config.parse().expect("TOML")).expect("a valid config");
    resumed.teacher = (entry.build)(&config, &resumed.setting).expect("built before");
    resumed.teacher.load(&saved(&straight)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let numbers = |class: &Class| {
        let bits = |(name, value): (&'static str, f64)| (name, value.to_bits());
        class.teacher.statistics().into_iter().map(bits).collect::<Vec<_>>()
    };
    assert_eq!(numbers(&resumed), numbers(&straight), "{name}");
    assert_eq!(resumed.teacher.weights(), straight.teacher.weights(), "{name}");
    assert_eq!(proposals(&mut resumed, 8), proposals(&mut straight, 8), "{name}");
    assert_eq!(saved(&resumed), saved(&straight), "{name}");
}

#[test]
fn a_loaded_teacher_continues_identically() {
    for (entry, config, _) in classes() {
        // After a single episode an evaluation may be overdue; after an odd number a set's turns are under way.
        continues_identically(entry, config, &[1]);
        continues_identically(entry, config, &[2, 2, 2, 2, 2, 2, 3]);
    }
}

#[test]
fn foreign_and_truncated_state_is_refused() {
    for (entry, _, mut taught) in classes() {
        proposals(&mut taught, 3);
        let bytes = taught.teacher.save().unwrap();
        let mut refuse = |what: &str, bytes: &[u8]| {
            let result = taught.teacher.load(bytes);
            assert!(matches!(result, Err(CurriculumError::State { .. })), "{}: {what}: {result:?}", entry.id);
        };
        refuse("noise", &[0xA5; 64]);
        refuse("another method", &curricula::snapshot::save("another", 1, &0u8));
        if !bytes.is_empty() {
            refuse("nothing", &[]);
            refuse("all but one byte", &bytes[..bytes.len() - 1]);
            refuse("half", &bytes[..bytes.len() / 2]);
        }
    }
}

#[test]
fn state_of_another_pool_is_refused() {
    for (entry, _, mut taught) in classes().filter(|(entry, ..)| entry.uses_pool) {
        proposals(&mut taught, 3);
        let bytes = taught.teacher.save().unwrap();
        if !bytes.is_empty() {
            let mut other = Class::with(entry, "", GOALS + 1, restless).unwrap();
            let error = other.teacher.load(&bytes).unwrap_err().to_string();
            assert!(error.contains("written for 12 goals; the pool has 13"), "{}: {error}", entry.id);
        }
    }
}

#[test]
fn of_a_pool_of_one_goal_that_one_is_chosen() {
    for entry in CURRICULA.iter().filter(|entry| entry.uses_pool) {
        let mut class = Class::with(entry, "", 1, restless).unwrap();
        assert_eq!(proposals(&mut class, 5), vec![Proposal::Pool(0); 10], "{}", entry.id);
        assert_eq!(class.weights(), [1.0], "{}", entry.id);
    }
}

#[test]
fn weights_are_a_distribution_over_the_pool() {
    for (entry, _, mut class) in classes() {
        for _ in 0..6 {
            proposals(&mut class, 1);
            let Some(weights) = class.teacher.weights() else {
                assert!(!entry.uses_pool, "{}: a teacher of the pool shows its weights", entry.id);
                continue;
            };
            assert_eq!(weights.len(), GOALS, "{}", entry.id);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{}", entry.id);
            let entropy: f64 = weights.iter().filter(|&&p| p > 0.0).map(|p| -p * p.ln()).sum();
            assert!((class.statistic("entropy") - entropy).abs() < 1e-12, "{}", entry.id);
            assert!((class.statistic("effective_goals") - entropy.exp()).abs() < 1e-9, "{}", entry.id);
        }
    }
}

#[test]
fn statistics_keep_their_names_and_order() {
    for (entry, _, mut class) in classes() {
        let names = |class: &Class| -> Vec<&str> {
            class.teacher.statistics().into_iter().map(|(name, _)| name).collect()
        };
        let before = names(&class);
        proposals(&mut class, 4);
        assert_eq!(before, names(&class), "{}", entry.id);
        let snake_case = |name: &&str| name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
        assert!(before.iter().all(snake_case), "{}: {before:?}", entry.id);
        assert!(
            class.teacher.statistics().iter().all(|(_, value)| value.is_finite()),
            "{}: after a few cycles every number is defined",
            entry.id
        );
    }
}
