//! Recorded numbers over training: a panel per number, each with an axis of its own.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Axis, draw_mesh};
use super::canvas::{self, MARGIN, PAGE_WIDTH};
use super::legend::{Label, Legend};
use super::palette::Palette;
use super::shapes::{self, Area, DrawResult};
use super::{caption, page, text, ticks};
use crate::analysis::curves::DDOF;
use crate::analysis::group::GroupKey;
use crate::analysis::numbers::{NumberCurve, NumberPlot, NumberPlots, NumberPoint};
use crate::error::ReportError;

/// Text sizes in points.
const TITLE: f64 = 8.0;
/// Lengths in pixels.
const COLUMNS: usize = 3;
const PLOT_HEIGHT: i32 = 340;
const TITLE_HEIGHT: i32 = 56;
const X_TICKS_HEIGHT: i32 = 50;
const Y_TICKS_WIDTH: i32 = 130;
const RIGHT_MARGIN: i32 = 44;
const X_NAME_HEIGHT: i32 = 44;
const GAP: i32 = 18;
/// Room above and below curves, as a share of their range.
const ROOM: f64 = 0.06;
/// Markers per curve, about.
const MARKERS: usize = 6;

/// The numbers of one environment, as SVG, with the report's looks; `what` says in the caption what the
/// numbers are.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn numbers(plots: &NumberPlots, palette: &Palette, what: &str) -> Result<String, ReportError> {
    text::register()?;
    let columns = plots.plots.len().clamp(1, COLUMNS) as i32;
    let width = (PAGE_WIDTH - 2 * MARGIN) / COLUMNS as i32 * columns + 2 * MARGIN;
    let legend = Legend::new(&entries(plots, palette), width - 2 * MARGIN)?;
    let caption = page::caption_lines(&caption_of(plots, what), width)?;
    let height = TITLE_HEIGHT + PLOT_HEIGHT + X_TICKS_HEIGHT;
    let rows = plots.plots.len().div_ceil(columns as usize) as i32;
    let below = MARGIN + rows * (height + GAP);
    let legend_top = below + X_NAME_HEIGHT + GAP;
    let caption_top = legend_top + legend.height() + GAP;
    let size = ((width - 2 * MARGIN) / columns, height);
    let end = points(plots.plots.iter()).map(|point| point.step).fold(0.0, f64::max);
    let end = if end > 0.0 { end } else { 1.0 };
    canvas::svg((width, caption_top + page::caption_height(&caption)), |root| {
        for (index, plot) in (0..).zip(&plots.plots) {
            let at = (MARGIN + index % columns * size.0, MARGIN + index / columns * (height + GAP));
            let title = text::shorten(&plot.name, &text::style(TITLE), size.0 - Y_TICKS_WIDTH)?;
            Panel { plot, end, at, size }
                .draw(root, &title, palette)
                .map_err(ReportError::figure(&plot.name))?;
        }
        let name = text::style(TITLE).pos(Pos::new(HPos::Center, VPos::Top));
        root.draw_text("Environment steps", &name, (width / 2, below)).map_err(canvas::failed("axis"))?;
        legend.draw(root, width / 2, legend_top)?;
        page::draw_caption(root, &caption, (width / 2, caption_top))
    })
}

fn points<'a>(plots: impl Iterator<Item = &'a NumberPlot>) -> impl Iterator<Item = &'a NumberPoint> {
    plots.flat_map(|plot| &plot.curves).flat_map(|curve| &curve.points)
}

/// Every method with a curve, once.
fn entries(plots: &NumberPlots, palette: &Palette) -> Vec<(Label, looks::Look)> {
    let mut keys: Vec<&GroupKey> =
        plots.plots.iter().flat_map(|plot| &plot.curves).map(|curve| &curve.key).collect();
    keys.sort_by(|a, b| a.cmp_method(b));
    keys.dedup_by(|a, b| a.cmp_method(b).is_eq());
    let label = |key: &GroupKey| Label { title: key.curriculum.title.clone(), detail: key.detail() };
    keys.into_iter().map(|key| (label(key), palette.look(key))).collect()
}

fn caption_of(plots: &NumberPlots, what: &str) -> String {
    let n = || points(plots.plots.iter()).map(|point| point.n);
    let seeds = (n().min().unwrap_or(0), n().max().unwrap_or(0));
    let spread = match seeds.1 {
        0 | 1 => "one seed, no band".to_owned(),
        _ => format!("mean ± std over {} seeds (ddof = {DDOF})", caption::range(seeds)),
    };
    format!("{}: {what}; {spread}", text::printable(&plots.environment))
}

/// A panel in its place, with an axis up to `end` steps.
struct Panel<'a> {
    plot: &'a NumberPlot,
    end: f64,
    /// Top left corner in pixels.
    at: (i32, i32),
    /// Width and height in pixels.
    size: (i32, i32),
}

