//! SVG to PNG, with the embedded font: the same picture on a machine without any fonts.

use std::sync::{Arc, OnceLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use crate::error::ReportError;
use crate::render::gif::Pixel;

/// The embedded font, and no other: PNGs must not depend on what is installed.
pub(super) fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let load = || {
        let mut database = fontdb::Database::new();
        database.load_font_data(dejavu::sans::regular().to_vec());
        database.set_sans_serif_family("DejaVu Sans");
        Arc::new(database)
    };
    FONTS.get_or_init(load).clone()
}

/// Renders `svg`, named `figure` in errors, at one pixel per SVG unit.
///
/// # Errors
/// [`ReportError::Figure`] if `svg` is no valid SVG or too large to render.
pub fn png(figure: &str, svg: &str) -> Result<Vec<u8>, ReportError> {
    pixmap(figure, svg)?.encode_png().map_err(ReportError::figure(figure))
}

/// The pixels of `svg`, likewise, row by row, with the width and height of the picture.
pub(super) fn pixels(figure: &str, svg: &str) -> Result<((u32, u32), Vec<Pixel>), ReportError> {
    let pixmap = pixmap(figure, svg)?;
    let opaque = pixmap.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
    Ok(((pixmap.width(), pixmap.height()), opaque.collect()))
}

fn pixmap(figure: &str, svg: &str) -> Result<Pixmap, ReportError> {
    let options = Options { fontdb: fonts(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(ReportError::figure(figure))?;
    let size = tree.size().to_int_size();
    let mut pixels = Pixmap::new(size.width(), size.height())
        .ok_or_else(|| format!("{} x {} pixels are too many", size.width(), size.height()))
        .map_err(ReportError::figure(figure))?;
    resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
    Ok(pixels)
}
