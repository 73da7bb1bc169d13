//! The table of teachers: complete, consistent, strict about configs, and open to others.

use std::collections::BTreeSet;

use curricula::testing::{Class, contract};
use curricula::{CURRICULA, CurriculumError, Entry, Lesson, Method, Proposal, Setting};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::support::entry;

#[test]
fn every_file_of_methods_has_its_row() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/methods");
    let files: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().path().file_stem().unwrap().to_str().unwrap().replace('_', "-"))
        .filter(|name| name != "mod")
        .collect();
    let rows: BTreeSet<String> = CURRICULA.iter().map(|entry| entry.id.to_owned()).collect();
    assert_eq!(files, rows);
    assert_eq!(rows.len(), CURRICULA.len(), "no id occurs twice");
}

/// What `resolve` says of `field = value`: the field it names, and why.
fn refusal(entry: &Entry, field: &str, value: Value) -> (String, String) {
    let written = Table::from_iter([(field.to_owned(), value.clone())]);
    match entry.resolve(written) {
        Err(CurriculumError::Config { field, reason }) => (field, reason),
        other => panic!("{}: {field} = {value} gives {other:?}", entry.id),
    }
}

#[test]
fn a_misspelt_field_is_refused_with_the_names_there_are() {
    let reason = |id: &str| refusal(entry(id), "windoww", 3.into()).1;
    assert_eq!(
        reason("teach"),
        "unknown field `windoww`, expected one of `window`, `interplay`, `record`, `signal`, `confidence`, \
         `states`, `replay_states`, `renewal`, `selection`"
    );
    assert_eq!(reason("her-iid"), "unknown field `windoww`, there are no fields");
}

/// The order that `list config` prints, and that runs are recorded with.
#[test]
fn shared_fields_stand_where_the_method_has_them() {
    let fields = |id: &str| (entry(id).defaults)().keys().cloned().collect::<Vec<_>>().join(" ");
    let probe = "confidence states replay_states renewal";
    assert_eq!(fields("teach"), format!("window interplay record signal {probe} selection"));
    assert_eq!(fields("space"), format!("eta kappa order update_steps {probe}"));
    assert_eq!(fields("procurl"), format!("beta bounds {probe} selection"));
    let mega = "candidates samples bandwidth cutoff easy hard episodes";
    assert_eq!((fields("mega"), fields("omega")), (mega.into(), format!("b renewal desired {mega}")));
}

#[test]
fn the_order_in_which_fields_are_written_does_not_matter() {
    for entry in CURRICULA {
        let backwards: Table = (entry.defaults)().into_iter().rev().collect();
        assert_eq!(
            entry.resolve(backwards).unwrap().to_string(),
            (entry.defaults)().to_string(),
            "{}",
            entry.id
        );
    }
}

