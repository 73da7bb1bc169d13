//! Lines, markers and bands in pixel coordinates.

use plotters::coord::Shift;
use plotters::prelude::*;

use looks::{Dash, Look, Marker};

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type DrawResult<T = ()> = Result<T, DrawingAreaErrorKind<std::io::Error>>;
type Pixel = (i32, i32);

/// Width of curves in pixels: about 1.2 points.
const LINE_WIDTH: u32 = 5;
/// Half the size of a marker in pixels.
const MARKER_RADIUS: i32 = 11;
/// Sizes of dots and of the rings around them, in pixels, and how much dots cover.
const DOT_RADIUS: i32 = 7;
const RING_RADIUS: i32 = 14;
const DOT_OPACITY: f64 = 0.5;
/// Opacity of bands: six of them on top of each other can still be told apart.
const BAND_OPACITY: f64 = 0.15;

fn colour(look: Look) -> RGBColor {
    let (red, green, blue) = look.colour;
    RGBColor(red, green, blue)
}

/// Lengths of dashes and gaps in turn, in pixels; `None` for a solid line. Each pattern ends with a whole
/// dash after the 90 pixels of the legend's samples.
fn pattern(dash: Dash) -> Option<&'static [f64]> {
    match dash {
        Dash::Solid => None,
        Dash::Long => Some(&[24.0, 9.0]),
        Dash::Short => Some(&[15.0, 10.0]),
        Dash::Dotted => Some(&[6.0, 8.0]),
        Dash::DashDot => Some(&[16.0, 8.0, 5.0, 8.0]),
        Dash::Sparse => Some(&[14.0, 24.0]),
    }
}

/// A line through `points`.
pub(super) fn line(area: &Area<'_>, points: &[Pixel], look: Look) -> DrawResult {
    let stroke = colour(look).stroke_width(LINE_WIDTH);
    let Some(pattern) = pattern(look.dash) else { return area.draw(&PathElement::new(points, stroke)) };
    for dash in dashes(points, pattern) {
        area.draw(&PathElement::new(dash, stroke))?;
    }
    Ok(())
}

/// The dashes of a line through `points`, which go around its corners. `pattern` holds dashes and gaps in
/// turn, all longer than 0.
fn dashes(points: &[Pixel], pattern: &[f64]) -> Vec<Vec<Pixel>> {
    let (mut found, mut current) = (Vec::new(), points.first().copied().into_iter().collect::<Vec<_>>());
    let (mut index, mut left) = (0, pattern[0]);
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (across, down) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let length = across.hypot(down);
        let mut done = 0.0;
        while length - done >= left {
            done += left;
            let share = if length > 0.0 { done / length } else { 1.0 };
            let at = (from.0 + (across * share).round() as i32, from.1 + (down * share).round() as i32);
            if index % 2 == 0 {
                current.push(at);
                found.push(std::mem::take(&mut current));
            } else {
                current = vec![at];
            }
            index = (index + 1) % pattern.len();
            left = pattern[index];
        }
        left -= length - done;
        if index % 2 == 0 {
            current.push(to);
        }
    }
    // What began at the very end has no length.
    found.extend(Some(current).filter(|dash| dash.first() != dash.last()));
    found
}

/// The polygon between two lines, each given from left to right.
pub(super) fn band(area: &Area<'_>, lower: &[Pixel], upper: &[Pixel], look: Look) -> DrawResult {
    let outline: Vec<Pixel> = lower.iter().chain(upper.iter().rev()).copied().collect();
    area.draw(&Polygon::new(outline, colour(look).mix(BAND_OPACITY)))
}

/// A marker around `at`.
pub(super) fn marker(area: &Area<'_>, at: Pixel, look: Look) -> DrawResult {
    let r = MARKER_RADIUS;
    let corners: &[Pixel] = match look.marker {
        Marker::Circle => return area.draw(&Circle::new(at, r, colour(look).filled())),
        Marker::Cross => {
            let stroke = colour(look).stroke_width(LINE_WIDTH);
            for (from, to) in [((-r, -r), (r, r)), ((-r, r), (r, -r))] {
                area.draw(&PathElement::new([shift(at, from), shift(at, to)], stroke))?;
            }
            return Ok(());
        }
        Marker::Square => &[(-r + 1, -r + 1), (r - 1, -r + 1), (r - 1, r - 1), (-r + 1, r - 1)],
        Marker::Triangle => &[(0, -r - 2), (r + 1, r - 1), (-r - 1, r - 1)],
        Marker::Wedge => &[(0, r + 2), (r + 1, -r + 1), (-r - 1, -r + 1)],
        Marker::Diamond => &[(0, -r - 3), (r + 3, 0), (0, r + 3), (-r - 3, 0)],
    };
    let outline: Vec<Pixel> = corners.iter().map(|&corner| shift(at, corner)).collect();
    area.draw(&Polygon::new(outline, colour(look).filled()))
}

/// A small dot around `at`, through which others are seen.
pub(super) fn dot(area: &Area<'_>, at: Pixel, look: Look) -> DrawResult {
    area.draw(&Circle::new(at, DOT_RADIUS, colour(look).mix(DOT_OPACITY).filled()))
}

/// A ring around `at`.
pub(super) fn ring(area: &Area<'_>, at: Pixel) -> DrawResult {
    area.draw(&Circle::new(at, RING_RADIUS, BLACK.stroke_width(3)))
}

fn shift(at: Pixel, by: Pixel) -> Pixel {
    (at.0 + by.0, at.1 + by.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_by_hand() {
        // 4 on, 2 off, around the corner at (5, 0).
        let found = dashes(&[(0, 0), (5, 0), (5, 7)], &[4.0, 2.0]);
        // The dash that would begin at the end is not drawn.
        assert_eq!(found, [[(0, 0), (4, 0)], [(5, 1), (5, 5)]]);
        assert_eq!(dashes(&[(0, 0), (5, 0), (5, 3)], &[6.0, 2.0]), [[(0, 0), (5, 0), (5, 1)]]);
        assert_eq!(dashes(&[], &[1.0, 1.0]), [[(0, 0); 0]; 0]);
    }

    #[test]
    fn no_line_is_mostly_gaps_that_hide_it_in_a_small_panel() {
        for dash in [Dash::Long, Dash::Short, Dash::Dotted, Dash::DashDot, Dash::Sparse] {
            let lengths = pattern(dash).unwrap();
            let drawn: f64 = lengths.iter().step_by(2).sum();
            assert!(drawn / lengths.iter().sum::<f64>() > 1.0 / 3.0, "{dash:?}");
        }
    }

    #[test]
    fn patterns_end_with_a_whole_dash_in_the_legend() {
        for dash in [Dash::Long, Dash::Short, Dash::Dotted, Dash::DashDot, Dash::Sparse] {
            let drawn = dashes(&[(0, 0), (90, 0)], pattern(dash).unwrap());
            let last = drawn.last().unwrap();
            let width = f64::from(last[1].0 - last[0].0);
            assert_eq!((last[1].0, Some(width)), (90, pattern(dash).map(|lengths| lengths[0])), "{dash:?}");
        }
    }
}
