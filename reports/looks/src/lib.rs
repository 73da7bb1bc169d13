//! How the curves of a method are drawn: colour, dashes and marker.
//!
//! A crate of its own, so that a method can carry its look without knowing of figures, and figures can draw
//! it without knowing of methods.

/// Red, green, blue.
pub type Rgb = (u8, u8, u8);

/// How a curve is drawn. Colour, dashes and marker each tell methods apart, so that figures can be read in
/// grey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Colour of line, marker and band.
    pub colour: Rgb,
    /// Dash pattern of the line.
    pub dash: Dash,
    /// Shape on the line.
    pub marker: Marker,
}

/// Dash pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// No gaps.
    Solid,
    /// Dashes with short gaps.
    Long,
    /// Dashes as long as the gaps.
    Short,
    /// Dots.
    Dotted,
    /// Long dashes and dots in turn.
    DashDot,
    /// Short dashes far apart.
    Sparse,
}

/// Shape of the markers on a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle.
    Circle,
    /// Filled square.
    Square,
    /// Filled triangle, tip up.
    Triangle,
    /// Filled triangle, tip down.
    Wedge,
    /// Filled square on its corner.
    Diamond,
    /// Diagonal cross.
    Cross,
}

impl Look {
    /// The look with these three.
    pub const fn new(colour: Rgb, dash: Dash, marker: Marker) -> Self {
        Self { colour, dash, marker }
    }
}

/// Colours that can be told apart with all common forms of colour blindness: Okabe and Ito, "Color Universal
/// Design" (2008).
pub mod colours {
    use super::Rgb;

    /// Black.
    pub const BLACK: Rgb = (0, 0, 0);
    /// Orange.
    pub const ORANGE: Rgb = (230, 159, 0);
    /// Sky blue.
    pub const SKY_BLUE: Rgb = (86, 180, 233);
    /// Bluish green, a little darker than theirs, which is too close to vermilion in grey.
    pub const GREEN: Rgb = (0, 154, 112);
    /// Blue.
    pub const BLUE: Rgb = (0, 114, 178);
    /// Vermilion.
    pub const VERMILION: Rgb = (213, 94, 0);
    /// Reddish purple.
    pub const PURPLE: Rgb = (204, 121, 167);
    /// Grey, in the place of their yellow, which fades on white paper; dark enough to stand out from the
    /// lines of the grid and from bands.
    pub const GREY: Rgb = (135, 135, 135);
}
