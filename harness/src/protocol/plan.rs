//! A plan: the runs that a protocol stands for, each with its complete config.

use std::collections::BTreeMap;

use curricula::Entry;
use reports::schema::RunKey;

use super::{DEFAULT_VARIANT, Patch, Protocol, Variant};
use crate::Registry;
use crate::config::layer::ConfigLayer;
use crate::config::{self, RunConfig};
use crate::error::HarnessError;
use crate::program;

/// One run to be done.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRun {
    /// Which run it is.
    pub key: RunKey,
    /// Its complete config.
    pub config: RunConfig,
    /// The program that plans it, as its manifest names it.
    pub program: String,
    /// Version of its curriculum.
    pub curriculum_version: String,
    /// Versions of its shadows, by curriculum id.
    pub shadow_versions: BTreeMap<String, String>,
}

/// Runs in the order in which they are started: seed by seed, so that a partial sweep has all cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Name of the protocol.
    pub name: String,
    /// The runs; ids are unique.
    pub runs: Vec<PlannedRun>,
}

impl Plan {
    /// Expands `protocol` and resolves the config of every run.
    ///
    /// # Errors
    /// [`HarnessError`] naming the place of the first wrong field.
    pub fn new(protocol: &Protocol, registry: &Registry) -> Result<Self, HarnessError> {
        check_number(protocol)?;
        check_patches(protocol, registry)?;
        let mut cells = Vec::new();
        for environment in &protocol.environments {
            for curriculum in &protocol.curricula {
                for (label, variant) in variants(protocol, environment, curriculum) {
                    let layer = variant.map(|variant| &variant.patch.layer);
                    let config = resolve(protocol, registry, environment, curriculum, layer)?;
                    check_title(registry, curriculum, &config)?;
                    let version = |id: &String| config::curriculum_version(registry, id, &config);
                    let shadows = config.shadow.iter().map(|id| (id.clone(), version(id))).collect();
                    let versions: (String, BTreeMap<_, _>) = (version(curriculum), shadows);
                    cells.push((environment, curriculum, label, config, versions));
                }
            }
        }
        let program = &program::described(registry.program());
        let runs = protocol.seeds.iter().flat_map(|&seed| {
            cells.iter().map(move |(environment, curriculum, label, config, versions)| PlannedRun {
                key: RunKey {
                    environment: (*environment).clone(),
                    curriculum: (*curriculum).clone(),
                    variant: (*label).to_owned(),
                    seed,
                },
                config: config.clone(),
                program: program.clone(),
                curriculum_version: versions.0.clone(),
                shadow_versions: versions.1.clone(),
            })
        });
        let plan = Self { name: protocol.name.clone(), runs: runs.collect() };
        if plan.runs.is_empty() {
            let reason =
                "the plan has no runs: no variant applies to these environments and curricula".into();
            return Err(HarnessError::Protocol { place: protocol.name.clone(), reason });
        }
        Ok(plan)
    }
}

impl Plan {
    /// The config of every kind of run, as TOML: a table for each, named as in `"MazeA/teach/default"`.
    pub fn configs(&self) -> String {
        let kinds = self.runs.iter().map(|run| {
            let RunKey { environment, curriculum, variant, .. } = &run.key;
            (format!("{environment}/{curriculum}/{variant}"), config::to_table(&run.config).into())
        });
        kinds.collect::<toml::Table>().to_string()
    }
}

/// More runs than this are a slip of the keyboard, and their configs would fill the memory.
const MOST_RUNS: usize = 20_000;

/// Counts the runs of `protocol` before any of them is made.
fn check_number(protocol: &Protocol) -> Result<(), HarnessError> {
    let Protocol { environments, curricula, seeds, .. } = protocol;
    let pairs = environments.iter().flat_map(|env| curricula.iter().map(move |curriculum| (env, curriculum)));
    let cells: usize =
        pairs.map(|(environment, curriculum)| variants(protocol, environment, curriculum).len()).sum();
    match cells.checked_mul(seeds.len()) {
        Some(runs) if runs <= MOST_RUNS => Ok(()),
        _ => {
            let reason = format!(
                "{cells} environments × curricula × variants with {} seeds each are more than {MOST_RUNS} runs; split them \
                 up, into one results folder or several",
                seeds.len()
            );
            Err(HarnessError::Protocol { place: protocol.name.clone(), reason })
        }
    }
}

