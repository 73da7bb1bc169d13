//! Drawing the plane from above: walls, start, path, goal, body, point.
//!
//! The first coordinate runs downwards and the second to the right, as the rows and columns of the mazes do.

use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Rect, Stroke, Transform};

use super::{Image, PlaneScene, Rectangle, RenderError};

const GROUND: [u8; 3] = [250, 250, 247];
const WALL: [u8; 3] = [64, 70, 82];
const START: [u8; 3] = [203, 213, 225];
const PATH: [u8; 3] = [37, 99, 235];
const GOAL: [u8; 3] = [220, 38, 38];
const BODY: [u8; 3] = [100, 116, 139];

/// Radius of the point, in the units of the square.
const POINT_RADIUS: f32 = 0.035;
/// Width of the path, in the units of the square.
const PATH_WIDTH: f32 = 0.02;
/// Width of a body's parts.
const BODY_WIDTH: f32 = 0.05;

/// Draws planes and remembers where the point went.
pub(super) struct PlaneRenderer {
    width: u32,
    height: u32,
    path: Vec<[f64; 2]>,
}

impl PlaneRenderer {
    pub(super) fn new(width: u32, height: u32) -> Self {
        Self { width, height, path: Vec::new() }
    }

    pub(super) fn forget_path(&mut self) {
        self.path.clear();
    }

    pub(super) fn draw(&mut self, scene: &PlaneScene<'_>) -> Result<Image, RenderError> {
        if self.path.last() != Some(&scene.position) {
            self.path.push(scene.position);
        }
        let pixmap = Pixmap::new(self.width, self.height).ok_or(RenderError::Memory)?;
        let mut canvas = Canvas { to_pixels: self.to_pixels(), pixmap };
        canvas.pixmap.fill(colour(WALL, u8::MAX));
        canvas.ground(scene.free);
        canvas.disc(self.path[0], POINT_RADIUS, START, u8::MAX);
        canvas.disc(scene.goal, scene.threshold as f32, GOAL, 70);
        canvas.disc(scene.goal, POINT_RADIUS / 2.0, GOAL, u8::MAX);
        canvas.line(&self.path, PATH_WIDTH, &paint(PATH, 160, true));
        canvas.line(&scene.body, BODY_WIDTH, &paint(BODY, u8::MAX, true));
        canvas.disc(scene.position, POINT_RADIUS, PATH, u8::MAX);
        let rgb = canvas.pixmap.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
        Ok(Image::new(self.width, self.height, rgb.collect()))
    }

    /// From (x₁, x₀) to pixels: the square as large as it fits, in the middle.
    fn to_pixels(&self) -> Transform {
        let (width, height) = (self.width as f32, self.height as f32);
        let scale = width.min(height) / 2.0;
        Transform::from_row(scale, 0.0, 0.0, scale, width / 2.0, height / 2.0)
    }
}

struct Canvas {
    pixmap: Pixmap,
    to_pixels: Transform,
}

impl Canvas {
    /// The ground, part by part where there are walls.
    fn ground(&mut self, free: Option<&[Rectangle]>) {
        let mut path = PathBuilder::new();
        for corners in free.unwrap_or(&[[[-1.0; 2], [1.0; 2]]]) {
            let [[top, left], [bottom, right]] = corners.map(|corner| corner.map(|edge| edge as f32));
            Rect::from_ltrb(left, top, right, bottom).into_iter().for_each(|cell| path.push_rect(cell));
        }
        self.fill(path, GROUND, u8::MAX, false);
    }

    fn disc(&mut self, centre: [f64; 2], radius: f32, rgb: [u8; 3], opacity: u8) {
        let mut path = PathBuilder::new();
        path.push_circle(centre[1] as f32, centre[0] as f32, radius);
        self.fill(path, rgb, opacity, true);
    }

    fn fill(&mut self, path: PathBuilder, rgb: [u8; 3], opacity: u8, smooth: bool) {
        let Some(path) = path.finish() else { return };
        let paint = paint(rgb, opacity, smooth);
        self.pixmap.fill_path(&path, &paint, FillRule::Winding, self.to_pixels, None);
    }

    fn line(&mut self, points: &[[f64; 2]], width: f32, paint: &Paint<'_>) {
        let mut path = PathBuilder::new();
        for (index, [x0, x1]) in points.iter().map(|point| point.map(|part| part as f32)).enumerate() {
            if index == 0 { path.move_to(x1, x0) } else { path.line_to(x1, x0) }
        }
        // A single point is no line.
        let Some(path) = path.finish() else { return };
        let stroke =
            Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixmap.stroke_path(&path, paint, &stroke, self.to_pixels, None);
    }
}

fn paint(rgb: [u8; 3], opacity: u8, smooth: bool) -> Paint<'static> {
    let mut paint = Paint { anti_alias: smooth, ..Paint::default() };
    paint.set_color(colour(rgb, opacity));
    paint
}

fn colour([red, green, blue]: [u8; 3], opacity: u8) -> Color {
    Color::from_rgba8(red, green, blue, opacity)
}
