//! Results as one file that can be cited, given away, and drawn beside other results.
//!
//! ```text
//! NAME.tar.zst: goalbench-results/SHA256SUMS                 of every other file, in the format of sha256sum
//!                                 DATA.md                    what this is: a dataset card
//!                                 policies/RUN/policy.json, policies/RUN/policy.safetensors
//!                                 protocols/NAME.toml
//!                                 records.parquet, runs.parquet
//!                                 runs/RUN/FILE              RUN: ENVIRONMENT/CURRICULUM/VARIANT/seed-N
//! ```
//!
//! The same results give the same bytes: files come in order, without times and owners. [`unpack`] trusts
//! nothing in an archive.

mod card;
mod member;
mod pack;
mod problem;
mod sums;
mod unpack;

use std::path::{Path, PathBuf};

use guard::text::short;
use reports::schema::{Manifest, RunKey};

use crate::error::HarnessError;
use crate::export::ExportedPolicy;

pub use pack::{Packed, Packing, PolicyChoice, pack};
pub use problem::{ArchiveProblem, PackProblem};
pub use unpack::{Unpacked, unpack, unpack_to};

/// The folder that everything in an archive lies in.
const ROOT: &str = "goalbench-results";
/// Name of the list of checksums, the first file of an archive.
const SUMS: &str = "SHA256SUMS";
/// Name of the folder of exported policies, in an archive and beside the runs that came out of one.
pub(crate) const POLICIES: &str = "policies";
/// Name of the dataset card.
const CARD: &str = "DATA.md";
/// How names of archives end.
pub const EXTENSION: &str = ".tar.zst";
/// Longest name of an archive, in characters: it marks methods in figures.
const LONGEST_NAME: usize = 40;
/// Most bytes that the files of an archive may have together.
const MOST_BYTES: u64 = 16 << 30;
/// Most files of an archive.
const MOST_FILES: usize = 400_000;

/// Where the exported policy of `run` lies in the folder of an archive that was unpacked.
pub(crate) fn policy_dir(results: &Path, run: &RunKey) -> PathBuf {
    results.join(POLICIES).join(run.to_string())
}

/// The policy that came with an archive for the run of `manifest`; `None` if none did.
///
/// # Errors
/// [`HarnessError`] if one did and is damaged, or that of another run.
pub(crate) fn unpacked_policy(
    results: &Path,
    manifest: &Manifest,
) -> Result<Option<ExportedPolicy>, HarnessError> {
    ExportedPolicy::kept(&policy_dir(results, &manifest.run), manifest)
}

/// The NAME of the archive at `path`, which marks its runs beside others.
///
/// # Errors
/// What is accepted, in words, where the file is not called `NAME.tar.zst`.
pub fn name_of(path: &Path) -> Result<&str, String> {
    let file = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let is_short = |name: &&str| (1..=LONGEST_NAME).contains(&name.chars().count());
    let is_readable = |name: &&str| !name.chars().any(|c| c.is_control() || "@/[]".contains(c));
    file.strip_suffix(EXTENSION).filter(is_short).filter(is_readable).ok_or_else(|| {
        format!(
            "{} is not called NAME{EXTENSION}, with a NAME of at most {LONGEST_NAME} characters, none of them @, [ or ]",
            short(&path.display().to_string())
        )
    })
}
