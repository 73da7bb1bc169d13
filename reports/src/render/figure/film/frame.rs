//! One picture of a film: the world with the goals of a slice, and how far training has come.

use looks::colours::VERMILION;
use plotters::prelude::*;
use plotters::style::TextStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::canvas::{self, FRAME};
use super::super::maze::WALL;
use super::super::shapes::{Area, DrawResult};
use super::super::{scale, text};
use crate::analysis::catalogue::MazeInfo;
use crate::analysis::film::{Film, FilmPick, GoalWorld, Slice};
use crate::analysis::goal_map::{Cube, PROJECTIONS};
use crate::error::ReportError;
use crate::render::table::cells::thousands;
use crate::wording::counted_u64;

/// Lengths in pixels.
const MARGIN: i32 = 14;
const TITLE_HEIGHT: i32 = 34;
const MAZE_SIDE: i32 = 468;
const SPACE_SIDE: i32 = 372;
const SPACE_GAP: i32 = 20;
const SPACE_TITLE: i32 = 24;
const KEY_HEIGHT: i32 = 40;
const STRIP_HEIGHT: i32 = 64;
const STRIP_LABEL: i32 = 24;
/// Radius of a goal of the pool, and of one that was trained on in no and in all episodes of the slice.
const GOAL: f64 = 3.5;
const PICKED: (f64, f64) = (7.0, 24.0);
const RING_WIDTH: i32 = 4;

/// Heights of text in pixels.
const TITLE: f64 = 20.0;
const LABEL: f64 = 14.5;

/// Colours.
pub(super) const PAPER: RGBColor = WHITE;
pub(super) const RING: RGBColor = RGBColor(VERMILION.0, VERMILION.1, VERMILION.2);
/// A goal of which nobody knows whether it can be reached.
const UNKNOWN: RGBColor = RGBColor(170, 170, 170);
/// A goal that was trained on, likewise.
const PICKED_UNKNOWN: RGBColor = RGBColor(242, 207, 178);
const CURVE: RGBColor = RGBColor(40, 40, 40);
const FUTURE: RGBColor = RGBColor(205, 205, 205);

/// Steps of the colour scale of success: tenths.
const LEVELS: u8 = 10;

/// All colours of a picture.
pub(super) fn colours() -> Vec<RGBColor> {
    let levels = (0..=LEVELS).map(|level| success_colour(f64::from(level) / f64::from(LEVELS)));
    [PAPER, WALL, RING, UNKNOWN, PICKED_UNKNOWN, CURVE, FUTURE, FRAME].into_iter().chain(levels).collect()
}

/// The colour of a success rate, rounded to tenths.
fn success_colour(rate: f64) -> RGBColor {
    scale::colour((rate * f64::from(LEVELS)).round() / f64::from(LEVELS))
}

/// The picture of a slice, as SVG.
pub(super) fn draw(world: GoalWorld<'_>, film: &Film, slice: &Slice) -> Result<String, ReportError> {
    let (width, side, top) = match world {
        GoalWorld::Maze(_) => (MAZE_SIDE, MAZE_SIDE, MARGIN + TITLE_HEIGHT),
        GoalWorld::Space(_) => (2 * SPACE_SIDE + SPACE_GAP, SPACE_SIDE, MARGIN + TITLE_HEIGHT + SPACE_TITLE),
    };
    let key_top = top + side + 8;
    let strip_top = key_top + KEY_HEIGHT;
    let height = strip_top + STRIP_HEIGHT + STRIP_LABEL + MARGIN;
    canvas::svg((width + 2 * MARGIN, height), |root| {
        draw_title(root, film, width)?;
        match world {
            GoalWorld::Maze(_) => draw_view(root, world, (film, slice), [1, 0], (MARGIN, top)),
            GoalWorld::Space(_) => draw_views(root, world, (film, slice), top),
        }
        .and_then(|()| draw_key(root, slice, (width, key_top)))
        .and_then(|()| draw_strip(root, film, slice, (width, strip_top)))
        .map_err(canvas::failed("film"))
    })
}

/// Black text of so many pixels.
fn label(pixels: f64, across: HPos, down: VPos) -> TextStyle<'static> {
    text::style(pixels * 72.0 / 300.0).pos(Pos::new(across, down))
}

fn draw_title(root: &Area<'_>, film: &Film, width: i32) -> Result<(), ReportError> {
    let seed = format!("seed {}", film.seed);
    let right = label(LABEL, HPos::Right, VPos::Center);
    let room = width - text::width(&seed, &right)? - MARGIN;
    let style = label(TITLE, HPos::Left, VPos::Center);
    let title = text::shorten(&format!("{}: {}", film.key.environment, film.key.name()), &style, room)?;
    let middle = MARGIN + TITLE_HEIGHT / 2 - 4;
    root.draw_text(&title, &style, (MARGIN, middle))
        .and_then(|()| root.draw_text(&seed, &right, (MARGIN + width, middle)))
        .map_err(canvas::failed("film"))
}

