//! Which places of its ordering a teacher trained on over time: a panel per method.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::canvas::{self, COLUMN_WIDTH, FRAME, MARGIN};
use super::shapes::{Area, DrawResult};
use super::{page, scale, text, ticks};
use crate::analysis::ranks::{RankMap, TIMES};
use crate::error::ReportError;
use crate::render::table::cells::thousands;
use crate::wording::counted;

/// Text sizes in points.
const TITLE: f64 = 8.5;
const AXIS: f64 = 8.0;
const TICK: f64 = 7.0;
/// Lengths in pixels.
const PLOT_HEIGHT: i32 = 520;
const TITLE_HEIGHT: i32 = 56;
const X_TICKS_HEIGHT: i32 = 50;
const X_NAME_HEIGHT: i32 = 48;
const Y_TICKS_WIDTH: i32 = 92;
const Y_NAME_WIDTH: i32 = 46;
const RIGHT_MARGIN: i32 = 56;
const GAP: i32 = 18;

/// The maps of the methods of one environment, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn ranks(maps: &[RankMap]) -> Result<String, ReportError> {
    text::register()?;
    let width = COLUMN_WIDTH;
    let most = most(maps);
    let caption = page::caption_lines(&text::printable(&caption(maps)), width)?;
    let height = TITLE_HEIGHT + PLOT_HEIGHT + X_TICKS_HEIGHT;
    let below = MARGIN + maps.len() as i32 * (height + GAP) - GAP;
    let bar_top = below + X_NAME_HEIGHT + GAP;
    let caption_top = bar_top + scale::BAR_HEIGHT + GAP;
    canvas::svg((width, caption_top + page::caption_height(&caption)), |root| {
        for (index, map) in (0..).zip(maps) {
            let title = text::shorten(&map.key.name(), &text::style(TITLE), width - 2 * MARGIN)?;
            draw(root, map, most, (&title, MARGIN + index * (height + GAP)))
                .map_err(canvas::failed("map of ranks"))?;
        }
        let name = text::style(AXIS).pos(Pos::new(HPos::Center, VPos::Top));
        let middle = (Y_NAME_WIDTH + Y_TICKS_WIDTH + width - RIGHT_MARGIN) / 2;
        let labels = ["0 %", "of the episodes", &format!("{:.0} %", 100.0 * most)];
        root.draw_text("Environment steps", &name, (middle, below))
            .and_then(|()| scale::draw_bar(root, labels, (width / 2, bar_top)))
            .map_err(canvas::failed("map of ranks"))?;
        page::draw_caption(root, &caption, (width / 2, caption_top))
    })
}

/// The end of the colour scale: the highest share of any slice in which several places had a turn, as the
/// first ones of a set of one goal would leave all others alike.
fn most(maps: &[RankMap]) -> f64 {
    let shares = maps.iter().flat_map(|map| (0..TIMES).map(|slice| map.shares(slice)));
    let several = shares.filter(|shares| shares.iter().filter(|share| **share > 0.0).count() > 1);
    let highest = several.flatten().fold(0.0, f64::max);
    if highest > 0.0 { highest } else { 1.0 }
}

fn caption(maps: &[RankMap]) -> String {
    let told = maps.iter().map(|map| {
        let rows =
            if map.together > 1 { format!(", {} places to a row", map.together) } else { String::new() };
        format!("{}: {}{rows}", map.key.name(), counted(map.runs, "seed"))
    });
    format!(
        "{}: training episodes by the place of their goal among those that the teacher ranked, 0 for the first: share of \
         the episodes of a {TIMES}th of training, all seeds together; white: none; the scale ends at the highest share \
         where more than one place had a turn. {}.",
        maps.first().map_or("", |map| map.key.environment.as_str()),
        told.collect::<Vec<_>>().join("; "),
    )
}

fn draw(root: &Area<'_>, map: &RankMap, most: f64, (title, top): (&str, i32)) -> DrawResult {
    let right = COLUMN_WIDTH - RIGHT_MARGIN;
    let centre = (Y_NAME_WIDTH + Y_TICKS_WIDTH + right) / 2;
    let above = Pos::new(HPos::Center, VPos::Bottom);
    root.draw_text(title, &text::style(TITLE).pos(above), (centre, top + TITLE_HEIGHT - 6))?;
    let style = text::style(AXIS).transform(FontTransform::Rotate270).pos(above);
    let middle = top + TITLE_HEIGHT + PLOT_HEIGHT / 2;
    root.draw_text("Place in the ordering", &style, (Y_NAME_WIDTH, middle))?;
    let area = root
        .clone()
        .shrink((Y_NAME_WIDTH, top + TITLE_HEIGHT), (right - Y_NAME_WIDTH, PLOT_HEIGHT + X_TICKS_HEIGHT));
    let (end, places) = (map.end.max(1) as f64, (map.counts.len() * map.together) as f64);
    let mut chart = ChartBuilder::on(&area)
        .y_label_area_size(Y_TICKS_WIDTH)
        .x_label_area_size(X_TICKS_HEIGHT)
        .build_cartesian_2d(
            Axis { range: 0.0..end, ticks: ticks::steps(map.end.max(1), 4) },
            // A place lies in the middle of its row.
            Axis { range: -0.5..places - 0.5, ticks: whole(places) },
        )?;
    for slice in 0..TIMES {
        for (row, share) in map.shares(slice).into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
            let edge = |slice: usize| end * slice as f64 / TIMES as f64;
            let low = (row * map.together) as f64 - 0.5;
            let from = chart.backend_coord(&(edge(slice), low + map.together as f64));
            let to = chart.backend_coord(&(edge(slice + 1), low));
            root.draw(&Rectangle::new([from, to], scale::colour(share / most).filled()))?;
        }
    }
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(FRAME.stroke_width(3))
        .label_style(text::style(TICK))
        .x_label_formatter(&|step| thousands(*step as u64))
        .y_label_formatter(&|place| format!("{place:.0}"))
        .draw()
}

/// At most six whole places from 0, evenly apart.
fn whole(places: f64) -> Vec<f64> {
    let every = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0]
        .into_iter()
        .find(|every| places / every <= 6.0)
        .unwrap_or(places);
    (0..6).map(|index| f64::from(index) * every).filter(|place| *place <= places - 1.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_places() {
        assert_eq!(whole(1.0), [0.0]);
        assert_eq!(whole(6.0), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(whole(9.0), [0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!(whole(195.0), [0.0, 50.0, 100.0, 150.0]);
    }
}
