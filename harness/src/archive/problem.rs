//! What is wrong with an archive, or with results that are to become one.

use std::io;
use std::path::PathBuf;

/// Why an archive is not used. Nothing of it is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveProblem {
    /// It cannot be read, or it is not compressed by zstd, or cut off.
    #[error("it cannot be read as a tar archive compressed by zstd")]
    Unreadable(#[from] io::Error),
    /// A file of it cannot be written where it is unpacked.
    #[error("{path} cannot be written")]
    Unwritable {
        /// Where it would lie.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// It unpacks to more than any results.
    #[error("it unpacks to more than {0} bytes")]
    TooLarge(u64),
    /// It has more files than any results.
    #[error("it has more than {0} files")]
    TooMany(usize),
    /// Something in it that no archive of results has: a link, or a name that leads elsewhere.
    #[error("its entry `{name}` {reason}")]
    Entry {
        /// Its name there.
        name: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A file is not what it was when it was packed.
    #[error("its entry `{name}` does not have the checksum that it was packed with")]
    Checksum {
        /// Its name there.
        name: String,
    },
    /// A line of the list of checksums.
    #[error("line {0} of its SHA256SUMS is no checksum and name of a file")]
    Sums(usize),
    /// A file that is listed and not there.
    #[error("it lacks `{0}`")]
    Lacking(String),
    /// Bytes behind the end of the archive, which most programs would not see.
    #[error("something follows its last file")]
    After,
    /// It has no run.
    #[error("it holds no runs")]
    Empty,
    /// Its runs are not what they were when they ended.
    #[error("its runs are damaged: {0}")]
    Damaged(String),
}

/// Why results are not packed. Nothing is written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackProblem {
    /// Files of theirs are damaged or belong nowhere, one in a line.
    #[error("what a report would name as problems must be set right first:\n  {0}")]
    Damaged(String),
    /// Runs that have not ended.
    #[error("these runs have not ended; finish them with `goalbench run`, or delete their folders:\n  {0}")]
    Unfinished(String),
    /// A policy that was asked for is not there.
    #[error(
        "--policies: no run with seed {seed} has finished, so there is no policy of it; finished are {finished}"
    )]
    NoPolicy {
        /// The seed.
        seed: u64,
        /// The seeds of runs that have finished.
        finished: String,
    },
    /// A name that the archive's format cannot hold.
    #[error(
        "`{0}` cannot be called so in an archive, which takes plain names of at most 100 bytes below folders of 155"
    )]
    Name(String),
    /// A file was changed while it was packed.
    #[error("`{0}` was changed while it was packed")]
    Changed(String),
    /// There is too much of it.
    #[error("they are {files} files of {bytes} bytes, more than an archive may hold")]
    TooLarge {
        /// Bytes of all files.
        bytes: u64,
        /// How many files.
        files: usize,
    },
}
