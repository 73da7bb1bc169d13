//! The baseline: what a protocol's runs looked like when all was well, complete in one small file.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::cells::{Cell, ExpectedRun, RunSummary};
use super::compare::Settings;
use super::config::{self, Fields};
use super::error::GateError;
use super::json;
use crate::schema;
use crate::store::StoreError;

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
    pub cells: BTreeMap<String, BaselineCell>,
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
pub struct BaselineCell {
    /// SHA-256 of the complete config.
    pub hash: String,
    /// Config fields that the cell does not share with all others.
    pub config: Fields,
    /// Episodes of an evaluation.
    pub episodes: u64,
    /// Training steps at every evaluation, `[evaluations]`.
    pub steps: Vec<u64>,
    /// Curves by seed.
    pub curves: BTreeMap<u64, RunSummary>,
}

/// Where the curves come from.
#[derive(Clone, Debug)]
pub struct Provenance {
    /// See [`Baseline::source`].
    pub source: String,
    /// See [`Baseline::protocol`].
    pub protocol: Value,
    /// See [`Baseline::versions`].
    pub versions: BTreeMap<String, String>,
    /// See [`Baseline::cpu`].
    pub cpu: String,
}

impl Baseline {
    /// A baseline of `cells`, all of which have the same seeds.
    pub fn new(provenance: Provenance, gate: Gate, cells: Vec<Cell>) -> Self {
        let Provenance { source, protocol, versions, cpu } = provenance;
        let common = config::common(cells.iter().map(|cell| &cell.config));
        let seeds = cells.first().map(|cell| cell.curves.keys().copied().collect()).unwrap_or_default();
        let recorded = cells.into_iter().map(|cell| {
            let id = cell.id();
            let Cell { config, episodes, steps, curves, .. } = cell;
            let hash = config::hash(&config);
            (id, BaselineCell { hash, config: config::own(&config, &common), episodes, steps, curves })
        });
        Self {
            schema: SCHEMA,
            record_schema: schema::SCHEMA,
            source,
            versions,
            cpu,
            gate,
            protocol,
            seeds,
            cells: recorded.collect(),
            config: common,
        }
    }

    /// Reads a baseline file.
    ///
    /// # Errors
    /// [`GateError`] if it is of another schema, or inconsistent in itself, with how to renew it.
    pub fn read(path: &Path) -> Result<Self, GateError> {
        let text = guard::files::read_to_string(path).map_err(StoreError::io(path, "read this baseline"))?;
        Self::parse(&text, path)
    }

    /// The baseline in `text`, the content of the file `path`.
    fn parse(text: &str, path: &Path) -> Result<Self, GateError> {
        let unfit = |cell, reason| GateError::Unfit { path: path.to_owned(), cell, reason };
        let no_baseline = |source| GateError::NoBaseline { path: path.to_owned(), source };
        let value: Value = serde_json::from_str(text).map_err(no_baseline)?;
        for (field, ours) in [("schema", SCHEMA), ("record_schema", schema::SCHEMA)] {
            let reason = match value.get(field).and_then(Value::as_u64) {
                Some(found) if found == u64::from(ours) => continue,
                Some(found) => format!("has {field} {found}, this program reads {ours}"),
                None => format!("is no baseline: it has no `{field}`"),
            };
            return Err(unfit(None, reason));
        }
        let baseline: Self = serde_json::from_value(value).map_err(no_baseline)?;
        if let Some(reason) = baseline.misfit() {
            return Err(unfit(None, reason));
        }
        for (id, cell) in &baseline.cells {
            if let Some(reason) = baseline.cell_misfit(id, cell) {
                return Err(unfit(Some(id.clone()), reason.to_owned()));
            }
        }
        Ok(baseline)
    }

    /// The seeds, rising.
    fn sorted_seeds(&self) -> Vec<u64> {
        let mut seeds = self.seeds.clone();
        seeds.sort_unstable();
        seeds
    }

    /// What serde cannot see of the file as a whole.
    fn misfit(&self) -> Option<String> {
        let seeds = self.sorted_seeds();
        if let Some(pair) = seeds.windows(2).find(|pair| pair[0] == pair[1]) {
            return Some(format!("seed {} is named twice", pair[0]));
        }
        (self.cells.is_empty() || seeds.is_empty()).then(|| "has no runs".to_owned())
    }

