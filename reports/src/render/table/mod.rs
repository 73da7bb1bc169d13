//! Tables: Markdown, HTML and LaTeX to read, CSV and Parquet to compute with.
//!
//! A table is rows and a list of [`Column`]s; everything else follows from these.
//!
//! ```
//! use reports::render::table::{Column, Sheet};
//!
//! let columns = [
//!     Column::text("name", "name of the run", |row: &(&str, f64)| row.0.to_owned())
//!         .named("Name", |row| row.0.to_owned()),
//!     Column::real("hours", "hours that it took", |row: &(&str, f64)| row.1)
//!         .shown("Hours", |row| format!("{:.2}", row.1)),
//! ];
//! let sheet = Sheet::of("How long it took.".to_owned(), &[("a", 1.25), ("b", 0.5)], &columns)?;
//! assert!(sheet.table.markdown().ends_with("| a | 1.25 |\n| b | 0.50 |\n"));
//! assert_eq!(reports::render::table::csv(sheet.data)?, b"name,hours\na,1.25\nb,0.5\n");
//! # Ok::<(), reports::ReportError>(())
//! ```

pub(crate) mod cells;
mod column;
mod latex;
mod markup;
mod sheet;

use polars::prelude::{CsvWriter, DataFrame, ParquetWriter, SerWriter};

pub use column::{Column, ColumnInfo};
pub use markup::markdown_escape;
pub use markup::{Align, Table, html_escape};
pub use sheet::Sheet;

use crate::error::ReportError;

/// A data frame as CSV, with a header; null is an empty field.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot write it.
pub fn csv(mut frame: DataFrame) -> Result<Vec<u8>, ReportError> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut frame)?;
    Ok(bytes)
}

/// A data frame as Parquet.
///
/// # Errors
/// [`ReportError::Frame`] if polars cannot write it.
pub fn parquet(mut frame: DataFrame) -> Result<Vec<u8>, ReportError> {
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame)?;
    hide_arrow_schema(&mut bytes);
    Ok(bytes)
}

/// Where readers of Arrow look for the types that the data had in memory.
const ARROW_SCHEMA: &[u8] = b"ARROW:schema";

/// Renames the note of the types that the data had in memory, so that all readers go by the types of the
/// file: for polars text is a `string_view`, which older readers refuse and pyarrow cannot filter; by the
/// file it is a `string`. The note comes behind all that could hold the same bytes, and keeps its length.
fn hide_arrow_schema(bytes: &mut [u8]) {
    let hidden: &[u8] = b"polarsschema";
    if let Some(at) = bytes.windows(ARROW_SCHEMA.len()).rposition(|part| part == ARROW_SCHEMA) {
        bytes[at..at + hidden.len()].copy_from_slice(hidden);
    }
}
