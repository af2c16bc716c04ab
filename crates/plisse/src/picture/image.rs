//! A picture in memory and as a PNG file.

use std::io::{self, Write};

/// An opaque sRGB picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// `[height][width][3]` red, green, blue (sRGB, 0–255), from the upper left.
    pub pixels: Vec<u8>,
}

impl Image {
    /// A white picture.
    pub fn blank(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![255; width * height * 3] }
    }

    /// The colour at column `x`, row `y`.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        assert!(
            x < self.width && y < self.height,
            "pixel {x}, {y} lies outside {}x{}",
            self.width,
            self.height
        );
        let at = 3 * (y * self.width + x);
        [self.pixels[at], self.pixels[at + 1], self.pixels[at + 2]]
    }

    /// Colours the pixel at `x`, `y`, if there is one.
    pub(super) fn set(&mut self, x: usize, y: usize, colour: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = 3 * (y * self.width + x);
            self.pixels[at..at + 3].copy_from_slice(&colour);
        }
    }

    /// Copies `other` with its upper left corner to `left`, `top`; what does not fit is left out.
    pub(super) fn paste(&mut self, other: &Image, left: usize, top: usize) {
        let width = other.width.min(self.width.saturating_sub(left));
        for y in 0..other.height.min(self.height.saturating_sub(top)) {
            let from = 3 * y * other.width;
            let to = 3 * ((top + y) * self.width + left);
            self.pixels[to..to + 3 * width].copy_from_slice(&other.pixels[from..from + 3 * width]);
        }
    }
}

/// Writes `image` to `out` as an 8-bit sRGB PNG file.
///
/// # Errors
/// Those of `out`; also an image without pixels, or with more than 2³¹ − 1 in a row or column,
/// which PNG cannot hold.
pub fn write_png(image: &Image, out: &mut dyn Write) -> io::Result<()> {
    let side = |n: usize| {
        u32::try_from(n).map_err(|_| {
            io::Error::new(io::ErrorKind::InvalidInput, "the picture is too large for PNG")
        })
    };
    let mut encoder = png::Encoder::new(out, side(image.width)?, side(image.height)?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // A fraction of the time, for files a quarter larger.
    encoder.set_compression(png::Compression::Fast);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&image.pixels)?;
    writer.finish()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_decodes_to_the_same_pixels() {
        let pixels = (0..17 * 9 * 3).map(|i| (i * 37 % 251) as u8).collect();
        let image = Image { width: 17, height: 9, pixels };
        let mut file = Vec::new();
        write_png(&image, &mut file).unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(file)).read_info().unwrap();
        let mut decoded = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut decoded).unwrap();
        assert_eq!((info.width, info.height, decoded), (17, 9, image.pixels));
    }

    #[test]
    fn an_empty_picture_is_an_error_and_not_a_panic() {
        assert!(write_png(&Image::blank(0, 5), &mut Vec::new()).is_err());
    }

    #[test]
    fn pasting_past_the_border_is_cut_off() {
        let mut image = Image::blank(4, 4);
        image.paste(&Image { width: 3, height: 3, pixels: vec![7; 27] }, 2, 3);
        assert_eq!(image.pixel(3, 3), [7; 3]);
        assert_eq!(image.pixels.iter().filter(|&&b| b == 7).count(), 6);
        image.paste(&Image::blank(2, 2), 9, 9);
    }
}
