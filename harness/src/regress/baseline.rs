//! The baseline: what a protocol's runs looked like when all was well, complete in one small file.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use reports::schema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::cells::{Cell, Curve};
use super::compare::Settings;
use super::config::{self, Fields};
use super::json;
use crate::Registry;
use crate::config::seeds;
use crate::error::HarnessError;
use crate::protocol::Protocol;
use crate::protocol::plan::Plan;

/// Version of the file, raised whenever a field changes its meaning.
pub const SCHEMA: u32 = 1;

/// Curves of every seed with the protocol, the config, and the machine that they come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// [`SCHEMA`].
    pub schema: u32,
    /// [`schema::SCHEMA`] of the runs.
    pub record_schema: u32,
    /// The options that name the protocol, as given when it was recorded.
    pub source: String,
    /// Versions of goalbench and its native libraries.
    pub versions: BTreeMap<String, String>,
    /// Model of the processor: another one may round differently.
    pub cpu: String,
    /// How a check compares, unless its options say otherwise.
    pub gate: Gate,
    /// The protocol as written.
    pub protocol: Value,
    /// Seeds that were recorded, `[seeds]`.
    pub seeds: Vec<u64>,
    /// Config fields that all cells share, by path, defaults included.
    pub config: Fields,
    /// Cells by `environment/curriculum/variant`.
    pub cells: BTreeMap<String, Recorded>,
}

/// The gate's defaults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gate {
    /// Seeds that a check runs.
    pub seeds: Vec<u64>,
    /// When it fails.
    pub settings: Settings,
}

/// One cell of a baseline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// SHA-256 of the complete config.
    pub hash: String,
    /// Config fields that the cell does not share with all others.
    pub config: Fields,
    /// Episodes of an evaluation.
    pub episodes: u64,
    /// Training steps at every evaluation, `[evaluations]`.
    pub steps: Vec<u64>,
    /// Curves by seed.
    pub curves: BTreeMap<u64, Curve>,
}

/// What is recorded besides the curves.
#[derive(Clone, Debug)]
pub struct Origin {
    /// See [`Baseline::source`].
    pub source: String,
    /// The protocol's TOML.
    pub protocol: String,
    /// See [`Baseline::versions`].
    pub versions: BTreeMap<String, String>,
}

impl Baseline {
    /// A baseline of `cells`, all of which have the same seeds.
    ///
    /// # Errors
    /// [`HarnessError::Protocol`] if the protocol is no TOML or has no JSON form.
    pub fn new(origin: Origin, gate: Gate, cells: Vec<Cell>) -> Result<Self, HarnessError> {
        let unfit = |reason: String| HarnessError::Protocol { place: origin.source.clone(), reason };
        let protocol: toml::Table =
            origin.protocol.parse().map_err(|e: toml::de::Error| unfit(e.to_string()))?;
        let protocol = serde_json::to_value(protocol).map_err(|e| unfit(e.to_string()))?;
        let common = config::common(cells.iter().map(|cell| &cell.config));
        let seeds = cells.first().map(|cell| cell.curves.keys().copied().collect()).unwrap_or_default();
        let recorded = cells.into_iter().map(|cell| {
            let id = cell.id();
            let Cell { config, episodes, steps, curves, .. } = cell;
            let hash = config::hash(&config);
            (id, Recorded { hash, config: config::own(&config, &common), episodes, steps, curves })
        });
        Ok(Self {
            schema: SCHEMA,
            record_schema: schema::SCHEMA,
            source: origin.source,
            versions: origin.versions,
            cpu: cpu(),
            gate,
            protocol,
            seeds,
            cells: recorded.collect(),
            config: common,
        })
    }

    /// Reads a baseline file.
    ///
    /// # Errors
    /// [`HarnessError::Damaged`] if it is of another schema, or inconsistent in itself, with how to renew it.
    pub fn read(path: &Path) -> Result<Self, HarnessError> {
        let text = fs::read_to_string(path).map_err(HarnessError::io(path, "read this baseline"))?;
        Self::parse(&text).map_err(|reason| HarnessError::Damaged {
            path: path.to_owned(),
            reason: reason + &renewal(None, path),
        })
    }

    fn parse(text: &str) -> Result<Self, String> {
        let value: Value = serde_json::from_str(text).map_err(|error| format!("is no baseline: {error}"))?;
        for (field, ours) in [("schema", SCHEMA), ("record_schema", schema::SCHEMA)] {
            match value.get(field).and_then(Value::as_u64) {
                Some(found) if found == u64::from(ours) => {}
                Some(found) => return Err(format!("has {field} {found}, this program reads {ours}")),
                None => return Err(format!("is no baseline: it has no `{field}`")),
            }
        }
        let baseline: Self =
            serde_json::from_value(value).map_err(|error| format!("is no baseline: {error}"))?;
        baseline.check()?;
        Ok(baseline)
    }

