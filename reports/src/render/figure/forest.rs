//! Points with their intervals, a row per method: aggregates and probabilities of improvement.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::basis::Basis;
use super::canvas::{self, FRAME, GRID, MARGIN, PAGE_WIDTH};
use super::rates::RateAxis;
use super::shapes::{self, Area, DrawResult};
use super::style::Style;
use super::{page, text};
use crate::analysis::aggregate::Aggregate;
use crate::analysis::group::GroupKey;
use crate::analysis::improvement::Improvement;
use crate::error::ReportError;
use looks::Look;

/// Text sizes in points.
const TITLE: f64 = 9.0;
const LABEL: f64 = 8.0;
const TICK: f64 = 7.0;
/// Lengths in pixels.
const ROW_HEIGHT: i32 = 58;
const TITLE_HEIGHT: i32 = 60;
const TICKS_HEIGHT: i32 = 48;
const NAME_HEIGHT: i32 = 48;
const WIDEST_LABEL: i32 = 700;
const GAP: i32 = 48;
/// Between plots: half a tick label sticks out on both sides.
const COLUMN_GAP: i32 = 96;
/// Height of the strokes at the ends of an interval.
const CAP: i32 = 10;

/// How far dots of a row lie below its middle, in turn.
const LIFTS: [i32; 5] = [0, -8, 8, -16, 16];

/// A value in [0, 1] and its interval.
type Estimate = (f64, Option<(f64, f64)>);

/// Single values behind an estimate.
pub(super) struct Dots {
    pub(super) all: Vec<f64>,
    /// Index of the one in a ring.
    pub(super) chosen: Option<usize>,
}

/// One plot over all rows.
pub(super) struct Column<'a> {
    title: &'a str,
    axis: RateAxis,
    /// A value to compare with: a line from top to bottom.
    reference: Option<f64>,
    estimates: Vec<Estimate>,
    /// Of every row; empty where no row has any.
    dots: Vec<Dots>,
}

/// Rows of estimates.
pub(super) struct Forest<'a> {
    pub(super) rows: Vec<(String, Look)>,
    pub(super) columns: Vec<Column<'a>>,
    pub(super) caption: String,
}

/// Interquartile mean and optimality gap of all methods, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn aggregates(rows: &[Aggregate<'_>], basis: &Basis<'_>, style: &Style) -> Result<String, ReportError> {
    let palette = &style.palette;
    let column = |title, x_name, estimate: fn(&Aggregate<'_>) -> Estimate| {
        Column::of(title, x_name, None, rows.iter().map(estimate).collect(), style)
    };
    Forest {
        rows: rows.iter().map(|row| (name(row.method), palette.look(row.method))).collect(),
        columns: vec![
            column("Interquartile mean", "Final success rate, more is better", |row| (row.iqm, row.iqm_ci)),
            column("Optimality gap", "Shortfall from 1, less is better", |row| {
                (row.optimality_gap, row.optimality_gap_ci)
            }),
        ],
        caption: format!("{}; {}", basis.runs(), lines(basis)),
    }
    .draw()
}

/// Probabilities that the first method, or a variant of it, improves on each other one, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn improvements(
    rows: &[Improvement<'_>],
    basis: &Basis<'_>,
    style: &Style,
) -> Result<String, ReportError> {
    let palette = &style.palette;
    let label = |row: &Improvement<'_>| {
        format!("{} over {} [{}]", name(row.method), name(row.other), row.environments)
    };
    Forest {
        rows: rows.iter().map(|row| (label(row), palette.look(row.other))).collect(),
        columns: vec![Column::of(
            "Probability of improvement",
            "P(a run scores above one of the other method)",
            Some(0.5),
            rows.iter().map(|row| (row.probability, row.interval)).collect(),
            style,
        )],
        caption: format!(
            "in brackets: environments that both methods have, in each the seeds that both have; {}",
            lines(basis)
        ),
    }
    .draw()
}

fn name(key: &GroupKey) -> String {
    key.name()
}

fn lines(basis: &Basis<'_>) -> String {
    format!("lines: {}; none where an environment has a single seed", basis.intervals())
}

impl<'a> Column<'a> {
    pub(super) fn of(
        title: &'a str,
        x_name: &str,
        reference: Option<f64>,
        estimates: Vec<Estimate>,
        style: &Style,
    ) -> Self {
        let ends = |(value, interval): &Estimate| {
            let (low, high) = interval.unwrap_or((*value, *value));
            [low, *value, high]
        };
        let values = estimates.iter().flat_map(ends).chain(reference);
        let axis = RateAxis::of(x_name, style.zoom, values);
        Self { title, axis, reference, estimates, dots: Vec::new() }
    }

