//! Maps of mazes: a row per method, with two blocks of maps over the thirds of training.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, FRAME, MARGIN, PAGE_WIDTH};
use super::shapes::{Area, DrawResult};
use super::{page, scale, text};
use crate::analysis::catalogue::MazeInfo;
use crate::analysis::parts::PHASES;
use crate::error::ReportError;
use crate::render::table::cells::thousands;

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
const REASON_HEIGHT: i32 = 44;

/// Darker than the whole scale, in grey too.
pub(super) const WALL: RGBColor = RGBColor(20, 20, 20);
/// A free cell without a colour, as where no goal lay.
pub(super) const UNSEEN: RGBColor = RGBColor(255, 255, 255);

/// A map: a value in [0, 1] for each cell that has one, `[side * side]`.
pub(super) struct MazePicture {
    pub(super) values: Vec<Option<f64>>,
    /// Why it is empty, across its middle.
    pub(super) reason: Option<&'static str>,
}

/// The maps of a method.
pub(super) struct MazeRow {
    pub(super) label: String,
    /// By block, then by third of training.
    pub(super) blocks: [[MazePicture; 3]; 2],
}

/// What stands above and below a block.
pub(super) struct MazeBlock {
    pub(super) title: &'static str,
    /// The labels of its colour scale: at its beginning, middle and end.
    pub(super) scale: [String; 3],
}

/// All of a figure.
pub(super) struct MazeSheet<'a> {
    pub(super) maze: &'a MazeInfo,
    pub(super) blocks: [MazeBlock; 2],
    pub(super) rows: Vec<MazeRow>,
    pub(super) caption: String,
}

/// The budgets of the runs that maps are of, as captions tell them: `60,000`, or `20,000 to 60,000`.
pub(super) fn budgets(steps: impl Iterator<Item = u64> + Clone) -> String {
    let (least, most) = (steps.clone().min().unwrap_or(0), steps.max().unwrap_or(0));
    if least == most { thousands(most) } else { format!("{} to {}", thousands(least), thousands(most)) }
}

