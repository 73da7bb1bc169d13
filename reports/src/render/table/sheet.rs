//! Rows and columns as everything that a table of a report is: data, dictionary, and a table to read.

use polars::prelude::DataFrame;

use super::column::{Column, ColumnInfo};
use super::markup::Table;
use crate::error::ReportError;

/// A table of a report.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The numbers, unrounded; null where there is none. No columns: there is nothing to compute with.
    pub data: DataFrame,
    /// The data dictionary.
    pub dictionary: Vec<ColumnInfo>,
    /// The table to read.
    pub table: Table,
}

impl Sheet {
    /// A row of data and one to read for each of `rows`.
    ///
    /// # Errors
    /// [`ReportError::Frame`] if polars cannot hold the rows.
    pub fn of<R>(caption: String, rows: &[R], columns: &[Column<'_, R>]) -> Result<Self, ReportError> {
        Self::with_remarks(caption, rows, columns, |_| false)
    }

    /// As [`of`](Self::of), where some rows are remarks: there to read, but no data.
    ///
    /// # Errors
    /// [`ReportError::Frame`] if polars cannot hold the rows.
    pub fn with_remarks<R>(
        caption: String,
        rows: &[R],
        columns: &[Column<'_, R>],
        is_remark: impl Fn(&R) -> bool,
    ) -> Result<Self, ReportError> {
        let counted: Vec<&R> = rows.iter().filter(|row| !is_remark(row)).collect();
        let series: Vec<_> = columns.iter().filter_map(|column| column.series(&counted)).collect();
        let cells = |row: &R| columns.iter().filter_map(|column| column.cell(row)).collect();
        let table = Table {
            caption,
            columns: columns.iter().filter_map(Column::header).collect(),
            rows: rows.iter().map(cells).collect(),
        };
        let height = if series.is_empty() { 0 } else { counted.len() };
        Ok(Self {
            data: DataFrame::new(height, series)?,
            dictionary: columns.iter().filter_map(Column::info).collect(),
            table,
        })
    }

    /// Whether there is anything to read.
    pub fn is_shown(&self) -> bool {
        !self.table.columns.is_empty() && !self.table.rows.is_empty()
    }

    /// The dictionary as a table in Markdown.
    pub fn dictionary_markdown(&self) -> String {
        let row =
            |ColumnInfo { name, kind, meaning }: &ColumnInfo| format!("| `{name}` | {kind} | {meaning} |\n");
        let rows: String = self.dictionary.iter().map(row).collect();
        format!("| Column | Type | Meaning |\n| --- | --- | --- |\n{rows}")
    }
}
