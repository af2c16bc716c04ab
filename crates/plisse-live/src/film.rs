//! A film of frames at half their size, as an animated PNG.

use std::io::{self, Write};

use plisse::picture::Image;

/// Largest number of frames a second that browsers play.
const FASTEST_FPS: f64 = 30.0;
/// Largest size of the pixels in memory (bytes); of longer films only every n-th frame is taken.
const MOST_BYTES: usize = 512 << 20;

/// Frames on their way into a file.
#[derive(Clone, Debug)]
pub struct Film {
    size: [usize; 2],
    frames: Vec<Vec<u8>>,
    /// Every n-th frame is taken, for this n.
    every: usize,
    seen: usize,
    /// Milliseconds between frames of the film.
    delay_ms: u16,
}

impl Film {
    /// A film of `frames` pictures of `size` (width, height) pixels, `fps` a second.
    pub fn new(size: [usize; 2], frames: usize, fps: f64) -> Self {
        let size = size.map(|s| (s / 2).max(1));
        let fit = (MOST_BYTES / (3 * size[0] * size[1])).max(1);
        let every = ((fps / FASTEST_FPS).ceil() as usize).max(frames.div_ceil(fit)).max(1);
        Self {
            size,
            frames: Vec::new(),
            every,
            seen: 0,
            delay_ms: (1e3 * every as f64 / fps).round().clamp(1.0, 60_000.0) as u16,
        }
    }

    /// Adds the next picture.
    pub fn push(&mut self, image: &Image) {
        if self.seen.is_multiple_of(self.every) {
            let pixel = |i: usize| {
                let (x, y) = (i % self.size[0], i / self.size[0]);
                let four = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| {
                    image.pixel(
                        (2 * x + dx).min(image.width - 1),
                        (2 * y + dy).min(image.height - 1),
                    )
                });
                [0, 1, 2]
                    .map(|c| ((four.iter().map(|p| u32::from(p[c])).sum::<u32>() + 2) / 4) as u8)
            };
            self.frames.push((0..self.size[0] * self.size[1]).flat_map(pixel).collect());
        }
        self.seen += 1;
    }

    /// True if there are not two frames yet: a still, no film.
    pub fn is_still(&self) -> bool {
        self.frames.len() < 2
    }

    /// Writes the film.
    ///
    /// # Errors
    /// Any error of `out`.
    pub fn write<W: Write>(self, out: W) -> io::Result<()> {
        let mut encoder = png::Encoder::new(out, self.size[0] as u32, self.size[1] as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_animated(self.frames.len() as u32, 0).map_err(io::Error::other)?;
        encoder.set_frame_delay(self.delay_ms, 1000).map_err(io::Error::other)?;
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        for frame in &self.frames {
            writer.write_image_data(frame).map_err(io::Error::other)?;
        }
        writer.finish().map_err(io::Error::other)
    }
}