impl Panel<'_> {
    fn draw(&self, root: &Area<'_>, title: &str, palette: &Palette) -> DrawResult {
        let (left, top) = self.at;
        let centre = left + (Y_TICKS_WIDTH + self.size.0 - RIGHT_MARGIN) / 2;
        let above = Pos::new(HPos::Center, VPos::Bottom);
        root.draw_text(title, &text::style(TITLE).pos(above), (centre, top + TITLE_HEIGHT - 4))?;
        let plot = root
            .clone()
            .shrink((left, top + TITLE_HEIGHT), (self.size.0 - RIGHT_MARGIN, self.size.1 - TITLE_HEIGHT));
        let (low, high) = range(&self.plot.curves);
        let mut chart = ChartBuilder::on(&plot)
            .y_label_area_size(Y_TICKS_WIDTH)
            .x_label_area_size(X_TICKS_HEIGHT)
            .build_cartesian_2d(
                Axis { range: 0.0..self.end, ticks: ticks::steps(self.end as u64, 4) },
                Axis { range: low..high, ticks: ticks::between(low, high, 4) },
            )?;
        draw_mesh(&mut chart, &|tick| ticks::label(tick), &|tick| ticks::number(tick))?;
        let pixel = |x: f64, y: f64| chart.backend_coord(&(x, y.clamp(low, high)));
        for curve in self.plot.curves.iter().rev() {
            draw_bands(root, curve, palette, &pixel)?;
        }
        let count = self.plot.curves.len().max(1) as f64;
        for (index, curve) in self.plot.curves.iter().enumerate().rev() {
            draw_line(root, curve, palette, index as f64 / count, &pixel)?;
        }
        Ok(())
    }
}

/// Lower and upper end of the axis of these curves: their means and bands, with some room.
fn range(curves: &[NumberCurve]) -> (f64, f64) {
    let points = curves.iter().flat_map(|curve| &curve.points);
    let edges = points.flat_map(|point| {
        let std = point.std.unwrap_or(0.0);
        [point.mean - std, point.mean + std]
    });
    let (low, high) = edges.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
    // A number that never changes lies in the middle of an axis around it.
    let room = if high > low { ROOM * (high - low) } else { 0.1 * low.abs().max(1e-3) };
    (low - room, high + room)
}

/// The band, wherever neighbouring points have one.
fn draw_bands(
    root: &Area<'_>,
    curve: &NumberCurve,
    palette: &Palette,
    pixel: &impl Fn(f64, f64) -> (i32, i32),
) -> DrawResult {
    for run in curve.points.chunk_by(|a, b| a.std.is_some() == b.std.is_some()) {
        let edges = run.iter().filter_map(|point| {
            let std = point.std?;
            Some((pixel(point.step, point.mean - std), pixel(point.step, point.mean + std)))
        });
        let (lower, upper): (Vec<_>, Vec<_>) = edges.unzip();
        if lower.len() > 1 {
            shapes::band(root, &lower, &upper, palette.look(&curve.key))?;
        }
    }
    Ok(())
}

/// The line, with markers whose `phase` in [0, 1) differs between lines: equal lines stay visible.
fn draw_line(
    root: &Area<'_>,
    curve: &NumberCurve,
    palette: &Palette,
    phase: f64,
    pixel: &impl Fn(f64, f64) -> (i32, i32),
) -> DrawResult {
    let look = palette.look(&curve.key);
    let points: Vec<(i32, i32)> = curve.points.iter().map(|point| pixel(point.step, point.mean)).collect();
    if points.len() > 1 {
        shapes::line(root, &points, look)?;
    }
    let stride = points.len().div_ceil(MARKERS).max(1);
    let first = (1 + (phase * stride as f64) as usize).min(points.len().saturating_sub(1));
    for at in points.iter().skip(first).step_by(stride) {
        shapes::marker(root, *at, look)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;

    #[test]
    fn axes_hold_means_and_bands() {
        let key = GroupKey::new(&Catalogue::default(), "E", "c", "default");
        let curve = |points: &[(f64, Option<f64>)]| NumberCurve {
            key: key.clone(),
            points: points.iter().map(|&(mean, std)| NumberPoint { step: 0.0, n: 1, mean, std }).collect(),
        };
        let (low, high) = range(&[curve(&[(1.0, Some(2.0))]), curve(&[(9.0, None)])]);
        assert!((low + 1.6).abs() < 1e-12 && (high - 9.6).abs() < 1e-12, "{low} to {high}");
        let (low, high) = range(&[curve(&[(0.0, None)])]);
        assert!(low < 0.0 && high > 0.0);
    }
}
