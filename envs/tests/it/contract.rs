//! The contract that every environment keeps to, and what is particular about those of this crate.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};

use envs::testing::contract;
use envs::{
    Defaults, Draws, Env, EnvError, EnvOptions, Environment, GoalEnv, Observation, Reward, Spec,
    WithinDistance, World, environments, find, make, suite,
};

#[test]
fn every_environment_keeps_the_contract() {
    environments().for_each(contract);
}

/// What [`Bead`] does wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flaw {
    None,
    StartsWhereItIs,
    FollowsAnotherInstance,
    GoalsOfTheMoment,
    OneGoal,
    PraisesFailure,
    Infinite,
}

thread_local! {
    static FLAW: Cell<Flaw> = const { Cell::new(Flaw::None) };
    static SHARED: Cell<f64> = const { Cell::new(0.0) };
}

/// A bead on a wire, with a flaw.
struct Bead {
    flaw: Flaw,
    start: f64,
    position: f64,
}

impl World for Bead {
    fn start(&mut self, draws: &mut Draws<'_>) -> Result<(), EnvError> {
        let [drawn] = draws.uniform([-0.1], [0.1]);
        self.start = if self.flaw == Flaw::StartsWhereItIs { self.position + drawn } else { drawn };
        self.position = self.start;
        Ok(())
    }

    fn draw_goal(&self, draws: &mut Draws<'_>, goal: &mut [f64]) {
        let [drawn] = draws.uniform([-0.5], [0.5]);
        goal[0] = match self.flaw {
            Flaw::GoalsOfTheMoment => self.position + drawn,
            Flaw::OneGoal => 0.7,
            _ => self.start + drawn,
        };
    }

    fn advance(&mut self, action: &[f64]) -> Result<(), EnvError> {
        self.position += 0.1 * action[0];
        if self.flaw == Flaw::FollowsAnotherInstance {
            SHARED.set(SHARED.get() + action[0]);
            self.position += SHARED.get();
        }
        Ok(())
    }

    fn observe(&self, observation: &mut Observation) {
        let overflows = self.flaw == Flaw::Infinite && self.position > 0.2;
        observation.state[0] = if overflows { f64::INFINITY } else { self.position };
        observation.achieved[0] = self.position;
    }

    fn task(&self) -> &dyn Reward {
        if self.flaw == Flaw::PraisesFailure { &Praise } else { &WithinDistance(0.05) }
    }
}

/// Rewards what it does not call a success.
struct Praise;

impl Reward for Praise {
    fn success(&self, achieved: &[f64], goal: &[f64]) -> bool {
        WithinDistance(0.05).success(achieved, goal)
    }

    fn reward(&self, achieved: &[f64], goal: &[f64]) -> f64 {
        WithinDistance(0.2).reward(achieved, goal)
    }
}

/// What the contract says of a bead with `flaw`.
fn told_of(flaw: Flaw) -> Option<String> {
    let spec = Spec {
        id: "Bead",
        family: "toy",
        state: 1,
        goal: 1,
        action: 1,
        horizon: 20,
        defaults: Defaults::TOY,
    };
    let row = Environment::new(spec, "Move a bead", "A test", |spec, _| {
        let bead = Bead { flaw: FLAW.get(), start: 0.0, position: 0.0 };
        Ok(Box::new(Env::new(spec, bead)))
    });
    FLAW.set(flaw);
    let message = catch_unwind(AssertUnwindSafe(|| contract(&row))).err()?;
    Some(message.downcast_ref::<String>().expect("a message").clone())
}

#[test]
fn the_contract_notices_what_is_broken_and_says_so() {
    assert_eq!(told_of(Flaw::None), None);
    for (flaw, rule) in [
        (Flaw::StartsWhereItIs, "not on earlier episodes"),
        (Flaw::FollowsAnotherInstance, "do not disturb each other"),
        (Flaw::GoalsOfTheMoment, "not to the moment"),
        (Flaw::OneGoal, "sampling a goal"),
        (Flaw::PraisesFailure, "exactly where there is success"),
        (Flaw::Infinite, "numbers are finite"),
    ] {
        let told = told_of(flaw).unwrap_or_else(|| panic!("{flaw:?} was not noticed"));
        assert!(told.starts_with("Bead breaks") && told.contains(rule), "{flaw:?}: {told}");
    }
}

