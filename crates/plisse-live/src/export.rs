//! Wrinkled geometry from live waves: every face divided, the new vertices moved along their
//! normals, into files that ordinary viewers open. One frame as a still, or many as morph targets
//! of the first, which an animation shows one after the other.
//!
//! Vertices are moved along the normals of the unified surface, so that no crack opens at texture
//! seams or hard edges; the normals in the file are those that Render shades with (eq. 7).

use std::collections::HashMap;
use std::io::{self, Write};

use plisse::{Error, Result};
use serde_json::json;

use crate::glb_out::{Glb, invalid, mesh_attributes};
use crate::live::LiveState;
use crate::model::Model;
use crate::profile::Profile;
use crate::skin::Skinned;
use crate::unify::Unified;
use crate::{Vec2, Vec3, bake};

/// Most bytes of a file.
pub const MOST_BYTES: u64 = 512 << 20;

/// A divided model. V' vertices, F·n² faces; both the same, in the same order, for every frame of
/// one model and one n.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fine {
    /// `[V']` displaced positions (m); the first V belong to the model's draw vertices.
    pub positions: Vec<Vec3>,
    /// `[V']` unit normals.
    pub normals: Vec<Vec3>,
    /// `[V']` texture coordinates (v down).
    pub uvs: Vec<Vec2>,
    /// `[F·n²][3]` faces, those of one coarse face together.
    pub faces: Vec<[u32; 3]>,
}

/// How the animation goes from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Each frame stands until the next.
    Step,
    /// Each frame moves into the next.
    Linear,
}

