//! Files and text from outside, without surprises.
//!
//! Folders of results are shared, copied and unpacked from archives. What lies in them may be a pipe in place
//! of a file, which would keep its reader waiting for ever, a link that leads elsewhere, what a killed
//! process left behind, or text that a terminal takes for orders. Every file that the workspace reads or
//! writes in folders of others goes through these modules:
//!
//! - [`files`] opens regular files alone, and writes through no link.
//! - [`fresh`] makes files that appear whole or not at all, and removes what killed processes left of them.
//! - [`text`] shows control characters instead of obeying them.

pub mod files;
pub mod fresh;
pub mod text;
