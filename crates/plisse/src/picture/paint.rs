//! The colour of what is seen: one view of one panel, without its lettering.
//!
//! Every pixel is the mean, in linear light, of 2×2 samples. Normals are in view space (right, up,
//! toward the viewer) and always turned toward the viewer, so both sides of a surface are lit.

use super::camera::Frame;
use super::colour::{self, Light};
use super::image::Image;
use super::raster::{NOTHING, Projected, SAMPLES, Seen, Triangle, see};
use super::relief::Relief;
use super::{Paint, Subject};
use crate::mesh::Vec3;
use rayon::prelude::*;

/// A direction in view space (right, up, toward the viewer), of unit length.
pub(super) type Normal = [f32; 3];

/// A drawn view, and what its key must say.
pub(super) struct Painted {
    pub(super) image: Image,
    /// Factor by which slopes were steepened for the light; 1 if not.
    pub(super) relief_gain: f32,
    /// True if some face carries no wrinkle.
    pub(super) unwrinkled: bool,
}

/// Colour of bodies that are not the subject (sRGB).
const BODY_SRGB: [u8; 3] = [150, 156, 160];

/// Draws a surface as `paint` says.
pub(super) fn paint(paint: Paint, surface: &Surface) -> Painted {
    let own = surface.own;
    let body = colour::light_from_srgb(BODY_SRGB);
    let shade = |colour: &(dyn Fn(&Facet, usize, usize) -> Light + Sync)| {
        shade(surface, |facet, x, y| {
            if facet.number < own { colour(facet, x, y) } else { lit(facet.normal(x, y).0, body) }
        })
    };
    let mut painted = Painted { image: Image::blank(0, 0), relief_gain: 1.0, unwrinkled: false };
    painted.image = match paint {
        Paint::Plain { colour, wireframe: true } => {
            let material = colour::light_from_srgb(colour);
            let border = border_sides(surface.positions.len(), &surface.faces);
            shade(&|facet, x, y| {
                wire(
                    &facet.triangle,
                    border[facet.number],
                    x,
                    y,
                    lit(facet.flat_normal(), material),
                )
            })
        }
        Paint::Plain { colour, wireframe: false } => {
            let material = colour::light_from_srgb(colour);
            let relief =
                Relief::measure(&surface.seen, own, |f, x, y| surface.facet(f).normal(x, y).0);
            painted.relief_gain = relief.gain;
            shade(&|facet, x, y| lit(relief.steepened(facet.normal(x, y).0, x, y), material))
        }
        Paint::Scalar { values, maximum, .. } => {
            let map: Vec<Light> =
                (0..=MAP).map(|i| colour::viridis(i as f32 / MAP as f32)).collect();
            let maximum = usable_maximum(maximum);
            shade(&|facet, x, y| {
                let (normal, weights) = facet.normal(x, y);
                let corners = surface.faces[facet.number];
                let value: f64 = (0..3)
                    .map(|k| weights[k] * values.get(corners[k]).copied().unwrap_or(f64::NAN))
                    .sum();
                let paint = if value.is_finite() {
                    map[((value / maximum).clamp(0.0, 1.0) * MAP as f64).round() as usize]
                } else {
                    [0.35; 3]
                };
                tinted(normal, paint)
            })
        }
        Paint::Phase { corners } => {
            let of_face =
                |f: usize| corners.get(f).copied().filter(|c| c.iter().all(|p| p.is_finite()));
            painted.unwrinkled = (0..own).any(|f| of_face(f).is_none());
            shade(&|facet, x, y| {
                let Some(phase) = of_face(facet.number) else { return [0.0; 3] };
                let (normal, weights) = facet.normal(x, y);
                let (sin, cos) = (0..3).map(|k| weights[k] * phase[k]).sum::<f64>().sin_cos();
                let [gx, gy] = facet.triangle.gradient(phase);
                let fade = resolved((gx * gx + gy * gy).sqrt());
                tinted(normal, colour::cyclic((fade * cos) as f32, (fade * sin) as f32))
            })
        }
    };
    painted
}

/// `maximum`, or 1 if it cannot be the end of a scale.
pub(super) fn usable_maximum(maximum: f64) -> f64 {
    if maximum.is_finite() && maximum > 0.0 { maximum } else { 1.0 }
}

/// Steps of the amplitude's colour map.
const MAP: usize = 1023;

/// A subject and the bodies around it, made ready for one view. Panels that show the same subject
/// share it.
pub(super) struct Surface<'a> {
    /// The first so many faces are the subject's.
    own: usize,
    positions: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    projected: Projected,
    /// `[V]` mean normal of the faces at each vertex, weighted by their area.
    normals: Vec<Normal>,
    seen: Seen,
    frame: &'a Frame,
}

