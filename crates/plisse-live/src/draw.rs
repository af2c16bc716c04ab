//! Pictures by stage "Render" on the processor: a rasteriser around the stage, for machines without
//! a GPU and as the GPU's reference.
//!
//! Each pixel takes four samples, as on the GPU. Samples are independent, so any number of threads
//! gives the same bytes.

use plisse::picture::Image;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::profile::Profile;
use crate::render::{Corner, FaceWaves};
use crate::shade::{from_srgb, shade, to_srgb};
use crate::texture::Texture;
use crate::{Vec2, Vec3};

/// Number of samples of each pixel along each side.
pub const SAMPLES: usize = 2;
/// The background (sRGB).
pub const BACKGROUND: [u8; 3] = [238, 240, 243];

/// The appearance of faces.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Profile of the wrinkles.
    pub profile: &'a Profile,
    /// Base colour.
    pub texture: &'a Texture,
    /// Linear colour that the base colour is multiplied with.
    pub colour: Vec3,
    /// True if the texture shifts with the wrinkles (6.2).
    pub parallax: bool,
}

/// A picture of a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// The picture.
    pub image: Image,
    /// Number of pixels that show the model, at least in part.
    pub covered: usize,
}

/// Draws `faces` as `camera` sees them on `size` (width, height) pixels.
pub fn draw(faces: &[[Corner; 3]], look: &Look<'_>, camera: &Camera, size: [usize; 2]) -> Picture {
    let fine = size.map(|s| s * SAMPLES);
    let faces: Vec<ScreenFace> =
        faces.iter().filter_map(|corners| ScreenFace::new(corners, camera, fine)).collect();
    let background: [f32; 3] = BACKGROUND.map(from_srgb);
    // Faces that reach each row of pixels.
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); size[1]];
    for (f, face) in faces.iter().enumerate() {
        for y in face.rows[0] / SAMPLES..=face.rows[1] / SAMPLES {
            rows[y].push(f as u32);
        }
    }
    let lines: Vec<(Vec<[u8; 3]>, usize)> = rows
        .par_iter()
        .enumerate()
        .map(|(y, reached)| {
            let mut nearest = vec![(f32::INFINITY, u32::MAX); fine[0] * SAMPLES];
            for &f in reached {
                faces[f as usize].cover(f, y * SAMPLES, fine[0], &mut nearest);
            }
            let colour = |x: usize, s: usize| {
                let (_, f) = nearest[s * fine[0] + x];
                let face = faces.get(f as usize)?;
                let weights = face.weights([x as f32 + 0.5, (y * SAMPLES + s) as f32 + 0.5])?;
                Some(pixel(face, weights, look, camera))
            };
            let mut covered = 0;
            let line = (0..size[0]).map(|x| {
                let (mut sum, mut any) = (Vec3::zeros(), false);
                for s in 0..SAMPLES * SAMPLES {
                    let found = colour(x * SAMPLES + s % SAMPLES, s / SAMPLES);
                    any |= found.is_some();
                    sum +=
                        found.unwrap_or_else(|| Vec3::from(background)).map(|c| c.clamp(0.0, 1.0));
                }
                covered += usize::from(any);
                let mean = sum / (SAMPLES * SAMPLES) as f32;
                [to_srgb(mean.x), to_srgb(mean.y), to_srgb(mean.z)]
            });
            (line.collect(), covered)
        })
        .collect();
    let covered = lines.iter().map(|line| line.1).sum();
    let pixels = lines.into_iter().flat_map(|line| line.0).flatten().collect();
    Picture { image: Image { width: size[0], height: size[1], pixels }, covered }
}

/// The pixel stage: linear colour of the point with these barycentric `weights`.
fn pixel(face: &ScreenFace, weights: [f32; 3], look: &Look<'_>, camera: &Camera) -> Vec3 {
    let point = face.waves.at(weights, look.profile);
    let to_viewer = camera.eye - point.position;
    let normal = if face.front { point.normal } else { -point.normal };
    let uv: Vec2 = if look.parallax { face.waves.shifted_uv(&point, &to_viewer) } else { point.uv };
    let albedo = look.texture.at(&uv).component_mul(&look.colour);
    shade(albedo, &normal, &to_viewer.normalize(), &camera.light())
}

