//! What a report can be told.

use crate::analysis::catalogue::{Catalogue, MazeInfo};
use crate::error::ReportError;
use crate::stats::Resampling;

/// How a report is made, and of what.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportOptions {
    /// Evaluations of a seed that its final score averages, and that steps to a success rate look back on.
    pub window: usize,
    /// How intervals are made, and the confidence that verdicts keep.
    pub resampling: Resampling,
    /// The difference of success rates that no claim of smallness calls small: "does not depend on" is
    /// confirmed by intervals within ± this.
    pub margin: f64,
    /// Pairs of seeds that a comparison over all environments needs.
    pub fewest_pairs: usize,
    /// What a run counts that broke down.
    pub failures: Failures,
    /// Whether methods that train different students are judged against each other all the same.
    pub mixed_students: bool,
    /// Whether figures of students' losses, values and gradients and of teachers' numbers are drawn.
    pub diagnostics: bool,
    /// Environments that the report is about, by id; empty: all of the results.
    pub environments: Vec<String>,
    /// Curricula that the report is about, by id; empty: all of the results.
    pub curricula: Vec<String>,
    /// What stands above the report; `None`: the names of the protocols.
    pub title: Option<String>,
    /// Whether axes of rates span what there is to see, and not 0 to 1.
    pub zoom: bool,
    /// What the bands of learning curves show.
    pub bands: Bands,
    /// What is known of methods, environments and the paper.
    pub catalogue: Catalogue,
}

/// What a run counts whose training broke down: its loss was no longer finite, say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Failures {
    /// Success 0 from the failure on: whoever trains by this method gets nothing from it.
    #[default]
    Zero,
    /// Nothing: it is left out of comparisons, and its number is said beside them.
    Apart,
}

impl Failures {
    /// All, as they are written in options.
    pub const ALL: [Self; 2] = [Self::Zero, Self::Apart];

    /// As in options: `zero`, `apart`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Apart => "apart",
        }
    }
}

/// What the bands around the means of learning curves show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bands {
    /// One standard deviation over seeds up and down.
    #[default]
    Std,
    /// One standard error of the mean up and down.
    Sem,
    /// Student's interval of the mean, with the confidence of the report's other intervals. Near 0 and 1, and
    /// of few seeds, it covers less than that.
    Ci,
}

impl Bands {
    /// All, as they are written in options.
    pub const ALL: [Self; 3] = [Self::Std, Self::Sem, Self::Ci];

    /// As in options: `std`, `sem`, `ci`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Std => "std",
            Self::Sem => "sem",
            Self::Ci => "ci",
        }
    }
}

/// [`ReportOptions::margin`] where nothing else is asked for.
pub const MARGIN: f64 = 0.1;

/// [`ReportOptions::fewest_pairs`] where nothing else is asked for: below, no test of an interval of 95 %
/// could refuse anything.
pub const FEWEST_PAIRS: usize = 5;

impl Default for ReportOptions {
    /// The last 5 evaluations; [`Resampling::default`]; [`MARGIN`]; [`FEWEST_PAIRS`]; failures count 0;
    /// different students are not judged; no diagnostics; all runs; axes from 0 to 1; bands of one standard
    /// deviation; an empty catalogue.
    fn default() -> Self {
        Self {
            window: 5,
            resampling: Resampling::default(),
            margin: MARGIN,
            fewest_pairs: FEWEST_PAIRS,
            failures: Failures::default(),
            mixed_students: false,
            diagnostics: false,
            environments: Vec::new(),
            curricula: Vec::new(),
            title: None,
            zoom: false,
            bands: Bands::default(),
            catalogue: Catalogue::default(),
        }
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
        if !(self.margin > 0.0 && self.margin < 1.0) {
            return wrong("margin", self.margin.to_string(), "a difference of success rates in (0, 1)");
        }
        if self.fewest_pairs == 0 {
            return wrong("fewest_pairs", "0".into(), "at least 1 pair of seeds");
        }
        self.catalogue.mazes.iter().try_for_each(MazeInfo::check)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_outside_their_range_are_named() {
        let text = |options: ReportOptions| options.check().unwrap_err().to_string();
        let options = ReportOptions { window: 0, ..ReportOptions::default() };
        assert_eq!(text(options), "option window is 0; expected at least 1 evaluation");
        let options = ReportOptions { margin: 1.0, ..ReportOptions::default() };
        assert_eq!(text(options), "option margin is 1; expected a difference of success rates in (0, 1)");
        let options = ReportOptions { fewest_pairs: 0, ..ReportOptions::default() };
        assert_eq!(text(options), "option fewest_pairs is 0; expected at least 1 pair of seeds");
        assert!(ReportOptions::default().check().is_ok());
    }
}