    /// What serde cannot see of a cell.
    fn cell_misfit(&self, id: &str, cell: &BaselineCell) -> Option<&'static str> {
        let rising = cell.steps.windows(2).all(|pair| pair[0] < pair[1]);
        let fits = |curve: &RunSummary| {
            curve.successes.len() == cell.steps.len()
                && curve.successes.iter().all(|&count| count <= cell.episodes)
        };
        if id.split('/').count() != 3 {
            Some("is no environment/curriculum/variant")
        } else if cell.steps.len() < 2 || !rising || cell.episodes == 0 {
            Some("needs two evaluations or more, at rising steps, of one episode or more")
        } else if !cell.curves.keys().eq(&self.sorted_seeds()) {
            Some("has other seeds than the file")
        } else if !cell.curves.values().all(fits) {
            Some("has a curve that does not fit its steps and episodes")
        } else if config::hash(&self.complete(cell)) != cell.hash {
            Some("its hash does not fit its config: the file was altered by hand")
        } else {
            None
        }
    }

    /// The file's text.
    pub fn text(&self) -> String {
        json::to_lines(self).expect("a baseline is plain data")
    }

    /// Its cells with their complete configs, in the order of `runs`, which are some or all of those
    /// recorded.
    ///
    /// # Errors
    /// [`GateError::OtherConfig`] with every field in which the configs of `runs` differ from those recorded,
    /// and how to renew the baseline at `path`.
    pub fn cells_of(&self, runs: &[ExpectedRun], path: &Path) -> Result<Vec<Cell>, GateError> {
        let mut cells: Vec<Cell> = Vec::new();
        let mut differences = Vec::new();
        for run in runs {
            let id = run.cell();
            if cells.iter().any(|cell| cell.id() == id) {
                continue;
            }
            let Some(recorded) = self.cells.get(&id) else {
                differences.push(format!("{id}: not recorded"));
                continue;
            };
            let config = self.complete(recorded);
            let fields = config::differences(&config, &run.config);
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
        Err(GateError::OtherConfig {
            path: path.to_owned(),
            differences,
            source_options: self.source.clone(),
        })
    }

    fn complete(&self, cell: &BaselineCell) -> Fields {
        self.config.iter().chain(&cell.config).map(|(path, value)| (path.clone(), value.clone())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gate::testing::cell;
    use crate::schema::RunKey;

    fn baseline() -> Baseline {
        let provenance = Provenance {
            source: "--preset toy".into(),
            protocol: Value::Null,
            versions: BTreeMap::new(),
            cpu: "none".into(),
        };
        let mut cell = cell("A", "x", &[8, 9]);
        cell.config.insert("student.batch".into(), 16.into());
        Baseline::new(provenance, Gate { seeds: vec![0], settings: Settings::default() }, vec![cell])
    }

    /// What a reader says to the baseline after `change` was done to its JSON.
    fn refused(change: impl FnOnce(&mut Value)) -> String {
        let mut value = serde_json::to_value(baseline()).expect("plain data");
        change(&mut value);
        Baseline::parse(&value.to_string(), Path::new("b.json")).expect_err("a misfit").to_string()
    }

    #[test]
    fn what_was_written_is_read() {
        let written = baseline();
        assert_eq!(Baseline::parse(&written.text(), Path::new("b.json")).expect("sound"), written);
    }

    #[test]
    fn misfits_are_named_with_how_to_renew_the_file() {
        let renewal = "; renew it with `goalbench regress record --protocol PROTOCOL --out b.json`";
        assert_eq!(
            refused(|value| value["schema"] = 9.into()),
            format!("b.json: has schema 9, this program reads 1{renewal}")
        );
        let cell = |reason: &str| format!("b.json: A/x/default: {reason}{renewal}");
        assert_eq!(
            refused(|value| value["cells"]["A/x/default"]["steps"] = vec![0, 0].into()),
            cell("needs two evaluations or more, at rising steps, of one episode or more")
        );
        assert_eq!(
            refused(|value| value["config"]["student.batch"] = 32.into()),
            cell("its hash does not fit its config: the file was altered by hand")
        );
        assert_eq!(
            refused(|value| value["seeds"] = vec![0, 2].into()),
            cell("has other seeds than the file")
        );
    }

    #[test]
    fn another_config_is_refused_field_by_field() {
        let key = |curriculum: &str| RunKey {
            environment: "A".into(),
            curriculum: curriculum.into(),
            variant: "default".into(),
            seed: 0,
        };
        let run = |curriculum: &str, batch: u64| ExpectedRun {
            key: key(curriculum),
            config: Fields::from([("student.batch".to_owned(), batch.into())]),
            episodes: 10,
        };
        let path = Path::new("b.json");
        let cells = baseline().cells_of(&[run("x", 16)], path).expect("the same config");
        assert_eq!(cells[0].curves.len(), 2);
        let error =
            baseline().cells_of(&[run("x", 32), run("y", 16)], path).expect_err("another").to_string();
        assert!(
            error.contains("A/x/default: student.batch: 16 there, 32 now\n  A/y/default: not recorded\n")
        );
        assert!(error.ends_with(
            "If that is meant; renew it with `goalbench regress record --preset toy --out b.json`"
        ));
    }
}
