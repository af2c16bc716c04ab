//! Wrinkled geometry of one frame: every face divided, and the new vertices moved along their
//! normals.
//!
//! Vertices move along the normals of the welded surface, so that no crack opens at texture seams
//! or hard edges. The normals of the fine mesh are those that Render shades with (eq. 7).

use std::collections::HashMap;

use crate::live::Frame;
use crate::model::Model;
use crate::profile::Profile;
use crate::weld::WeldedMesh;
use crate::{Vec2, Vec3, bake};

/// Parts of an edge to a wavelength at which exported waves look round.
pub const PARTS_PER_WAVE: f32 = 6.0;

/// A divided model. V' vertices, F·n² faces; both the same, in the same order, for every frame of
/// one model and one n.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FineMesh {
    /// `[V']` displaced positions (m); the first V belong to the model's draw vertices.
    pub positions: Vec<Vec3>,
    /// `[V']` unit normals.
    pub normals: Vec<Vec3>,
    /// `[V']` texture coordinates (v down).
    pub uvs: Vec<Vec2>,
    /// `[F·n²][3]` faces, those of one coarse face together.
    pub faces: Vec<[u32; 3]>,
}

/// Divides every face of `model` into `parts`² and displaces it by the waves of `frame`.
pub fn refine(
    model: &Model,
    welded: &WeldedMesh,
    frame: &Frame<'_>,
    profile: &Profile,
    parts: usize,
) -> FineMesh {
    let parts = parts.max(1);
    let (draw, posed) = (frame.drawn, &frame.state.posed);
    let wave_faces = bake::faces(model, welded, frame);
    let lattice = Lattice::new(&model.faces, draw.positions.len(), parts);
    let mut fine = FineMesh {
        positions: vec![Vec3::zeros(); lattice.count],
        normals: vec![Vec3::zeros(); lattice.count],
        uvs: vec![Vec2::zeros(); lattice.count],
        faces: Vec::with_capacity(model.faces.len() * parts * parts),
    };
    // Draw vertices on no face stay where they are.
    fine.positions[..draw.positions.len()].copy_from_slice(&draw.positions);
    fine.normals[..draw.normals.len()].copy_from_slice(&draw.normals);
    let mut seen = vec![false; lattice.count];
    for (f, face) in model.faces.iter().enumerate() {
        let up = welded.faces[f].map(|u| posed.normals[u as usize]);
        let at = |i: usize, j: usize| lattice.vertex(f, face, i, j);
        for i in 0..=parts {
            for j in 0..=parts - i {
                let weights = [parts - i - j, i, j].map(|w| w as f32 / parts as f32);
                let (v, point) = (at(i, j), wave_faces[f].at(weights, profile));
                if !std::mem::replace(&mut seen[v], true) {
                    let normal = up[0] * weights[0] + up[1] * weights[1] + up[2] * weights[2];
                    let normal = normal.try_normalize(1e-20).unwrap_or(point.base_normal);
                    fine.positions[v] = point.position + normal * point.height_m;
                    fine.uvs[v] = point.uv;
                    fine.normals[v] = Vec3::zeros();
                }
                fine.normals[v] += point.normal;
            }
        }
        let id = |i: usize, j: usize| at(i, j) as u32;
        for i in 0..parts {
            for j in 0..parts - i {
                fine.faces.push([id(i, j), id(i + 1, j), id(i, j + 1)]);
                if i + j + 1 < parts {
                    fine.faces.push([id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]);
                }
            }
        }
    }
    fine.normals.iter_mut().for_each(|n| *n = n.try_normalize(1e-12).unwrap_or_else(Vec3::z));
    fine
}

/// Number of parts of an edge at which the median edge of `welded` (rest) has `per_wave` parts to a
/// wavelength (m); 1 to 64.
pub fn suggest_parts(welded: &WeldedMesh, wavelength_m: f32, per_wave: f32) -> usize {
    let x = &welded.vertices.positions;
    let lengths = |v: usize| welded.around(v).iter().map(move |&n| (x[n as usize] - x[v]).norm());
    let mut lengths: Vec<f32> = (0..welded.count()).flat_map(lengths).collect();
    lengths.sort_by(f32::total_cmp);
    let median = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
    (median / wavelength_m * per_wave).ceil().clamp(1.0, 64.0) as usize
}

/// Numbers of the vertices of divided faces: draw vertices, then those on edges, then those inside
/// faces.
pub(crate) struct Lattice {
    parts: usize,
    corners: usize,
    edges: HashMap<[u32; 2], usize>,
    count: usize,
}

impl Lattice {
    pub(crate) fn new(faces: &[[u32; 3]], corners: usize, parts: usize) -> Self {
        let mut edges = HashMap::new();
        for face in faces {
            for k in 0..3 {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                let next = edges.len();
                edges.entry([a.min(b), a.max(b)]).or_insert(next);
            }
        }
        let mut lattice = Self { parts, corners, edges, count: 0 };
        lattice.count = lattice.count_at(parts, faces.len());
        lattice
    }

    /// Number of vertices when edges have `parts` parts.
    pub(crate) fn count_at(&self, parts: usize, faces: usize) -> usize {
        self.corners + self.edges.len() * (parts - 1) + faces * inner(parts)
    }

    /// The vertex with barycentric coordinates (n − i − j, i, j)/n of face `f` with corners `face`.
    fn vertex(&self, f: usize, face: &[u32; 3], i: usize, j: usize) -> usize {
        let n = self.parts;
        let steps = [n - i - j, i, j];
        if let Some(k) = steps.iter().position(|&s| s == n) {
            return face[k] as usize;
        }
        if let Some(k) = steps.iter().position(|&s| s == 0) {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            // Counted from the end with the lower number.
            let from_low = if face[a] < face[b] { steps[b] } else { steps[a] };
            let edge = self.edges[&[face[a].min(face[b]), face[a].max(face[b])]];
            return self.corners + edge * (n - 1) + from_low - 1;
        }
        // Rows i = 1, 2, … have n − 1 − i vertices inside each.
        let before = (i - 1) * (n - 1) - i * (i - 1) / 2;
        self.corners + self.edges.len() * (n - 1) + f * inner(n) + before + j - 1
    }
}

/// Number of vertices inside a face whose edges have `parts` parts.
fn inner(parts: usize) -> usize {
    (parts - 1) * parts.saturating_sub(2) / 2
}
