//! A linear axis whose ticks are given, and the mesh between two of them.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;

use super::canvas::{FRAME, GRID};
use super::shapes::DrawResult;
use super::text;

/// Size of the ticks' labels in points.
const TICK: f64 = 7.0;

/// A chart with two such axes.
pub(super) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// Draws frame, ticks and the lines at them; `x` and `y` say what a tick is called.
pub(super) fn draw_mesh(
    chart: &mut Chart<'_, '_>,
    x: &dyn Fn(f64) -> String,
    y: &dyn Fn(f64) -> String,
) -> DrawResult {
    chart
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(2))
        .light_line_style(TRANSPARENT)
        .axis_style(FRAME.stroke_width(3))
        .label_style(text::style(TICK))
        .x_label_formatter(&|&tick| x(tick))
        .y_label_formatter(&|&tick| y(tick))
        .draw()
}

/// A range of numbers with the ticks that it shows: no more, no fewer.
pub(super) struct Axis {
    pub(super) range: Range<f64>,
    pub(super) ticks: Vec<f64>,
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // plotters asks again for unlabelled points in between; there are none.
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}
