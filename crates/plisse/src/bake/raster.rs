//! The texels of a surface.

use rayon::prelude::*;

use super::maps::{Baked, Coverage, Options, Sample, Surface};
use super::padding::pad;
use super::tangents::{Frame, frames};
use crate::mesh::{Vec2, Vec3};
use crate::{Error, Result};

/// Largest number of texels across.
const MOST: usize = 16384;
/// Rows that one thread does in one go.
const BAND: usize = 16;
/// Barycentric coordinates (no unit) at which a centre counts as on a face's edge.
const EDGE: f64 = 1e-9;
/// Distance (no unit) by which texture coordinates may lie outside by round-off.
const OUTSIDE: f64 = 1e-5;

/// One texel of a band: face (`u32::MAX`: none) and whether its centre lies clear of the face's
/// edges.
#[derive(Clone, Copy)]
struct Texel {
    face: u32,
    inside: bool,
    height_m: f32,
    normal: [f32; 3],
}

/// Bakes the samples `sample(face, barycentric coordinates)` of `surface`. The result does not
/// depend on the number of threads.
///
/// ```
/// use plisse::bake::{Options, Sample, Surface, bake};
/// use plisse::mesh::{Vec2, Vec3};
///
/// // One triangle, 1 mm high everywhere.
/// let surface = Surface {
///     positions: &[Vec3::zeros(), Vec3::x(), Vec3::y()],
///     normals: &[Vec3::z(); 3],
///     faces: &[[0, 1, 2]],
///     uvs: &[Vec2::zeros(), Vec2::x(), Vec2::y()],
///     uv_faces: &[[0, 1, 2]],
/// };
/// let flat = |_: usize, _: [f64; 3]| Sample { height_m: 1e-3, gradient: Vec3::zeros() };
/// let maps = bake(&surface, flat, &Options { size: 64, padding: 4 })?;
/// assert_eq!((maps.height_m.len(), maps.height_m[63 * 64]), (64 * 64, 1e-3));
/// # Ok::<(), plisse::Error>(())
/// ```
///
/// # Errors
/// [`Error::Value`] for a size of 0 or beyond 16384, and for a texture coordinate that is no number
/// or outside [0, 1]; [`Error::Mesh`] for lists that do not match or a corner out of range.
pub fn bake(
    surface: &Surface<'_>,
    sample: impl Fn(usize, [f64; 3]) -> Sample + Sync,
    options: &Options,
) -> Result<Baked> {
    check(surface, options)?;
    let n = options.size;
    let frames = frames(surface);
    let texel_of =
        |t: usize| Vec2::new(surface.uvs[t].x * n as f64, (1.0 - surface.uvs[t].y) * n as f64);
    let corners: Vec<[Vec2; 3]> = surface.uv_faces.iter().map(|face| face.map(texel_of)).collect();
    let rows = |c: &[Vec2; 3]| {
        let (low, high) =
            c.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.y), h.max(p.y)));
        (
            (low - 0.5).ceil().max(0.0) as usize,
            ((high - 0.5).floor() + 1.0).clamp(0.0, n as f64) as usize,
        )
    };
    let mut in_band = vec![Vec::new(); n.div_ceil(BAND)];
    for (f, c) in corners.iter().enumerate() {
        let (first, end) = rows(c);
        if first < end {
            (first / BAND..=(end - 1) / BAND).for_each(|band| in_band[band].push(f as u32));
        }
    }
    let empty = Texel { face: u32::MAX, inside: false, height_m: 0.0, normal: [0.0, 0.0, 1.0] };
    let bands: Vec<(Vec<Texel>, usize)> = in_band
        .into_par_iter()
        .enumerate()
        .map(|(band, list)| {
            let (begin, stop) = (band * BAND, (band * BAND + BAND).min(n));
            let mut texels = vec![empty; (stop - begin) * n];
            let mut twice = vec![false; texels.len()];
            for f in list {
                let c = &corners[f as usize];
                let (first, end) = rows(c);
                each_centre(c, first.max(begin)..end.min(stop), n, |x, y, weights| {
                    let at = (y - begin) * n + x;
                    let inside = weights.iter().all(|&w| w > EDGE);
                    let old = texels[at];
                    if old.face != u32::MAX {
                        twice[at] |= old.inside && inside;
                        return;
                    }
                    let found = sample(f as usize, weights);
                    let normal = tangent_normal(&frames[f as usize], weights, &found.gradient);
                    texels[at] = Texel { face: f, inside, height_m: found.height_m as f32, normal };
                });
            }
            (texels, twice.iter().filter(|&&t| t).count())
        })
        .collect();
    let mut seen = vec![false; surface.faces.len()];
    let mut baked = Baked {
        size: n,
        height_m: Vec::with_capacity(n * n),
        normal: Vec::with_capacity(n * n),
        coverage: Vec::with_capacity(n * n),
        overlapping: 0,
        missed_faces: 0,
    };
    for (texels, overlapping) in bands {
        baked.overlapping += overlapping;
        for texel in texels {
            let covered = texel.face != u32::MAX;
            if covered {
                seen[texel.face as usize] = true;
            }
            baked.height_m.push(texel.height_m);
            baked.normal.push(texel.normal);
            baked.coverage.push(if covered { Coverage::Covered } else { Coverage::None });
        }
    }
    baked.missed_faces = seen.iter().filter(|s| !**s).count();
    pad(&mut baked, options.padding);
    Ok(baked)
}