/// A field of a method with a value out of its range, and what is said to be accepted.
type Refused = (&'static str, &'static str, Value, &'static str);

/// Every value is refused with the name of its field and what is accepted.
fn refuse(cases: &[Refused]) {
    for (id, field, value, accepted) in cases {
        let (named, reason) = refusal(entry(id), field, value.clone());
        assert_eq!(named, *field);
        assert!(reason.contains(accepted), "{id}.{field}: {reason}");
    }
}

#[test]
fn values_out_of_range_are_refused_by_the_papers_methods() {
    refuse(&[
        ("teach", "window", 1.into(), "at least 2"),
        ("teach", "window", (-1).into(), "invalid value"),
        ("teach", "interplay", 0.into(), "at least 1"),
        ("teach", "replay_states", 0.into(), "in 1..=1024"),
        ("teach", "replay_states", 1025.into(), "in 1..=1024"),
        ("teach", "selection", "softmax".into(), "expected `proportional` or `argmax`"),
        ("teach", "confidence", "both".into(), "expected one of `online`, `target`, `target-critic`"),
        ("teach", "states", "start".into(), "expected one of `reference`, `replay`, `initial`"),
        ("teach", "record", "step".into(), "expected `cycle` or `evaluation`"),
        ("teach", "signal", "std".into(), "expected `variance` or `difference`"),
        ("teach", "renewal", 9.into(), "at least 10, the evaluations that are compared"),
        ("space", "eta", (-0.1).into(), "at least 0"),
        ("space", "eta", f64::NAN.into(), "finite"),
        ("space", "eta", f64::INFINITY.into(), "finite"),
        ("space", "kappa", 0.into(), "at least 1"),
        ("space", "update_steps", 0.into(), "at least 1"),
        ("space", "renewal", 1.into(), "at least 2"),
        ("space", "replay_states", 0.into(), "in 1..=1024"),
        ("procurl", "replay_states", 0.into(), "in 1..=1024"),
        ("space", "order", "random".into(), "expected one of `signed`, `absolute`, `relative`"),
        ("procurl", "beta", f64::INFINITY.into(), "finite"),
        ("procurl", "beta", (-1.0).into(), "at least 0"),
        ("procurl", "bounds", "loose".into(), "expected `fixed` or `adaptive`"),
        ("vds", "members", 1.into(), "in 2..=64"),
        ("vds", "members", 65.into(), "in 2..=64"),
        ("vds", "candidates", 0.into(), "in 1..=100000"),
        ("vds", "candidates", 100_001.into(), "in 1..=100000"),
        ("vds", "updates_per_cycle", 0.into(), "\"auto\" or in 1..=1000000"),
        ("vds", "updates_per_cycle", 1_000_001.into(), "\"auto\" or in 1..=1000000"),
        ("vds", "batch", 0.into(), "\"auto\" or in 1..=65536"),
        ("vds", "batch", 65_537.into(), "\"auto\" or in 1..=65536"),
        ("vds", "batch", "own".into(), "a number or \"auto\""),
        ("vds", "learning_rate", 0.0.into(), "positive"),
        ("vds", "learning_rate", f64::INFINITY.into(), "finite"),
        ("vds", "learning_rate", f64::NAN.into(), "positive and finite"),
        ("vds", "polyak", 1.5.into(), "\"auto\" or in [0, 1]"),
        ("vds", "polyak", (-0.1).into(), "\"auto\" or in [0, 1]"),
    ]);
}

#[test]
fn values_out_of_range_are_refused_by_the_other_methods() {
    refuse(&[
        ("sfl", "interval", 0.into(), "at least 1"),
        ("sfl", "candidates", 0.into(), "in 1..=100000"),
        ("sfl", "rollouts", 1.into(), "in 2..=1000"),
        ("sfl", "kept", 51.into(), "in 1..=50, the candidates"),
        ("sfl", "share", 1.5.into(), "in [0, 1]"),
        ("sfl", "charge", "yes".into(), "expected a boolean"),
        ("plr", "score", "max".into(), "expected `absolute` or `positive`"),
        ("plr", "beta", 0.0.into(), "positive and finite"),
        ("plr", "staleness", f64::NAN.into(), "in [0, 1]"),
        ("plr", "schedule", "never".into(), "expected `proportionate` or `fixed`"),
        ("plr", "replay", (-0.5).into(), "in [0, 1]"),
        ("goid", "lowest", (-0.1).into(), "in [0, 1]"),
        ("goid", "highest", 0.05.into(), "in [0.1, 1]"),
        ("goid", "window", 1.into(), "in 2..=100000"),
        ("goid", "goals_per_region", 0.into(), "at least 1"),
        ("goid", "fresh", 0.0.into(), "in (0, 1]"),
        ("goid", "fresh", 0.9.into(), "at most 1 together with `earlier`, which is 0.2"),
        ("lp", "regions", 0.into(), "in 1..=100000"),
        ("lp", "window", 100_001.into(), "in 1..=100000"),
        ("lp", "epsilon", 1.5.into(), "in [0, 1]"),
        ("alp-gmm", "fit_every", 19.into(), "in 20..=10000"),
        ("alp-gmm", "fit_every", 10_001.into(), "in 20..=10000"),
        ("alp-gmm", "components", 1.into(), "in 2..=20"),
        ("alp-gmm", "components", 21.into(), "in 2..=20"),
        ("alp-gmm", "random", 1.1.into(), "in [0, 1]"),
        ("alp-gmm", "random", f64::NAN.into(), "in [0, 1]"),
        ("alp-gmm", "candidates", 0.into(), "in 1..=100000"),
        ("mega", "candidates", 0.into(), "in 1..=10000"),
        ("mega", "samples", 100_001.into(), "in 1..=100000"),
        ("mega", "bandwidth", 0.0.into(), "in [0.001, 1000]"),
        ("mega", "bandwidth", f64::NAN.into(), "in [0.001, 1000]"),
        ("mega", "cutoff", 0.1.into(), "in [-1000, 0]"),
        ("mega", "cutoff", (-1001.0).into(), "in [-1000, 0]"),
        ("mega", "easy", 1.5.into(), "in (0, 1]"),
        ("mega", "hard", 0.7.into(), "in [0, 1) and below `easy`"),
        ("mega", "hard", (-0.1).into(), "in [0, 1) and below `easy`"),
        ("mega", "episodes", 0.into(), "in 1..=10000"),
        ("omega", "b", f64::INFINITY.into(), "in [-1000, 1000]"),
        ("omega", "renewal", 0.into(), "in 1..=100000"),
        ("omega", "desired", 10_001.into(), "in 1..=10000"),
        ("omega", "cutoff", 1.0.into(), "in [-1000, 0]"),
        ("hgg", "goals", 0.into(), "in 1..=1000"),
        ("hgg", "trajectories", 49.into(), "at least `goals` and at most 10000"),
        ("hgg", "trajectories", 10_001.into(), "at least `goals` and at most 10000"),
        ("hgg", "c", (-1.0).into(), "in [0, 1000000]"),
        ("hgg", "lipschitz", 0.0.into(), "in [0.001, 1000000]"),
        ("hgg", "least_motion", f64::NAN.into(), "finite and at least 0"),
    ]);
}

#[test]
fn the_ends_of_every_range_are_accepted() {
    let cases: [(&str, &str, &[Value]); 50] = [
        ("teach", "window", &[2.into()]),
        ("teach", "interplay", &[1.into()]),
        ("teach", "replay_states", &[1.into(), 1024.into()]),
        ("teach", "renewal", &[10.into(), i64::MAX.into()]),
        ("space", "eta", &[0.0.into(), f64::MAX.into()]),
        ("space", "kappa", &[1.into(), i64::MAX.into()]),
        ("space", "update_steps", &[1.into(), i64::MAX.into()]),
        ("space", "renewal", &[2.into()]),
        ("space", "replay_states", &[1.into(), 1024.into()]),
        ("procurl", "beta", &[0.0.into(), f64::MAX.into()]),
        ("procurl", "replay_states", &[1.into(), 1024.into()]),
        ("procurl", "renewal", &[1.into()]),
        ("vds", "members", &[2.into(), 64.into()]),
        ("vds", "candidates", &[1.into(), 100_000.into()]),
        ("vds", "updates_per_cycle", &[1.into(), 1_000_000.into(), "auto".into()]),
        ("vds", "batch", &[1.into(), 65_536.into(), "auto".into()]),
        ("vds", "polyak", &[0.0.into(), 1.0.into(), "auto".into()]),
        ("sfl", "interval", &[1.into(), i64::MAX.into()]),
        ("sfl", "candidates", &[10.into(), 100_000.into()]),
        ("sfl", "rollouts", &[2.into(), 1000.into()]),
        ("sfl", "kept", &[1.into(), 50.into()]),
        ("sfl", "share", &[0.0.into(), 1.0.into()]),
        ("plr", "beta", &[1e-3.into(), f64::MAX.into()]),
        ("plr", "staleness", &[0.0.into(), 1.0.into()]),
        ("plr", "replay", &[0.0.into(), 1.0.into()]),
        ("goid", "lowest", &[0.0.into(), 0.9.into()]),
        ("goid", "highest", &[0.1.into(), 1.0.into()]),
        ("goid", "window", &[2.into(), 100_000.into()]),
        ("goid", "goals_per_region", &[1.into(), i64::MAX.into()]),
        ("goid", "fresh", &[1e-9.into(), 0.8.into()]),
        ("lp", "regions", &[1.into(), 100_000.into()]),
        ("lp", "epsilon", &[0.0.into(), 1.0.into()]),
        ("alp-gmm", "fit_every", &[20.into(), 10_000.into()]),
        ("alp-gmm", "components", &[2.into(), 20.into()]),
        ("alp-gmm", "random", &[0.0.into(), 1.0.into()]),
        ("alp-gmm", "candidates", &[1.into(), 100_000.into()]),
        ("mega", "candidates", &[1.into(), 10_000.into()]),
        ("mega", "samples", &[1.into(), 100_000.into()]),
        ("mega", "cutoff", &[0.0.into(), (-1000.0).into()]),
        ("mega", "easy", &[1.0.into()]),
        ("mega", "hard", &[0.0.into()]),
        ("mega", "episodes", &[1.into(), 10_000.into()]),
        ("omega", "b", &[(-1000.0).into(), 1000.0.into()]),
        ("omega", "renewal", &[1.into(), 100_000.into()]),
        ("omega", "desired", &[1.into(), 10_000.into()]),
        ("hgg", "goals", &[1.into(), 1000.into()]),
        ("hgg", "trajectories", &[50.into(), 10_000.into()]),
        ("hgg", "c", &[0.0.into(), 1e6.into()]),
        ("hgg", "lipschitz", &[0.001.into(), 1e6.into()]),
        ("mega", "bandwidth", &[0.001.into(), 1000.0.into()]),
    ];
    for (id, field, values) in cases {
        for value in values {
            let written = Table::from_iter([(field.to_owned(), value.clone())]);
            let resolved = entry(id).resolve(written).unwrap_or_else(|error| panic!("{id}: {error}"));
            assert_eq!(&resolved[field], value, "{id}.{field}");
        }
    }
}

/// A method of someone else's: always the same goal.
struct Fixed(FixedConfig);

#[derive(Default, Serialize, Deserialize)]
struct FixedConfig {
    goal: usize,
}

impl Method for Fixed {
    type Config = FixedConfig;
    type State = ();
    const ID: &'static str = "fixed";
    const TITLE: &'static str = "Fixed";
    const SOURCE: &'static str = "none";
    const VERSION: &'static str = "1";
    const USES_POOL: bool = true;

    fn build(config: FixedConfig, _setting: &Setting) -> Result<Self, CurriculumError> {
        Ok(Self(config))
    }

    fn begin(&self, _setting: &Setting) -> Result<(), CurriculumError> {
        Ok(())
    }

    fn propose(&self, _state: &mut (), _lesson: &mut Lesson<'_>) -> Result<Proposal, CurriculumError> {
        Ok(Proposal::pool(self.0.goal))
    }
}

#[test]
fn others_can_add_a_method_from_outside() {
    let entry = Entry::of::<Fixed>();
    let mut class = Class::with(&entry, "goal = 3", 4, |_, _| 0.0).unwrap();
    assert_eq!(class.cycles(2), [3, 3]);
    contract(&entry);
}
