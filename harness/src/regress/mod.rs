//! The regression gate: carries out a reduced protocol, records it as a baseline, or checks against one.
//!
//! [`reports::gate`] compares runs and knows neither protocols nor programs. This module connects it to them:
//! it turns a [`Plan`] into [`ExpectedRun`]s and a protocol into JSON and back, and names this machine's
//! versions and processor. A [sweep](crate::sweep) carries out the plan, or finds that it was carried out
//! before.
//!
//! The page `harness/docs/regression.md` says how to use it and which faults it was seen to catch.

use std::fs;
use std::path::Path;

use reports::gate::Baseline;
use reports::gate::baseline::Provenance;
use reports::gate::cells::ExpectedRun;
use reports::gate::config;
use serde_json::Value;

use crate::Registry;
use crate::config::layer::Document;
use crate::error::{Cause, HarnessError};
use crate::protocol::Protocol;
use crate::protocol::plan::{Plan, PlannedRun};
use crate::run::manifest::{self, COMMIT};

/// The runs of `plan` as the gate knows them.
pub fn expected(plan: &Plan) -> Vec<ExpectedRun> {
    let expected = |run: &PlannedRun| {
        let resolved = serde_json::to_value(&run.config).expect("a config is plain data");
        ExpectedRun {
            key: run.key.clone(),
            config: config::fields(&resolved),
            episodes: run.config.evaluation.episodes,
        }
    };
    plan.runs.iter().map(expected).collect()
}

/// What a baseline records besides its curves: the protocol in TOML, the options `source` that name it, and
/// this machine.
///
/// # Errors
/// [`HarnessError::Protocol`] if the protocol is no TOML, [`HarnessError::Notation`] if it has no JSON form.
pub fn provenance(source: String, protocol: &str) -> Result<Provenance, HarnessError> {
    let (_, table) = Document::parse(&source, protocol)?;
    let protocol = serde_json::to_value(table).map_err(unwritable(&source, "JSON"))?;
    Ok(Provenance { source, protocol, versions: manifest::versions(), cpu: cpu() })
}

/// The protocol that was recorded in the baseline at `path`, with the baseline's seeds.
///
/// # Errors
/// [`HarnessError`] if this program cannot read it.
pub fn protocol(baseline: &Baseline, path: &Path, registry: &Registry) -> Result<Protocol, HarnessError> {
    let place = format!("{} (protocol)", path.display());
    let mut protocol = Protocol::parse(&place, &as_toml(&baseline.protocol, &place)?, registry)?;
    protocol.refuse_search()?;
    protocol.seeds.clone_from(&baseline.seeds);
    Ok(protocol)
}

fn as_toml(protocol: &Value, place: &str) -> Result<String, HarnessError> {
    let table = toml::Table::try_from(protocol).map_err(unwritable(place, "TOML"))?;
    toml::to_string(&table).map_err(unwritable(place, "TOML"))
}

fn unwritable<E: Into<Cause>>(place: &str, notation: &'static str) -> impl FnOnce(E) -> HarnessError {
    move |error| HarnessError::Notation { place: place.to_owned(), notation, source: error.into() }
}

/// How this machine differs from the one that recorded the baseline; curves may then differ too.
pub fn foreign(baseline: &Baseline) -> Vec<String> {
    let now = manifest::versions();
    let version = |(name, there): (&String, &String)| {
        let here = now.get(name).map_or("none", String::as_str);
        (here != there).then(|| format!("{name} is {here} here, the baseline was recorded with {there}"))
    };
    let compared = baseline.versions.iter().filter(|(name, _)| name.as_str() != COMMIT);
    let mut notes: Vec<String> = compared.filter_map(version).collect();
    let cpu = cpu();
    if cpu != baseline.cpu {
        notes.push(format!(
            "the processor is {cpu} here, {} in the baseline: rounding may differ",
            baseline.cpu
        ));
    }
    notes
}

/// Model of this machine's processor.
fn cpu() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    model.map_or("unknown".to_owned(), |(_, name)| name.trim().to_owned())
}
