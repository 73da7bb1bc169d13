//! Ranges of hyper-parameters: each check refuses a field and says what it accepts.

use crate::error::AgentError;

/// The largest number of episodes that a field accepts: more than any run has, and small enough that counting
/// their steps cannot overflow.
pub(crate) const MOST_EPISODES: u64 = 1_000_000_000;

/// Refuses `field` with `reason` unless `good`.
pub(crate) fn accept(
    field: &'static str,
    good: bool,
    reason: impl FnOnce() -> String,
) -> Result<(), AgentError> {
    if good { Ok(()) } else { Err(AgentError::Config { field, reason: reason() }) }
}

pub(crate) fn at_least(field: &'static str, given: usize, least: usize) -> Result<(), AgentError> {
    accept(field, given >= least, || format!("{given} given, a whole number of at least {least} accepted"))
}

pub(crate) fn between(
    field: &'static str,
    given: usize,
    least: usize,
    most: usize,
) -> Result<(), AgentError> {
    let reason = || format!("{given} given, a whole number from {least} to {most} accepted");
    accept(field, (least..=most).contains(&given), reason)
}

pub(crate) fn at_most(field: &'static str, given: u64, most: u64) -> Result<(), AgentError> {
    accept(field, given <= most, || format!("{given} given, a whole number of at most {most} accepted"))
}

pub(crate) fn positive(field: &'static str, given: f64) -> Result<(), AgentError> {
    accept(field, given > 0.0 && given.is_finite(), || format!("{given} given, a positive number accepted"))
}

pub(crate) fn not_negative(field: &'static str, given: f64) -> Result<(), AgentError> {
    accept(field, given >= 0.0 && given.is_finite(), || {
        format!("{given} given, a number of at least 0 accepted")
    })
}

pub(crate) fn fraction(field: &'static str, given: f64) -> Result<(), AgentError> {
    accept(field, (0.0..=1.0).contains(&given), || format!("{given} given, a number in [0, 1] accepted"))
}
