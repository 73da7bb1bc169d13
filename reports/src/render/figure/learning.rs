//! Learning curves: mean and band of the success rate over training.

use super::band::Band;
use super::legend::Label;
use super::page::Page;
use super::palette::Palette;
use super::panel::{Content, Mark, Series, XAxis};
use super::style::Style;
use super::{caption, panel, ticks};
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

/// A figure of learning curves against `progress`, as SVG. Points without a place on the axis are left out.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn learning(
    panels: &[LearningPanel<'_>],
    style: &Style,
    progress: Progress,
) -> Result<String, ReportError> {
    sheet(panels, &Drawn { style, look: Palette::look }, progress)
}

/// As [`learning`] against environment steps, of the levels of an ablation, which stand in the place of
/// variants.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn ablation(panels: &[LearningPanel<'_>], style: &Style) -> Result<String, ReportError> {
    sheet(panels, &Drawn { style, look: Palette::level }, Progress::EnvironmentSteps)
}

/// How curves are drawn.
struct Drawn<'a> {
    style: &'a Style,
    look: fn(&Palette, &GroupKey) -> Look,
}

impl Drawn<'_> {
    fn look(&self, curve: &Curve) -> Look {
        (self.look)(&self.style.palette, &curve.key)
    }
}

fn sheet(panels: &[LearningPanel<'_>], drawn: &Drawn<'_>, progress: Progress) -> Result<String, ReportError> {
    // Narrow panels have room for fewer tick labels.
    let most_ticks = if panels.len() > 2 { 4 } else { 6 };
    let curves: Vec<&Curve> = panels.iter().flat_map(|panel| panel.curves.iter().copied()).collect();
    let unit = TimeUnit::fit(last(&curves, Progress::Hours));
    let mut caption = caption::of(&curves, drawn.style.band);
    if progress == Progress::Hours {
        caption.push_str("; time: mean over seeds, evaluations included");
    }
    Page {
        panels: panels.iter().map(|panel| content(panel, drawn, progress, most_ticks, unit)).collect(),
        legend: legend(&curves, panels.len(), drawn),
        caption,
    }
    .draw()
}

/// How far the curves go.
fn last(curves: &[&Curve], progress: Progress) -> f64 {
    let points = curves.iter().flat_map(|curve| &curve.points);
    points.filter_map(|point| point.at(progress)).fold(0.0, f64::max)
}

fn content(
    panel: &LearningPanel<'_>,
    drawn: &Drawn<'_>,
    progress: Progress,
    most_ticks: u64,
    unit: TimeUnit,
) -> Content {
    let series = |curve: &&Curve| Series {
        marks: curve.points.iter().filter_map(|point| mark(point, progress, drawn.style.band)).collect(),
        look: drawn.look(curve),
    };
    let series: Vec<Series> = panel.curves.iter().map(series).collect();
    Content {
        title: panel.title.clone(),
        x: axis(progress, last(&panel.curves, progress), most_ticks, unit),
        y: panel::rates("Success rate", drawn.style, &series),
        series,
    }
}

/// How hours are written on an axis.
#[derive(Clone, Copy)]
struct TimeUnit {
    name: &'static str,
    per_hour: f64,
    /// Hours in this unit.
    label: fn(f64) -> String,
}

/// From short to long.
static TIME_UNITS: [TimeUnit; 3] = [
    TimeUnit { name: "Wall-clock time in seconds", per_hour: 3600.0, label: |hours| rounded(hours * 3600.0) },
    TimeUnit { name: "Wall-clock time in minutes", per_hour: 60.0, label: |hours| rounded(hours * 60.0) },
    TimeUnit { name: "Wall-clock time in hours", per_hour: 1.0, label: rounded },
];

/// Without what is left of turning one unit into another.
fn rounded(value: f64) -> String {
    ((value * 1e6).round() / 1e6).to_string()
}

impl TimeUnit {
    /// The first unit that has at most 100 of it in `hours`.
    fn fit(hours: f64) -> Self {
        let fits = |unit: &&Self| hours * unit.per_hour <= 100.0;
        *TIME_UNITS.iter().find(fits).unwrap_or(&TIME_UNITS[2])
    }
}

/// An axis up to `last`; up to 1 where that is 0, so that a lone evaluation of the untrained student has an
/// axis. Hours are labelled in `unit`, which all panels of a figure share.
fn axis(progress: Progress, last: f64, most_ticks: u64, unit: TimeUnit) -> XAxis {
    let end = if last > 0.0 { last } else { 1.0 };
    let steps = |name| XAxis { name, end, ticks: ticks::steps(end as u64, most_ticks), label: ticks::label };
    match progress {
        Progress::EnvironmentSteps => steps("Environment steps"),
        Progress::AllSteps => steps("All steps taken"),
        Progress::GradientSteps => steps("Gradient steps"),
        Progress::Hours => {
            // Round in the unit that is shown.
            let end_in_units = (end * unit.per_hour * 1e6).round() / 1e6;
            let ticks = ticks::reals(end_in_units, most_ticks).into_iter();
            let ticks = ticks.map(|tick| tick / unit.per_hour).collect();
            XAxis { name: unit.name, end, ticks, label: unit.label }
        }
    }
}

fn mark(point: &Point, progress: Progress, band: Band) -> Option<Mark> {
    Some(Mark { x: point.at(progress)?, y: point.mean, band: band.at(point) })
}

/// Every curriculum and variant among the curves once, in order. Where the numbers of seeds differ, and each
/// label stands for one curve, labels say how many there are.
fn legend(curves: &[&Curve], panels: usize, drawn: &Drawn<'_>) -> Vec<(Label, Look)> {
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
    methods.iter().map(|curve| (label(curve), drawn.look(curve))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_labelled_in_the_unit_that_fits() {
        let said = |hours: f64| {
            let axis = axis(Progress::Hours, hours, 4, TimeUnit::fit(hours));
            (axis.name, axis.ticks.iter().map(|tick| (axis.label)(*tick)).collect::<Vec<_>>().join(" "))
        };
        assert_eq!(said(30.0 / 3600.0), ("Wall-clock time in seconds", "0 10 20 30".to_owned()));
        assert_eq!(said(0.5), ("Wall-clock time in minutes", "0 10 20 30".to_owned()));
        assert_eq!(said(2.78), ("Wall-clock time in hours", "0 1 2".to_owned()));
        // A panel of less than a minute beside one of half an hour.
        let short = axis(Progress::Hours, 36.0 / 3600.0, 4, TimeUnit::fit(0.5));
        assert_eq!(
            (short.name, (short.label)(short.ticks[1])),
            ("Wall-clock time in minutes", "0.2".to_owned())
        );
    }
}
