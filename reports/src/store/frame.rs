//! All evaluations as one data frame.

use std::collections::BTreeSet;

use polars::prelude::{Column, DataFrame, NamedFrom, Series};

use super::Store;
use crate::error::ReportError;
use crate::schema::Record;

impl Store {
    /// One row per evaluation, ordered by run and step. Columns: the fields of [`Record`] in their order,
    /// then `teacher.NAME` for every number any teacher recorded, by name; null where a teacher has no such
    /// number.
    ///
    /// # Errors
    /// [`ReportError::Frame`] if polars cannot hold the data.
    pub fn frame(&self) -> Result<DataFrame, ReportError> {
        let records: Vec<&Record> = self.runs().iter().flat_map(|run| &run.records).collect();
        let mut columns = vec![
            column("environment", &records, |record| record.environment.as_str()),
            column("curriculum", &records, |record| record.curriculum.as_str()),
            column("variant", &records, |record| record.variant.as_str()),
            column("seed", &records, |record| record.seed),
            column("step", &records, |record| record.step),
            column("eval_index", &records, |record| record.eval_index),
            column("episodes", &records, |record| record.episodes),
            column("success_rate", &records, |record| record.success_rate),
            column("any_success_rate", &records, |record| record.any_success_rate),
            column("mean_return", &records, |record| record.mean_return),
            column("gradient_steps", &records, |record| record.gradient_steps),
        ];
        let names: BTreeSet<&String> = records.iter().flat_map(|record| record.teacher.keys()).collect();
        for name in names {
            let number = |record: &Record| record.teacher.get(name).and_then(serde_json::Value::as_f64);
            columns.push(column(&format!("teacher.{name}"), &records, number));
        }
        Ok(DataFrame::new(records.len(), columns)?)
    }
}

/// A column of one value per record.
fn column<'a, T>(name: &str, records: &[&'a Record], value: impl Fn(&'a Record) -> T) -> Column
where
    Series: NamedFrom<Vec<T>, [T]>,
{
    let values: Vec<T> = records.iter().map(|record| value(record)).collect();
    Column::new(name.into(), values)
}