impl MazeSheet<'_> {
    /// The figure as SVG.
    ///
    /// # Errors
    /// [`ReportError::Figure`] if drawing fails.
    pub(super) fn draw(&self) -> Result<String, ReportError> {
        text::register()?;
        let top = MARGIN + TITLE_HEIGHT + PHASE_HEIGHT;
        let bars_top = top + self.rows.len() as i32 * (self.map_side() + GAP);
        let caption = page::caption_lines(&text::printable(&self.caption), PAGE_WIDTH)?;
        let caption_top = bars_top + scale::BAR_HEIGHT + GAP;
        let label_style = text::style(LABEL).pos(Pos::new(HPos::Left, VPos::Center));
        let mut labels = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            labels.push(text::shorten(&row.label, &label_style, LABEL_WIDTH - GAP)?);
        }
        canvas::svg((PAGE_WIDTH, caption_top + page::caption_height(&caption)), |root| {
            self.draw_titles(root).map_err(canvas::failed("heat map titles"))?;
            for (index, (row, label)) in (0..).zip(self.rows.iter().zip(&labels)) {
                let row_top = top + index * (self.map_side() + GAP);
                let at = (MARGIN, row_top + self.map_side() / 2);
                root.draw_text(label, &label_style, at).map_err(canvas::failed("heat map labels"))?;
                self.draw_row(root, row, row_top).map_err(canvas::failed("heat map"))?;
            }
            self.draw_bars(root, bars_top).map_err(canvas::failed("heat map scale"))?;
            page::draw_caption(root, &caption, (PAGE_WIDTH / 2, caption_top))
        })
    }

    /// Width of a cell of the maze in pixels.
    fn cell(&self) -> i32 {
        let room = PAGE_WIDTH - 2 * MARGIN - LABEL_WIDTH - 4 * GAP - BLOCK_GAP;
        (room / (6 * self.maze.side() as i32)).max(1)
    }

    fn map_side(&self) -> i32 {
        self.cell() * self.maze.side() as i32
    }

    /// Left edge of map `phase` of a block.
    fn left(&self, block: i32, phase: i32) -> i32 {
        let map = self.map_side() + GAP;
        MARGIN + LABEL_WIDTH + block * (3 * map - GAP + BLOCK_GAP) + phase * map
    }

    fn draw_titles(&self, root: &Area<'_>) -> DrawResult {
        let above = Pos::new(HPos::Center, VPos::Bottom);
        for (block, MazeBlock { title, .. }) in (0..).zip(&self.blocks) {
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

    fn draw_row(&self, root: &Area<'_>, row: &MazeRow, top: i32) -> DrawResult {
        for phase in 0..PHASES.len() {
            for (block, pictures) in (0..).zip(&row.blocks) {
                let at = (self.left(block, phase as i32), top);
                let MazePicture { values, reason } = &pictures[phase];
                self.draw_map(root, values, at)?;
                if let Some(reason) = reason {
                    self.draw_reason(root, reason, at)?;
                }
            }
        }
        Ok(())
    }

    /// A map; all cells without a value where there are no `values`.
    fn draw_map(&self, root: &Area<'_>, values: &[Option<f64>], at: (i32, i32)) -> DrawResult {
        let side = self.maze.side();
        for index in 0..side * side {
            let (row, column) = (index / side, index % side);
            let colour = match values.get(index).copied().flatten() {
                _ if self.maze.cell(row, column) == '#' => WALL,
                Some(value) => scale::colour(value),
                None => UNSEEN,
            };
            let corner = (at.0 + column as i32 * self.cell(), at.1 + row as i32 * self.cell());
            // One pixel under the next cells: viewers would show hairlines between edges that only touch.
            let under = |index: usize| self.cell() + i32::from(index + 1 < side);
            let opposite = (corner.0 + under(column), corner.1 + under(row));
            root.draw(&Rectangle::new([corner, opposite], colour.filled()))?;
        }
        self.draw_start(root, values, at)?;
        let opposite = (at.0 + self.map_side(), at.1 + self.map_side());
        root.draw(&Rectangle::new([at, opposite], FRAME.stroke_width(2)))
    }

    /// Why a map is empty, across its middle.
    fn draw_reason(&self, root: &Area<'_>, reason: &str, at: (i32, i32)) -> DrawResult {
        let style = text::style(TICK).pos(Pos::new(HPos::Center, VPos::Center));
        let side = self.map_side();
        let middle = (at.0 + side / 2, at.1 + side / 2);
        let strip =
            [(at.0 + 1, middle.1 - REASON_HEIGHT / 2), (at.0 + side - 1, middle.1 + REASON_HEIGHT / 2)];
        root.draw(&Rectangle::new(strip, WHITE.filled()))?;
        root.draw_text(reason, &style, middle)
    }

    /// The letter in the start cell, in black or white.
    fn draw_start(&self, root: &Area<'_>, values: &[Option<f64>], at: (i32, i32)) -> DrawResult {
        let side = self.maze.side();
        let is_start = |index: &usize| self.maze.cell(index / side, index % side) == 'S';
        for index in (0..side * side).filter(is_start) {
            let is_dark = values.get(index).copied().flatten().is_some_and(|value| value > 0.5);
            let colour = if is_dark { &WHITE } else { &BLACK };
            let style = text::style(START).pos(Pos::new(HPos::Center, VPos::Center)).color(colour);
            let middle = |index: usize| index as i32 * self.cell() + self.cell() / 2;
            root.draw_text("S", &style, (at.0 + middle(index % side), at.1 + middle(index / side)))?;
        }
        Ok(())
    }

    /// The colour scale of each block below it.
    fn draw_bars(&self, root: &Area<'_>, top: i32) -> DrawResult {
        for (block, MazeBlock { scale: [low, what, high], .. }) in (0..).zip(&self.blocks) {
            scale::draw_bar(root, [low, what, high], (self.left(block, 1) + self.map_side() / 2, top))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance, Rec. 709 weights.
    fn grey(RGBColor(r, g, b): RGBColor) -> f64 {
        0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
    }

    #[test]
    fn the_scale_darkens_steadily_between_white_and_walls() {
        let greys: Vec<f64> = (0..=100).map(|i| grey(scale::colour(f64::from(i) / 100.0))).collect();
        assert!(greys.windows(2).all(|pair| pair[1] <= pair[0]), "{greys:?}");
        assert!(greys[0] < grey(UNSEEN) - 25.0 && greys[100] > grey(WALL) + 25.0, "{greys:?}");
        assert_eq!(scale::colour(0.125), RGBColor(188, 220, 59));
    }
}
