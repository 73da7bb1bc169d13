//! What the report was told.

use super::{Artefact, Section};
use crate::analysis::options::ReportOptions;
use crate::analysis::whole::Analysis;
use crate::error::ReportError;
use crate::render::table::{Column, Sheet};

const SECTION: Section = Section::Named { id: "options", title: "Options of this report" };

pub(super) const ROW: Artefact = Artefact::table("options", SECTION, "option", sheet);

/// An option, its value and what it decides.
type Row = (&'static str, String, &'static str);

fn sheet(analysis: &Analysis<'_>) -> Result<Sheet, ReportError> {
    let columns = [
        Column::only_named("Option", |row: &Row| row.0.to_owned()),
        Column::only_named("Value", |row: &Row| row.1.clone()),
        Column::only_named("What it decides", |row: &Row| row.2.to_owned()),
    ];
    Sheet::of("What this report was made with.".to_owned(), &rows(analysis.options), &columns)
}

fn rows(options: &ReportOptions) -> Vec<Row> {
    // The catalogue is no option of whoever asks for a report.
    let ReportOptions { window, resampling, margin, fewest_pairs, failures, mixed_students, .. } = options;
    let answer = |yes: bool| if yes { "yes" } else { "no" }.to_owned();
    let names = |ids: &[String]| if ids.is_empty() { "all".to_owned() } else { ids.join(", ") };
    vec![
        ("window", window.to_string(), "evaluations at the end of a run that its final success averages"),
        ("confidence", resampling.confidence.to_string(), "coverage of intervals, and what verdicts keep"),
        (
            "margin",
            margin.to_string(),
            "largest difference of success rates that claims of no difference call none",
        ),
        (
            "fewest pairs",
            fewest_pairs.to_string(),
            "pairs of runs that a verdict needs, over all environments",
        ),
        ("failures", failures.as_str().to_owned(), "runs that failed: success 0 from then on, or left out"),
        (
            "mixed students",
            answer(*mixed_students),
            "whether claims are judged where both sides train different students",
        ),
        ("environments", names(&options.environments), "those that the report is about"),
        ("curricula", names(&options.curricula), "those that the report is about"),
        (
            "bands",
            options.bands.as_str().to_owned(),
            "of learning curves: the standard deviation over seeds (std), the standard error of the mean (sem) or Student's \
             interval of the mean (ci)",
        ),
        ("zoom", answer(options.zoom), "whether axes of rates span what there is to see, and not 0 to 1"),
        (
            "diagnostics",
            answer(options.diagnostics),
            "whether students' losses, values and gradients and teachers' numbers are drawn",
        ),
        (
            "resamples",
            resampling.resamples.to_string(),
            "of bootstraps, and of sign flips too many to enumerate",
        ),
    ]
}
