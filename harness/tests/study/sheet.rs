//! Tables of a report as the program wrote them, row by row.

use std::fs::File;
use std::path::Path;

use polars::prelude::{AnyValue, CsvReadOptions, DataFrame, SerReader};

/// A table of a report.
pub(crate) struct Sheet(DataFrame);

/// A row of it.
#[derive(Clone, Copy)]
pub(crate) struct Row<'a> {
    frame: &'a DataFrame,
    index: usize,
}

impl Sheet {
    /// The table `name` of the report in `folder`.
    pub(crate) fn read(folder: &Path, name: &str) -> Self {
        let file = File::open(folder.join(format!("{name}.csv"))).expect("a table of the report");
        let all_rows = CsvReadOptions::default().with_infer_schema_length(None);
        Self(all_rows.into_reader_with_file_handle(file).finish().expect("CSV"))
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        (0..self.0.height()).map(|index| Row { frame: &self.0, index })
    }
}

impl Row<'_> {
    fn value(&self, column: &str) -> AnyValue<'_> {
        let column = self.frame.column(column).expect("a column of the table");
        column.get(self.index).expect("a row of the table")
    }

    /// The text in `column`; empty where the field is.
    pub(crate) fn text(&self, column: &str) -> String {
        match self.value(column) {
            AnyValue::Null => String::new(),
            value => value.get_str().expect("a column of text").to_owned(),
        }
    }

    /// The number in `column`; `None` where the field is empty.
    pub(crate) fn number(&self, column: &str) -> Option<f64> {
        match self.value(column) {
            AnyValue::Null => None,
            value => Some(value.try_extract().expect("a column of numbers")),
        }
    }
}
