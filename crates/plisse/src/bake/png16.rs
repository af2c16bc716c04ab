//! Maps as PNG files with 16 bits a channel.
//!
//! Zero is 32768 in both kinds, exactly: height = (value − 32768)/32767 · scale, normal component =
//! (value − 32768)/32767.

use std::io::{self, Write};

use super::maps::Baked;

/// The key of the PNG text that holds a height map's scale (m).
pub const SCALE_KEY: &str = "plisse:height-scale-m";

/// Writes the heights of `baked` to `out`, 16-bit grey: 0.5 is zero, white is `scale_m` (m), black
/// −`scale_m`; what lies beyond is cut off. The scale stands in a text of the file, under
/// [`SCALE_KEY`].
///
/// # Errors
/// Those of `out`; [`io::ErrorKind::InvalidData`] for a scale that is not above 0.
pub fn write_height(out: &mut dyn Write, baked: &Baked, scale_m: f64) -> io::Result<()> {
    if !(scale_m > 0.0 && scale_m.is_finite()) {
        return Err(io::Error::new(
            io::ErrorKind::InvalidData,
            format!("a height map cannot have the scale {scale_m} m; give one above 0"),
        ));
    }
    let texts = [
        (SCALE_KEY, format!("{scale_m:e}")),
        (
            "Comment",
            "height_m = (value - 32768) / 32767 * height-scale-m; value of 16 bits, no \
            colour space"
                .to_owned(),
        ),
    ];
    let values = baked.height_m.iter().map(|&h| level(f64::from(h) / scale_m));
    write(out, baked.size, png::ColorType::Grayscale, &texts, values)
}

/// Writes the normals of `baked` to `out`, 16-bit RGB: red along u, green along v (up), blue
/// outwards.
///
/// # Errors
/// Those of `out`.
pub fn write_normal(out: &mut dyn Write, baked: &Baked) -> io::Result<()> {
    let texts =
        [("Comment", "tangent-space normals, +Y up (glTF, OpenGL); no colour space".to_owned())];
    let values = baked.normal.iter().flatten().map(|&x| level(f64::from(x)));
    write(out, baked.size, png::ColorType::Rgb, &texts, values)
}

/// The 16-bit level of a number in [−1, 1].
fn level(x: f64) -> u16 {
    (32768.0 + 32767.0 * x.clamp(-1.0, 1.0)).round() as u16
}

fn write(
    out: &mut dyn Write,
    size: usize,
    colour: png::ColorType,
    texts: &[(&str, String)],
    values: impl Iterator<Item = u16>,
) -> io::Result<()> {
    let side = u32::try_from(size)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidInput, "the map is too large for PNG"))?;
    let mut encoder = png::Encoder::new(out, side, side);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fast);
    for (key, text) in texts {
        encoder.add_text_chunk((*key).to_owned(), text.clone())?;
    }
    let mut writer = encoder.write_header()?;
    let bytes: Vec<u8> = values.flat_map(u16::to_be_bytes).collect();
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(())
}
