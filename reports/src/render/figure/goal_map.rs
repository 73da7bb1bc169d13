//! Goal maps: a row per method, its goals over time from above beside those from the side.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, FRAME, MARGIN, PAGE_WIDTH};
use super::shapes::{Area, DrawResult};
use super::{page, scale, text};
use crate::analysis::goal_map::{CELLS, GoalMaps, PROJECTIONS};
use crate::analysis::parts::PHASES;
use crate::error::ReportError;

/// Text sizes in points.
const TITLE: f64 = 9.0;
const LABEL: f64 = 8.0;
/// Lengths in pixels.
const TITLE_HEIGHT: i32 = 60;
const PHASE_HEIGHT: i32 = 60;
const LABEL_WIDTH: i32 = 280;
const GAP: i32 = 24;
const BLOCK_GAP: i32 = 60;
const CELL: i32 = (PAGE_WIDTH - 2 * MARGIN - LABEL_WIDTH - 4 * GAP - BLOCK_GAP) / (6 * CELLS as i32);
const SIDE: i32 = CELL * CELLS as i32;

/// What coordinates are called.
const AXES: [&str; 3] = ["x", "y", "z"];
/// From where each of [`PROJECTIONS`] looks.
const VIEWS: [&str; PROJECTIONS.len()] = ["From above", "From the side"];

/// The goal maps of one environment, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn goal_map(maps: &GoalMaps) -> Result<String, ReportError> {
    text::register()?;
    let top = MARGIN + TITLE_HEIGHT + PHASE_HEIGHT;
    let bar_top = top + maps.maps.len() as i32 * (SIDE + GAP);
    let caption_top = bar_top + scale::BAR_HEIGHT + GAP;
    let caption = page::caption_lines(&caption(maps), PAGE_WIDTH)?;
    let style = text::style(LABEL).pos(Pos::new(HPos::Left, VPos::Center));
    let names = maps.maps.iter().map(|map| text::shorten(&map.key.name(), &style, LABEL_WIDTH - GAP));
    let names: Vec<String> = names.collect::<Result<_, _>>()?;
    let most = most(maps);
    canvas::svg((PAGE_WIDTH, caption_top + page::caption_height(&caption)), |root| {
        draw_titles(root).map_err(canvas::failed("goal map titles"))?;
        for (row, (map, name)) in (0..).zip(maps.maps.iter().zip(&names)) {
            let row_top = top + row * (SIDE + GAP);
            root.draw_text(name, &style, (MARGIN, row_top + SIDE / 2))
                .map_err(canvas::failed("goal map labels"))?;
            for (block, phases) in (0..).zip(&map.counts) {
                for (phase, counts) in (0..).zip(phases) {
                    draw_map(root, &shares(counts), most, (left(block, phase), row_top))
                        .map_err(canvas::failed("goal map"))?;
                }
            }
        }
        draw_bar(root, most, bar_top).map_err(canvas::failed("goal map scale"))?;
        page::draw_caption(root, &caption, (PAGE_WIDTH / 2, caption_top))
    })
}

fn caption(maps: &GoalMaps) -> String {
    let axis = |(name, low): (&str, f64)| format!("{name} from {low:.3} to {:.3}", low + maps.cube.edge);
    let axes: Vec<String> = AXES.into_iter().zip(maps.cube.low).map(axis).collect();
    format!(
        "{}: share of a third's goals in each cell, by third of training, training episodes of all seeds; white: none; \
         maps show {} in the goals' own unit",
        text::printable(&maps.environment),
        axes.join(", "),
    )
}

/// Shares of the goals, `[CELLS * CELLS]`; all 0 without goals.
fn shares(counts: &[u32]) -> Vec<f64> {
    let total: u32 = counts.iter().sum();
    counts.iter().map(|&count| f64::from(count) / f64::from(total.max(1))).collect()
}

/// The highest share of any map: the end of the colour scale.
fn most(maps: &GoalMaps) -> f64 {
    let all = maps.maps.iter().flat_map(|map| map.counts.iter().flatten());
    all.flat_map(|counts| shares(counts)).fold(f64::MIN_POSITIVE, f64::max)
}

/// Left edge of map `phase` of a block.
fn left(block: i32, phase: i32) -> i32 {
    let map = SIDE + GAP;
    MARGIN + LABEL_WIDTH + block * (PHASES.len() as i32 * map - GAP + BLOCK_GAP) + phase * map
}

fn draw_titles(root: &Area<'_>) -> DrawResult {
    let above = Pos::new(HPos::Center, VPos::Bottom);
    for (block, (view, [right, up])) in (0..).zip(VIEWS.into_iter().zip(PROJECTIONS)) {
        let title = format!("{view}: {} to the right, {} up", AXES[right], AXES[up]);
        let centre = left(block, 1) + SIDE / 2;
        root.draw_text(&title, &text::style(TITLE).pos(above), (centre, MARGIN + TITLE_HEIGHT - 8))?;
        for (phase, name) in (0..).zip(PHASES) {
            let at = (left(block, phase) + SIDE / 2, MARGIN + TITLE_HEIGHT + PHASE_HEIGHT - 20);
            root.draw_text(name, &text::style(LABEL).pos(above), at)?;
        }
    }
    Ok(())
}

fn draw_map(root: &Area<'_>, shares: &[f64], most: f64, at: (i32, i32)) -> DrawResult {
    for (index, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
        let (row, column) = (index / CELLS, index % CELLS);
        let corner = (at.0 + column as i32 * CELL, at.1 + row as i32 * CELL);
        root.draw(&Rectangle::new(
            [corner, (corner.0 + CELL, corner.1 + CELL)],
            scale::colour(share / most).filled(),
        ))?;
    }
    root.draw(&Rectangle::new([at, (at.0 + SIDE, at.1 + SIDE)], FRAME.stroke_width(2)))
}

/// The colour scale of all maps below them.
fn draw_bar(root: &Area<'_>, most: f64, top: i32) -> DrawResult {
    scale::draw_bar(root, ["0 %", "of goals", &format!("{:.1} %", 100.0 * most)], (PAGE_WIDTH / 2, top))
}