fn check(surface: &Surface<'_>, options: &Options) -> Result<()> {
    if !(1..=MOST).contains(&options.size) {
        return Err(Error::value(
            "size",
            format!("{} texels across cannot be baked; give 1 to {MOST}", options.size),
        ));
    }
    let (v, t) = (surface.positions.len(), surface.uvs.len());
    if surface.normals.len() != v || surface.uv_faces.len() != surface.faces.len() {
        return Err(Error::mesh(
            "bake",
            "normals or texture faces do not match vertices and faces; give one for each",
        ));
    }
    let in_range = |f: &usize| {
        surface.faces[*f].iter().all(|&i| i < v) && surface.uv_faces[*f].iter().all(|&i| i < t)
    };
    if let Some(f) = (0..surface.faces.len()).find(|f| !in_range(f)) {
        return Err(Error::mesh(
            "bake",
            format!("face {f} names a vertex or texture coordinate that is not there; correct it"),
        ));
    }
    let fits = |uv: &Vec2| uv.iter().all(|x| (-OUTSIDE..=1.0 + OUTSIDE).contains(x));
    if let Some(&i) = surface.uv_faces.iter().flatten().find(|&&i| !fits(&surface.uvs[i])) {
        let uv = surface.uvs[i];
        let message = format!(
            "texture coordinate {i} is ({:.4}, {:.4}), outside the unit square; pack all islands \
             into it (\"UV pack\") and export again",
            uv.x, uv.y
        );
        return Err(Error::value("texture coordinates", message));
    }
    Ok(())
}

/// Calls `found(x, y, barycentric)` for every texel centre in `rows` that lies on the triangle `c`
/// (texels) or its edge.
fn each_centre(
    c: &[Vec2; 3],
    rows: std::ops::Range<usize>,
    n: usize,
    mut found: impl FnMut(usize, usize, [f64; 3]),
) {
    let area = (c[1] - c[0]).perp(&(c[2] - c[0]));
    if area.abs() < 1e-12 {
        return;
    }
    let (low, high) =
        c.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.x), h.max(p.x)));
    let columns = (low - 0.5).ceil().max(0.0) as usize
        ..((high - 0.5).floor() + 1.0).clamp(0.0, n as f64) as usize;
    for y in rows {
        for x in columns.clone() {
            let p = Vec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let (s, t) =
                ((p - c[0]).perp(&(c[2] - c[0])) / area, (c[1] - c[0]).perp(&(p - c[0])) / area);
            let weights = [1.0 - s - t, s, t];
            if weights.iter().all(|&w| w >= -EDGE) {
                found(x, y, weights);
            }
        }
    }
}

/// Normal of the wrinkled surface in the frame at a point: n − ∇h (eq. 7 of [Loviscach 2006]).
fn tangent_normal(frame: &Frame, weights: [f64; 3], gradient: &Vec3) -> [f32; 3] {
    let [t, b] = frame.at(weights);
    let normal = Vec3::new(-gradient.dot(&t), -gradient.dot(&b), 1.0).normalize();
    if normal.iter().all(|x| x.is_finite()) {
        [normal.x as f32, normal.y as f32, normal.z as f32]
    } else {
        [0.0, 0.0, 1.0]
    }
}
