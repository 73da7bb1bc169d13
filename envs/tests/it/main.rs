//! Tests of the environments through the crate's public interface.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod assets;
mod contract;
mod damaged;
mod distributions;
mod golden;
mod render;

/// An error with all its sources, as the program prints it.
fn told(error: &dyn std::error::Error) -> String {
    let sources = std::iter::successors(Some(error), |error| error.source());
    sources.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
