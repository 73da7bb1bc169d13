//! Learning curves: mean ± standard deviation of the success rate over training.

use super::legend::Label;
use super::page::Page;
use super::palette::Palette;
use super::panel::{Content, Mark, Series, XAxis};
use super::{caption, ticks};
use crate::analysis::curves::{Curve, Point, Progress};
use crate::analysis::group::GroupKey;
use crate::error::ReportError;
use looks::Look;

/// A panel of learning curves.
#[derive(Clone, Debug)]
pub struct LearningPanel<'a> {
    /// What stands above it.
    pub title: String,
    /// Its curves, the most important first.
    pub curves: Vec<&'a Curve>,
}

/// A panel for each environment of `curves`, which come sorted by key.
pub fn by_environment<'a>(curves: &[&'a Curve]) -> Vec<LearningPanel<'a>> {
    let panel = |curves: &[&'a Curve]| LearningPanel {
        title: curves.first().map_or(String::new(), |curve| curve.key.environment.clone()),
        curves: curves.to_vec(),
    };
    curves.chunk_by(|a, b| a.key.environment == b.key.environment).map(panel).collect()
}

/// A figure of learning curves against `progress`, as SVG. `keys` are those of all curves of the report,
/// which settle the looks: a curriculum has the same colour in every figure. Points without a place on the
/// axis are left out.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn learning<'a>(
    panels: &[LearningPanel<'_>],
    keys: impl IntoIterator<Item = &'a GroupKey>,
    progress: Progress,
) -> Result<String, ReportError> {
    sheet(panels, &Palette::new(keys), progress)
}

/// As [`learning`] against environment steps, of the levels of an ablation: the variant `plain`, the default
/// setting, has the look of its curriculum.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn ablation<'a>(
    panels: &[LearningPanel<'_>],
    keys: impl IntoIterator<Item = &'a GroupKey>,
    plain: &'a str,
) -> Result<String, ReportError> {
    sheet(panels, &Palette::around(keys, plain), Progress::EnvironmentSteps)
}

fn sheet(
    panels: &[LearningPanel<'_>],
    palette: &Palette<'_>,
    progress: Progress,
) -> Result<String, ReportError> {
    // Narrow panels have room for fewer tick labels.
    let most_ticks = if panels.len() > 2 { 4 } else { 6 };
    let curves: Vec<&Curve> = panels.iter().flat_map(|panel| panel.curves.iter().copied()).collect();
    let mut caption = caption::of(&curves);
    if progress == Progress::Hours {
        caption.push_str("; time: mean over seeds, evaluations included");
    }
    Page {
        panels: panels.iter().map(|panel| content(panel, palette, progress, most_ticks)).collect(),
        legend: legend(&curves, panels.len(), palette),
        caption,
    }
    .draw()
}

fn content(panel: &LearningPanel<'_>, palette: &Palette<'_>, progress: Progress, most_ticks: u64) -> Content {
    let points = panel.curves.iter().flat_map(|curve| &curve.points);
    let last = points.filter_map(|point| point.at(progress)).fold(0.0, f64::max);
    let series = |curve: &&Curve| Series {
        marks: curve.points.iter().filter_map(|point| mark(point, progress)).collect(),
        look: palette.look(&curve.key),
    };
    Content {
        title: panel.title.clone(),
        x: axis(progress, last, most_ticks),
        y_name: "Success rate",
        series: panel.curves.iter().map(series).collect(),
    }
}

/// An axis up to `last`; up to 1 where that is 0, so that a lone evaluation of the untrained student has an
/// axis.
fn axis(progress: Progress, last: f64, most_ticks: u64) -> XAxis {
    let end = if last > 0.0 { last } else { 1.0 };
    let (name, ticks, label): (_, _, fn(f64) -> String) = match progress {
        Progress::EnvironmentSteps => {
            ("Environment steps", ticks::steps(end as u64, most_ticks), ticks::label)
        }
        Progress::GradientSteps => ("Gradient steps", ticks::steps(end as u64, most_ticks), ticks::label),
        Progress::Hours => {
            ("Wall-clock time in hours", ticks::reals(end, most_ticks), |hours| hours.to_string())
        }
    };
    XAxis { name, end, ticks, label }
}

fn mark(point: &Point, progress: Progress) -> Option<Mark> {
    let band = point.std.map(|std| (point.mean - std, point.mean + std));
    Some(Mark { x: point.at(progress)?, y: point.mean, band })
}

/// Every curriculum and variant among the curves once, in order. Where the numbers of seeds differ, and each
/// label stands for one curve, labels say how many there are.
fn legend(curves: &[&Curve], panels: usize, palette: &Palette<'_>) -> Vec<(Label, Look)> {
    let mut methods: Vec<&Curve> = curves.to_vec();
    methods.sort_by(|a, b| a.key.cmp_method(&b.key));
    methods.dedup_by(|a, b| a.key.cmp_method(&b.key).is_eq());
    let uneven = curves.iter().any(|curve| curve.seeds() != curves[0].seeds());
    let label = |curve: &Curve| {
        let mut detail = curve.key.detail();
        if panels == 1 && uneven {
            detail.push_str(&format!(", n = {}", caption::range(curve.seeds())));
        }
        Label { title: curve.key.curriculum.title.clone(), detail }
    };
    methods.iter().map(|curve| (label(curve), palette.look(&curve.key))).collect()
}