/// From above and from the side.
fn draw_views(root: &Area<'_>, world: GoalWorld<'_>, shown: (&Film, &Slice), top: i32) -> DrawResult {
    const TITLES: [&str; 2] = ["from above: x to the right, y up", "from the side: x to the right, z up"];
    for (index, (title, axes)) in (0..).zip(TITLES.into_iter().zip(PROJECTIONS)) {
        let left = MARGIN + index * (SPACE_SIDE + SPACE_GAP);
        let style = label(LABEL, HPos::Center, VPos::Center);
        root.draw_text(title, &style, (left + SPACE_SIDE / 2, top - SPACE_TITLE / 2))?;
        draw_view(root, world, shown, axes, (left, top))?;
    }
    Ok(())
}

/// The world in one projection: which coordinate goes to the right, and which up (down in mazes).
fn draw_view(
    root: &Area<'_>,
    world: GoalWorld<'_>,
    (film, slice): (&Film, &Slice),
    axes: [usize; 2],
    at: (i32, i32),
) -> DrawResult {
    let side = if let GoalWorld::Maze(_) = world { MAZE_SIDE } else { SPACE_SIDE };
    if let GoalWorld::Maze(maze) = world {
        draw_walls(root, maze, at)?;
    }
    let pixel = |goal: &[f32]| {
        let [across, down] = match world {
            GoalWorld::Maze(_) => axes.map(|axis| f64::midpoint(f64::from(goal[axis]), 1.0)),
            GoalWorld::Space(cube) => in_cube(&cube, goal, axes),
        };
        let place = |share: f64| (share.clamp(0.0, 1.0) * f64::from(side)).round() as i32;
        (at.0 + place(across), at.1 + place(down))
    };
    for (index, goal) in film.goals.iter().enumerate() {
        let rate = slice.success.as_ref().and_then(|rates| rates.get(index));
        let colour = rate.map_or(UNKNOWN, |&rate| success_colour(rate));
        root.draw(&Circle::new(pixel(goal), GOAL.round() as i32 + 1, FRAME.filled()))?;
        root.draw(&Circle::new(pixel(goal), GOAL.round() as i32, colour.filled()))?;
    }
    // The large ones below: none is hidden.
    let mut picks: Vec<&FilmPick> = slice.picks.iter().collect();
    picks.sort_by_key(|pick| std::cmp::Reverse(pick.times));
    for pick in picks {
        let rate = pick.goal.and_then(|goal| slice.success.as_ref()?.get(goal as usize));
        let colour = rate.map_or(PICKED_UNKNOWN, |&rate| success_colour(rate));
        let radius = radius(f64::from(pick.times) / f64::from(slice.episodes())).round() as i32;
        root.draw(&Circle::new(pixel(&pick.place), radius, RING.filled()))?;
        root.draw(&Circle::new(pixel(&pick.place), radius - RING_WIDTH, colour.filled()))?;
    }
    root.draw(&Rectangle::new([at, (at.0 + side, at.1 + side)], FRAME.stroke_width(1)))
}

/// Radius of a goal with this share of the episodes: what it covers beyond the smallest grows with it.
fn radius(share: f64) -> f64 {
    let (none, all) = PICKED;
    (none * none + share * (all * all - none * none)).sqrt()
}

/// Where a goal lies in a projection of the cube, from its upper left corner, as shares of the edge.
fn in_cube(cube: &Cube, goal: &[f32], [right, up]: [usize; 2]) -> [f64; 2] {
    // Room for the goals at the border.
    let share = |axis: usize| (f64::from(goal[axis]) - cube.low[axis]) / cube.edge * 0.9 + 0.05;
    [share(right), 1.0 - share(up)]
}

