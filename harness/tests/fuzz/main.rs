//! Whatever stands in a file or behind an option: no panic, no hang, no memory without bound; what is refused
//! is named; what is accepted stays the same when it is written and read again.
//!
//! Each target damages valid input in ways that chance chooses, or makes up bytes. `PROPTEST_CASES` scales
//! the number of cases (256 is the default and takes about a minute). Seeds of failures are kept in
//! `harness/tests/fuzz/failures/`, and are tried first from then on.

#![allow(clippy::expect_used, reason = "a test that cannot go on fails")]

#[path = "../support/mod.rs"]
mod support;

mod archives;
mod damage;
mod fixture;
mod gate;
mod options;
mod program;
mod results;
mod saved;
mod target;
mod traces;
