//! Performance profiles: the share of runs that reach more than each success rate.

use super::basis::Basis;
use super::legend::Label;
use super::page::Page;
use super::panel::{self, Content, Mark, Series, XAxis};
use super::style::Style;
use super::ticks;
use crate::analysis::aggregate::Profile;
use crate::error::ReportError;
use crate::wording::counted;

/// A figure of the profiles of all methods, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn profiles(profiles: &[Profile<'_>], basis: &Basis<'_>, style: &Style) -> Result<String, ReportError> {
    let palette = &style.palette;
    let series = |profile: &Profile<'_>| {
        let bands: Vec<Option<(f64, f64)>> = match &profile.intervals {
            Some(intervals) => intervals.iter().copied().map(Some).collect(),
            None => vec![None; profile.shares.len()],
        };
        let marks = profile.thresholds.iter().zip(&profile.shares).zip(bands);
        Series {
            marks: marks.map(|((&x, &y), band)| Mark { x, y, band }).collect(),
            look: palette.look(profile.method),
        }
    };
    let label = |profile: &Profile<'_>| Label {
        title: profile.method.curriculum.title.clone(),
        detail: profile.method.detail(),
    };
    let x =
        XAxis { name: "Final success rate τ", end: 1.0, ticks: ticks::shares(), label: ticks::share_label };
    let series: Vec<Series> = profiles.iter().map(series).collect();
    Page {
        panels: vec![Content {
            title: format!("Performance profiles, {}", counted(basis.environments, "environment")),
            x,
            y: panel::rates("Share of runs above τ", style, &series),
            series,
        }],
        legend: profiles.iter().map(|profile| (label(profile), palette.look(profile.method))).collect(),
        caption: caption(profiles, basis),
    }
    .draw()
}

fn caption(profiles: &[Profile<'_>], basis: &Basis<'_>) -> String {
    let bands = format!("bands: pointwise {}", basis.intervals());
    let bands = match profiles.iter().filter(|profile| profile.intervals.is_none()).count() {
        0 => bands,
        all if all == profiles.len() => "no bands: single seeds in some environment".to_owned(),
        _ => format!("{bands}; none for methods with a single seed in some environment"),
    };
    format!("{}; {bands}", basis.runs())
}
