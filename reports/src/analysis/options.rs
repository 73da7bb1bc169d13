//! What a report can be told.

use crate::analysis::catalogue::{Catalogue, MazeInfo};
use crate::error::ReportError;
use crate::stats::Resampling;

/// How a report is made, and of what.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportOptions {
    /// Evaluations of a seed that its final score averages, and that steps to a success rate look back on.
    pub window: usize,
    /// How bootstrap intervals are made.
    pub resampling: Resampling,
    /// What is known of methods, environments and the paper.
    pub catalogue: Catalogue,
}

impl Default for ReportOptions {
    /// The last 5 evaluations; [`Resampling::default`]; an empty catalogue.
    fn default() -> Self {
        Self { window: 5, resampling: Resampling::default(), catalogue: Catalogue::default() }
    }
}

impl ReportOptions {
    /// # Errors
    /// [`ReportError::Option`], naming the field and what is accepted.
    pub(crate) fn check(&self) -> Result<(), ReportError> {
        let wrong = |option, value: String, accepted| Err(ReportError::Option { option, value, accepted });
        let Resampling { resamples, confidence, .. } = self.resampling;
        if self.window == 0 {
            return wrong("window", "0".into(), "at least 1 evaluation");
        }
        if resamples == 0 {
            return wrong("resampling.resamples", "0".into(), "at least 1 resample");
        }
        if !(confidence > 0.0 && confidence < 1.0) {
            return wrong("resampling.confidence", confidence.to_string(), "a number in (0, 1)");
        }
        self.catalogue.mazes.iter().try_for_each(MazeInfo::check)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_outside_their_range_are_named() {
        let options = ReportOptions { window: 0, ..ReportOptions::default() };
        let error = options.check().unwrap_err();
        assert_eq!(error.to_string(), "option window is 0; expected at least 1 evaluation");
    }
}
