//! A finished picture.

use super::RenderError;

/// An RGB picture, eight bits per channel, rows from top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

impl Image {
    /// A picture of `width` × `height` pixels from 3·width·height bytes.
    pub(super) fn new(width: u32, height: u32, pixels: Vec<u8>) -> Self {
        debug_assert_eq!(pixels.len(), 3 * width as usize * height as usize);
        Self { width, height, pixels }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green and blue of all pixels, row after row: `[height, width, 3]`.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Red, green and blue of the pixel in column `x` and row `y`.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        assert!(
            x < self.width && y < self.height,
            "({x}, {y}) lies outside {} × {}",
            self.width,
            self.height
        );
        let first = 3 * (y as usize * self.width as usize + x as usize);
        [self.pixels[first], self.pixels[first + 1], self.pixels[first + 2]]
    }

    /// The picture as a PNG file.
    ///
    /// # Errors
    /// [`RenderError::Png`].
    pub fn to_png(&self) -> Result<Vec<u8>, RenderError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let encode = || {
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&self.pixels)?;
            writer.finish()
        };
        encode().map_err(|error: png::EncodingError| RenderError::Png { source: error.into() })?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::Image;

    #[test]
    fn a_png_holds_the_pixels() {
        let image = Image::new(2, 1, vec![255, 0, 0, 0, 0, 255]);
        assert_eq!((image.pixel(0, 0), image.pixel(1, 0)), ([255, 0, 0], [0, 0, 255]));
        let decoded = tiny_skia::Pixmap::decode_png(&image.to_png().unwrap()).unwrap();
        assert_eq!(decoded.data(), [255, 0, 0, 255, 0, 0, 255, 255]);
    }
}
