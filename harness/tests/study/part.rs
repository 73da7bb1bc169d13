//! A part of the study: its preset and its archive.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use goalbench::Registry;
use goalbench::archive::{Unpacked, unpack_to};
use goalbench::protocol::plan::{Plan, PlannedRun};
use goalbench::protocol::presets::PRESETS;
use reports::store::{Run, Store};
use serde_json::Value;
use tempfile::TempDir;

use crate::support::{goalbench, stderr};

/// The parts by the names of presets and archives.
pub(crate) const PARTS: [&str; 2] = ["laptop", "laptop-ablations"];

/// What there is of a part, unpacked.
pub(crate) struct Part {
    pub(crate) store: Store,
    pub(crate) bytes: u64,
    /// SHA-256 of its archive.
    pub(crate) sha256: String,
    plan: BTreeMap<String, PlannedRun>,
    folder: TempDir,
}

impl Part {
    /// The part `name`; `None` while none of it is there.
    pub(crate) fn unpack(name: &str) -> Option<Self> {
        let path = archive(name);
        let bytes = path.metadata().ok()?.len();
        let folder = tempfile::tempdir().expect("a temporary folder");
        let Unpacked { store, sha256, .. } = unpack_to(&path, &folder.path().join("results")).expect(name);
        let registry = Registry::builtin();
        let preset = PRESETS.iter().find(|preset| preset.id == name).expect("a preset for every part");
        let protocol = preset.protocol(&registry).expect("a preset is valid");
        let runs = Plan::new(&protocol, &registry).expect("a preset is a plan").runs;
        let plan = runs.into_iter().map(|run| (run.key.to_string(), run)).collect();
        Some(Self { store, bytes, sha256, plan, folder })
    }

    /// Whether all runs that were planned are there.
    pub(crate) fn is_whole(&self) -> bool {
        self.store.runs().len() == self.plan.len()
    }

    /// Whether it has the run, too.
    pub(crate) fn has(&self, run: &Run) -> bool {
        self.store.runs().iter().any(|own| own.key() == run.key())
    }

    /// Checks that `run` is a planned one and has ended.
    pub(crate) fn assert_is_planned(&self, run: &Run) {
        let planned = self.plan.get(&run.key().to_string()).expect("a run of the plan");
        let config = serde_json::to_value(&planned.config).expect("a config is plain data");
        assert_says(&run.manifest.config, &config, &run.key().to_string());
        assert!(run.outcome.is_some(), "{}", run.key());
    }

    pub(crate) fn results(&self) -> PathBuf {
        self.folder.path().join("results")
    }

    /// Reports the part with the default options, which must go without a problem but for runs that failed.
    /// Gives the report's folder.
    pub(crate) fn report(&self) -> PathBuf {
        report(&self.results(), &self.store)
    }
}

/// The archive `name` of the study.
fn archive(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("study").join(name).with_extension("tar.zst")
}

/// Unpacks the archive `name`, whose runs belong to no preset, below `folder` and reports it. Gives the
/// report's folder and the archive's SHA-256.
pub(crate) fn report_of(name: &str, folder: &Path) -> (PathBuf, String) {
    let results = folder.join(name);
    let Unpacked { store, sha256, .. } = unpack_to(&archive(name), &results).expect(name);
    (report(&results, &store), sha256)
}

fn report(results: &Path, store: &Store) -> PathBuf {
    let output = goalbench(&["report", results.to_str().expect("a test path is UTF-8"), "--bands", "ci"]);
    let code = i32::from(!store.runs().iter().all(Run::is_finished));
    assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
    results.join("report")
}

/// That every value of the config `run` is that of `planned`, which may have fields that are younger.
fn assert_says(run: &Value, planned: &Value, place: &str) {
    let Value::Object(fields) = run else {
        assert_eq!(run, planned, "{place}");
        return;
    };
    for (name, value) in fields {
        assert_says(value, &planned[name], &format!("{place}: {name}"));
    }
}
