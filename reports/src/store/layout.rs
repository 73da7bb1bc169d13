//! Where things lie in a results folder.
//!
//! ```text
//! RESULTS/runs/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/{manifest.json, records.jsonl, teaching.jsonl, timing.jsonl,
//!                                                     outcome.json, crashes.jsonl, worker.log}
//! RESULTS/report/{index.html, summary.md, *.csv, *.parquet, DATA.md, files.txt, tables/*.tex, figures/*.{svg, png}}
//! ```

use std::path::{Path, PathBuf};

use crate::schema::RunKey;

/// Name of the manifest file of a run.
pub const MANIFEST: &str = "manifest.json";
/// Name of the file of evaluations of a run.
pub const RECORDS: &str = "records.jsonl";
/// Name of the file of what the teacher did in a run.
pub const TEACHING: &str = "teaching.jsonl";
/// Name of the file of timings of a run.
pub const TIMING: &str = "timing.jsonl";
/// Name of the file that says how a run ended.
pub const OUTCOME: &str = "outcome.json";

/// Name of the file that notes crashed workers of a run.
pub const CRASHES: &str = "crashes.jsonl";

/// Name of the file that keeps what a run's workers said on standard error; absent where they said nothing.
pub const WORKER_LOG: &str = "worker.log";

/// The folder of all runs of a results folder.
pub fn runs_dir(results: &Path) -> PathBuf {
    results.join("runs")
}

/// The folder of one run.
pub fn run_dir(results: &Path, run: &RunKey) -> PathBuf {
    runs_dir(results)
        .join(&run.environment)
        .join(&run.curriculum)
        .join(&run.variant)
        .join(format!("seed-{}", run.seed))
}

/// The folder of the figures and tables.
pub fn report_dir(results: &Path) -> PathBuf {
    results.join("report")
}