fn build(id: &str) -> Box<dyn GoalEnv> {
    make(id, &EnvOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// What the references say of some environments.
struct Reference {
    ids: &'static [&'static str],
    /// S, G, A and H.
    dimensions: [usize; 4],
    /// The action's dimension in the paper's Table 1, where it is another.
    table: Option<usize>,
    /// Whether there are walls.
    maze: bool,
    /// TEACH, section 5.2: a million steps for robotics, 400,000 for mazes; a layer more for the hand.
    training: Defaults,
}

const ROBOTICS: Defaults = Defaults { steps: 1_000_000, evaluate_every: 10_000, layers: 2 };
const HAND: Defaults = Defaults { layers: 3, ..ROBOTICS };

/// Environments that no reference describes are not in here.
const REFERENCES: [Reference; 6] = [
    Reference {
        ids: &["MazeA", "MazeB", "MazeC"],
        dimensions: [2, 2, 2, 50],
        table: None,
        maze: true,
        training: Defaults { steps: 400_000, evaluate_every: 5_000, layers: 2 },
    },
    Reference {
        ids: &["FetchReach"],
        dimensions: [10, 3, 4, 50],
        table: Some(3),
        maze: false,
        training: ROBOTICS,
    },
    Reference {
        ids: &["FetchPush", "FetchSlide"],
        dimensions: [25, 3, 4, 50],
        table: Some(3),
        maze: false,
        training: ROBOTICS,
    },
    Reference {
        ids: &["FetchPickAndPlace"],
        dimensions: [25, 3, 4, 50],
        table: None,
        maze: false,
        training: ROBOTICS,
    },
    Reference { ids: &["HandReach"], dimensions: [63, 15, 20, 50], table: None, maze: false, training: HAND },
    Reference {
        ids: &[
            "HandManipulateBlock",
            "HandManipulateBlockRotateZ",
            "HandManipulateBlockRotateParallel",
            "HandManipulatePen",
            "HandManipulatePenRotate",
            "HandManipulateEgg",
            "HandManipulateEggRotate",
        ],
        dimensions: [61, 7, 20, 100],
        table: None,
        maze: false,
        training: HAND,
    },
];

#[test]
fn ids_are_unique() {
    let ids: BTreeSet<_> = environments().map(Environment::id).collect();
    assert_eq!(ids.len(), environments().count());
}

#[test]
fn dimensions_and_training_are_those_of_the_references() {
    for reference in REFERENCES {
        for id in reference.ids {
            let row = find(id).unwrap();
            let spec = &row.spec;
            assert_eq!([spec.state, spec.goal, spec.action, spec.horizon], reference.dimensions, "{id}");
            assert_eq!(row.paper.map(|paper| paper.action), reference.table, "{id}");
            assert_eq!(row.walls.is_some(), reference.maze, "{id}");
            assert_eq!(spec.defaults, reference.training, "{id}");
        }
    }
}

#[test]
fn suites_hold_the_papers_eleven_tasks() {
    for name in ["paper", "paper-ids"] {
        let ids = suite(name).unwrap();
        assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), 11, "{name}");
        assert!(ids.iter().all(|id| find(id).is_ok()), "{name}");
    }
    let rotating = suite("paper").unwrap().iter().filter(|id| id.contains("Rotate")).count();
    assert_eq!(rotating, 3, "appendix B describes rotation tasks");
}

#[test]
fn unknown_names_are_errors_that_list_the_known_ones() {
    let unknown = make("FetchFly", &EnvOptions::default()).err().unwrap().to_string();
    assert!(unknown.contains("`FetchFly`") && unknown.contains("HandManipulateEggRotate"), "{unknown}");
    let unknown = suite("papers").unwrap_err().to_string();
    assert!(unknown.contains("`papers`") && unknown.contains("paper-ids"), "{unknown}");
}

#[test]
fn what_lies_far_off_is_no_success() {
    for row in environments() {
        let env = build(row.id());
        let achieved = env.observation().achieved.clone();
        let far = far_from(&achieved);
        assert!(!env.success(&achieved, &far), "{}", row.id());
        assert_eq!(env.reward(&achieved, &far), -1.0, "{}", row.id());
    }
}

/// A metre away in every coordinate; a pose is also turned by 180°.
fn far_from(achieved: &[f64]) -> Vec<f64> {
    match *achieved {
        [x, y, z, qw, qx, qy, qz] => vec![x + 1.0, y + 1.0, z + 1.0, -qx, qw, -qz, qy],
        _ => achieved.iter().map(|part| part + 1.0).collect(),
    }
}
