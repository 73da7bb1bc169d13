//! What settings make of each method: a row per method, a dot per trial of a search.

use super::forest::{Column, Dots, Forest};
use super::style::Style;
use crate::analysis::tuning::TunedPlace;
use crate::error::ReportError;
use crate::schema::Tuning;
use crate::wording::counted;

/// Scores of all trials in one environment, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn trials(rows: &[TunedPlace<'_>], tuning: &Tuning, style: &Style) -> Result<String, ReportError> {
    let estimate =
        |row: &TunedPlace<'_>| row.on_search_seeds().map_or((0.0, None), |place| (place.score, None));
    let dots = |row: &TunedPlace<'_>| Dots { all: row.drawn(), chosen: row.chosen() };
    let (name, environment) =
        (capital(tuning.measure.in_words()), rows.first().map_or("", |row| row.key.environment.as_str()));
    let (estimates, dots) = (rows.iter().map(estimate).collect(), rows.iter().map(dots).collect());
    Forest {
        rows: rows.iter().map(|row| (row.key.name(), style.palette.look(&row.key))).collect(),
        columns: vec![Column::with_dots(environment, &name, estimates, dots, style)],
        caption: format!(
            "large markers: default settings; dots: trials, means over {} of the search; ring: the chosen trial, best over all \
             environments",
            counted(tuning.seeds.len(), "seed")
        ),
    }
    .draw()
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
