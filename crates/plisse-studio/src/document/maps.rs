//! Painted layers as images in the model's texture space.
//!
//! A layer with one number becomes 16-bit grey, from its least value (black) to its largest (white)
//! ([`Layer::range`]). Wrinkles and expansion have a direction: red, green and blue are ½ + ½·x for
//! each of its components in the rest pose, and alpha is the amount. Texels beside islands take the
//! numbers of the nearest island.

use std::io::{self, Write};

use plisse::{Error, Result};

use super::layers::{Layer, Range, amount};
use super::{Document, Subject};

/// Width of the rim around islands that takes their numbers (texels).
const PADDING: usize = 4;

/// A map in texture space, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintMap {
    /// Width and height (texels).
    pub size: usize,
    /// `[size][size]` interpolated numbers of the layer; `None` outside all faces.
    pub texels: Vec<Option<[f32; 4]>>,
}

/// The map of `layer`, `size` texels along each side.
///
/// # Errors
/// [`Error::Value`] for a model without texture coordinates.
pub fn paint_map(document: &Document, layer: Layer, size: usize) -> Result<PaintMap> {
    let subject: &Subject = &document.subject;
    plisse_live::bake::check(&subject.model).map_err(|_| {
        Error::value(
            &subject.model.name,
            "it has no texture coordinates to paint maps into; unwrap it and open it again",
        )
    })?;
    let (values, model) = (document.layers.of(layer), &subject.model);
    let mut texels = vec![None; size * size];
    for (face, welded) in model.faces.iter().zip(&subject.welded.faces) {
        let uv = face.map(|v| model.uvs[v as usize] * size as f32);
        let [a, b, c] = uv;
        let twice = (b - a).perp(&(c - a));
        if !twice.is_finite() || twice == 0.0 {
            continue;
        }
        let span = |k: usize| {
            let low = uv.iter().fold(f32::INFINITY, |m, p| m.min(p[k])).floor() as i64;
            let high = uv.iter().fold(f32::NEG_INFINITY, |m, p| m.max(p[k])).ceil() as i64;
            low.max(-(size as i64))..high.min(2 * size as i64)
        };
        for y in span(1) {
            for x in span(0) {
                let p = plisse_live::Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let weights = [
                    (b - p).perp(&(c - p)) / twice,
                    (c - p).perp(&(a - p)) / twice,
                    (a - p).perp(&(b - p)) / twice,
                ];
                if weights.iter().any(|&w| w < 0.0) {
                    continue;
                }
                let at =
                    y.rem_euclid(size as i64) as usize * size + x.rem_euclid(size as i64) as usize;
                let blend = |k: usize| {
                    (0..3).map(|c| weights[c] * values[welded[c] as usize][k]).sum::<f32>()
                };
                texels[at] = Some([blend(0), blend(1), blend(2), blend(3)]);
            }
        }
    }
    for _ in 0..PADDING {
        texels = padded(&texels, size);
    }
    Ok(PaintMap { size, texels })
}

/// Empty texels with a neighbour that has numbers take the first such neighbour's.
fn padded(texels: &[Option<[f32; 4]>], size: usize) -> Vec<Option<[f32; 4]>> {
    let at = |x: usize, y: usize| texels[y * size + x];
    let fill = |i: usize| {
        let (x, y) = (i % size, i / size);
        texels[i]
            .or_else(|| (x > 0).then(|| at(x - 1, y)).flatten())
            .or_else(|| (x + 1 < size).then(|| at(x + 1, y)).flatten())
            .or_else(|| (y > 0).then(|| at(x, y - 1)).flatten())
            .or_else(|| (y + 1 < size).then(|| at(x, y + 1)).flatten())
    };
    (0..texels.len()).map(fill).collect()
}

/// Writes `map` of `layer` as PNG: 16-bit grey, or 16-bit RGBA for layers with a direction.
///
/// # Errors
/// Those of `out`.
pub fn write_png<W: Write + ?Sized>(out: &mut W, layer: Layer, map: &PaintMap) -> io::Result<()> {
    let Range { low, high, .. } = layer.range();
    let share = |x: f32| (((x - low) / (high - low)).clamp(0.0, 1.0) * 65535.0 + 0.5) as u16;
    let mut data = Vec::with_capacity(8 * map.texels.len());
    for texel in &map.texels {
        let numbers = texel.unwrap_or(layer.neutral());
        if layer.is_directed() {
            let length =
                (numbers[0].powi(2) + numbers[1].powi(2) + numbers[2].powi(2)).sqrt().max(1e-12);
            for x in &numbers[..3] {
                data.extend(
                    (((0.5 + 0.5 * x / length).clamp(0.0, 1.0) * 65535.0 + 0.5) as u16)
                        .to_be_bytes(),
                );
            }
        }
        data.extend(share(amount(layer, &numbers)).to_be_bytes());
    }
    let mut encoder = png::Encoder::new(out, map.size as u32, map.size as u32);
    encoder.set_color(if layer.is_directed() {
        png::ColorType::Rgba
    } else {
        png::ColorType::Grayscale
    });
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.write_header()?.write_image_data(&data)?;
    Ok(())
}
