//! The manifest of a run: its resolved config and the hash that keeps configs apart.

use std::collections::BTreeMap;

use reports::schema::{CURRICULUM, Manifest, PROGRAM, SCHEMA};
use reports::store::checksums::manifest_hash;
use serde_json::{Value, json};

use crate::config::RunConfig;
use crate::error::ManifestError;
use crate::program::executable_digest;
use crate::protocol::plan::PlannedRun;

/// JSON pointer to the budget in a manifest's config.
const BUDGET: &str = "/budget/steps";

/// The manifest of a planned run.
pub fn manifest(run: &PlannedRun) -> Manifest {
    let config = serde_json::to_value(&run.config).expect("a config is plain data");
    Manifest {
        schema: SCHEMA,
        hash: manifest_hash(&run.key, &config),
        run: run.key.clone(),
        config,
        versions: versions_of(run),
        earlier_budgets: Vec::new(),
    }
}

/// All that is known of the programs behind a planned run.
fn versions_of(run: &PlannedRun) -> BTreeMap<String, String> {
    let mut versions = versions();
    versions.insert(PROGRAM.to_owned(), run.program.clone());
    versions.insert(CURRICULUM.to_owned(), run.curriculum_version.clone());
    let shadows = run.shadow_versions.iter();
    versions.extend(shadows.map(|(id, version)| (format!("shadow {id}"), version.clone())));
    if let Some(digest) = executable_digest() {
        versions.insert(EXECUTABLE.to_owned(), digest.to_owned());
    }
    versions
}

/// The smaller budget of `found`, in training steps, if it differs from `wanted` in nothing else.
pub fn smaller_budget(found: &Manifest, wanted: &Manifest) -> Option<u64> {
    let budget = |manifest: &Manifest| manifest.config.pointer(BUDGET)?.as_u64();
    let (steps, more) = (budget(found)?, budget(wanted)?);
    let mut config = wanted.config.clone();
    *config.pointer_mut(BUDGET)? = steps.into();
    (steps < more && found.config == config).then_some(steps)
}

/// The manifest of the run of `found`, whose budget is `steps`, once it is trained on to that of `wanted`. It
/// remembers the budgets before, and which program began the run.
pub fn extended(found: Manifest, steps: u64, wanted: &Manifest) -> Manifest {
    let earlier_budgets = found.earlier_budgets.into_iter().chain([steps]).collect();
    Manifest { earlier_budgets, versions: found.versions, ..wanted.clone() }
}

/// Reads the typed config back.
///
/// # Errors
/// [`ManifestError`] if it has another schema, a config that does not fit, or a hash that does not match.
pub fn config(manifest: &Manifest) -> Result<RunConfig, ManifestError> {
    if manifest.schema != SCHEMA {
        return Err(ManifestError::Schema { found: manifest.schema });
    }
    if manifest_hash(&manifest.run, &manifest.config) != manifest.hash {
        return Err(ManifestError::Altered);
    }
    serde_path_to_error::deserialize(&manifest.config).map_err(|error| ManifestError::Config {
        field: error.path().to_string(),
        source: error.into_inner(),
    })
}

/// The name, among a manifest's versions, of the commit that the program was built from. It alone never keeps
/// a run from going on, since most commits change no result.
pub const COMMIT: &str = "commit";

/// Likewise, of the SHA-256 of the program's file. A program built again may differ in it and in nothing
/// else.
pub const EXECUTABLE: &str = "executable";

/// How the program and the curriculum of `found` differ from those of `wanted`: a line for each differing
/// version, [`COMMIT`] and [`EXECUTABLE`] left out. `None` if they are alike.
pub fn other_program(found: &Manifest, wanted: &Manifest) -> Option<String> {
    // Older manifests name neither program nor curriculum.
    let is_told = |name: &str| found.versions.contains_key(name) || ![PROGRAM, CURRICULUM].contains(&name);
    let compared = |manifest: &Manifest| {
        let mut versions = manifest.versions.clone();
        versions.retain(|name, _| ![COMMIT, EXECUTABLE].contains(&name.as_str()) && is_told(name));
        json!({ "versions": versions })
    };
    let (there, here) = (compared(found), compared(wanted));
    (there != here).then(|| differences(&there, &here))
}

/// How the curriculum of `found` differs from that of `wanted`, which has the same config; `None` if it does
/// not, or is not told.
pub fn other_curriculum(found: &Manifest, wanted: &Manifest) -> Option<String> {
    let version = |manifest: &Manifest| manifest.versions.get(CURRICULUM).cloned();
    let (there, here) = (version(found)?, version(wanted)?);
    let versions = |version: String| json!({ "versions": { CURRICULUM: version } });
    (there != here).then(|| differences(&versions(there), &versions(here)))
}

/// How the build that began the run of `found` differs from that of `wanted`, where versions do not tell:
/// their commits or, at one commit, their files.
pub fn other_build(found: &Manifest, wanted: &Manifest) -> Option<String> {
    let both = |name: &str| [found, wanted].map(|manifest| manifest.versions.get(name).cloned());
    let [there, here] = both(COMMIT);
    if there != here {
        let [there, here] = [there, here].map(|commit| commit.unwrap_or_else(|| "unknown".to_owned()));
        return Some(format!("begun by a build of commit {there}, goes on with {here}"));
    }
    let [Some(there), Some(here)] = both(EXECUTABLE) else { return None };
    let short = |digest: String| digest.chars().take(12).collect::<String>();
    (there != here).then(|| {
        let (there, here) = (short(there), short(here));
        format!("begun by another build of this version (SHA-256 {there}...), goes on with {here}...")
    })
}

/// Versions of this program and of the native libraries that it runs on, and its [`COMMIT`] if it was built
/// from one.
pub fn versions() -> BTreeMap<String, String> {
    let libraries = agents::versions().into_iter().map(|(name, version)| (name.to_owned(), version));
    let mut versions: BTreeMap<String, String> = libraries.collect();
    // Environments refuse to run on any other version.
    versions.insert("mujoco".to_owned(), envs::MUJOCO_VERSION.to_owned());
    versions.insert("goalbench".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
    let commit = env!("GOALBENCH_COMMIT");
    if !commit.is_empty() {
        versions.insert(COMMIT.to_owned(), commit.to_owned());
    }
    versions
}

/// The fields in which two configs differ, one per line: `path: OLD there, NEW now`.
pub fn differences(old: &Value, new: &Value) -> String {
    let mut lines = Vec::new();
    compare("", old, new, &mut lines);
    lines.join("\n")
}

fn compare(path: &str, old: &Value, new: &Value, lines: &mut Vec<String>) {
    match (old, new) {
        (Value::Object(a), Value::Object(b)) => {
            let added = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(added) {
                let below = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                compare(
                    &below,
                    a.get(key).unwrap_or(&Value::Null),
                    b.get(key).unwrap_or(&Value::Null),
                    lines,
                );
            }
        }
        _ if old == new => {}
        _ => lines.push(format!("  {path}: {old} there, {new} now")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_name_the_fields() {
        let old = json!({"a": {"b": 1, "c": 2}, "d": 3});
        let new = json!({"a": {"b": 1, "c": 5}, "e": 4});
        assert_eq!(
            differences(&old, &new),
            "  a.c: 2 there, 5 now\n  d: 3 there, null now\n  e: null there, 4 now"
        );
    }
}
