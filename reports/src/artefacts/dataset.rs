//! The runs and evaluations of a results folder as tidy data alone, without figures.

use std::path::{Path, PathBuf};

use super::made::make;
use super::report::{columns_of, data};
use super::{records, runs};
use crate::analysis::groups::Groups;
use crate::analysis::options::ReportOptions;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::store::Store;
use crate::store::protocols::ProtocolCopy;

/// Tidy data, and what its columns mean.
#[derive(Clone, Debug, PartialEq)]
pub struct TidyData {
    /// Parquet files: name and content.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// What every column of every file means, as Markdown.
    pub columns: String,
}

/// The evaluations and the runs of `store`, which lies in the folder `results`, as Parquet. The same results
/// give the same bytes.
///
/// # Errors
/// [`ReportError::Option`], [`ReportError::Frame`].
pub fn tidy_data(results: &Path, store: &Store, options: &ReportOptions) -> Result<TidyData, ReportError> {
    options.check()?;
    let groups = Groups::of(store, &[], options);
    let protocols: [ProtocolCopy; 0] = [];
    let analysis = Analysis::of(results, (store, &protocols), &groups, options);
    let mut tidy = TidyData { files: Vec::new(), columns: String::new() };
    for row in [&records::ROW, &runs::ROW] {
        let made = make(row, &analysis)?;
        let is_parquet =
            |(path, _): &(PathBuf, Vec<u8>)| path.extension().is_some_and(|end| end == "parquet");
        tidy.files.extend(data(&made)?.into_iter().filter(is_parquet));
        tidy.columns += &columns_of(&made, &format!("{}.parquet", row.id)).unwrap_or_default();
    }
    Ok(tidy)
}