/// Divides every face of `model` into `parts`² and displaces it by the waves of `state`, over draw
/// vertices posed as `draw` (`[V]`).
pub fn refine(
    model: &Model,
    unified: &Unified,
    draw: &Skinned,
    state: &LiveState,
    profile: &Profile,
    parts: usize,
) -> Fine {
    let parts = parts.max(1);
    let waves = bake::faces(model, unified, draw, state);
    let lattice = Lattice::new(&model.faces, draw.positions.len(), parts);
    let mut fine = Fine {
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
        let up = unified.faces[f].map(|u| state.posed.normals[u as usize]);
        let at = |i: usize, j: usize| lattice.vertex(f, face, i, j);
        for i in 0..=parts {
            for j in 0..=parts - i {
                let weights = [parts - i - j, i, j].map(|w| w as f32 / parts as f32);
                let (v, point) = (at(i, j), waves[f].at(weights, profile));
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

/// Parts of an edge at which the median edge of `unified` (rest) has `per_wave` parts to a
/// wavelength (m); 1 to 64.
pub fn suggest_parts(unified: &Unified, wavelength_m: f32, per_wave: f32) -> usize {
    let x = &unified.vertices.positions;
    let lengths = |v: usize| unified.around(v).iter().map(move |&n| (x[n as usize] - x[v]).norm());
    let mut lengths: Vec<f32> = (0..unified.count()).flat_map(lengths).collect();
    lengths.sort_by(f32::total_cmp);
    let median = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
    (median / wavelength_m * per_wave).ceil().clamp(1.0, 64.0) as usize
}

/// Refuses what would make a file beyond [`MOST_BYTES`], before anything long begins.
///
/// # Errors
/// [`Error::Value`] about the frames (or the parts, for one frame alone) with as many as would do.
pub fn check_size(model: &Model, parts: usize, frames: usize) -> Result<()> {
    let vertices = Lattice::new(&model.faces, model.draw.positions.len(), 1)
        .count_at(parts, model.faces.len()) as u64;
    let fixed = vertices * 32 + (model.faces.len() * parts * parts) as u64 * 12;
    let frame = vertices * 24;
    let count = frames as u64;
    if fixed + frame * (count - count.min(1)) + 4 * count * count <= MOST_BYTES {
        return Ok(());
    }
    let most = (1..=count).rev().find(|n| fixed + frame * (n - 1) + 4 * n * n <= MOST_BYTES);
    Err(match most {
        Some(most) => Error::value(
            "frames",
            format!(
                "{frames} frames of {vertices} vertices make more than 512 MB; give {most} or \
                 fewer, or divide faces less"
            ),
        ),
        None => Error::value(
            "parts",
            format!(
                "faces divided into {parts}² parts make {vertices} vertices, more than 512 MB; \
                 give fewer parts"
            ),
        ),
    })
}

/// Writes one frame as binary glTF, with the base colour image of `model`.
///
/// # Errors
/// What `out` says; [`io::ErrorKind::InvalidData`] for a number that is not finite.
pub fn write_still<W: Write + ?Sized>(out: &mut W, model: &Model, fine: &Fine) -> io::Result<()> {
    let mut glb = Glb::default();
    let attributes = mesh_attributes(&mut glb, fine)?;
    let material = glb.material(model.base_colour.as_deref());
    glb.write(out, attributes, material, json!({}), json!({}))
}

/// Writes `frames` as binary glTF: the first as the mesh, each further one as a morph target, and
/// an animation "wrinkles" that shows one after the other, `fps` a second.
///
/// # Errors
/// As [`write_still`]; also [`io::ErrorKind::InvalidData`] without frames, for frames of different
/// models, and for an `fps` that is not above 0.
pub fn write_sequence<W: Write + ?Sized>(
    out: &mut W,
    model: &Model,
    frames: &[Fine],
    fps: f32,
    between: Between,
) -> io::Result<()> {
    let Some((first, others)) = frames.split_first() else {
        return Err(invalid("there are no frames to write".into()));
    };
    if others.is_empty() {
        return write_still(out, model, first);
    }
    if !(fps > 0.0 && fps.is_finite()) {
        return Err(invalid(format!(
            "{fps} frames a second cannot be played; give a number above 0"
        )));
    }
    if let Some(k) = others
        .iter()
        .position(|f| f.faces != first.faces || f.positions.len() != first.positions.len())
    {
        return Err(invalid(format!("frame {} has other vertices than the first", k + 1)));
    }
    let mut glb = Glb::default();
    let mut attributes = mesh_attributes(&mut glb, first)?;
    let mut targets = Vec::new();
    for frame in others {
        let shift =
            |a: &[Vec3], b: &[Vec3]| -> Vec<Vec3> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let position =
            glb.vectors(&shift(&frame.positions, &first.positions), true, "a morph target")?;
        let normal =
            glb.vectors(&shift(&frame.normals, &first.normals), false, "a morph target")?;
        targets.push(json!({"POSITION": position, "NORMAL": normal}));
    }
    let times: Vec<f32> = (0..frames.len()).map(|k| k as f32 / fps).collect();
    let weights: Vec<f32> = (0..frames.len())
        .flat_map(|k| (1..frames.len()).map(move |target| if target == k { 1.0 } else { 0.0 }))
        .collect();
    let (input, output) = (glb.numbers(&times, true)?, glb.numbers(&weights, false)?);
    let interpolation = match between {
        Between::Step => "STEP",
        Between::Linear => "LINEAR",
    };
    attributes["targets"] = json!(targets);
    let material = glb.material(model.base_colour.as_deref());
    let animation = json!({"animations": [{
        "name": "wrinkles",
        "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
    }]});
    glb.write(out, attributes, material, json!({"weights": vec![0.0; others.len()]}), animation)
}

/// Numbers of the vertices of divided faces: draw vertices, then those on edges, then those inside
/// faces.
struct Lattice {
    parts: usize,
    corners: usize,
    edges: HashMap<[u32; 2], usize>,
    count: usize,
}

impl Lattice {
    fn new(faces: &[[u32; 3]], corners: usize, parts: usize) -> Self {
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

    /// Vertices in all when edges have `parts` parts.
    fn count_at(&self, parts: usize, faces: usize) -> usize {
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

/// Vertices inside a face whose edges have `parts` parts.
fn inner(parts: usize) -> usize {
    (parts - 1) * parts.saturating_sub(2) / 2
}
