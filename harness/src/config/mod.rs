//! The config of one run: typed, complete, and put together from layers.
//!
//! Paths are the same in a protocol file and in `--set`: `budget.steps`, `student.batch`,
//! `curriculum.teach.window`. Low to high: the environment's defaults, the student's preset, the
//! protocol's tables, its overrides, the variant's patch, the command line.

mod cause;
pub mod count;
pub mod fit;
pub mod frontier;
pub mod layer;
pub mod notes;
pub mod reference;
pub mod schema;
pub mod seeds;
pub mod shadow;
pub mod streams;
pub mod strict;
pub mod words;

use agents::{Auto, Preset, StudentConfig};
use curricula::Entry as CurriculumEntry;
use envs::Spec;
use guard::text::short;
use reports::wording::counted;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::Registry;
use crate::error::HarnessError;
use fit::fit;
use frontier::FrontierOptions;
use layer::{ConfigLayer, merge};
use streams::StreamSeeds;
use strict::{FieldError, field_error};

/// Everything that decides a run's bytes, apart from environment id and seed.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// How long to train.
    pub budget: Budget,
    /// How to measure.
    pub evaluation: Evaluation,
    /// Measures of the student's success at every goal of the pool.
    // At its default it leaves no trace in manifests: runs keep the hashes that they had before this table.
    #[serde(default, skip_serializing_if = "FrontierOptions::is_default")]
    pub frontier: FrontierOptions,
    /// Physics options of MuJoCo environments.
    pub physics: PhysicsOptions,
    /// The pool of candidate goals.
    pub pool: Pool,
    /// Seeds of single random streams.
    #[serde(default)]
    pub seed: StreamSeeds,
    /// Curricula whose teachers watch the student as shadows: they hear of every episode and every update, as
    /// the teacher that acts does, and propose a goal for every episode, which nobody plays. With and without
    /// them a run trains, and records everything else, in the same way. `all` stands for every curriculum
    /// that has all it needs; the one that acts is left out.
    ///
    /// Source: a choice.
    // Empty it leaves no trace in manifests: runs keep the hashes that they had before this field.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shadow: Vec<String>,
    /// The student's hyper-parameters. In a manifest numbers stand in the place of `auto`.
    pub student: StudentConfig,
    /// The curriculum's own config under its id: `{ teach = { window = 10, ... } }`, and that of each shadow
    /// under its.
    #[schemars(with = "()")]
    pub curriculum: Table,
}

/// `budget`: how long to train.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Environment steps of training, and of probe rollouts that are charged; whole cycles are run until at
    /// least this many are taken.
    ///
    /// Unit: steps. Range: 1 to 1,000,000,000. Auto: the environment's. Source: TEACH 5.2.
    #[schemars(with = "Auto<u64>")]
    pub steps: u64,
}

/// `evaluation`: how success is measured.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    /// Environment steps between evaluations: one follows the first cycle that reaches each multiple. A value
    /// below the length of a cycle means after every cycle.
    ///
    /// Unit: steps. Range: at least 1. Auto: the environment's. Source: a choice; the paper names no
    /// interval.
    #[schemars(with = "Auto<u64>")]
    pub every: u64,
    /// Greedy episodes per evaluation.
    ///
    /// Unit: episodes. Range: 1 to 1,000,000. Source: TEACH 5.2.
    pub episodes: u64,
    /// Where their goals come from.
    ///
    /// Source: a choice; TEACH 5.2 can be read in two ways.
    #[serde(default)]
    pub goals: EvaluationGoals,
}

/// Where the goals of evaluations come from: two readings of TEACH 5.2, "randomly sampling goals from the
/// goal space", which "consists of N goals".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EvaluationGoals {
    /// Drawn by the environment at the reset: goals that no curriculum chose from.
    #[default]
    Environment,
    /// Drawn evenly from the run's pool, also for methods that do not choose from it.
    Pool,
}

/// `physics`: options of MuJoCo environments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table with the key `native_ccd`")]
pub struct PhysicsOptions {
    /// MuJoCo's native convex collision detection; `false` is closest to the paper's MuJoCo.
    ///
    /// Source: a choice.
    pub native_ccd: bool,
}

/// `pool`: the candidate goals that pool curricula choose from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Pool {
    /// N, number of goals, drawn once per run.
    ///
    /// Unit: goals. Range: 1 to 1,000,000. Source: TEACH 5.2.
    pub size: usize,
}

impl Default for Pool {
    fn default() -> Self {
        Self { size: 1000 }
    }
}

