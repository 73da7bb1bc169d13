//! Moving pictures as GIF: few colours, and of each picture only what has changed.

use std::borrow::Cow;
use std::collections::HashMap;

use gif::{DisposalMethod, Encoder, Frame, Repeat};

use crate::error::ReportError;

/// Red, green and blue of a pixel.
pub type Pixel = [u8; 3];

/// Most colours of a palette; one more is kept for pixels that stay as they were.
const MOST_COLOURS: usize = 255;

/// A picture of a moving one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Still {
    /// Its pixels row by row, `[width * height]`.
    pub pixels: Vec<Pixel>,
    /// How long it stays, in hundredths of a second.
    pub hundredths: u16,
}

/// `stills` of `size` pixels, played again and again, as GIF, named `figure` in errors. Every pixel gets the
/// nearest colour of `palette`, so a colour of it stays as it is.
///
/// # Errors
/// [`ReportError::Figure`] if the pictures are larger than a GIF can be.
///
/// # Panics
/// If the palette is empty or has more than 255 colours, or a picture has other than `size` pixels.
pub fn animation(
    figure: &str,
    size: (u32, u32),
    palette: &[Pixel],
    stills: &[Still],
) -> Result<Vec<u8>, ReportError> {
    assert!((1..=MOST_COLOURS).contains(&palette.len()), "{} colours", palette.len());
    let side = |pixels: u32| u16::try_from(pixels).map_err(ReportError::figure(figure));
    let size = (side(size.0)?, side(size.1)?);
    let mut encoder =
        Encoder::new(Vec::new(), size.0, size.1, &palette.concat()).map_err(ReportError::figure(figure))?;
    encoder.set_repeat(Repeat::Infinite).map_err(ReportError::figure(figure))?;
    let mut nearest = Nearest { palette, known: HashMap::new() };
    let mut before: Option<Vec<u8>> = None;
    for still in stills {
        let colours: Vec<u8> = still.pixels.iter().map(|&pixel| nearest.index(pixel)).collect();
        assert_eq!(colours.len(), usize::from(size.0) * usize::from(size.1), "a colour for every pixel");
        let frame = change(before.as_deref(), &colours, size, palette.len() as u8);
        encoder
            .write_frame(&Frame { delay: still.hundredths, ..frame })
            .map_err(ReportError::figure(figure))?;
        before = Some(colours);
    }
    encoder.into_inner().map_err(ReportError::figure(figure))
}

/// Colours of a palette by what is nearest to them.
struct Nearest<'a> {
    palette: &'a [Pixel],
    known: HashMap<Pixel, u8>,
}

impl Nearest<'_> {
    /// The place of the colour that is nearest to `pixel`; the first of several.
    fn index(&mut self, pixel: Pixel) -> u8 {
        let palette = self.palette;
        *self.known.entry(pixel).or_insert_with(|| {
            let apart = |colour: &Pixel| -> i32 {
                pixel.iter().zip(colour).map(|(&a, &b)| (i32::from(a) - i32::from(b)).pow(2)).sum()
            };
            (0u8..).zip(palette).min_by_key(|(_, colour)| apart(colour)).map_or(0, |(index, _)| index)
        })
    }
}

/// The smallest frame that turns the colours `before` into `now`, pixels that stay being of the colour
/// `same`; all of it without a `before`.
fn change(before: Option<&[u8]>, now: &[u8], (width, height): (u16, u16), same: u8) -> Frame<'static> {
    let frame = |left: usize, top: usize, width: usize, height: usize, buffer: Vec<u8>| Frame {
        left: left as u16,
        top: top as u16,
        width: width as u16,
        height: height as u16,
        transparent: Some(same),
        dispose: DisposalMethod::Keep,
        buffer: Cow::Owned(buffer),
        ..Frame::default()
    };
    let (across, down) = (usize::from(width), usize::from(height));
    let Some(before) = before else { return frame(0, 0, across, down, now.to_vec()) };
    let changed = |index: &usize| before[*index] != now[*index];
    let places = || (0..now.len()).filter(changed);
    let columns = || places().map(|index| index % across);
    // A picture that stays as it was is still a frame.
    let (left, right) = (columns().min().unwrap_or(0), columns().max().unwrap_or(0));
    let (top, bottom) = (places().next().unwrap_or(0) / across, places().next_back().unwrap_or(0) / across);
    let pixel = |index: usize| if changed(&index) { now[index] } else { same };
    let rows = (top..=bottom).flat_map(|row| (left..=right).map(move |column| row * across + column));
    frame(left, top, right - left + 1, bottom - top + 1, rows.map(pixel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays a GIF: all pixels after each of its frames.
    fn played(bytes: &[u8]) -> Vec<Vec<Pixel>> {
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes).unwrap();
        let width = usize::from(decoder.width());
        let mut canvas = vec![[9, 9, 9]; width * usize::from(decoder.height())];
        let mut found = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            for (index, pixel) in frame.buffer.chunks(4).enumerate() {
                let across = usize::from(frame.width);
                let row = usize::from(frame.top) + index / across;
                let column = usize::from(frame.left) + index % across;
                if pixel[3] > 0 {
                    canvas[row * width + column] = [pixel[0], pixel[1], pixel[2]];
                }
            }
            found.push(canvas.clone());
        }
        found
    }

    #[test]
    fn every_picture_comes_back_in_colours_of_the_palette() {
        let [white, black, red] = [[255, 255, 255], [0, 0, 0], [200, 0, 0]];
        let still = |pixels: [Pixel; 6]| Still { pixels: pixels.to_vec(), hundredths: 10 };
        let stills = [
            still([white, white, white, white, white, white]),
            // Nearly black and nearly red.
            still([white, [9, 9, 9], white, white, white, [190, 9, 0]]),
            still([white, black, white, white, white, red]),
            still([black, white, white, white, white, red]),
        ];
        let bytes = animation("test", (3, 2), &[white, black, red], &stills).unwrap();
        let exact = [white, black, white, white, white, red];
        let expected =
            [vec![white; 6], exact.to_vec(), exact.to_vec(), vec![black, white, white, white, white, red]];
        assert_eq!(played(&bytes), expected);
        assert_eq!(animation("test", (3, 2), &[white, black, red], &stills).unwrap(), bytes);
        assert!(animation("test", (70_000, 1), &[white], &[]).is_err());
    }

    #[test]
    fn a_frame_holds_no_more_than_what_has_changed() {
        let before = [0, 0, 0, 0, 0, 0];
        let frame = change(Some(&before), &[0, 0, 1, 0, 2, 0], (3, 2), 7);
        assert_eq!((frame.left, frame.top, frame.width, frame.height), (1, 0, 2, 2));
        assert_eq!(&frame.buffer[..], [7, 1, 2, 7]);
        let still = change(Some(&before), &before, (3, 2), 7);
        assert_eq!((still.width, still.height, &still.buffer[..]), (1, 1, &[7][..]));
    }
}
