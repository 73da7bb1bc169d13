//! Every method of the table keeps the contract, with its defaults and with whatever else it does in another
//! way.

use curricula::testing::{Class, contract, contract_with};
use curricula::{
    CURRICULA, CurriculumError, Entry, Lesson, Method, Proposal, Setting, TeacherState, TeacherSummary,
    snapshot,
};
use serde::{Deserialize, Serialize};

/// Configs besides the defaults.
fn configs(entry: &Entry) -> &'static [&'static str] {
    match entry.id {
        "teach" => &[
            "selection = \"argmax\"\nstates = \"initial\"",
            "signal = \"difference\"\nstates = \"replay\"\nreplay_states = 3",
            // States are handed over in the middle of what is tested.
            "window = 3\nrenewal = 4\nreplay_states = 3",
            // A curriculum falls due before there are states to compute it from.
            "interplay = 5\nstates = \"replay\"",
            "interplay = 5\nrecord = \"evaluation\"\nconfidence = \"target-critic\"",
        ],
        // Episodes of the point task have 20 steps; by default no update would fall due in these tests.
        "space" => &[
            "update_steps = 50",
            "update_steps = 20\nrenewal = 3",
            "update_steps = 20\nstates = \"initial\"\norder = \"absolute\"",
            "update_steps = 1\nstates = \"replay\"\nreplay_states = 3\norder = \"relative\"",
        ],
        "procurl" => &[
            "selection = \"argmax\"\nstates = \"reference\"\nrenewal = 3",
            "bounds = \"adaptive\"\nstates = \"replay\"\nreplay_states = 3",
        ],
        "vds" => &["disagreement = \"var\"", "disagreement = \"tanh\"", "disagreement = \"exp\""],
        "sfl" => &["interval = 4\ncandidates = 5\nkept = 2\nshare = 1.0", "charge = false\ninterval = 1"],
        "plr" => &["score = \"positive\"\nstaleness = 0.5", "schedule = \"fixed\"\nreplay = 0.9\nbeta = 1.0"],
        "goid" => {
            &["goals_per_region = 1\nwindow = 2", "lowest = 0.25\nhighest = 0.75\ngoals_per_region = 3"]
        }
        "lp" => &["regions = 3\nwindow = 2", "epsilon = 0.0\nregions = 4\nwindow = 3"],
        // By default no mixture would be fitted in these tests.
        "alp-gmm" => &["fit_every = 20\ncandidates = 30", "fit_every = 20\nrandom = 0.0\ncomponents = 2"],
        "mega" => &["samples = 50\nepisodes = 3", "samples = 20\ncandidates = 1\ncutoff = 0.0"],
        "omega" => &["samples = 50\ndesired = 20\nrenewal = 3\nepisodes = 3", "samples = 50\nb = 3.0"],
        // Episodes of these tests stand still.
        "hgg" => &["goals = 3\ntrajectories = 4\nleast_motion = 0.0", "goals = 1\nleast_motion = 0.0"],
        _ => &[],
    }
}

/// Methods that teach with their defaults; `process`, which needs a program, has tests of its own.
fn ready() -> impl Iterator<Item = &'static Entry> {
    CURRICULA.iter().filter(|entry| entry.needs.is_none())
}

#[test]
fn every_method_keeps_it_with_its_defaults() {
    ready().for_each(contract);
}

#[test]
fn every_method_keeps_it_with_its_other_configs() {
    for entry in CURRICULA {
        configs(entry).iter().for_each(|config| contract_with(entry, config));
    }
}

#[test]
fn every_teacher_of_the_pool_shows_its_weights_and_every_number_is_defined_before_long() {
    for entry in ready() {
        let config = match entry.id {
            "space" => "update_steps = 50",
            "hgg" => "goals = 2\nleast_motion = 0.0",
            _ => "",
        };
        let mut class =
            Class::with(entry, config, 12, |goal, steps| -((goal as u64 * steps) as f64)).unwrap();
        for _ in 0..5 {
            assert_eq!(class.teacher.summary().weights.is_some(), entry.uses_pool, "{}", entry.id);
            class.propose().unwrap();
            class.learn();
        }
        let numbers = class.teacher.summary().statistics;
        assert!(numbers.iter().all(|(_, value)| value.is_finite()), "{}: {numbers:?}", entry.id);
    }
}

/// Goals of the pool in turn, by a count that is left out of what is saved.
struct Forgetful {
    pool: usize,
}

#[derive(Default, Serialize, Deserialize)]
struct ForgetfulConfig {}

struct ForgetfulState {
    proposed: usize,
}

impl TeacherState for ForgetfulState {
    const VERSION: u32 = 1;

    fn write(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(vec![0])
    }

    fn read(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        if bytes == [0] { Ok(()) } else { Err(snapshot::refuse("not what was written")) }
    }
}

impl Method for Forgetful {
    type Config = ForgetfulConfig;
    type State = ForgetfulState;
    const ID: &'static str = "forgetful";
    const TITLE: &'static str = "Forgetful";
    const SOURCE: &'static str = "none";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn build(_config: ForgetfulConfig, setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self { pool: setting.pool.len() })
    }

    fn begin(&self, _setting: &Setting) -> Result<ForgetfulState, CurriculumError> {
        Ok(ForgetfulState { proposed: 0 })
    }

    fn propose(
        &self,
        state: &mut ForgetfulState,
        _lesson: &mut Lesson<'_>,
    ) -> Result<Proposal, CurriculumError> {
        state.proposed += 1;
        Ok(Proposal::pool(state.proposed % self.pool))
    }
}

#[test]
#[should_panic(expected = "forgetful with \"\", saved after [1]")]
fn a_state_that_writes_less_than_it_needs_does_not_keep_it() {
    contract_with(&Entry::of::<Forgetful>(), "");
}

/// The environment's own goals, and numbers of any names.
struct Telling(TellingConfig);

#[derive(Default, Serialize, Deserialize)]
struct TellingConfig {
    names: Vec<String>,
}

impl Method for Telling {
    type Config = TellingConfig;
    type State = ();
    const ID: &'static str = "telling";
    const TITLE: &'static str = "Telling";
    const SOURCE: &'static str = "none";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = false;

    fn build(config: TellingConfig, _setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self(config))
    }

    fn begin(&self, _setting: &Setting) -> Result<(), CurriculumError> {
        Ok(())
    }

    fn propose(&self, (): &mut (), _lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        Ok(Proposal::native())
    }

    fn summary<'a>(&'a self, (): &'a ()) -> TeacherSummary<'a> {
        let statistics = self.0.names.iter().map(|name| (name.as_str(), 1.0)).collect();
        TeacherSummary { weights: None, statistics }
    }
}

#[test]
fn names_of_its_own_keep_it() {
    contract_with(&Entry::of::<Telling>(), "names = [\"one\", \"other\"]");
}

#[test]
#[should_panic(expected = "goalbench itself records effective_picks")]
fn a_name_that_goalbench_records_of_every_teacher_does_not_keep_it() {
    contract_with(&Entry::of::<Telling>(), "names = [\"one\", \"effective_picks\"]");
}

#[test]
#[should_panic(expected = "tells two numbers called one")]
fn two_numbers_of_one_name_do_not_keep_it() {
    contract_with(&Entry::of::<Telling>(), "names = [\"one\", \"other\", \"one\"]");
}