/// A face on the screen.
struct ScreenFace {
    waves: FaceWaves,
    /// Corners in samples, from the upper left; the third is depth.
    at: [Vec3; 3],
    /// 1/w of the corners.
    inverse_w: [f32; 3],
    /// First and last row and column of samples that it may reach.
    rows: [usize; 2],
    columns: [usize; 2],
    /// Twice its area on the screen, positive for front faces; neither zero.
    area: f32,
    front: bool,
}

impl ScreenFace {
    fn new(corners: &[Corner; 3], camera: &Camera, size: [usize; 2]) -> Option<Self> {
        let map = camera.clip_from_world();
        let clip = corners.map(|c| map * c.position.push(1.0));
        // Faces that reach behind the viewer are left out: cameras that fit the model have none.
        if clip.iter().any(|c| c.iter().any(|x| !x.is_finite()) || c.w <= 1e-6 || c.z < 0.0) {
            return None;
        }
        let at = clip.map(|c| {
            let ndc = c.xyz() / c.w;
            Vec3::new(
                (0.5 + 0.5 * ndc.x) * size[0] as f32,
                (0.5 - 0.5 * ndc.y) * size[1] as f32,
                ndc.z,
            )
        });
        let area = cross(&at[0], &at[1], &at[2]);
        let span = |k: usize| {
            let low = at.iter().fold(f32::INFINITY, |a, p| a.min(p[k]));
            let high = at.iter().fold(f32::NEG_INFINITY, |a, p| a.max(p[k]));
            let most = size[k] as f32 - 1.0;
            (low - 0.5 <= most && high - 0.5 >= 0.0).then(|| {
                [(low - 0.5).clamp(0.0, most) as usize, (high - 0.5).clamp(0.0, most) as usize]
            })
        };
        let (columns, rows) = (span(0)?, span(1)?);
        // Rows run downwards, so faces that show their front turn clockwise here.
        (area != 0.0 && area.is_finite()).then(|| Self {
            waves: FaceWaves::new(*corners),
            at,
            inverse_w: clip.map(|c| 1.0 / c.w),
            rows,
            columns,
            area,
            front: area < 0.0,
        })
    }

    /// Barycentric coordinates on the screen of `p` (samples); `None` outside.
    fn flat(&self, p: [f32; 2]) -> Option<[f32; 3]> {
        let p = Vec3::new(p[0], p[1], 0.0);
        let [a, b, c] = &self.at;
        let s =
            [cross(&p, b, c) / self.area, cross(&p, c, a) / self.area, cross(&p, a, b) / self.area];
        s.iter().all(|&x| x >= 0.0).then_some(s)
    }

    /// Barycentric coordinates on the face itself, with perspective.
    fn weights(&self, p: [f32; 2]) -> Option<[f32; 3]> {
        let s = self.flat(p)?;
        let part = [0, 1, 2].map(|k| s[k] * self.inverse_w[k]);
        let sum: f32 = part.iter().sum();
        Some(part.map(|x| x / sum))
    }

    /// Puts this face, number `f`, where it is nearest into the `SAMPLES` rows of samples from
    /// `top` on.
    fn cover(&self, f: u32, top: usize, width: usize, nearest: &mut [(f32, u32)]) {
        for s in 0..SAMPLES {
            for x in self.columns[0]..=self.columns[1] {
                if let Some(flat) = self.flat([x as f32 + 0.5, (top + s) as f32 + 0.5]) {
                    let depth = (0..3).map(|k| flat[k] * self.at[k].z).sum::<f32>();
                    let there = &mut nearest[s * width + x];
                    if depth < there.0 && depth <= 1.0 {
                        *there = (depth, f);
                    }
                }
            }
        }
    }
}

/// Twice the signed area of a triangle on the screen.
fn cross(a: &Vec3, b: &Vec3, c: &Vec3) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}