    /// The same without intervals, and with single values of every row behind its estimate.
    pub(super) fn with_dots(
        title: &'a str,
        x_name: &str,
        estimates: Vec<Estimate>,
        dots: Vec<Dots>,
        style: &Style,
    ) -> Self {
        let values = estimates.iter().map(|(value, _)| *value);
        let values = values.chain(dots.iter().flat_map(|dots| dots.all.iter().copied()));
        let axis = RateAxis::of(x_name, style.zoom, values);
        Self { title, axis, reference: None, estimates, dots }
    }
}

impl Forest<'_> {
    pub(super) fn draw(&self) -> Result<String, ReportError> {
        text::register()?;
        let style = text::style(LABEL).pos(Pos::new(HPos::Right, VPos::Center));
        let mut labels = Vec::with_capacity(self.rows.len());
        let mut widest = 0;
        for (label, _) in &self.rows {
            let label = text::shorten(label, &style, WIDEST_LABEL)?;
            widest = widest.max(text::width(&label, &style)?);
            labels.push(label);
        }
        let left = MARGIN + widest + GAP;
        let count = self.columns.len() as i32;
        let width = (PAGE_WIDTH - MARGIN - left - (count - 1) * COLUMN_GAP) / count - GAP;
        let top = MARGIN + TITLE_HEIGHT;
        let height = self.rows.len() as i32 * ROW_HEIGHT;
        let caption = page::caption_lines(&self.caption, PAGE_WIDTH)?;
        let caption_top = top + height + TICKS_HEIGHT + NAME_HEIGHT + MARGIN;
        canvas::svg((PAGE_WIDTH, caption_top + page::caption_height(&caption)), |root| {
            for (index, label) in (0..).zip(&labels) {
                let at = (left - GAP / 2, top + index * ROW_HEIGHT + ROW_HEIGHT / 2);
                root.draw_text(label, &style, at).map_err(canvas::failed("labels"))?;
            }
            for (index, column) in (0..).zip(&self.columns) {
                let at = (left + index * (width + COLUMN_GAP), top);
                self.draw_column(root, column, at, (width, height)).map_err(canvas::failed(column.title))?;
            }
            page::draw_caption(root, &caption, (PAGE_WIDTH / 2, caption_top))
        })
    }

    fn draw_column(
        &self,
        root: &Area<'_>,
        column: &Column<'_>,
        at: (i32, i32),
        size: (i32, i32),
    ) -> DrawResult {
        let ((left, top), (width, height)) = (at, size);
        let bottom = top + height;
        let RateAxis { low, high, ref ticks, ref name, .. } = column.axis;
        let x = |share: f64| {
            let inside = (share.clamp(low, high) - low) / (high - low);
            left + (inside * f64::from(width)).round() as i32
        };
        let above = Pos::new(HPos::Center, VPos::Bottom);
        let below = Pos::new(HPos::Center, VPos::Top);
        let centre = left + width / 2;
        root.draw_text(column.title, &text::style(TITLE).pos(above), (centre, top - 12))?;
        for &tick in ticks {
            canvas::segment(root, (x(tick), top), (x(tick), bottom), GRID.stroke_width(2))?;
            let label = column.axis.label(tick);
            root.draw_text(&label, &text::style(TICK).pos(below), (x(tick), bottom + 10))?;
        }
        let name_style = text::style(LABEL).pos(below);
        root.draw_text(name, &name_style, (centre, bottom + TICKS_HEIGHT))?;
        if let Some(reference) = column.reference {
            canvas::segment(root, (x(reference), top), (x(reference), bottom), FRAME.stroke_width(3))?;
        }
        canvas::segment(root, (left, bottom), (left + width, bottom), FRAME.stroke_width(3))?;
        for (index, ((value, interval), (_, look))) in (0..).zip(column.estimates.iter().zip(&self.rows)) {
            let y = top + index * ROW_HEIGHT + ROW_HEIGHT / 2;
            if let Some((from, to)) = *interval {
                let solid = Look { dash: looks::Dash::Solid, ..*look };
                shapes::line(root, &[(x(from), y), (x(to), y)], solid)?;
                for end in [x(from), x(to)] {
                    shapes::line(root, &[(end, y - CAP), (end, y + CAP)], solid)?;
                }
            }
            shapes::marker(root, (x(*value), y), *look)?;
            if let Some(dots) = column.dots.get(index as usize) {
                // Equal values beside each other, below and above the row's middle.
                for (number, (&value, lift)) in dots.all.iter().zip(LIFTS.iter().cycle()).enumerate() {
                    let at = (x(value), y + lift);
                    shapes::dot(root, at, *look)?;
                    if dots.chosen == Some(number) {
                        shapes::ring(root, at)?;
                    }
                }
            }
        }
        Ok(())
    }
}
