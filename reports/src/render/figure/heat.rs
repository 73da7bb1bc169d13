//! Heat maps of mazes: a row per method, where its teacher sent the student beside where the student
//! succeeded.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, FRAME, MARGIN, PAGE_WIDTH};
use super::shapes::{Area, DrawResult};
use super::{page, text};
use crate::analysis::catalogue::MazeInfo;
use crate::analysis::heat::{FEWEST_EPISODES, HeatMap, PHASES};
use crate::error::ReportError;

/// Text sizes in points.
const TITLE: f64 = 9.0;
const LABEL: f64 = 8.0;
const TICK: f64 = 7.0;
const START: f64 = 5.0;
/// Lengths in pixels.
const TITLE_HEIGHT: i32 = 60;
const PHASE_HEIGHT: i32 = 60;
const LABEL_WIDTH: i32 = 280;
const GAP: i32 = 24;
const BLOCK_GAP: i32 = 60;
const BAR_HEIGHT: i32 = 28;
const BAR_WIDTH: i32 = 460;
const BAR_LABEL_HEIGHT: i32 = 44;

const WALL: RGBColor = RGBColor(120, 120, 120);
/// A free cell that too few goals lay in, where rates are shown.
const UNSEEN: RGBColor = RGBColor(255, 255, 255);

/// From low to high; lightness falls steadily, so that it reads in grey and with any colour vision (the
/// colours of viridis, by Smith and van der Walt 2015, from its light end).
const SCALE: [(u8, u8, u8); 6] =
    [(253, 231, 37), (122, 209, 81), (34, 168, 132), (42, 120, 142), (65, 68, 135), (68, 1, 84)];

/// The heat maps of the methods run in one maze, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn heat(maze: &MazeInfo, maps: &[HeatMap]) -> Result<String, ReportError> {
    Sheet::new(maze, maps).draw()
}

/// The layout: two blocks of three maps per row.
struct Sheet<'a> {
    maze: &'a MazeInfo,
    maps: &'a [HeatMap],
    /// Width of a cell of the maze in pixels.
    cell: i32,
    /// Highest share of goals in a cell: the end of its colour scale.
    most: f64,
}

impl<'a> Sheet<'a> {
    fn new(maze: &'a MazeInfo, maps: &'a [HeatMap]) -> Self {
        let room = PAGE_WIDTH - 2 * MARGIN - LABEL_WIDTH - 4 * GAP - BLOCK_GAP;
        let cell = (room / (6 * maze.side() as i32)).max(1);
        let shares = maps.iter().flat_map(|map| &map.phases).flat_map(|phase| phase.shares());
        Self { maze, maps, cell, most: shares.fold(f64::MIN_POSITIVE, f64::max) }
    }

    fn map_side(&self) -> i32 {
        self.cell * self.maze.side() as i32
    }

    /// Left edge of map `phase` of a block: 0 for goals, 1 for success.
    fn left(&self, block: i32, phase: i32) -> i32 {
        let map = self.map_side() + GAP;
        MARGIN + LABEL_WIDTH + block * (3 * map - GAP + BLOCK_GAP) + phase * map
    }

    fn draw(&self) -> Result<String, ReportError> {
        text::register()?;
        let top = MARGIN + TITLE_HEIGHT + PHASE_HEIGHT;
        let bars_top = top + self.maps.len() as i32 * (self.map_side() + GAP);
        let caption = page::caption_lines(
            &format!(
                "{}: goals of training episodes and the success rate at them (with exploration noise), by third of \
                 training, all seeds; grey: walls, white: fewer than {FEWEST_EPISODES} goals lay there",
                text::printable(&self.maze.id)
            ),
            PAGE_WIDTH,
        )?;
        let caption_top = bars_top + BAR_HEIGHT + BAR_LABEL_HEIGHT + GAP;
        let label_style = text::style(LABEL).pos(Pos::new(HPos::Left, VPos::Center));
        let mut labels = Vec::with_capacity(self.maps.len());
        for map in self.maps {
            let label = map.key.name();
            labels.push(text::shorten(&label, &label_style, LABEL_WIDTH - GAP)?);
        }
        canvas::svg((PAGE_WIDTH, caption_top + page::caption_height(&caption)), |root| {
            self.draw_titles(root).map_err(canvas::failed("heat map titles"))?;
            for (index, (map, label)) in (0..).zip(self.maps.iter().zip(&labels)) {
                let row_top = top + index * (self.map_side() + GAP);
                let at = (MARGIN, row_top + self.map_side() / 2);
                root.draw_text(label, &label_style, at).map_err(canvas::failed("heat map labels"))?;
                self.draw_row(root, map, row_top).map_err(canvas::failed("heat map"))?;
            }
            self.draw_bars(root, bars_top).map_err(canvas::failed("heat map scale"))?;
            page::draw_caption(root, &caption, (PAGE_WIDTH / 2, caption_top))
        })
    }