/// The config as written: `auto` is allowed, student and curriculum are still plain tables.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct PartialConfig {
    budget: PartialBudget,
    evaluation: PartialEvaluation,
    frontier: FrontierOptions,
    physics: PhysicsOptions,
    pool: Pool,
    seed: StreamSeeds,
    shadow: Vec<String>,
    student: Table,
    curriculum: Table,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table with the key `steps`")]
struct PartialBudget {
    steps: Auto<u64>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table with the keys `every`, `episodes` and `goals`")]
struct PartialEvaluation {
    every: Auto<u64>,
    episodes: u64,
    goals: EvaluationGoals,
}

impl Default for PartialEvaluation {
    fn default() -> Self {
        Self { every: Auto::Auto, episodes: 20, goals: EvaluationGoals::default() }
    }
}

/// The names of the config's top-level tables and fields.
pub const SECTIONS: [&str; 9] =
    ["budget", "evaluation", "frontier", "physics", "pool", "seed", "shadow", "student", "curriculum"];

/// Puts the config of one run together from `layers`, low to high.
///
/// # Errors
/// [`HarnessError::Config`] naming the place and path of the first field that is unknown or out of range.
pub fn resolve(
    registry: &Registry,
    spec: &Spec,
    curriculum: &CurriculumEntry,
    layers: &[ConfigLayer],
) -> Result<RunConfig, HarnessError> {
    let attempt = |layers: &[ConfigLayer]| try_resolve(registry, spec, curriculum, layers);
    attempt(layers).map_err(|FieldError { path, reason }| {
        let place = cause::place(layers, &path, |layers| attempt(layers).is_ok());
        HarnessError::Config { place, path: short(&path), reason }
    })
}

fn try_resolve(
    registry: &Registry,
    spec: &Spec,
    curriculum: &CurriculumEntry,
    layers: &[ConfigLayer],
) -> Result<RunConfig, FieldError> {
    let mut table = Table::new();
    for layer in layers {
        merge(&mut table, &layer.table);
    }
    let mut table = Value::Table(table);
    fit(registry.config_schema(), &mut table, "")?;
    let written: PartialConfig = strict::read(table, "")?;
    let student = read_student(written.student, spec)?;
    let curricula = read_curricula(&written.curriculum, registry)?;
    let table_of = |entry: &CurriculumEntry| &curricula[entry.id];
    let lacks = |entry: &CurriculumEntry| lacking(entry, table_of(entry)).is_some();
    let shadow = shadow::read(&written.shadow, registry, curriculum, lacks)?;
    let mut own = Table::new();
    for entry in registry.curricula() {
        if entry.id == curriculum.id || shadow.iter().any(|id| id == entry.id) {
            lacking(entry, table_of(entry)).map_or(Ok(()), Err)?;
            own.insert(entry.id.to_owned(), table_of(entry).clone());
        }
    }
    let config = RunConfig {
        budget: Budget { steps: written.budget.steps.value_or(|| spec.defaults.steps) },
        evaluation: Evaluation {
            every: written.evaluation.every.value_or(|| spec.defaults.evaluate_every),
            episodes: written.evaluation.episodes,
            goals: written.evaluation.goals,
        },
        frontier: written.frontier,
        physics: written.physics,
        pool: written.pool,
        seed: written.seed,
        shadow,
        curriculum: own,
        student,
    };
    check_ranges(&config, spec)?;
    Ok(config)
}

fn read_student(written: Table, spec: &Spec) -> Result<StudentConfig, FieldError> {
    #[derive(Deserialize)]
    struct Chosen {
        #[serde(default)]
        preset: Preset,
    }
    let chosen: Chosen = strict::read(Value::Table(written.clone()), "student")?;
    let mut table = to_table(&StudentConfig::preset(chosen.preset));
    merge(&mut table, &written);
    let config: StudentConfig = strict::read(Value::Table(table), "student")?;
    config.resolve(spec).map_err(|error| match error {
        agents::AgentError::Config { field, reason } => field_error("student", field, &reason),
        other => field_error("student", "", &other.to_string()),
    })
}

/// The table of every curriculum, checked and completed.
fn read_curricula(written: &Table, registry: &Registry) -> Result<Table, FieldError> {
    let mut tables = Table::new();
    for entry in registry.curricula() {
        let empty = Table::new();
        let table = written.get(entry.id).and_then(Value::as_table).unwrap_or(&empty);
        tables.insert(entry.id.to_owned(), Value::Table(complete(entry, table)?));
    }
    Ok(tables)
}

/// What a curriculum whose config is `table` cannot teach without, if that is not set.
fn lacking(entry: &CurriculumEntry, table: &Value) -> Option<FieldError> {
    let field = entry.needs.filter(|field| table.get(*field) == (entry.defaults)().get(*field))?;
    let reason = format!("must be set: curriculum `{}` has no default for it", entry.id);
    Some(field_error(&format!("curriculum.{}", entry.id), field, &reason))
}

fn complete(entry: &CurriculumEntry, written: &Table) -> Result<Table, FieldError> {
    let mut table = (entry.defaults)();
    merge(&mut table, written);
    entry.resolve(table).map_err(|error| {
        let prefix = format!("curriculum.{}", entry.id);
        match error {
            curricula::CurriculumError::Config { field, reason } => field_error(&prefix, &field, &reason),
            other => field_error(&prefix, "", &other.to_string()),
        }
    })
}

/// The version of the curriculum with this id, as it teaches with `config`.
///
/// # Panics
/// If `registry` lacks it, or `config` is another's: configs are checked when they are resolved.
pub fn curriculum_version(registry: &Registry, id: &str, config: &RunConfig) -> String {
    let entry = registry.curriculum(id).expect("names were checked when the protocol was read");
    let own = config.curriculum.get(id).and_then(Value::as_table).cloned().unwrap_or_default();
    (entry.configure)(own).expect("a resolved config is valid").version()
}

/// Larger counts than this are a slip of the keyboard and would exhaust the memory.
const MOST: u64 = 1_000_000;
/// The same for training steps.
const MOST_STEPS: u64 = 1_000_000_000;

/// The most numbers that one tensor may have: 1 GiB of them in single precision.
const MOST_NUMBERS: u64 = 1 << 28;

fn check_ranges(config: &RunConfig, spec: &Spec) -> Result<(), FieldError> {
    let wrong = |path: &str, reason: String| Err(FieldError { path: path.to_owned(), reason });
    let episodes = config.student.episodes_per_cycle() as u64;
    let sizes = [
        ("budget.steps", config.budget.steps, MOST_STEPS),
        ("evaluation.episodes", config.evaluation.episodes, MOST),
        ("frontier.episodes", config.frontier.episodes, MOST),
        ("pool.size", config.pool.size as u64, MOST),
    ];
    for (path, value, most) in sizes {
        if !(1..=most).contains(&value) {
            return wrong(path, format!("is {value}; must be 1 to {most}"));
        }
    }
    let (batch, width) = (config.student.batch() as u64, config.student.width as u64);
    let between_layers = config.student.layers(spec).saturating_sub(1) as u64;
    let products = [
        (
            "student.width",
            "weights between the hidden layers of one network",
            [width * width, between_layers],
        ),
        ("student.batch", "numbers for one hidden layer", [batch, width]),
        ("student.episodes_per_cycle", "training steps in a cycle", [episodes, spec.horizon as u64]),
    ];
    for (path, what, [a, b]) in products {
        // An overflow is more than any number.
        let product = a.saturating_mul(b);
        if product > MOST_NUMBERS {
            return wrong(path, format!("makes {product} {what}; at most {MOST_NUMBERS} are accepted"));
        }
    }
    let cycle = episodes * spec.horizon as u64;
    if config.evaluation.every < cycle {
        let reason = format!(
            "is {}, below the {cycle} steps of one cycle ({} of {}); must be at least that",
            config.evaluation.every,
            counted(config.student.episodes_per_cycle(), "episode"),
            counted(spec.horizon, "step")
        );
        return wrong("evaluation.every", reason);
    }
    Ok(())
}

/// The config with every default, `auto` kept: what `goalbench list config` prints.
pub fn defaults(registry: &Registry) -> Table {
    let mut table = to_table(&PartialConfig::default());
    let mut student = to_table(&StudentConfig::preset(Preset::default()));
    // A run's own config leaves it out where it is false.
    student.insert("tf32".into(), false.into());
    table.insert("student".into(), Value::Table(student));
    let curricula =
        registry.curricula().iter().map(|entry| (entry.id.to_owned(), Value::Table((entry.defaults)())));
    table.insert("curriculum".into(), Value::Table(curricula.collect()));
    table
}

/// A config as a table.
pub(crate) fn to_table(value: &impl Serialize) -> Table {
    Table::try_from(value).expect("config structs serialise as tables")
}
