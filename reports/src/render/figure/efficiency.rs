//! Sample efficiency: the interquartile mean over environments while runs train.

use super::legend::Label;
use super::page::Page;
use super::palette::Palette;
use super::panel::{Content, Mark, Series, XAxis};
use super::ticks;
use crate::analysis::efficiency::Efficiency;
use crate::analysis::group::GroupKey;
use crate::error::ReportError;
use crate::stats::Resampling;

/// A figure of the sample-efficiency curves of all methods over `environments` environments, as SVG. `keys`
/// are those of the whole report, which settle the looks.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn efficiency<'a>(
    curves: &[Efficiency<'_>],
    environments: usize,
    resampling: Resampling,
    keys: impl IntoIterator<Item = &'a GroupKey>,
) -> Result<String, ReportError> {
    let palette = Palette::new(keys);
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
    let has_bands = curves.iter().any(|curve| curve.intervals.is_some());
    let bands = if has_bands {
        let percent = resampling.confidence * 100.0;
        format!("bands: pointwise {percent} % stratified bootstrap intervals over seeds")
    } else {
        "no bands: single seeds in some environment".to_owned()
    };
    Page {
        panels: vec![Content {
            title: format!("Sample efficiency, {environments} environments"),
            x: XAxis {
                name: "Share of the steps that all runs have taken",
                end: 1.0,
                ticks: ticks::shares(),
                label: ticks::share_label,
            },
            y_name: "IQM of the success rate",
            series: curves.iter().map(series).collect(),
        }],
        legend: curves.iter().map(|curve| (label(curve), palette.look(curve.method))).collect(),
        caption: bands,
    }
    .draw()
}
