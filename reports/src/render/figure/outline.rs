//! Text as outlines: the same picture in any viewer, without any font installed.

use resvg::usvg::{Options, Tree, WriteOptions};

use super::raster::fonts;
use crate::error::ReportError;

/// Digits after the point of coordinates, at 300 pixels per inch.
const PRECISION: u8 = 2;
/// Digits after the point of the factors in transforms.
const TRANSFORM_PRECISION: u8 = 6;

/// `svg`, named `figure` in errors, with every letter as a path of the embedded font.
///
/// # Errors
/// [`ReportError::Figure`] if `svg` is no valid SVG.
pub fn outlined(figure: &str, svg: &str) -> Result<String, ReportError> {
    let options = Options { fontdb: fonts(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(ReportError::figure(figure))?;
    let write = WriteOptions {
        coordinates_precision: PRECISION,
        transforms_precision: TRANSFORM_PRECISION,
        preserve_text: false,
        ..WriteOptions::default()
    };
    Ok(tree.to_string(&write))
}
