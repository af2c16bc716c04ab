//! Base colour images, decoded from files or made here. They are sampled as the GPU samples them
//! without mip levels.

use plisse::{Error, Result};

use crate::model::Model;
use crate::shade::from_srgb;
use crate::{Vec2, Vec3};

/// Largest side (pixels) that every GPU takes.
const LARGEST: usize = 4096;

/// Colour of models without image and texture coordinates (sRGB).
const SKIN_SRGB: [u8; 3] = [214, 176, 158];

/// An sRGB image, rows from the top; texture coordinates (0, 0) are its upper left corner, as in
/// glTF. It repeats.
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

    /// A checked cloth, eight checks along each side, for models without an image: it shows where
    /// the texture shifts.
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
        Self {
            width: size,
            height: size,
            rgba: (0..size * size).map(|i| colour(i % size, i / size)).collect(),
        }
    }

    /// The image that `model` is drawn with: its own, or else a checked cloth or one colour, as it
    /// has texture coordinates or not. With the reason, if its own cannot be read.
    pub fn of(model: &Model) -> (Self, Option<Error>) {
        match model.base_colour.as_ref().map(|bytes| Self::decode(&model.name, bytes)) {
            Some(Ok(texture)) => (texture, None),
            Some(Err(error)) => (Self::checked(), Some(error)),
            None if model.has_uvs() => (Self::checked(), None),
            None => (Self::plain(SKIN_SRGB), None),
        }
    }

    /// Decodes a PNG or JPEG image; larger ones than 4,096 pixels are halved until they fit.
    ///
    /// # Errors
    /// [`Error::Mesh`] at `place` if it is neither, or broken.
    pub fn decode(place: &str, bytes: &[u8]) -> Result<Self> {
        let decoded =
            if bytes.starts_with(b"\x89PNG") { from_png(bytes) } else { from_jpeg(bytes) };
        let mut texture = decoded.map_err(|e| {
            Error::mesh(
                place,
                format!("its image cannot be read ({e}); save it as PNG or JPEG again"),
            )
        })?;
        while texture.width.max(texture.height) > LARGEST {
            texture = texture.halved();
        }
        Ok(texture)
    }

    /// Half as large; each pixel is the mean of four.
    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let at = |x: usize, y: usize| {
            self.rgba[y.min(self.height - 1) * self.width + x.min(self.width - 1)]
        };
        let mean = |i: usize| {
            let (x, y) = (2 * (i % width), 2 * (i / width));
            let four = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
            std::array::from_fn(|c| (four.iter().map(|p| u32::from(p[c])).sum::<u32>() / 4) as u8)
        };
        Self { width, height, rgba: (0..width * height).map(mean).collect() }
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

/// An image with `channels` bytes a pixel: grey or red, green, blue, and perhaps opacity, which is
/// left out.
fn from_channels(
    width: usize,
    height: usize,
    channels: usize,
    bytes: &[u8],
) -> std::result::Result<Texture, String> {
    if !(1..=4).contains(&channels)
        || width * height == 0
        || bytes.len() < width * height * channels
    {
        return Err(format!("{width} x {height} pixels of {channels} channels"));
    }
    let colour =
        |p: &[u8]| if channels < 3 { [p[0], p[0], p[0], 255] } else { [p[0], p[1], p[2], 255] };
    Ok(Texture {
        width,
        height,
        rgba: bytes.chunks_exact(channels).take(width * height).map(colour).collect(),
    })
}

fn from_png(bytes: &[u8]) -> std::result::Result<Texture, String> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let mut data = vec![0; reader.output_buffer_size().ok_or("too large")?];
    let info = reader.next_frame(&mut data).map_err(|e| e.to_string())?;
    from_channels(info.width as usize, info.height as usize, info.color_type.samples(), &data)
}

fn from_jpeg(bytes: &[u8]) -> std::result::Result<Texture, String> {
    let mut decoder = zune_jpeg::JpegDecoder::new(std::io::Cursor::new(bytes));
    let data = decoder.decode().map_err(|e| format!("{e:?}"))?;
    let info = decoder.info().ok_or("no size")?;
    let (width, height) = (usize::from(info.width), usize::from(info.height));
    from_channels(width, height, data.len() / (width * height).max(1), &data)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampling_is_bilinear_and_repeats() {
        let texture = Texture { width: 2, height: 1, rgba: vec![[0, 0, 0, 255], [255; 4]] };
        for (u, value) in
            [(0.25, 0.0), (0.75, 1.0), (0.5, 0.5), (1.0, 0.5), (-0.25, 1.0), (3.25, 0.0)]
        {
            assert!((texture.at(&Vec2::new(u, 0.3)).x - value).abs() < 1e-5, "{u}");
        }
        for broken in [&b"no image"[..], b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0"] {
            let text = Texture::decode("x", broken).unwrap_err().to_string();
            assert!(
                text.starts_with("x: its image cannot be read") && text.ends_with("again"),
                "{text}"
            );
        }
        let jpeg = std::fs::read(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/images/live/square.jpg"
        ))
        .unwrap();
        let picture = Texture::decode("square.jpg", &jpeg).unwrap();
        assert_eq!((picture.width, picture.height), (1380, 312));
        // Its corner is the background, but for the losses of JPEG.
        let corner = picture.rgba[0];
        assert!((0..3).all(|c| corner[c].abs_diff(crate::draw::BACKGROUND[c]) < 8), "{corner:?}");
        let small =
            Texture { width: 3, height: 2, rgba: (0..6).map(|i| [40 * i, 0, 255, 255]).collect() }
                .halved();
        assert_eq!((small.width, small.height, small.rgba), (1, 1, vec![[80, 0, 255, 255]]));
        assert!(Texture::checked().rgba.len() == 512 * 512);
    }
}