impl<'a> Surface<'a> {
    /// `subject` among `bodies` in the view of `frame`.
    pub(super) fn new(subject: Subject, bodies: Subject, frame: &'a Frame) -> Self {
        let shift = subject.positions.len();
        let positions = [subject.positions, bodies.positions].concat();
        let mut faces = subject.faces.to_vec();
        faces.extend(bodies.faces.iter().map(|face| face.map(|v| v.saturating_add(shift))));
        let mut sums = vec![[0f64; 3]; positions.len()];
        for face in &faces {
            if face.iter().any(|&v| v >= positions.len()) {
                continue;
            }
            let [a, b, c] = face.map(|v| positions[v]);
            let normal = (b - a).cross(&(c - a));
            if normal.iter().all(|x| x.is_finite()) {
                for &v in face {
                    for k in 0..3 {
                        sums[v][k] += normal[k];
                    }
                }
            }
        }
        let normals = sums
            .par_iter()
            .map(|&sum| {
                let view = frame.view_from_world * Vec3::from(sum);
                unit([view.x, view.y, view.z])
            })
            .collect();
        let projected = Projected::new(&positions, frame);
        let seen = see(&projected, &faces, frame.size);
        Self { own: subject.faces.len(), positions, faces, projected, normals, seen, frame }
    }

    /// Face `f`, which must be one that is seen.
    fn facet(&self, f: usize) -> Facet<'_> {
        let triangle =
            self.projected.triangle(self.faces[f]).expect("a face that is seen has a triangle");
        let sign = if triangle.faces_viewer() { 1.0 } else { -1.0 };
        let normals = self.faces[f].map(|v| self.normals[v].map(|x| sign * f64::from(x)));
        Facet { number: f, triangle, normals, surface: self }
    }
}

/// A face that is seen, made ready for its samples.
struct Facet<'a> {
    number: usize,
    triangle: Triangle,
    /// Normals of its corners, on the side that faces the viewer.
    normals: [[f64; 3]; 3],
    surface: &'a Surface<'a>,
}

impl Facet<'_> {
    /// Smooth normal and barycentric coordinates at sample `x`, `y`.
    fn normal(&self, x: usize, y: usize) -> (Normal, [f64; 3]) {
        let weights = self.triangle.weights(x, y);
        let normal =
            unit([0, 1, 2].map(|c| (0..3).map(|k| weights[k] * self.normals[k][c]).sum::<f64>()));
        if normal == [0.0; 3] {
            return (self.flat_normal(), weights);
        }
        // Past a silhouette the smooth normal of a face that is still seen points away; mirrored,
        // it varies without a jump.
        ([normal[0], normal[1], normal[2].abs()], weights)
    }

    /// Normal of the face itself.
    fn flat_normal(&self) -> Normal {
        let [a, b, c] = self.surface.faces[self.number].map(|v| self.surface.positions[v]);
        let view = self.surface.frame.view_from_world * (b - a).cross(&(c - a));
        let sign = if self.triangle.faces_viewer() { 1.0 } else { -1.0 };
        let normal = unit([sign * view.x, sign * view.y, sign * view.z]);
        if normal == [0.0; 3] { [0.0, 0.0, 1.0] } else { normal }
    }
}

/// Colours every pixel from the samples in it; `colour(facet, x, y)` is the light of a sample where
/// a face is seen.
fn shade(surface: &Surface, colour: impl Fn(&Facet, usize, usize) -> Light + Sync) -> Image {
    let seen = &surface.seen;
    let mut image = Image::blank(seen.width / SAMPLES, seen.height / SAMPLES);
    if image.pixels.is_empty() {
        return image;
    }
    let row_length = 3 * image.width;
    image.pixels.par_chunks_mut(row_length).enumerate().for_each(|(row, pixels)| {
        // Neighbouring samples mostly see the same face.
        let mut facet: Option<Facet> = None;
        for (column, pixel) in pixels.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let mut sum = [0f32; 3];
            let mut covered = false;
            for (dy, dx) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let (x, y) = (column * SAMPLES + dx, row * SAMPLES + dy);
                let face = seen.faces[y * seen.width + x];
                let light = if face == NOTHING {
                    [1.0; 3]
                } else {
                    let known = facet.take().filter(|known| known.number == face as usize);
                    colour(
                        facet.insert(known.unwrap_or_else(|| surface.facet(face as usize))),
                        x,
                        y,
                    )
                };
                covered |= face != NOTHING;
                for k in 0..3 {
                    sum[k] += light[k].min(1.0);
                }
            }
            if covered {
                *pixel = colour::srgb_from_light(sum.map(|s| s / (SAMPLES * SAMPLES) as f32));
            }
        }
    });
    image
}

