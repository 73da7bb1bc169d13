//! Axes and the lines between them.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Axis, draw_mesh};
use super::rates::RateAxis;
use super::shapes::{self, Area, DrawResult};
use super::style::Style;
use super::text;
use crate::error::ReportError;
use looks::Look;

/// Text sizes in points.
const TITLE: f64 = 9.0;
const AXIS: f64 = 8.0;

/// Heights and widths in pixels.
pub(super) const TITLE_HEIGHT: i32 = 56;
pub(super) const X_TICKS_HEIGHT: i32 = 50;
pub(super) const X_NAME_HEIGHT: i32 = 44;
pub(super) const Y_NAME_WIDTH: i32 = 46;
const Y_TICKS_WIDTH: i32 = 74;
/// Further room for every digit of a tick after the first behind the point.
const DIGIT_WIDTH: i32 = 20;
/// Half of the last tick's label sticks out by less than this.
const RIGHT_MARGIN: i32 = 44;

/// Room above and below, as a share of the y axis, so that curves at the limits do not hide in the frame.
const Y_ROOM: f64 = 0.04;
/// Markers per curve, about.
const MARKERS: usize = 6;

/// A point of a line.
#[derive(Clone, Copy)]
pub(super) struct Mark {
    pub(super) x: f64,
    /// In [0, 1].
    pub(super) y: f64,
    /// Lower and upper edge of the band here; cut at 0 and 1.
    pub(super) band: Option<(f64, f64)>,
}

/// A line of a panel, by rising x.
pub(super) struct Series {
    pub(super) marks: Vec<Mark>,
    pub(super) look: Look,
}

/// The x axis of a panel, from 0.
pub(super) struct XAxis {
    pub(super) name: &'static str,
    pub(super) end: f64,
    pub(super) ticks: Vec<f64>,
    /// What a tick says.
    pub(super) label: fn(f64) -> String,
}

/// What a panel shows: shares in [0, 1] over something.
pub(super) struct Content {
    pub(super) title: String,
    pub(super) x: XAxis,
    pub(super) y: RateAxis,
    /// The most important first: it is drawn on top.
    pub(super) series: Vec<Series>,
}

/// The axis of rates of a panel with these lines, bands included.
pub(super) fn rates(name: &str, style: &Style, series: &[Series]) -> RateAxis {
    let marks = || series.iter().flat_map(|line| &line.marks);
    let edges = marks().filter_map(|mark| mark.band).flat_map(|(low, high)| [low, high]);
    RateAxis::of(name, style.zoom, marks().map(|mark| mark.y).chain(edges))
}

/// A panel in its place.
pub(super) struct Panel<'a> {
    pub(super) content: &'a Content,
    /// Top left corner in pixels.
    pub(super) at: (i32, i32),
    /// Width and height in pixels, title and tick labels included.
    pub(super) size: (i32, i32),
    /// Whether the x axis is named below the panel, outside `size`.
    pub(super) name_x: bool,
    /// Whether the y axis is named left of the panel, outside `size`.
    pub(super) name_y: bool,
}