    /// What serde cannot see.
    fn check(&self) -> Result<(), String> {
        seeds::unique(&self.seeds)?;
        let mut seeds = self.seeds.clone();
        seeds.sort_unstable();
        if self.cells.is_empty() || seeds.is_empty() {
            return Err("has no runs".into());
        }
        for (id, cell) in &self.cells {
            let wrong = |reason: &str| Err(format!("{id}: {reason}"));
            let rising = cell.steps.windows(2).all(|pair| pair[0] < pair[1]);
            if id.split('/').count() != 3 {
                return wrong("is no environment/curriculum/variant");
            }
            if cell.steps.len() < 2 || !rising || cell.episodes == 0 {
                return wrong("needs two evaluations or more, at rising steps, of one episode or more");
            }
            if !cell.curves.keys().eq(&seeds) {
                return wrong("has other seeds than the file");
            }
            let fits = |curve: &Curve| {
                curve.successes.len() == cell.steps.len()
                    && curve.successes.iter().all(|&count| count <= cell.episodes)
            };
            if !cell.curves.values().all(fits) {
                return wrong("has a curve that does not fit its steps and episodes");
            }
            if config::hash(&self.complete(cell)) != cell.hash {
                return wrong("its hash does not fit its config: the file was altered by hand");
            }
        }
        Ok(())
    }

    /// The file's text.
    pub fn text(&self) -> String {
        json::to_lines(self).expect("a baseline is plain data")
    }

    /// The protocol that was recorded, with the baseline's seeds.
    ///
    /// # Errors
    /// [`HarnessError`] if this program does not take it.
    pub fn protocol(&self, path: &Path, registry: &Registry) -> Result<Protocol, HarnessError> {
        let place = format!("{} (protocol)", path.display());
        let unfit = |reason: String| HarnessError::Protocol { place: place.clone(), reason };
        let table = toml::Table::try_from(&self.protocol).map_err(|error| unfit(error.to_string()))?;
        let text = toml::to_string(&table).map_err(|error| unfit(error.to_string()))?;
        let mut protocol = Protocol::parse(&place, &text, registry)?;
        protocol.seeds.clone_from(&self.seeds);
        Ok(protocol)
    }

    /// Its cells with their complete configs, in the order of `plan`, which names some or all of them.
    ///
    /// # Errors
    /// [`HarnessError::Damaged`] naming every field in which the plan's configs differ from those recorded, and how to renew
    /// the baseline.
    pub fn cells_of(&self, plan: &Plan, path: &Path) -> Result<Vec<Cell>, HarnessError> {
        let mut cells: Vec<Cell> = Vec::new();
        let mut differences = Vec::new();
        for run in &plan.runs {
            let id = format!("{}/{}/{}", run.key.environment, run.key.curriculum, run.key.variant);
            if cells.iter().any(|cell| cell.id() == id) {
                continue;
            }
            let Some(recorded) = self.cells.get(&id) else {
                differences.push(format!("{id}: not recorded"));
                continue;
            };
            let config = self.complete(recorded);
            let fields = config::differences(&config, &config::fields(run));
            differences.extend(fields.into_iter().map(|field| format!("{id}: {field}")));
            cells.push(Cell {
                environment: run.key.environment.clone(),
                curriculum: run.key.curriculum.clone(),
                variant: run.key.variant.clone(),
                config,
                episodes: recorded.episodes,
                steps: recorded.steps.clone(),
                curves: recorded.curves.clone(),
            });
        }
        if differences.is_empty() {
            return Ok(cells);
        }
        let list = shortened(&differences).join("\n  ");
        let reason = format!(
            "was recorded with another config than its protocol has now, so that curves cannot be compared:\n  {list}\nIf \
             that is meant{}",
            renewal(Some(&self.source), path)
        );
        Err(HarnessError::Damaged { path: path.to_owned(), reason })
    }

    fn complete(&self, cell: &Recorded) -> Fields {
        self.config.iter().chain(&cell.config).map(|(path, value)| (path.clone(), value.clone())).collect()
    }
}

/// Differences shown before the rest is counted.
const SHOWN: usize = 12;

fn shortened(lines: &[String]) -> Vec<String> {
    let mut shown: Vec<String> = lines.iter().take(SHOWN).cloned().collect();
    if lines.len() > SHOWN {
        shown.push(format!("and {} more", lines.len() - SHOWN));
    }
    shown
}

/// How to make a new baseline at `path`.
fn renewal(source: Option<&str>, path: &Path) -> String {
    let source = source.unwrap_or("--protocol PROTOCOL");
    format!("; renew it with `goalbench regress record {source} --out {}`", path.display())
}

/// Model of this machine's processor.
pub fn cpu() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    model.map_or("unknown".to_owned(), |(_, name)| name.trim().to_owned())
}
