//! A white SVG to draw on.

use plotters::prelude::*;

use super::shapes::{Area, DrawResult};
use super::text;
use crate::error::ReportError;

/// Widths of figures in pixels at 300 pixels per inch: 3.5 and 7.16 inch.
pub(super) const COLUMN_WIDTH: i32 = 1050;
pub(super) const PAGE_WIDTH: i32 = 2148;
/// Space around everything in pixels.
pub(super) const MARGIN: i32 = 16;
/// Thin lines behind curves, and lines around plots.
pub(super) const GRID: RGBColor = RGBColor(225, 225, 225);
pub(super) const FRAME: RGBColor = RGBColor(90, 90, 90);

/// The SVG of `size` pixels that `draw` fills.
pub(super) fn svg(
    size: (i32, i32),
    draw: impl FnOnce(&Area<'_>) -> Result<(), ReportError>,
) -> Result<String, ReportError> {
    text::register()?;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (size.0 as u32, size.1 as u32)).into_drawing_area();
        root.fill(&WHITE).map_err(failed("background"))?;
        draw(&root)?;
        root.present().map_err(failed("background"))?;
    }
    Ok(svg)
}

/// For `map_err` on drawing `part` of a figure.
pub(super) fn failed(part: &str) -> impl FnOnce(DrawingAreaErrorKind<std::io::Error>) -> ReportError {
    ReportError::figure(part)
}

/// Straight line between two pixels.
pub(super) fn segment(area: &Area<'_>, from: (i32, i32), to: (i32, i32), style: ShapeStyle) -> DrawResult {
    area.draw(&PathElement::new([from, to], style))
}
