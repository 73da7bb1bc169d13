//! Moving pictures of where a teacher sent its student: a picture for each slice of training.

mod frame;

use rayon::prelude::*;

use super::raster;
use crate::analysis::film::{Film, GoalWorld, Slice};
use crate::error::ReportError;
use crate::render::gif::{self, Pixel, Still};

/// A moving picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moving {
    /// The GIF.
    pub gif: Vec<u8>,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Its pictures.
    pub pictures: usize,
}

/// A file has no more bytes, so that a page can hold many of them.
pub const MOST_BYTES: usize = 1_000_000;

/// How long a picture stays, and the last one, in hundredths of a second.
const FRAME_TIME: u16 = 20;
const LAST_FRAME_TIME: u16 = 200;

/// The film of a run in its `world`. Neighbouring slices are shown together where it would be larger than
/// [`MOST_BYTES`] otherwise.
///
/// # Errors
/// [`ReportError::Figure`] if drawing fails.
pub fn film(world: GoalWorld<'_>, film: &Film) -> Result<Moving, ReportError> {
    let mut film = film.clone();
    loop {
        let moving = shoot(world, &film)?;
        if moving.gif.len() <= MOST_BYTES || film.slices.len() <= 1 {
            return Ok(moving);
        }
        film = film.halved();
    }
}

fn shoot(world: GoalWorld<'_>, film: &Film) -> Result<Moving, ReportError> {
    let last = film.slices.len().saturating_sub(1);
    let still = |(index, slice): (usize, &Slice)| {
        let svg = frame::draw(world, film, slice)?;
        let (size, pixels) = raster::pixels("film", &svg)?;
        let hundredths = if index < last { FRAME_TIME } else { LAST_FRAME_TIME };
        Ok((size, Still { pixels, hundredths }))
    };
    let shot: Result<Vec<_>, ReportError> = film.slices.par_iter().enumerate().map(still).collect();
    let (sizes, stills): (Vec<(u32, u32)>, Vec<Still>) = shot?.into_iter().unzip();
    let size = sizes.first().copied().unwrap_or((1, 1));
    let gif = gif::animation("film", size, &palette(), &stills)?;
    Ok(Moving { gif, size, pictures: stills.len() })
}

/// All colours of a frame, and some between each of them and what lies beside it, for smooth edges.
fn palette() -> Vec<Pixel> {
    let between = |(a, b): (Pixel, Pixel), share: f64| -> Pixel {
        [0, 1, 2].map(|channel| {
            let [a, b] = [a, b].map(|colour: Pixel| f64::from(colour[channel]));
            (a + (b - a) * share).round() as u8
        })
    };
    let mut colours: Vec<Pixel> = (0..=16u8).map(|step| [step.saturating_mul(16); 3]).collect();
    let mut add = |colour: Pixel| {
        if !colours.contains(&colour) {
            colours.push(colour);
        }
    };
    let told: Vec<Pixel> =
        frame::colours().into_iter().map(|colour| [colour.0, colour.1, colour.2]).collect();
    told.iter().for_each(|&colour| add(colour));
    let [white, ring] = [frame::PAPER, frame::RING].map(|colour| [colour.0, colour.1, colour.2]);
    for &colour in &told {
        for share in [0.33, 0.67] {
            add(between((colour, white), share));
        }
        add(between((colour, ring), 0.5));
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gif_can_hold_the_palette() {
        let palette = palette();
        assert!(palette.len() < 256, "{}", palette.len());
        for colour in frame::colours() {
            assert!(palette.contains(&[colour.0, colour.1, colour.2]), "{colour:?}");
        }
    }
}
