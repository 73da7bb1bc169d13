//! How alike teachers order the goals of a pool that saw the same student: a matrix for each third of its
//! training.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, FRAME, MARGIN, PAGE_WIDTH};
use super::shapes::{Area, DrawResult};
use super::{page, scale, text};
use crate::analysis::parts::PHASES;
use crate::analysis::shadow::agreement::AgreementSummary;
use crate::error::ReportError;
use crate::render::table::cells::decimal;

/// Text sizes in points.
const TITLE: f64 = 8.0;
const LABEL: f64 = 7.0;
const VALUE: f64 = 5.0;
/// Lengths in pixels.
const TITLE_HEIGHT: i32 = 56;
const HEAD_HEIGHT: i32 = 44;
const LABEL_WIDTH: i32 = 330;
const GAP: i32 = 40;
const LARGEST_CELL: i32 = 110;

/// The matrices of one group of runs.
#[derive(Debug)]
pub struct AgreementMatrix<'a> {
    /// The teacher that acted, as figures call its runs.
    pub name: String,
    /// Every two teachers.
    pub pairs: Vec<&'a AgreementSummary>,
}

impl AgreementMatrix<'_> {
    /// The teachers, by title, in the order in which pairs name them.
    fn teachers(&self) -> Vec<&str> {
        let mut titles: Vec<&str> = Vec::new();
        for teacher in self.pairs.iter().flat_map(|pair| &pair.teachers) {
            if !titles.contains(&teacher.title.as_str()) {
                titles.push(&teacher.title);
            }
        }
        titles
    }

    /// The mean correlation of two of them in a third.
    fn correlation(&self, (a, b): (&str, &str), third: usize) -> Option<f64> {
        let is_pair = |pair: &&&AgreementSummary| {
            let [one, other] = pair.teachers.each_ref().map(|teacher| teacher.title.as_str());
            (one, other) == (a, b) || (one, other) == (b, a)
        };
        self.pairs.iter().find(is_pair)?.correlation[third].0
    }
}

/// The matrices of the groups of one environment, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn agreement(environment: &str, matrices: &[AgreementMatrix<'_>]) -> Result<String, ReportError> {
    text::register()?;
    let caption = page::caption_lines(&text::printable(&caption(environment, matrices)), PAGE_WIDTH)?;
    let mut tops = Vec::with_capacity(matrices.len());
    let mut top = MARGIN + TITLE_HEIGHT;
    for matrix in matrices {
        tops.push(top);
        top += TITLE_HEIGHT + HEAD_HEIGHT + cell(matrix) * matrix.teachers().len() as i32 + GAP;
    }
    let caption_top = top + scale::BAR_HEIGHT + GAP;
    canvas::svg((PAGE_WIDTH, caption_top + page::caption_height(&caption)), |root| {
        for (matrix, &top) in matrices.iter().zip(&tops) {
            draw(root, matrix, top)?;
        }
        let bar = scale::draw_bar(root, ["-1.0", "rank correlation", "1.0"], (PAGE_WIDTH / 2, top));
        bar.map_err(canvas::failed("agreement scale"))?;
        page::draw_caption(root, &caption, (PAGE_WIDTH / 2, caption_top))
    })
}

/// Width of a cell in pixels.
fn cell(matrix: &AgreementMatrix<'_>) -> i32 {
    let room = (PAGE_WIDTH - 2 * MARGIN - LABEL_WIDTH - 2 * GAP) / 3;
    (room / matrix.teachers().len().max(1) as i32).min(LARGEST_CELL)
}

/// The three matrices of a group, down from `top`.
fn draw(root: &Area<'_>, matrix: &AgreementMatrix<'_>, top: i32) -> Result<(), ReportError> {
    let (teachers, cell) = (matrix.teachers(), cell(matrix));
    let label = text::style(LABEL).pos(Pos::new(HPos::Left, VPos::Center));
    let first = top + TITLE_HEIGHT + HEAD_HEIGHT;
    for (row, title) in (0..).zip(&teachers) {
        let title = text::shorten(&format!("{}  {title}", row + 1), &label, LABEL_WIDTH - GAP)?;
        let at = (MARGIN, first + row * cell + cell / 2);
        root.draw_text(&title, &label, at).map_err(canvas::failed("agreement labels"))?;
    }
    for (third, phase) in PHASES.into_iter().enumerate() {
        let left = MARGIN + LABEL_WIDTH + third as i32 * (cell * teachers.len() as i32 + GAP);
        let title = format!("{}: {phase}", matrix.name);
        draw_third(root, (matrix, &teachers, third), &title, (left, top))
            .map_err(canvas::failed("agreement"))?;
    }
    Ok(())
}

