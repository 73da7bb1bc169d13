//! Reliability diagrams: a panel per teacher, measured success over the teacher's estimate of it.

use looks::colours::{BLUE, ORANGE};
use looks::{Dash, Look, Marker};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Axis, Chart, draw_mesh};
use super::canvas::{self, FRAME, MARGIN, PAGE_WIDTH};
use super::legend::{Label, Legend};
use super::shapes::{self, Area, DrawResult};
use super::{page, text};
use crate::analysis::calibration::BINS;
use crate::analysis::calibration::estimate::{Calibration, SeedBin};
use crate::analysis::teachers::GroupTeacher;
use crate::error::ReportError;
use crate::render::table::cells::{decimal, or_undefined};

/// Text sizes in points.
const TITLE: f64 = 7.5;
const AXIS: f64 = 8.0;
const NOTE: f64 = 6.5;
/// Lengths in pixels.
const COLUMNS: usize = 4;
const TITLE_HEIGHT: i32 = 56;
const X_TICKS_HEIGHT: i32 = 50;
const Y_TICKS_WIDTH: i32 = 74;
const Y_NAME_WIDTH: i32 = 46;
const X_NAME_HEIGHT: i32 = 48;
const RIGHT_MARGIN: i32 = 36;
const GAP: i32 = 18;
const WHISKER: u32 = 3;
/// Room around the axes, as a share of them.
const ROOM: f64 = 0.03;

/// Shares of estimates, behind everything.
const BARS: RGBColor = RGBColor(222, 222, 222);
/// Fewest estimates of all seeds that make a point: chance alone would place one of fewer.
pub(super) const FEWEST: u64 = 10;

/// The parts of a run that are drawn, by their place in [`Calibration::bins`].
const PARTS: [(usize, &str, Look); 2] = [
    (1, "first third of training", Look::new(ORANGE, Dash::Short, Marker::Square)),
    (3, "last third of training", Look::new(BLUE, Dash::Solid, Marker::Circle)),
];

/// The diagrams of the teachers of one environment, as SVG.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn calibration(environment: &str, judged: &[Calibration]) -> Result<String, ReportError> {
    text::register()?;
    let rows = rows(judged);
    let columns = rows.iter().map(|row| row.len()).max().unwrap_or(1) as i32;
    let room = (PAGE_WIDTH - 2 * MARGIN - Y_NAME_WIDTH) / (COLUMNS as i32);
    // At the scale of a page of four also where there are fewer, but no narrower than the legend.
    let width = (room * columns + Y_NAME_WIDTH + 2 * MARGIN).max(PAGE_WIDTH / 2);
    let left = (width - room * columns + Y_NAME_WIDTH) / 2;
    // Square plots.
    let height = room - Y_TICKS_WIDTH - RIGHT_MARGIN + TITLE_HEIGHT + X_TICKS_HEIGHT;
    let entries = PARTS.map(|(_, title, look)| (Label { title: title.into(), detail: String::new() }, look));
    let legend = Legend::new(&entries, width - 2 * MARGIN)?;
    let caption = page::caption_lines(&text::printable(&caption(environment, judged)), width)?;
    let below = MARGIN + rows.len() as i32 * (height + GAP) - GAP;
    let legend_top = below + X_NAME_HEIGHT + GAP;
    let caption_top = legend_top + legend.height() + GAP;
    canvas::svg((width, caption_top + page::caption_height(&caption)), |root| {
        for (row, teachers) in (0..).zip(&rows) {
            for (column, judged) in (0..).zip(*teachers) {
                let at = (left + column * room, MARGIN + row * (height + GAP));
                let title = text::shorten(&title(judged), &text::style(TITLE), room - GAP)?;
                Panel { judged, at, size: (room, height), is_first: column == 0 }
                    .draw(root, &title)
                    .map_err(canvas::failed("reliability diagram"))?;
            }
        }
        let name = text::style(AXIS).pos(Pos::new(HPos::Center, VPos::Top));
        let middle = left + (room * columns + Y_TICKS_WIDTH - RIGHT_MARGIN) / 2;
        root.draw_text("Teacher's estimate of success", &name, (middle, below))
            .map_err(canvas::failed("axis"))?;
        legend.draw(root, width / 2, legend_top)?;
        page::draw_caption(root, &caption, (width / 2, caption_top))
    })
}

