//! A teacher's state as bytes.
//!
//! The bytes begin with the method's id and the version of its state, so that a state is only ever read by
//! what wrote it. Guarding against damage on disk is the checkpoint's business.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::CurriculumError;

/// `state` as the bytes of a teacher: marked with the method's `id` and the `version` of its state.
///
/// ```
/// use curricula::snapshot;
///
/// let bytes = snapshot::save("mine", 1, &vec![0.5, 2.0]);
/// assert_eq!(snapshot::load::<Vec<f64>>("mine", 1, &bytes)?, [0.5, 2.0]);
/// assert!(snapshot::load::<Vec<f64>>("another", 1, &bytes).is_err());
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
pub fn save<S: Serialize>(id: &str, version: u32, state: &S) -> Vec<u8> {
    seal(id, version, plain_bytes(state))
}

/// The state that [`save`] wrote for the same `id` and `version`.
///
/// ```
/// use curricula::snapshot;
///
/// let bytes = snapshot::save("mine", 2, &7u64);
/// assert_eq!(snapshot::load::<u64>("mine", 2, &bytes)?, 7);
/// let error = snapshot::load::<u64>("mine", 3, &bytes).unwrap_err();
/// assert_eq!(error.to_string(), "saved teacher state: version 2 of `mine`; this program reads version 3");
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
///
/// # Errors
/// [`CurriculumError::State`] if the bytes are another method's, another version's, cut short or too long.
pub fn load<S: DeserializeOwned>(id: &str, version: u32, bytes: &[u8]) -> Result<S, CurriculumError> {
    from_plain_bytes(open(id, version, bytes)?)
}

/// `state`, the bytes of a state alone, marked with the method's `id` and the `version` of its state. No
/// bytes stay no bytes: they are those of a stateless teacher.
pub(crate) fn seal(id: &str, version: u32, state: Vec<u8>) -> Vec<u8> {
    if state.is_empty() {
        return state;
    }
    let mut bytes = plain_bytes(&(id, version));
    bytes.extend(state);
    bytes
}

/// The bytes of the state that [`seal`] marked with the same `id` and `version`.
///
/// # Errors
/// [`CurriculumError::State`] if they are another method's or another version's.
pub(crate) fn open<'a>(id: &str, version: u32, bytes: &'a [u8]) -> Result<&'a [u8], CurriculumError> {
    if bytes.is_empty() {
        return Ok(bytes);
    }
    let ((found, written), state) = postcard::take_from_bytes::<(&str, u32)>(bytes).map_err(damaged)?;
    if found != id {
        return Err(refuse(format!("written by `{found}`, not by `{id}`")));
    }
    if written != version {
        return Err(refuse(format!("version {written} of `{id}`; this program reads version {version}")));
    }
    Ok(state)
}

/// Data in memory as bytes, without a mark.
///
/// ```
/// use curricula::snapshot::{from_plain_bytes, plain_bytes};
///
/// let bytes = plain_bytes(&(3u64, 0.5f64));
/// assert_eq!(from_plain_bytes::<(u64, f64)>(&bytes)?, (3, 0.5));
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
pub fn plain_bytes<S: Serialize>(state: &S) -> Vec<u8> {
    postcard::to_stdvec(state).expect("plain data in memory always serialises")
}

/// The data that [`plain_bytes`] gave.
///
/// ```
/// use curricula::snapshot::{from_plain_bytes, plain_bytes};
///
/// let mut bytes = plain_bytes(&0.5f64);
/// assert_eq!(from_plain_bytes::<f64>(&bytes)?, 0.5);
/// bytes.push(0);
/// assert!(from_plain_bytes::<f64>(&bytes).is_err());
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
///
/// # Errors
/// [`CurriculumError::State`] if the bytes are of another type, cut short or too long.
pub fn from_plain_bytes<S: DeserializeOwned>(bytes: &[u8]) -> Result<S, CurriculumError> {
    let (state, rest) = postcard::take_from_bytes(bytes).map_err(damaged)?;
    if rest.is_empty() { Ok(state) } else { Err(refuse(format!("{} bytes too many", rest.len()))) }
}

/// A state that does not fit, and why.
///
/// ```
/// let error = curricula::snapshot::refuse("its window has another length");
/// assert_eq!(error.to_string(), "saved teacher state: its window has another length");
/// ```
pub fn refuse(reason: impl Into<String>) -> CurriculumError {
    CurriculumError::State { reason: reason.into(), source: None }
}

/// The same where another error says more.
///
/// ```
/// use std::error::Error;
///
/// let cause = "x".parse::<u32>().unwrap_err();
/// let error = curricula::snapshot::refuse_because("no number", cause.clone());
/// assert_eq!(error.to_string(), "saved teacher state: no number");
/// assert_eq!(error.source().unwrap().to_string(), cause.to_string());
/// ```
pub fn refuse_because(
    reason: impl Into<String>,
    source: impl std::error::Error + Send + Sync + 'static,
) -> CurriculumError {
    CurriculumError::State { reason: reason.into(), source: Some(Box::new(source)) }
}

fn damaged(error: postcard::Error) -> CurriculumError {
    refuse_because("not a teacher's state, or damaged", error)
}

/// Refuses a state with values for `found` goals where the pool has `pool`.
///
/// ```
/// use curricula::snapshot::require_goals;
///
/// assert!(require_goals(200, 200).is_ok());
/// let error = require_goals(100, 200).unwrap_err();
/// assert_eq!(error.to_string(), "saved teacher state: written for 100 goals; the pool has 200");
/// ```
///
/// # Errors
/// [`CurriculumError::State`] if the two differ.
pub fn require_goals(found: usize, pool: usize) -> Result<(), CurriculumError> {
    if found == pool {
        Ok(())
    } else {
        Err(refuse(format!("written for {found} goals; the pool has {pool}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `load` says of bytes that it must refuse.
    fn refusal(bytes: &[u8]) -> String {
        load::<Vec<f64>>("teach", 1, bytes).expect_err("must be refused").to_string()
    }

    #[test]
    fn what_was_saved_is_loaded() {
        let bytes = save("teach", 1, &vec![0.1, -3.0]);
        assert_eq!(load::<Vec<f64>>("teach", 1, &bytes).unwrap(), [0.1, -3.0]);
    }

    /// Checkpoints of earlier programs were written in one piece.
    #[test]
    fn mark_and_state_are_what_one_tuple_of_them_would_be() {
        let state = (7u64, true, vec![0.1, -3.0]);
        assert_eq!(save("teach", 300, &state), postcard::to_stdvec(&("teach", 300u32, &state)).unwrap());
    }

    #[test]
    fn foreign_bytes_are_refused_with_their_origin() {
        let state = vec![0.1, -3.0];
        assert!(refusal(&save("space", 1, &state)).contains("`space`"));
        assert!(refusal(&save("teach", 2, &state)).contains("version 2"));
        assert!(refusal(b"\xff\xff\xff\xff").contains("damaged"));
    }

    #[test]
    fn every_truncation_and_extension_is_refused() {
        let mut bytes = save("teach", 1, &vec![0.1, -3.0]);
        for length in 0..bytes.len() {
            refusal(&bytes[..length]);
        }
        bytes.push(0);
        assert!(refusal(&bytes).contains("1 bytes too many"));
    }

    #[test]
    fn nothing_is_saved_as_nothing() {
        assert!(save("her-iid", 1, &()).is_empty());
        load::<()>("her-iid", 1, &[]).unwrap();
        let error = load::<()>("her-iid", 1, &save("teach", 1, &1u8)).unwrap_err();
        assert!(error.to_string().contains("`teach`"), "{error}");
    }
}
