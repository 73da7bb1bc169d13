//! Tables: Markdown, HTML and LaTeX to read, CSV and Parquet to compute with.

mod aggregate;
mod cells;
mod comparison;
mod cost;
mod deviations;
mod environment;
mod latex;
mod ledger;
mod markup;
mod readings;
mod runs;
mod summary;
mod teaching;

use polars::prelude::{Column, CsvWriter, DataFrame, NamedFrom, ParquetWriter, SerWriter, Series};

pub use aggregate::{aggregate_frame, aggregate_table};
pub use comparison::{comparison_frame, comparison_table};
pub use cost::{cost_frame, cost_table};
pub use deviations::deviation_table;
pub use environment::{environment_frame, environment_table};
pub use ledger::{ledger_frame, ledger_table};
pub(crate) use markup::markdown_escape;
pub use markup::{Align, Table, html_escape};
pub use readings::{readings_frame, readings_table};
pub use runs::{run_frame, run_table};
pub use summary::{summary_frame, summary_table};
pub use teaching::{teaching_frame, teaching_table};

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
    Ok(bytes)
}

/// A column of one value per row.
pub(crate) fn column<'a, R, T>(name: &str, rows: &'a [R], value: impl Fn(&'a R) -> T) -> Column
where
    Series: NamedFrom<Vec<T>, [T]>,
{
    let values: Vec<T> = rows.iter().map(value).collect();
    Column::new(name.into(), values)
}