impl Panel<'_> {
    /// Draws the panel on the whole figure's area.
    pub(super) fn draw(&self, root: &Area<'_>) -> Result<(), ReportError> {
        let plot_centre = self.at.0 + (self.ticks_width() + self.size.0 - RIGHT_MARGIN) / 2;
        let title_style = text::style(TITLE);
        let title = text::shorten(&self.content.title, &title_style, self.size.0 - 10)?;
        // A long title is centred on the panel instead, so that it stays inside.
        let half = text::width(&title, &title_style)? / 2;
        let centre =
            plot_centre.clamp(self.at.0 + half, (self.at.0 + self.size.0 - half).max(self.at.0 + half));
        self.draw_names(root, &title, centre, plot_centre)
            .and_then(|()| self.draw_plot(root))
            .map_err(ReportError::figure(&self.content.title))
    }

    /// Width of the ticks' labels.
    fn ticks_width(&self) -> i32 {
        Y_TICKS_WIDTH + DIGIT_WIDTH * (self.content.y.digits.max(1) as i32 - 1)
    }

    fn draw_names(&self, root: &Area<'_>, title: &str, title_x: i32, plot_centre: i32) -> DrawResult {
        let (left, top) = self.at;
        let bottom = top + self.size.1;
        let plot_middle = top + (TITLE_HEIGHT + self.size.1 - X_TICKS_HEIGHT) / 2;
        let above = Pos::new(HPos::Center, VPos::Bottom);
        let below = Pos::new(HPos::Center, VPos::Top);
        root.draw_text(title, &text::style(TITLE).pos(above), (title_x, top + TITLE_HEIGHT - 4))?;
        if self.name_x {
            root.draw_text(self.content.x.name, &text::style(AXIS).pos(below), (plot_centre, bottom))?;
        }
        if self.name_y {
            let style = text::style(AXIS).transform(FontTransform::Rotate270).pos(above);
            root.draw_text(&self.content.y.name, &style, (left, plot_middle))?;
        }
        Ok(())
    }

    fn draw_plot(&self, root: &Area<'_>) -> DrawResult {
        let Content { x, y: rates, series, .. } = self.content;
        let room = Y_ROOM * (rates.high - rates.low);
        let (left, top) = self.at;
        let plot: DrawingArea<_, Shift> = root
            .clone()
            .shrink((left, top + TITLE_HEIGHT), (self.size.0 - RIGHT_MARGIN, self.size.1 - TITLE_HEIGHT));
        let mut chart = ChartBuilder::on(&plot)
            .y_label_area_size(self.ticks_width())
            .x_label_area_size(X_TICKS_HEIGHT)
            .build_cartesian_2d(
                Axis { range: 0.0..x.end, ticks: x.ticks.clone() },
                Axis { range: rates.low - room..rates.high + room, ticks: rates.ticks.clone() },
            )?;
        draw_mesh(&mut chart, &|tick| (x.label)(tick), &|tick| rates.label(tick))?;
        let pixel = |x: f64, y: f64| chart.backend_coord(&(x, y.clamp(rates.low, rates.high)));
        for line in series.iter().rev() {
            draw_bands(root, line, &pixel)?;
        }
        for (index, line) in series.iter().enumerate().rev() {
            draw_line(root, line, index as f64 / series.len() as f64, &pixel)?;
        }
        Ok(())
    }
}

/// The band, wherever neighbouring points have one.
fn draw_bands(root: &Area<'_>, line: &Series, pixel: &impl Fn(f64, f64) -> (i32, i32)) -> DrawResult {
    for run in line.marks.chunk_by(|a, b| a.band.is_some() == b.band.is_some()) {
        let edges = run.iter().filter_map(|mark| {
            let (low, high) = mark.band?;
            Some((pixel(mark.x, low), pixel(mark.x, high)))
        });
        let (lower, upper): (Vec<_>, Vec<_>) = edges.unzip();
        if lower.len() > 1 {
            shapes::band(root, &lower, &upper, line.look)?;
        }
    }
    Ok(())
}

/// The line, with markers whose `phase` in [0, 1) differs between lines: equal lines stay visible. None is on
/// the first point, where it would touch the labels of the y axis, unless that is the only one.
fn draw_line(
    root: &Area<'_>,
    line: &Series,
    phase: f64,
    pixel: &impl Fn(f64, f64) -> (i32, i32),
) -> DrawResult {
    let points: Vec<(i32, i32)> = line.marks.iter().map(|mark| pixel(mark.x, mark.y)).collect();
    if points.len() > 1 {
        shapes::line(root, &points, line.look)?;
    }
    let stride = points.len().div_ceil(MARKERS).max(1);
    let first = (1 + (phase * stride as f64) as usize).min(points.len().saturating_sub(1));
    for at in points.iter().skip(first).step_by(stride) {
        shapes::marker(root, *at, line.look)?;
    }
    Ok(())
}
