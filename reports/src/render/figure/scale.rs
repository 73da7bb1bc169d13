//! The colour scale of maps.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::shapes::{Area, DrawResult};
use super::text;

/// From low to high; lightness falls steadily, so that it reads in grey and with any colour vision (the
/// colours of viridis, by Smith and van der Walt 2015, from its light end; its dark end would look like
/// walls).
const SCALE: [(u8, u8, u8); 5] =
    [(253, 231, 37), (122, 209, 81), (34, 168, 132), (42, 120, 142), (65, 68, 135)];

/// Size of the labels in points.
const LABEL: f64 = 7.0;
/// Lengths in pixels.
const WIDTH: i32 = 460;
const STRIP_HEIGHT: i32 = 28;
/// Height of the bar with its labels.
pub(super) const BAR_HEIGHT: i32 = STRIP_HEIGHT + 44;

/// The colour of a value in [0, 1], between its neighbours on [`SCALE`].
pub(super) fn colour(value: f64) -> RGBColor {
    let position = value.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let below = (position as usize).min(SCALE.len() - 2);
    let share = position - below as f64;
    let ((r0, g0, b0), (r1, g1, b1)) = (SCALE[below], SCALE[below + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    RGBColor(mix(r0, r1), mix(g0, g1), mix(b0, b1))
}

/// The scale as a bar, `labels` below its beginning, middle and end; the point given is the middle of its
/// upper edge.
pub(super) fn draw_bar(root: &Area<'_>, labels: [&str; 3], (centre, top): (i32, i32)) -> DrawResult {
    let left = centre - WIDTH / 2;
    for x in 0..WIDTH {
        let colour = colour(f64::from(x) / f64::from(WIDTH - 1));
        // Down to the end of the bar, under the strips that follow: no hairlines between them.
        root.draw(&Rectangle::new([(left + x, top), (left + WIDTH, top + STRIP_HEIGHT)], colour.filled()))?;
    }
    let below = Pos::new(HPos::Center, VPos::Top);
    for (x, label) in [0, WIDTH / 2, WIDTH].into_iter().zip(labels) {
        root.draw_text(label, &text::style(LABEL).pos(below), (left + x, top + STRIP_HEIGHT + 8))?;
    }
    Ok(())
}
