//! Sample efficiency: the interquartile mean over environments while runs train.

use super::basis::Basis;
use super::legend::Label;
use super::page::Page;
use super::panel::{self, Content, Mark, Series, XAxis};
use super::style::Style;
use super::ticks;
use crate::analysis::efficiency::Efficiency;
use crate::error::ReportError;
use crate::wording::counted;

/// A figure of the sample-efficiency curves of all methods, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn efficiency(
    curves: &[Efficiency<'_>],
    basis: &Basis<'_>,
    style: &Style,
) -> Result<String, ReportError> {
    let palette = &style.palette;
    let series = |curve: &Efficiency<'_>| {
        let band =
            |index: usize| curve.intervals.as_ref().and_then(|intervals| intervals.get(index).copied());
        let points = curve.shares.iter().zip(&curve.iqm).enumerate();
        Series {
            marks: points.map(|(index, (&x, &y))| Mark { x, y, band: band(index) }).collect(),
            look: palette.look(curve.method),
        }
    };
    let label = |curve: &Efficiency<'_>| Label {
        title: curve.method.curriculum.title.clone(),
        detail: curve.method.detail(),
    };
    let bands = if curves.iter().any(|curve| curve.intervals.is_some()) {
        format!("bands: pointwise {}", basis.intervals())
    } else {
        "no bands: single seeds in some environment".to_owned()
    };
    let series: Vec<Series> = curves.iter().map(series).collect();
    Page {
        panels: vec![Content {
            title: format!("Sample efficiency, {}", counted(basis.environments, "environment")),
            x: XAxis {
                name: "Share of the steps that all runs have taken",
                end: 1.0,
                ticks: ticks::shares(),
                label: ticks::share_label,
            },
            y: panel::rates("IQM of the success rate", style, &series),
            series,
        }],
        legend: curves.iter().map(|curve| (label(curve), palette.look(curve.method))).collect(),
        caption: format!(
            "success rate of single evaluations, not smoothed, on a line in between; {}; {bands}",
            basis.runs()
        ),
    }
    .draw()
}