/// The teachers in rows: a row for each group of students, or more where many teachers saw it.
fn rows(judged: &[Calibration]) -> Vec<&[Calibration]> {
    judged.chunk_by(|a, b| a.teacher.key == b.teacher.key).flat_map(|group| group.chunks(COLUMNS)).collect()
}

fn title(judged: &Calibration) -> String {
    let GroupTeacher { key, method } = &judged.teacher;
    if judged.teacher.is_shadow() { format!("{} on {}", method.title, key.name()) } else { key.name() }
}

fn caption(environment: &str, judged: &[Calibration]) -> String {
    let seeds: Vec<usize> = judged.iter().map(|row| row.n_seeds).collect();
    let seeds = super::caption::range((
        seeds.iter().copied().min().unwrap_or(0),
        seeds.iter().copied().max().unwrap_or(0),
    ));
    let is_watched = judged.iter().any(|judged| judged.teacher.is_shadow());
    let watched = if is_watched { " A on B: teacher A, which watched the student of B." } else { "" };
    format!(
        "{environment}: goals of the pool by their teacher's estimate of success, in {BINS} bins; points: mean measured \
         success over mean estimate of a bin, all seeds together; whiskers: standard deviation over the seeds (n = {seeds}) \
         that have one, cut at 0 and 1; bins of fewer than {FEWEST} estimates have none. Grey line: estimates that hold; \
         points below it: the teacher took goals for easier than they were. Bars: share of all estimates. ECE: expected \
         calibration error in the first and in the last third, mean over seeds. TEACH's and SPaCE's confidence is read as \
         ProCuRL reads it, as a share of the way from the lowest return there is to 0.{watched}"
    )
}

/// A diagram in its place.
struct Panel<'a> {
    judged: &'a Calibration,
    /// Top left corner and size in pixels.
    at: (i32, i32),
    size: (i32, i32),
    /// Whether it is the first of its row, where the y axis is named.
    is_first: bool,
}