/// Resolves once every override and variant that applies to no planned run: a mistyped key in one of them is
/// reported now, not on the day when it first matters. All others are resolved with the runs, together with
/// the layers that may make them valid.
fn check_patches(protocol: &Protocol, registry: &Registry) -> Result<(), HarnessError> {
    let overrides = protocol.overrides.iter().map(|patch| (patch, None));
    let own = protocol.variants.iter().map(|variant| (&variant.patch, Some(&variant.patch.layer)));
    for (patch, layer) in overrides.chain(own).filter(|(patch, _)| !is_planned(patch, protocol)) {
        let environment = patch.environments.first().unwrap_or(&protocol.environments[0]);
        let curriculum = patch.curricula.first().unwrap_or(&protocol.curricula[0]);
        resolve(protocol, registry, environment, curriculum, layer)?;
    }
    Ok(())
}

/// Whether it applies to a planned run.
fn is_planned(patch: &Patch, protocol: &Protocol) -> bool {
    let Protocol { environments, curricula, .. } = protocol;
    let mut pairs =
        environments.iter().flat_map(|env| curricula.iter().map(move |curriculum| (env, curriculum)));
    pairs.any(|(environment, curriculum)| {
        patch.applies(environment, curriculum) && !variants(protocol, environment, curriculum).is_empty()
    })
}

/// # Errors
/// [`HarnessError::Argument`] if the curriculum's own `title` is that of another curriculum.
fn check_title(registry: &Registry, curriculum: &str, config: &RunConfig) -> Result<(), HarnessError> {
    let own = config.curriculum.get(curriculum).and_then(|table| table.get("title")?.as_str());
    let is_taken = |entry: &&Entry| {
        entry.id != curriculum && own.is_some_and(|own| own.eq_ignore_ascii_case(entry.title))
    };
    registry.curricula().iter().find(is_taken).map_or(Ok(()), |other| {
        let place = format!("curriculum.{curriculum}.title");
        let reason =
            format!("`{}` is what `{}` is called in reports; choose another title", other.title, other.id);
        Err(HarnessError::Protocol { place, reason })
    })
}

fn variants<'a>(
    protocol: &'a Protocol,
    environment: &str,
    curriculum: &str,
) -> Vec<(&'a str, Option<&'a Variant>)> {
    if protocol.variants.is_empty() {
        return vec![(DEFAULT_VARIANT, None)];
    }
    let applying = protocol.variants.iter().filter(|variant| variant.patch.applies(environment, curriculum));
    applying.map(|variant| (variant.label.as_str(), Some(variant))).collect()
}

/// The config of a cell whose variant sets `layer`.
///
/// # Errors
/// [`HarnessError`] naming the place of the first wrong field.
pub(super) fn resolve(
    protocol: &Protocol,
    registry: &Registry,
    environment: &str,
    curriculum: &str,
    layer: Option<&ConfigLayer>,
) -> Result<RunConfig, HarnessError> {
    let known = "names were checked when the protocol was read";
    let spec = &registry.environment(environment).expect(known).spec;
    let entry = registry.curriculum(curriculum).expect(known);
    let applying = protocol.overrides.iter().filter(|patch| patch.applies(environment, curriculum));
    let layers: Vec<ConfigLayer> = std::iter::once(&protocol.base)
        .chain(applying.map(|patch| &patch.layer))
        .chain(layer)
        .chain(&protocol.options)
        .cloned()
        .collect();
    config::resolve(registry, spec, entry, &layers)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "name = 'a-test'\nenvironments = ['Point']\ncurricula = ['teach']\nseeds = [0]\n";
    const LONG: &str = "[[variant]]\nlabel = 'long'\nset = { curriculum.teach.window = 9000 }\n";

    fn planned(text: &str, options: &[&str]) -> Result<Plan, HarnessError> {
        let registry = Registry::builtin();
        let mut protocol = Protocol::parse("a test", text, &registry)?;
        for option in options {
            protocol.set(ConfigLayer::from_assignment("--set", option)?);
        }
        Plan::new(&protocol, &registry)
    }

    #[test]
    fn a_variant_need_only_be_valid_together_with_what_its_runs_have() {
        // `renewal` must be at least the window; alone, the variant is wrong.
        assert!(planned(&format!("{HEAD}{LONG}"), &[]).is_err());
        let renewal = "[[override]]\ncurricula = ['teach']\nset = { curriculum.teach.renewal = 10000 }\n";
        assert!(planned(&format!("{HEAD}{renewal}{LONG}"), &[]).is_ok());
        assert!(planned(&format!("{HEAD}{LONG}"), &["curriculum.teach.renewal=10000"]).is_ok());
    }

    #[test]
    fn a_mistake_in_what_applies_to_no_run_is_reported() {
        let elsewhere =
            |set: &str| format!("{HEAD}[[override]]\nenvironments = ['MazeA']\nset = {{ {set} }}\n");
        assert!(planned(&elsewhere("student.batch = 8"), &[]).is_ok());
        let error = planned(&elsewhere("student.bach = 8"), &[]).expect_err("a misspelt key").to_string();
        assert!(error.contains("bach"), "{error}");
    }
}
