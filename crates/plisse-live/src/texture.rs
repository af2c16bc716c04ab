//! Base colour images: decoded from files or woven here, sampled like the GPU does it without mip levels.

use image::ImageReader;
use plisse::{Error, Result};

use crate::shade::from_srgb;
use crate::{Vec2, Vec3};

/// Largest side (pixels) that every GPU takes.
const LARGEST: u32 = 4096;

/// An sRGB image, rows from the top; texture coordinates (0, 0) are its upper left corner, as in glTF. It repeats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Width (pixels).
    pub width: usize,
    /// Height (pixels).
    pub height: usize,
    /// `[height][width]` red, green, blue, 255.
    pub rgba: Vec<[u8; 4]>,
}

impl Texture {
    /// One colour (sRGB).
    pub fn plain([r, g, b]: [u8; 3]) -> Self {
        Self { width: 1, height: 1, rgba: vec![[r, g, b, 255]] }
    }

    /// A checked cloth, eight checks along each side, for models without an image: it shows where the texture shifts.
    pub fn checked() -> Self {
        let size = 512;
        let band = |i: usize| (i / 32).is_multiple_of(2);
        let thread = |i: usize| i % 32 < 2;
        let colour = |x: usize, y: usize| match (band(x), band(y)) {
            _ if thread(x) || thread(y) => [222, 200, 178, 255],
            (true, true) => [186, 142, 122, 255],
            (false, false) => [216, 186, 164, 255],
            _ => [202, 164, 143, 255],
        };
        Self { width: size, height: size, rgba: (0..size * size).map(|i| colour(i % size, i / size)).collect() }
    }

    /// Decodes a PNG or JPEG image; larger ones than 4,096 pixels are halved until they fit.
    ///
    /// # Errors
    /// [`Error::Mesh`] at `place` if it is neither, or broken.
    pub fn decode(place: &str, bytes: &[u8]) -> Result<Self> {
        let bad = |e: &dyn std::fmt::Display| Error::mesh(place, format!("its image cannot be read ({e}); save it as PNG or JPEG again"));
        let reader = ImageReader::new(std::io::Cursor::new(bytes)).with_guessed_format().map_err(|e| bad(&e))?;
        let mut image = reader.decode().map_err(|e| bad(&e))?;
        while image.width().max(image.height()) > LARGEST {
            image = image.thumbnail_exact((image.width() / 2).max(1), (image.height() / 2).max(1));
        }
        let image = image.to_rgba8();
        let rgba = image.pixels().map(|p| [p.0[0], p.0[1], p.0[2], 255]).collect();
        Ok(Self { width: image.width() as usize, height: image.height() as usize, rgba })
    }

    /// Linear colour at `uv`: bilinear between linear values of the four nearest pixels, repeating.
    pub fn at(&self, uv: &Vec2) -> Vec3 {
        let place = |t: f32, size: usize| {
            let x = (t - t.floor()) * size as f32 - 0.5;
            let low = x.floor();
            let i = (low as i64).rem_euclid(size as i64) as usize;
            (i, (i + 1) % size, x - low)
        };
        let ((i, j, s), (k, l, t)) = (place(uv.x, self.width), place(uv.y, self.height));
        let pixel = |x: usize, y: usize| {
            let [r, g, b, _] = self.rgba[y * self.width + x];
            Vec3::new(from_srgb(r), from_srgb(g), from_srgb(b))
        };
        let (upper, lower) = (pixel(i, k).lerp(&pixel(j, k), s), pixel(i, l).lerp(&pixel(j, l), s));
        upper.lerp(&lower, t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampling_is_bilinear_and_repeats() {
        let texture = Texture { width: 2, height: 1, rgba: vec![[0, 0, 0, 255], [255; 4]] };
        for (u, value) in [(0.25, 0.0), (0.75, 1.0), (0.5, 0.5), (1.0, 0.5), (-0.25, 1.0), (3.25, 0.0)] {
            assert!((texture.at(&Vec2::new(u, 0.3)).x - value).abs() < 1e-5, "{u}");
        }
        assert!(Texture::decode("x", b"no image").is_err());
        assert!(Texture::checked().rgba.len() == 512 * 512);
    }
}
