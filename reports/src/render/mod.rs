//! From numbers to what is read: figures, tables and the page that shows them.

pub mod figure;
pub mod gif;
pub mod page;
pub mod table;