fn draw_third(
    root: &Area<'_>,
    (matrix, teachers, third): (&AgreementMatrix<'_>, &[&str], usize),
    title: &str,
    (left, top): (i32, i32),
) -> DrawResult {
    let cell = cell(matrix);
    let style = |points| text::style(points).pos(Pos::new(HPos::Center, VPos::Center));
    let middle = left + cell * teachers.len() as i32 / 2;
    root.draw_text(title, &style(TITLE), (middle, top + TITLE_HEIGHT / 2))?;
    let first = top + TITLE_HEIGHT + HEAD_HEIGHT;
    for (column, b) in (0..).zip(teachers) {
        let head = (left + column * cell + cell / 2, first - HEAD_HEIGHT / 2);
        root.draw_text(&(column + 1).to_string(), &style(LABEL), head)?;
        for (row, a) in (0..).zip(teachers) {
            let corner = (left + column * cell, first + row * cell);
            let square = [corner, (corner.0 + cell, corner.1 + cell)];
            // Below the diagonal: every two once.
            if row > column {
                let value = matrix.correlation((a, b), third);
                let colour = value.map_or(WHITE, |value| scale::colour(f64::midpoint(value, 1.0)));
                root.draw(&Rectangle::new(square, colour.filled()))?;
                let ink = if value.is_some_and(|value| value > 0.3) { &WHITE } else { &BLACK };
                let text = value.map_or("–".to_owned(), decimal);
                let at = (corner.0 + cell / 2, corner.1 + cell / 2);
                root.draw_text(&text, &style(VALUE).color(ink), at)?;
            }
            if row >= column {
                root.draw(&Rectangle::new(square, FRAME.stroke_width(1)))?;
            }
        }
    }
    Ok(())
}

fn caption(environment: &str, matrices: &[AgreementMatrix<'_>]) -> String {
    let names: Vec<&str> = matrices.iter().map(|matrix| matrix.name.as_str()).collect();
    format!(
        "{environment}: Spearman's rank correlation of the weights over the pool of every two teachers that saw the same \
         student, trained by {}; means over the evaluations of each third of a run, then over seeds. Dashes: one of the two \
         made no difference between goals. Teachers that do not weigh the pool are left out.",
        names.join(" or ")
    )
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::analysis::catalogue::{Catalogue, MethodInfo};
    use crate::analysis::group::GroupKey;

    #[test]
    fn every_two_teachers_have_a_cell() {
        let teacher = |id: &str| Arc::new(MethodInfo::new(id, id.to_uppercase(), None));
        let pair = |a: &str, b: &str, mean: Option<f64>| AgreementSummary {
            key: GroupKey::new(&Catalogue::default(), "E", "a", "default"),
            teachers: [teacher(a), teacher(b)],
            n_seeds: 2,
            correlation: [(mean, None), (None, None), (mean, None)],
            overlap: [(Some(0.1), None); 3],
        };
        let pairs = [pair("a", "b", Some(0.25)), pair("a", "c", Some(-0.5)), pair("b", "c", None)];
        let matrix = AgreementMatrix { name: "A".into(), pairs: pairs.iter().collect() };
        assert_eq!(matrix.teachers(), ["A", "B", "C"]);
        assert_eq!(matrix.correlation(("C", "A"), 0), Some(-0.5));
        assert_eq!(matrix.correlation(("A", "B"), 1), None);
        let svg = agreement("E", &[matrix]).unwrap();
        assert_eq!(svg.matches("0.25").count(), 2);
        assert!(svg.contains("-0.50") && svg.contains("3  C") && svg.contains("trained by A"), "{svg}");
    }
}