impl Panel<'_> {
    fn draw(&self, root: &Area<'_>, title: &str) -> DrawResult {
        let (left, top) = self.at;
        let centre = left + (Y_TICKS_WIDTH + self.size.0 - RIGHT_MARGIN) / 2;
        let above = Pos::new(HPos::Center, VPos::Bottom);
        root.draw_text(title, &text::style(TITLE).pos(above), (centre, top + TITLE_HEIGHT - 6))?;
        if self.is_first {
            let style = text::style(AXIS).transform(FontTransform::Rotate270).pos(above);
            let middle = top + (TITLE_HEIGHT + self.size.1 - X_TICKS_HEIGHT) / 2;
            root.draw_text("Measured success", &style, (left, middle))?;
        }
        let plot = root
            .clone()
            .shrink((left, top + TITLE_HEIGHT), (self.size.0 - RIGHT_MARGIN, self.size.1 - TITLE_HEIGHT));
        let ticks = || (0..=5u8).map(|tick| f64::from(tick) / 5.0).collect();
        let axis = || Axis { range: -ROOM..1.0 + ROOM, ticks: ticks() };
        let mut chart = ChartBuilder::on(&plot)
            .y_label_area_size(Y_TICKS_WIDTH)
            .x_label_area_size(X_TICKS_HEIGHT)
            .build_cartesian_2d(axis(), axis())?;
        let pixel = |chart: &Chart<'_, '_>, x: f64, y: f64| chart.backend_coord(&(x, y.clamp(0.0, 1.0)));
        let bars = self.bars();
        for (low, share) in bars {
            let corners = [(low, share), (low + 1.0 / BINS as f64, 0.0)];
            let [from, to] = corners.map(|(x, y)| pixel(&chart, x, y));
            root.draw(&Rectangle::new([(from.0 + 2, from.1), (to.0 - 2, to.1)], BARS.filled()))?;
        }
        let label = |tick| format!("{tick:.1}");
        draw_mesh(&mut chart, &label, &label)?;
        let ends = [pixel(&chart, 0.0, 0.0), pixel(&chart, 1.0, 1.0)];
        root.draw(&PathElement::new(ends, FRAME.mix(0.6).stroke_width(3)))?;
        for (part, _, look) in PARTS {
            self.draw_part(root, part, look, &|x, y| pixel(&chart, x, y))?;
        }
        let error = |third: usize| or_undefined(self.judged.error.thirds[third].0, decimal);
        let note = format!("ECE {} → {}", error(0), error(2));
        let corner = pixel(&chart, 0.0, 1.0);
        let style = text::style(NOTE).pos(Pos::new(HPos::Left, VPos::Top));
        root.draw_text(&note, &style, (corner.0 + 6, corner.1 + 4))
    }

    /// The lower end of every bin and the share of the estimates that lie in it.
    fn bars(&self) -> Vec<(f64, f64)> {
        let counts = self.judged.bins[0].each_ref().map(|bin| bin.bin.count);
        let all: u64 = counts.iter().sum();
        let bar = |(index, count): (usize, u64)| {
            (count > 0).then(|| (index as f64 / BINS as f64, count as f64 / all as f64))
        };
        counts.into_iter().enumerate().filter_map(bar).collect()
    }

    /// The points of a part of a run, whiskers and the line through them.
    fn draw_part(
        &self,
        root: &Area<'_>,
        part: usize,
        look: Look,
        pixel: &dyn Fn(f64, f64) -> (i32, i32),
    ) -> DrawResult {
        let told = self.judged.bins[part].iter().filter(|bin| bin.bin.count >= FEWEST);
        let point = |bin: &SeedBin| Some((bin.bin.estimate()?, bin.bin.outcome()?, bin.std));
        let points: Vec<(f64, f64, Option<f64>)> = told.filter_map(point).collect();
        let colour = RGBColor(look.colour.0, look.colour.1, look.colour.2);
        for &(x, y, std) in &points {
            if let Some(std) = std {
                let ends = [pixel(x, y - std), pixel(x, y + std)];
                root.draw(&PathElement::new(ends, colour.mix(0.6).stroke_width(WHISKER)))?;
            }
        }
        let places: Vec<(i32, i32)> = points.iter().map(|&(x, y, _)| pixel(x, y)).collect();
        if places.len() > 1 {
            shapes::line(root, &places, look)?;
        }
        places.into_iter().try_for_each(|at| shapes::marker(root, at, look))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::analysis::catalogue::{Catalogue, MethodInfo};
    use crate::analysis::group::GroupKey;
    use crate::analysis::parts::{ByThird, ByThirdMeans};
    use crate::stats::ReliabilityBin;

    fn judged(curriculum: &str, teacher: &str, error: f64) -> Calibration {
        let mut bins = [[SeedBin::default(); BINS]; 4];
        let bin = |count| SeedBin {
            bin: ReliabilityBin { count, estimates: 0.45 * count as f64, outcomes: 0.0 },
            n_seeds: 2,
            std: Some(0.1),
        };
        (bins[0][4], bins[1][4], bins[3][4]) = (bin(30), bin(FEWEST - 1), bin(FEWEST));
        let thirds = [Some(error), None, Some(0.25)];
        Calibration {
            teacher: GroupTeacher {
                key: GroupKey::new(&Catalogue::default(), "E", curriculum, "default"),
                method: Arc::new(MethodInfo::new(teacher, teacher.to_uppercase(), None)),
            },
            n_seeds: 2,
            means: (0.45, 0.0),
            error: ByThirdMeans::of(&[ByThird { all: Some(error), thirds }]),
            correlation: ByThirdMeans::default(),
            bins,
        }
    }

    #[test]
    fn every_teacher_has_a_panel_in_the_row_of_its_student() {
        let first = ["a", "b", "c", "d", "e"].map(|teacher| judged("a", teacher, 0.5));
        let all = [&first[..], &[judged("f", "f", 0.75)]].concat();
        assert_eq!(rows(&all).iter().map(|row| row.len()).collect::<Vec<_>>(), [4, 1, 1]);
        let svg = calibration("E", &all).unwrap();
        assert_eq!(svg.matches("ECE 0.50 → 0.25").count(), 5);
        assert!(svg.contains("ECE 0.75 → 0.25") && svg.contains("B on a"), "{svg}");
        // Of the two parts only the last third has estimates enough for a point; the legend has one of each.
        assert_eq!(svg.matches("<circle").count(), 6 + 1);
    }
}
