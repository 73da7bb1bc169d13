//! What changes while a method teaches, and how it becomes bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::CurriculumError;
use crate::snapshot;

/// All that changes while a method teaches: it knows how to write and to read itself.
///
/// A state that is data in memory needs no more than [`PlainState`]. One that holds networks implements this
/// trait, as VDS's does.
pub trait TeacherState: Sized + Send + 'static {
    /// Raised whenever the bytes change, so that an old state is never read as a new one.
    const VERSION: u32;

    /// All of it as bytes.
    ///
    /// # Errors
    /// [`CurriculumError`] if networks cannot be read.
    fn write(&self) -> Result<Vec<u8>, CurriculumError>;

    /// Becomes what [`TeacherState::write`] gave. It is called on the state that
    /// [`Method::begin`](crate::Method::begin) made, which is thrown away if this fails.
    ///
    /// # Errors
    /// [`CurriculumError::State`] if the bytes do not fit.
    fn read(&mut self, bytes: &[u8]) -> Result<(), CurriculumError>;
}

/// A [`TeacherState`] that is data in memory.
///
/// ```
/// use curricula::{PlainState, TeacherState};
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Serialize, Deserialize)]
/// struct Mine {
///     successes: u64,
/// }
///
/// impl PlainState for Mine {
///     const VERSION: u32 = 1;
/// }
///
/// let mut state = Mine { successes: 0 };
/// state.read(&Mine { successes: 7 }.write()?)?;
/// assert_eq!(state.successes, 7);
/// # Ok::<(), curricula::CurriculumError>(())
/// ```
pub trait PlainState: Serialize + DeserializeOwned + Send + 'static {
    /// Raised whenever the type changes, so that an old state is never read as a new one.
    const VERSION: u32;
}

impl<S: PlainState> TeacherState for S {
    const VERSION: u32 = <S as PlainState>::VERSION;

    fn write(&self) -> Result<Vec<u8>, CurriculumError> {
        Ok(snapshot::plain_bytes(self))
    }

    fn read(&mut self, bytes: &[u8]) -> Result<(), CurriculumError> {
        *self = snapshot::from_plain_bytes(bytes)?;
        Ok(())
    }
}

/// The state of a method that remembers nothing.
impl PlainState for () {
    const VERSION: u32 = 1;
}
