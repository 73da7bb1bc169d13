//! Results as one file that can be cited, given away, and drawn beside other results.
//!
//! ```text
//! NAME.tar.zst: goalbench-results/SHA256SUMS                 of every other file, in the format of sha256sum
//!                                 DATA.md                    what this is: a dataset card
//!                                 policies/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/{policy.json,
//!                                 policy.safetensors} protocols/NAME.toml records.parquet, runs.parquet
//!                                 runs/ENVIRONMENT/CURRICULUM/VARIANT/seed-N/FILE
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

pub use pack::{Packed, Packing, PolicyChoice, pack};
pub use problem::{ArchiveProblem, PackProblem};
pub use unpack::{Unpacked, unpack};

/// The folder that everything in an archive lies in.
const ROOT: &str = "goalbench-results";
/// Name of the list of checksums, the first file of an archive.
const SUMS: &str = "SHA256SUMS";
/// Name of the dataset card.
const CARD: &str = "DATA.md";
/// How names of archives end.
pub const EXTENSION: &str = ".tar.zst";
/// Most bytes that the files of an archive may have together.
const MOST_BYTES: u64 = 16 << 30;
/// Most files of an archive.
const MOST_FILES: usize = 400_000;
