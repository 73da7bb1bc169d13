//! Figures, as SVG drawn with plotters.
//!
//! Figures are drawn for print at 300 pixels per inch: one panel at the width of a text column (3.5 inch),
//! several at the width of a page (7.16 inch). [`png`] renders the very same SVG; [`outlined`] frees it from
//! fonts.

mod agreement;
mod axis;
mod band;
mod basis;
mod calibration;
mod canvas;
mod caption;
mod efficiency;
mod film;
mod forest;
mod frontier;
mod goal_map;
mod heat;
mod learning;
mod legend;
mod maze;
mod numbers;
mod outline;
mod page;
mod palette;
mod panel;
mod profile;
mod ranks;
mod raster;
mod rates;
mod scale;
mod shapes;
mod style;
mod text;
mod ticks;
mod trials;

pub use agreement::{AgreementMatrix, agreement};
pub use band::Band;
pub use basis::Basis;
pub use calibration::calibration;
pub use efficiency::efficiency;
pub use film::{MOST_BYTES, Moving, film};
pub use forest::{aggregates, improvements};
pub use frontier::frontier;
pub use goal_map::goal_map;
pub use heat::heat;
pub use learning::{LearningPanel, ablation, by_environment, learning};
pub use numbers::numbers;
pub use outline::outlined;
pub use palette::{FALLBACK, Palette};
pub use profile::profiles;
pub use ranks::ranks;
pub use raster::png;
pub use style::Style;
pub use trials::trials;
