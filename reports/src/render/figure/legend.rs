//! The legend below the panels: rows of equal columns, so that it never hides a curve.

use plotters::style::TextStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas;
use super::shapes::{self, Area};
use super::text;
use crate::error::ReportError;
use looks::Look;

/// Text size in points.
const TEXT: f64 = 7.0;
/// Lengths in pixels.
const ROW_HEIGHT: i32 = 44;
const SAMPLE_WIDTH: i32 = 90;
const SAMPLE_GAP: i32 = 12;
const COLUMN_GAP: i32 = 30;

/// What an entry says: `NOVA (n=3)`.
pub(super) struct Label {
    /// Name of the curriculum.
    pub(super) title: String,
    /// What follows it, or nothing.
    pub(super) detail: String,
}

impl Label {
    /// The label on at most `room` pixels. Where it is too long, both parts are shortened to share the room:
    /// either may be what tells two entries apart.
    fn fit(&self, style: &TextStyle<'_>, room: i32) -> Result<String, ReportError> {
        let whole = text::printable(&format!("{}{}", self.title, self.detail));
        if self.detail.is_empty() {
            return text::shorten(&whole, style, room);
        }
        if text::width(&whole, style)? <= room {
            return Ok(whole);
        }
        let (title, detail) = (text::width(&self.title, style)?, text::width(&self.detail, style)?);
        let half = room / 2;
        let title_room = half.max(room - detail);
        let detail_room = half.max(room - title);
        Ok(text::shorten(&self.title, style, title_room)? + &text::shorten(&self.detail, style, detail_room)?)
    }
}

/// A legend laid out for a given width.
pub(super) struct Legend {
    entries: Vec<(String, Look)>,
    columns: usize,
    column_width: i32,
}

impl Legend {
    /// Lays out labelled looks on at most `width` pixels; longer labels are shortened.
    pub(super) fn new(entries: &[(Label, Look)], width: i32) -> Result<Self, ReportError> {
        let style = text::style(TEXT);
        let room = width - SAMPLE_WIDTH - SAMPLE_GAP;
        let mut widest = 0;
        let mut fitted = Vec::with_capacity(entries.len());
        for (label, look) in entries {
            let label = label.fit(&style, room)?;
            widest = widest.max(text::width(&label, &style)?);
            fitted.push((label, *look));
        }
        let column_width = SAMPLE_WIDTH + SAMPLE_GAP + widest;
        let most = ((width + COLUMN_GAP) / (column_width + COLUMN_GAP)).max(1) as usize;
        // As few rows as possible, then as few columns: six entries on four columns become two rows of three.
        let rows = fitted.len().div_ceil(most).max(1);
        Ok(Self { columns: fitted.len().div_ceil(rows).max(1), entries: fitted, column_width })
    }

    /// Height in pixels.
    pub(super) fn height(&self) -> i32 {
        self.entries.len().div_ceil(self.columns) as i32 * ROW_HEIGHT
    }

    /// Draws the legend centred on `centre`, down from `top`.
    pub(super) fn draw(&self, root: &Area<'_>, centre: i32, top: i32) -> Result<(), ReportError> {
        let style = text::style(TEXT).pos(Pos::new(HPos::Left, VPos::Center));
        let columns = self.columns as i32;
        let left = centre - (columns * self.column_width + (columns - 1) * COLUMN_GAP) / 2;
        for (index, (label, look)) in self.entries.iter().enumerate() {
            let x = left + (index % self.columns) as i32 * (self.column_width + COLUMN_GAP);
            let y = top + (index / self.columns) as i32 * ROW_HEIGHT + ROW_HEIGHT / 2;
            shapes::line(root, &[(x, y), (x + SAMPLE_WIDTH, y)], *look)
                .and_then(|()| shapes::marker(root, (x + SAMPLE_WIDTH / 2, y), *look))
                .and_then(|()| root.draw_text(label, &style, (x + SAMPLE_WIDTH + SAMPLE_GAP, y)))
                .map_err(canvas::failed("legend"))?;
        }
        Ok(())
    }
}
