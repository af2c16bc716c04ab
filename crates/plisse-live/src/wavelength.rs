//! Wavelengths that differ over a model: shares of one given wavelength, from vertex colours or
//! from a map read through the texture coordinates.
//!
//! A share of 1 is the whole wavelength, 0.5 half of it. Shares below [`LEAST_SHARE`] count as this
//! one, because waves shorter than any pixel are of no use.

use plisse::{Error, Result};

use crate::Vec2;
use crate::weld::WeldedMesh;

/// Least share of the wavelength (no unit).
pub const LEAST_SHARE: f32 = 0.05;

/// Wavelengths as [`crate::live::LiveOptions`] takes them: one for all (m, rest) without `shares`
/// (`[V]`, of draw vertices, 0..1), else `[U]` of them; a welded vertex takes the share of its
/// first draw vertex.
pub fn per_vertex(welded: &WeldedMesh, wavelength_m: f32, shares: Option<&[f32]>) -> Vec<f32> {
    let Some(shares) = shares else { return vec![wavelength_m] };
    let mut result = vec![f32::NAN; welded.count()];
    for (&v, share) in welded.vertex_of_draw.iter().zip(shares) {
        let wavelength = &mut result[v as usize];
        if wavelength.is_nan() {
            *wavelength =
                wavelength_m * if share.is_finite() { share.clamp(LEAST_SHARE, 1.0) } else { 1.0 };
        }
    }
    // There are fewer shares than draw vertices only if the caller made a mistake.
    result.iter_mut().filter(|w| w.is_nan()).for_each(|w| *w = wavelength_m);
    result
}

/// Shares `[V]` (0..1) that the PNG file `bytes` has at `uvs` (`[V]`, glTF's: v down, from the
/// upper left): its first channel as the numbers stand there (0..255 or 0..65535, no colour space),
/// interpolated linearly between pixel centres, repeated outside [0, 1].
///
/// # Errors
/// [`Error::Value`] for a file that is no PNG.
pub fn sample_map(bytes: &[u8], uvs: &[Vec2]) -> Result<Vec<f32>> {
    let bad = |e: &dyn std::fmt::Display| {
        Error::value(
            "wavelength map",
            format!("it is no readable PNG ({e}); save it as PNG, grey or RGB"),
        )
    };
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| bad(&e))?;
    let size = reader.output_buffer_size().ok_or_else(|| bad(&"too large"))?;
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data).map_err(|e| bad(&e))?;
    let (width, height) = (info.width as usize, info.height as usize);
    let (step, wide) = (info.color_type.samples(), info.bit_depth == png::BitDepth::Sixteen);
    let pixel = |x: i64, y: i64| {
        let i = (y.rem_euclid(height as i64) as usize * width
            + x.rem_euclid(width as i64) as usize)
            * step;
        if wide {
            f32::from(u16::from_be_bytes([data[2 * i], data[2 * i + 1]])) / 65535.0
        } else {
            f32::from(data[i]) / 255.0
        }
    };
    let sample = |uv: &Vec2| {
        if !(uv.x.is_finite() && uv.y.is_finite()) {
            return 1.0;
        }
        let (x, y) =
            (uv.x.rem_euclid(1.0) * width as f32 - 0.5, uv.y.rem_euclid(1.0) * height as f32 - 0.5);
        let ([i, j], [s, t]) = ([x, y].map(|x| x.floor() as i64), [x - x.floor(), y - y.floor()]);
        let row = |j: i64| pixel(i, j) * (1.0 - s) + pixel(i + 1, j) * s;
        row(j) * (1.0 - t) + row(j + 1) * t
    };
    Ok(uvs.iter().map(sample).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(depth: png::BitDepth, colour: png::ColorType, data: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 2);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        file
    }

    #[test]
    fn maps_are_read_between_pixel_centres() {
        let wide: Vec<u8> =
            [0u16, 65535, 13107, 65535].iter().flat_map(|x| x.to_be_bytes()).collect();
        for file in [
            map(png::BitDepth::Sixteen, png::ColorType::Grayscale, &wide),
            map(
                png::BitDepth::Eight,
                png::ColorType::Rgb,
                &[0, 9, 9, 255, 9, 9, 51, 9, 9, 255, 9, 9],
            ),
        ] {
            let at = |u: f32, v: f32| sample_map(&file, &[Vec2::new(u, v)]).unwrap()[0];
            assert_eq!((at(0.25, 0.25), at(0.75, 0.25)), (0.0, 1.0));
            // v runs down: the second row lies at v = 0.75.
            assert!(
                (at(0.25, 0.75) - 0.2).abs() < 1e-4
                    && (at(0.25, 0.5) - 0.1).abs() < 1e-4
                    && (at(0.5, 0.25) - 0.5).abs() < 1e-4
            );
            assert!((at(1.25, -0.25) - 0.2).abs() < 1e-4, "repeated");
        }
    }

    #[test]
    fn what_is_no_png_is_told() {
        let message = sample_map(b"GIF89a", &[]).unwrap_err().to_string();
        assert!(message.starts_with("wavelength map: ") && message.contains(';'), "{message}");
        let cut = &map(png::BitDepth::Eight, png::ColorType::Grayscale, &[1, 2, 3, 4])[..40];
        assert!(sample_map(cut, &[]).is_err());
    }

    #[test]
    fn the_first_draw_vertex_gives_the_wavelength() {
        let model = crate::models::sleeve();
        let welded = WeldedMesh::new(&model, 1e-5);
        let mut shares = vec![0.5; model.draw.positions.len()];
        // The seam's second vertex (20) is the same place as its first (0).
        (shares[20], shares[1], shares[2]) = (0.9, 0.0, 7.0);
        let list = per_vertex(&welded, 0.1, Some(&shares));
        assert_eq!(
            (list.len(), list[0], list[1], list[2]),
            (welded.count(), 0.05, 0.1 * LEAST_SHARE, 0.1)
        );
        assert_eq!(per_vertex(&welded, 0.1, None), [0.1]);
    }
}