/// Light from a material: a grazing key light from the upper left that models relief, a soft fill
/// from the right, a little of both from all around, and a mild gloss.
fn lit(normal: Normal, material: Light) -> Light {
    const KEY: Normal = [-0.704, 0.503, 0.503];
    const FILL: Normal = [0.683, 0.098, 0.724];
    // Halfway between key light and viewer.
    const GLOSS: Normal = [-0.406, 0.290, 0.867];
    let key = dot(normal, KEY).max(0.0);
    let fill = dot(normal, FILL).max(0.0);
    let around = 0.5 + 0.5 * normal[1];
    let diffuse = 0.10 + 0.10 * around + 0.90 * key + 0.30 * fill;
    let gloss = 0.10 * dot(normal, GLOSS).max(0.0).powi(40);
    material.map(|m| m * diffuse + gloss)
}

/// A map's colour with just enough shade to show the form.
fn tinted(normal: Normal, colour: Light) -> Light {
    const SOFT: Normal = [-0.30, 0.40, 0.866];
    let shade = 0.62 + 0.38 * dot(normal, SOFT).max(0.0);
    colour.map(|c| c * shade)
}

/// Share of a wave that is left at `radians_per_sample`: 1 where samples resolve it, 0 from two
/// samples per wave on, so that unresolved waves become even grey instead of a false pattern.
fn resolved(radians_per_sample: f64) -> f64 {
    let t = ((radians_per_sample / std::f64::consts::PI - 0.5) / 0.5).clamp(0.0, 1.0);
    1.0 - t * t * (3.0 - 2.0 * t)
}

/// `under` with the sides of the triangle drawn over it. Every face draws its own half of a line,
/// so a hidden line is hidden like its face. `border` tells which sides have no neighbour; there
/// the face draws the whole line.
fn wire(triangle: &Triangle, border: [bool; 3], x: usize, y: usize, under: Light) -> Light {
    const INK: Light = [0.012, 0.016, 0.024];
    /// Half of a line's width (samples).
    const HALF_WIDTH: f64 = 0.6 * SAMPLES as f64;
    let weights = triangle.weights(x, y);
    let heights = [0, 1, 2].map(|k| triangle.height(k));
    let mut ink: f64 = 0.0;
    for k in 0..3 {
        let distance = weights[(k + 2) % 3] * heights[k];
        let width = if border[k] { 2.0 * HALF_WIDTH } else { HALF_WIDTH };
        ink = ink.max((width + 0.5 - distance).clamp(0.0, 1.0));
    }
    // Where triangles are not much wider than lines, thinner ink keeps the surface visible.
    let narrowest = heights[0].min(heights[1]).min(heights[2]);
    let strength = 0.85 * (narrowest / (10.0 * HALF_WIDTH)).clamp(0.2, 1.0);
    let ink = (strength * ink) as f32;
    [0, 1, 2].map(|k| under[k].min(1.0) * (1.0 - ink) + INK[k] * ink)
}

/// `[F][3]` true if the side from corner `k` to `k+1` belongs to one face only.
fn border_sides(vertex_count: usize, faces: &[[usize; 3]]) -> Vec<[bool; 3]> {
    let mut border = vec![[false; 3]; faces.len()];
    let mut sides = Vec::with_capacity(3 * faces.len());
    for (f, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let (i, j) = (face[k], face[(k + 1) % 3]);
            if i < vertex_count && j < vertex_count {
                sides.push((i.min(j), i.max(j), f, k));
            }
        }
    }
    sides.sort_unstable();
    for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if let [(_, _, f, k)] = *same {
            border[f][k] = true;
        }
    }
    border
}

fn dot(a: Normal, b: Normal) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `v` at unit length; zero if it has no direction.
pub(super) fn unit(v: [f64; 3]) -> Normal {
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    // Where the squares leave the range of numbers, slowly.
    let length = if square.is_normal() { square.sqrt() } else { v[0].hypot(v[1]).hypot(v[2]) };
    if length > 0.0 && length.is_finite() { v.map(|x| (x / length) as f32) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unresolved_wave_is_grey_and_a_resolved_one_is_not_touched() {
        assert_eq!(resolved(0.3), 1.0);
        assert_eq!(resolved(4.0), 0.0);
        let grey = colour::srgb_from_light(colour::cyclic(0.0, 0.0));
        assert!(grey[0].abs_diff(grey[1]) <= 1 && grey[1].abs_diff(grey[2]) <= 1);
    }

    #[test]
    fn only_sides_of_one_face_are_border() {
        assert_eq!(
            border_sides(4, &[[0, 1, 2], [2, 1, 3]]),
            [[true, false, true], [false, true, true]]
        );
    }

    #[test]
    fn no_normal_toward_the_viewer_is_black() {
        for i in 0..200 {
            let (turn, tilt) = (f64::from(i) * 0.7, f64::from(i) / 200.0 * 1.57);
            let light =
                lit(unit([turn.cos() * tilt.sin(), turn.sin() * tilt.sin(), tilt.cos()]), [0.5; 3]);
            assert!(light[0] > 0.04);
        }
    }
}
