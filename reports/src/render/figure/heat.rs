//! Heat maps of mazes: a row per method, where its teacher sent the student beside where the student
//! succeeded.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, FRAME, MARGIN, PAGE_WIDTH};
use super::shapes::{Area, DrawResult};
use super::{page, scale, text};
use crate::analysis::catalogue::MazeInfo;
use crate::analysis::heat::{FEWEST_EPISODES, HeatMap, HeatPhase, MazeHeat, PHASES};
use crate::error::ReportError;
use crate::render::table::cells::thousands;
use crate::wording::counted;

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
const WALL: RGBColor = RGBColor(20, 20, 20);
/// A free cell without a colour: no goal lay there, or too few for a rate.
const UNSEEN: RGBColor = RGBColor(255, 255, 255);

/// The heat maps of the methods run in one maze, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn heat(heat: &MazeHeat<'_>) -> Result<String, ReportError> {
    Sheet::new(heat).draw()
}

/// The layout: two blocks of three maps per row.
struct Sheet<'a> {
    maze: &'a MazeInfo,
    maps: &'a [HeatMap],
    /// Training steps whose thirds are shown.
    end: u64,
    /// Width of a cell of the maze in pixels.
    cell: i32,
    /// Highest share of goals in a cell: the end of its colour scale.
    most: f64,
}

impl<'a> Sheet<'a> {
    fn new(MazeHeat { maze, end, maps }: &'a MazeHeat<'a>) -> Self {
        let room = PAGE_WIDTH - 2 * MARGIN - LABEL_WIDTH - 4 * GAP - BLOCK_GAP;
        let cell = (room / (6 * maze.side() as i32)).max(1);
        let shares = maps.iter().flat_map(|map| &map.phases).flat_map(|phase| phase.shares());
        Self { maze, maps, end: *end, cell, most: shares.fold(f64::MIN_POSITIVE, f64::max) }
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
        let caption = page::caption_lines(&text::printable(&self.caption()), PAGE_WIDTH)?;
        let caption_top = bars_top + scale::BAR_HEIGHT + GAP;
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

    /// What the maps show, and of what.
    fn caption(&self) -> String {
        let partly = self.maps.iter().filter(|map| map.runs.0 < map.runs.1);
        let runs: Vec<String> = partly
            .map(|map| format!("{}: {} of {}", map.key.name(), map.runs.0, counted(map.runs.1, "run")))
            .collect();
        let seeds = match &runs[..] {
            [] => "all seeds".to_owned(),
            runs => format!(
                "all seeds, but only those with a record of what their teacher did ({})",
                runs.join(", ")
            ),
        };
        format!(
            "{}: training episodes (with exploration noise) by thirds of {} training steps, in each the episodes that ended \
             there; {seeds}. Black: walls. Left: share of the third's goals, white where none lay. Right: success rate, white \
             where fewer than {FEWEST_EPISODES} goals lay. Empty maps say why.",
            self.maze.id,
            thousands(self.end),
        )
    }

    /// Why the map of goals of the third `index` and the one of success are empty, where they are.
    fn reasons(&self, map: &HeatMap, index: usize, phase: &HeatPhase) -> [Option<&'static str>; 2] {
        let begin = (u128::from(self.end) * index as u128 / 3) as u64;
        if phase.total() == 0 {
            let why = if map.reached <= begin { "not trained so far" } else { "no episode here" };
            return [Some(why); 2];
        }
        let has_rate = phase.rates().iter().any(Option::is_some);
        [None, (!has_rate).then_some("too few goals")]
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
        for (index, phase) in map.phases.iter().enumerate() {
            let [no_goals, no_rates] = self.reasons(map, index, phase);
            let index = index as i32;
            let shares: Vec<Option<f64>> =
                phase.shares().into_iter().map(|share| (share > 0.0).then_some(share / self.most)).collect();
            for (block, values, reason) in [(0, shares, no_goals), (1, phase.rates(), no_rates)] {
                let at = (self.left(block, index), top);
                self.draw_map(root, &values, at)?;
                if let Some(reason) = reason {
                    self.draw_reason(root, reason, at)?;
                }
            }
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
                Some(value) => scale::colour(*value),
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
            scale::draw_bar(root, [low, what, high], (self.left(block, 1) + self.map_side() / 2, top))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::catalogue::Catalogue;
    use crate::analysis::group::GroupKey;

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

    #[test]
    fn empty_maps_say_why() {
        let maze = MazeInfo { id: "M".into(), grid: ["..", ".S"].map(String::from).to_vec() };
        let key = GroupKey::new(&Catalogue::default(), "M", "nova", "default");
        let phase = |episodes: [u32; 4]| HeatPhase { episodes: episodes.to_vec(), successes: vec![0; 4] };
        let phases = [phase([9, 1, 0, 0]), phase([4, 4, 4, 4]), phase([0; 4])];
        let map = HeatMap { key, runs: (1, 2), reached: 60, phases };
        let heat = MazeHeat { maze: &maze, end: 90, maps: vec![map] };
        let sheet = Sheet::new(&heat);
        let reasons = |index: usize| sheet.reasons(&heat.maps[0], index, &heat.maps[0].phases[index]);
        assert_eq!(reasons(0), [None, None]);
        assert_eq!(reasons(1), [None, Some("too few goals")]);
        assert_eq!(reasons(2), [Some("not trained so far"); 2]);
        let caption = sheet.caption();
        assert!(
            caption.contains("thirds of 90 training steps") && caption.contains("nova: 1 of 2 runs"),
            "{caption}"
        );
        let svg = super::heat(&heat).unwrap();
        assert!(svg.contains("not trained so far") && svg.contains("too few goals"));
    }
}
