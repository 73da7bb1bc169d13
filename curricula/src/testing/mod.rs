//! For tests of methods, here and in programs that bring their own.
//!
//! [`contract`] checks what every method must keep. A [`Class`] is a teacher with a [`ScriptedStudent`], for
//! tests of what a method does with what it sees.

mod class;
mod contract;
mod episode;
mod student;

pub use class::{Class, Mastery};
pub use contract::{contract, contract_with};
pub use episode::standing_still;
pub use student::{LOWEST, Question, Script, ScriptedStudent, Surprise, scripted_action};