    fn draw_titles(&self, root: &Area<'_>) -> DrawResult {
        let above = Pos::new(HPos::Center, VPos::Bottom);
        for (block, title) in [(0, "Where the teacher sent the student"), (1, "Where the student succeeded")]
        {
            let centre = self.left(block, 1) + self.map_side() / 2;
            root.draw_text(title, &text::style(TITLE).pos(above), (centre, MARGIN + TITLE_HEIGHT - 8))?;
            for (phase, name) in (0..).zip(PHASES) {
                let at = (
                    self.left(block, phase) + self.map_side() / 2,
                    MARGIN + TITLE_HEIGHT + PHASE_HEIGHT - 20,
                );
                root.draw_text(name, &text::style(LABEL).pos(above), at)?;
            }
        }
        Ok(())
    }

    fn draw_row(&self, root: &Area<'_>, map: &HeatMap, top: i32) -> DrawResult {
        for (index, phase) in (0..).zip(&map.phases) {
            let shares: Vec<Option<f64>> =
                phase.shares().into_iter().map(|share| (share > 0.0).then_some(share / self.most)).collect();
            self.draw_map(root, &shares, (self.left(0, index), top))?;
            self.draw_map(root, &phase.rates(), (self.left(1, index), top))?;
        }
        Ok(())
    }

    /// A map of values in [0, 1], `[side * side]`.
    fn draw_map(&self, root: &Area<'_>, values: &[Option<f64>], at: (i32, i32)) -> DrawResult {
        let side = self.maze.side();
        for (index, value) in values.iter().enumerate() {
            let (row, column) = (index / side, index % side);
            let colour = match value {
                _ if self.maze.cell(row, column) == '#' => WALL,
                Some(value) => scale(*value),
                None => UNSEEN,
            };
            let corner = (at.0 + column as i32 * self.cell, at.1 + row as i32 * self.cell);
            // One pixel under the next cells: viewers would show hairlines between edges that only touch.
            let under = |index: usize| self.cell + i32::from(index + 1 < side);
            let opposite = (corner.0 + under(column), corner.1 + under(row));
            root.draw(&Rectangle::new([corner, opposite], colour.filled()))?;
        }
        self.draw_start(root, values, at)?;
        let opposite = (at.0 + self.map_side(), at.1 + self.map_side());
        root.draw(&Rectangle::new([at, opposite], FRAME.stroke_width(2)))
    }

    /// The letter in the start cell, in black or white.
    fn draw_start(&self, root: &Area<'_>, values: &[Option<f64>], at: (i32, i32)) -> DrawResult {
        let side = self.maze.side();
        let is_start = |index: &usize| self.maze.cell(index / side, index % side) == 'S';
        for index in (0..values.len()).filter(is_start) {
            let colour = if values[index].is_some_and(|value| value > 0.5) { &WHITE } else { &BLACK };
            let style = text::style(START).pos(Pos::new(HPos::Center, VPos::Center)).color(colour);
            let middle = |index: usize| index as i32 * self.cell + self.cell / 2;
            root.draw_text("S", &style, (at.0 + middle(index % side), at.1 + middle(index / side)))?;
        }
        Ok(())
    }

    /// The colour scale of each block below it.
    fn draw_bars(&self, root: &Area<'_>, top: i32) -> DrawResult {
        let most = format!("{:.1} %", self.most * 100.0);
        let bars = [(0, "0 %", most.as_str(), "of goals"), (1, "0.0", "1.0", "success rate")];
        for (block, low, high, what) in bars {
            let left = self.left(block, 1) + self.map_side() / 2 - BAR_WIDTH / 2;
            for x in 0..BAR_WIDTH {
                let colour = scale(f64::from(x) / f64::from(BAR_WIDTH - 1));
                // Down to the end of the bar, under the strips that follow: no hairlines between them.
                root.draw(&Rectangle::new(
                    [(left + x, top), (left + BAR_WIDTH, top + BAR_HEIGHT)],
                    colour.filled(),
                ))?;
            }
            let below = Pos::new(HPos::Center, VPos::Top);
            for (x, label) in [(0, low), (BAR_WIDTH / 2, what), (BAR_WIDTH, high)] {
                root.draw_text(label, &text::style(TICK).pos(below), (left + x, top + BAR_HEIGHT + 8))?;
            }
        }
        Ok(())
    }
}

/// The colour of a value in [0, 1], between its neighbours on [`SCALE`].
pub(super) fn scale(value: f64) -> RGBColor {
    let position = value.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let below = (position as usize).min(SCALE.len() - 2);
    let share = position - below as f64;
    let ((r0, g0, b0), (r1, g1, b1)) = (SCALE[below], SCALE[below + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
    RGBColor(mix(r0, r1), mix(g0, g1), mix(b0, b1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_darkens_steadily() {
        // Relative luminance, Rec. 709 weights.
        let grey = |value: f64| {
            let RGBColor(r, g, b) = scale(value);
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        let greys: Vec<f64> = (0..=100).map(|i| grey(f64::from(i) / 100.0)).collect();
        assert!(greys.windows(2).all(|pair| pair[1] <= pair[0]), "{greys:?}");
        assert_eq!(scale(0.1), RGBColor(188, 220, 59));
    }
}
