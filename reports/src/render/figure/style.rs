//! What all figures of a report have in common.

use super::band::Band;
use super::palette::Palette;
use crate::analysis::group::GroupKey;

/// How the figures of a report are drawn.
#[derive(Clone, Debug)]
pub struct Style {
    /// The looks of its curves.
    pub palette: Palette,
    /// Whether axes of rates span what there is to see, and not 0 to 1.
    pub zoom: bool,
    /// The bands of learning curves.
    pub band: Band,
}

impl Style {
    /// Looks for curves with these keys, axes from 0 to 1, and bands of one standard deviation.
    pub fn new<'a>(keys: impl IntoIterator<Item = &'a GroupKey>) -> Self {
        Self { palette: Palette::new(keys), zoom: false, band: Band::default() }
    }
}