/// The walls as in the maps of mazes, and the start.
fn draw_walls(root: &Area<'_>, maze: &MazeInfo, at: (i32, i32)) -> DrawResult {
    let cells = maze.side() as i32;
    let edge = |index: i32| index * MAZE_SIDE / cells;
    for row in 0..cells {
        for column in 0..cells {
            let corner = (at.0 + edge(column), at.1 + edge(row));
            let opposite = (at.0 + edge(column + 1), at.1 + edge(row + 1));
            match maze.cell(row as usize, column as usize) {
                '#' => root.draw(&Rectangle::new([corner, opposite], WALL.filled()))?,
                'S' => {
                    let middle = (i32::midpoint(corner.0, opposite.0), i32::midpoint(corner.1, opposite.1));
                    root.draw_text("S", &label(TITLE, HPos::Center, VPos::Center), middle)?;
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// What rings and colours mean, in a line.
fn draw_key(root: &Area<'_>, slice: &Slice, (width, top): (i32, i32)) -> DrawResult {
    let middle = top + KEY_HEIGHT / 2 - 4;
    let style = label(LABEL, HPos::Left, VPos::Center);
    let at = (MARGIN + 9, middle);
    root.draw(&Circle::new(at, 9, RING.filled()))?;
    root.draw(&Circle::new(at, 9 - RING_WIDTH, WHITE.filled()))?;
    let picked = format!("goals of {}", counted_u64(u64::from(slice.episodes()), "episode"));
    root.draw_text(&picked, &style, (MARGIN + 25, middle))?;
    let right = MARGIN + width;
    if slice.success.is_none() {
        root.draw(&Circle::new((right - 6, middle), 5, UNKNOWN.filled()))?;
        let style = label(LABEL, HPos::Right, VPos::Center);
        return root.draw_text("goals of the pool", &style, (right - 18, middle));
    }
    let block = 7;
    let bar = right - block * (i32::from(LEVELS) + 1) - 12;
    for level in 0..=LEVELS {
        let left = bar + i32::from(level) * block;
        let colour = success_colour(f64::from(level) / f64::from(LEVELS));
        root.draw(&Rectangle::new([(left, middle - 6), (left + block, middle + 7)], colour.filled()))?;
    }
    root.draw_text("measured success  0", &label(LABEL, HPos::Right, VPos::Center), (bar - 4, middle))?;
    root.draw_text("1", &label(LABEL, HPos::Right, VPos::Center), (right, middle))
}

/// Success in evaluations over training, up to the slice's end and beyond it, with the slice in it.
fn draw_strip(root: &Area<'_>, film: &Film, slice: &Slice, (width, top): (i32, i32)) -> DrawResult {
    let end = film.end().max(1) as f64;
    let x = |step: u64| MARGIN + (step as f64 / end * f64::from(width)).round() as i32;
    let y = |rate: f64| top + 3 + ((1.0 - rate) * f64::from(STRIP_HEIGHT - 6)).round() as i32;
    let bottom = top + STRIP_HEIGHT;
    let (from, to) = (x(slice.steps.0), x(slice.steps.1));
    root.draw(&Rectangle::new([(from, top), (to.max(from + 2), bottom)], PICKED_UNKNOWN.filled()))?;
    let place = |&(step, rate): &(u64, f64)| (x(step), y(rate));
    let all: Vec<(i32, i32)> = film.curve.iter().map(place).collect();
    let so_far: Vec<(i32, i32)> =
        film.curve.iter().filter(|(step, _)| *step <= slice.steps.1).map(place).collect();
    root.draw(&PathElement::new(all, FUTURE.stroke_width(2)))?;
    root.draw(&PathElement::new(so_far, CURVE.stroke_width(2)))?;
    root.draw(&Rectangle::new([(MARGIN, top), (MARGIN + width, bottom)], FRAME.stroke_width(1)))?;
    let middle = bottom + STRIP_LABEL / 2 + 2;
    let steps = format!("steps {} to {}", thousands(slice.steps.0), thousands(slice.steps.1));
    root.draw_text(&steps, &label(LABEL, HPos::Left, VPos::Center), (MARGIN, middle))?;
    let what = "success in evaluations, 0 to 1";
    root.draw_text(what, &label(LABEL, HPos::Right, VPos::Center), (MARGIN + width, middle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_sizes_by_hand() {
        assert_eq!([0.0, 1.0].map(radius), [PICKED.0, PICKED.1]);
        // A third of the area between the two.
        let third = (49.0 + (576.0 - 49.0) / 3.0_f64).sqrt();
        assert!((radius(1.0 / 3.0) - third).abs() < 1e-12);
        let cube = Cube { low: [1.0, 0.0, -1.0], edge: 2.0 };
        // x halfway, y at the upper end, z at the lower one.
        let goal = [2.0, 2.0, -1.0];
        assert_eq!(in_cube(&cube, &goal, PROJECTIONS[0]).map(|share| (share * 100.0).round()), [50.0, 5.0]);
        assert_eq!(in_cube(&cube, &goal, PROJECTIONS[1]).map(|share| (share * 100.0).round()), [50.0, 95.0]);
        assert_eq!(success_colour(0.44), scale::colour(0.4));
    }
}
