//! A page: panels in rows, the legend below them, the caption below that.

use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, COLUMN_WIDTH, MARGIN, PAGE_WIDTH};
use super::legend::{Label, Legend};
use super::panel::{self, Content, Panel};
use super::shapes::Area;
use super::text;
use crate::error::ReportError;
use looks::Look;

/// Height of the plots, as a share of their width.
const ASPECT: f64 = 0.66;
/// Text size of the caption in points, and the height of its lines in pixels.
const CAPTION: f64 = 6.5;
const CAPTION_HEIGHT: i32 = 36;
/// Space above the legend and above the caption in pixels.
const GAP: i32 = 18;

/// Lines of text for a caption on a page of `width` pixels.
pub(super) fn caption_lines(caption: &str, width: i32) -> Result<Vec<String>, ReportError> {
    text::wrap(caption, &text::style(CAPTION), width - 2 * MARGIN)
}

/// Height of so many lines of a caption in pixels, with the margin below.
pub(super) fn caption_height(lines: &[String]) -> i32 {
    lines.len() as i32 * CAPTION_HEIGHT + MARGIN
}

/// Draws the lines of a caption, centred, down from `at`.
pub(super) fn draw_caption(root: &Area<'_>, lines: &[String], at: (i32, i32)) -> Result<(), ReportError> {
    let style = text::style(CAPTION).pos(Pos::new(HPos::Center, VPos::Top));
    for (index, line) in lines.iter().enumerate() {
        let at = (at.0, at.1 + index as i32 * CAPTION_HEIGHT);
        root.draw_text(line, &style, at).map_err(canvas::failed("caption"))?;
    }
    Ok(())
}

/// What a page shows.
pub(super) struct Page {
    pub(super) panels: Vec<Content>,
    pub(super) legend: Vec<(Label, Look)>,
    pub(super) caption: String,
}

impl Page {
    /// Draws the page as SVG: one panel at the width of a text column, several at the width of a page.
    pub(super) fn draw(&self) -> Result<String, ReportError> {
        text::register()?;
        let (width, columns) = self.grid();
        let panels = self.layout(width, columns);
        let legend = Legend::new(&self.legend, width - 2 * MARGIN)?;
        let caption = caption_lines(&self.caption, width)?;

        let below_panels = panels.iter().map(|panel| panel.at.1 + panel.size.1).max().unwrap_or(0);
        let legend_top = below_panels + panel::X_NAME_HEIGHT + GAP;
        let caption_top = legend_top + legend.height() + GAP;
        let height = caption_top + caption_height(&caption);

        canvas::svg((width, height), |root| {
            for panel in &panels {
                panel.draw(root)?;
            }
            legend.draw(root, width / 2, legend_top)?;
            draw_caption(root, &caption, (width / 2, caption_top))
        })
    }

    /// Width of the page in pixels, and panels per row.
    fn grid(&self) -> (i32, i32) {
        match self.panels.len() {
            0 | 1 => (COLUMN_WIDTH, 1),
            2 | 4 => (PAGE_WIDTH, 2),
            3 | 5 | 6 | 9 => (PAGE_WIDTH, 3),
            _ => (PAGE_WIDTH, 4),
        }
    }

    /// The panels row by row; axes are named at the left and where there is no panel below.
    fn layout(&self, width: i32, columns: i32) -> Vec<Panel<'_>> {
        let left = MARGIN + panel::Y_NAME_WIDTH;
        let panel_width = (width - left) / columns;
        let plot_height = (f64::from(panel_width) * ASPECT) as i32;
        let size = (panel_width, panel::TITLE_HEIGHT + plot_height + panel::X_TICKS_HEIGHT);
        let count = self.panels.len() as i32;
        let place = |(index, content)| {
            let (row, column) = (index / columns, index % columns);
            Panel {
                content,
                at: (left + column * panel_width, MARGIN + row * (size.1 + GAP)),
                size,
                name_x: index + columns >= count,
                name_y: column == 0,
            }
        };
        (0..).zip(&self.panels).map(place).collect()
    }
}
