//! Tangent frames as renderers make them: the direction of u on each face, averaged per vertex, by
//! angle, over faces that share vertex, texture coordinate and handedness (as MikkTSpace does),
//! made perpendicular to the normal.

use std::collections::HashMap;

use super::maps::Surface;
use crate::mesh::Vec3;

/// Frames at a face's corners.
pub(super) struct Frame {
    normals: [Vec3; 3],
    tangents: [Vec3; 3],
    /// +1, or −1 where the texture is mirrored.
    handedness: f64,
}

impl Frame {
    /// Unit tangents along u and v at the point with barycentric coordinates `weights`,
    /// perpendicular to the interpolated normal.
    pub(super) fn at(&self, weights: [f64; 3]) -> [Vec3; 2] {
        let blend =
            |list: &[Vec3; 3]| list[0] * weights[0] + list[1] * weights[1] + list[2] * weights[2];
        let n = blend(&self.normals).try_normalize(1e-12).unwrap_or_else(Vec3::z);
        let t = across(&blend(&self.tangents), &n);
        [t, n.cross(&t) * self.handedness]
    }
}

/// The part of `t` across `n`, of unit length; any such direction if there is none.
fn across(t: &Vec3, n: &Vec3) -> Vec3 {
    let part = |t: &Vec3| (t - n * n.dot(t)).try_normalize(1e-12);
    part(t).or_else(|| part(&Vec3::x())).or_else(|| part(&Vec3::y())).unwrap_or_else(Vec3::x)
}

/// `[F]` frames of all faces.
pub(super) fn frames(surface: &Surface<'_>) -> Vec<Frame> {
    // Only looked up, never walked through: the order of a hash map does no harm. Sums go by face.
    let mut sums: HashMap<(usize, usize, bool), Vec3> = HashMap::new();
    let faces: Vec<(Vec3, bool)> = surface
        .faces
        .iter()
        .zip(surface.uv_faces)
        .map(|(face, uv_face)| {
            let (p, uv) = (face.map(|v| surface.positions[v]), uv_face.map(|t| surface.uvs[t]));
            let (side_b, side_c, uv_b, uv_c) =
                (p[1] - p[0], p[2] - p[0], uv[1] - uv[0], uv[2] - uv[0]);
            let area = uv_b.perp(&uv_c);
            let tangent = ((side_b * uv_c.y - side_c * uv_b.y) * area.signum())
                .try_normalize(0.0)
                .unwrap_or_else(Vec3::zeros);
            let mirrored = area < 0.0;
            for k in 0..3 {
                let (to, fro) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                let angle = to.angle(&fro);
                let n = surface.normals[face[k]];
                let flat = (tangent - n * n.dot(&tangent))
                    .try_normalize(1e-12)
                    .unwrap_or_else(Vec3::zeros);
                if angle.is_finite() {
                    *sums.entry((face[k], uv_face[k], mirrored)).or_insert_with(Vec3::zeros) +=
                        flat * angle;
                }
            }
            (tangent, mirrored)
        })
        .collect();
    faces
        .iter()
        .zip(surface.faces.iter().zip(surface.uv_faces))
        .map(|((tangent, mirrored), (face, uv_face))| {
            let normals = face.map(|v| surface.normals[v]);
            let tangents = [0, 1, 2].map(|k| {
                let sum = sums.get(&(face[k], uv_face[k], *mirrored)).copied().unwrap_or(*tangent);
                across(&if sum.norm_squared() > 1e-20 { sum } else { *tangent }, &normals[k])
            });
            Frame { normals, tangents, handedness: if *mirrored { -1.0 } else { 1.0 } }
        })
        .collect()
}
