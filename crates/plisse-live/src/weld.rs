//! The welded mesh: draw vertices welded by their rest positions, for the simulation (section 3 of
//! [Loviscach 2006]), with their neighbours.
//!
//! A texture seam splits vertices, but wrinkles must run across it. Vertices at one place become
//! one vertex, whatever their normals and texture coordinates, if they move alike: joints, weights
//! and morph shifts agree. Others only touch, as closed lips do, or two rigid parts. A welded
//! vertex has the weights of its first draw vertex.

mod agreement;

use std::collections::HashMap;

use self::agreement::Motions;
use crate::Vec3;
use crate::model::{Model, Morph, Vertices};

/// The mesh that is simulated. Never changes after it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct WeldedMesh {
    /// `U` vertices; normals are the means of the faces around them, weighted by area.
    pub vertices: Vertices,
    /// `[V]` welded vertex of each draw vertex.
    pub vertex_of_draw: Vec<u32>,
    /// `[F][3]` welded vertices of each face; two may be equal where the face is a sliver.
    pub faces: Vec<[u32; 3]>,
    /// `[U + 1]` first neighbour of each vertex in `neighbours`.
    pub starts: Vec<u32>,
    /// Neighbours along edges, ascending at each vertex.
    pub neighbours: Vec<u32>,
}

impl WeldedMesh {
    /// Welds `model`'s draw vertices that are less than `tolerance` (a share of the bounding
    /// box's diagonal; 1e-5 does for most files) apart and move alike.
    pub fn new(model: &Model, tolerance: f32) -> Self {
        let draw = &model.draw;
        let (vertex_of_draw, first) = weld(model, tolerance);
        let pick = |list: &[Vec3]| -> Vec<Vec3> {
            if list.is_empty() { Vec::new() } else { first.iter().map(|&v| list[v]).collect() }
        };
        let faces: Vec<[u32; 3]> =
            model.faces.iter().map(|f| f.map(|v| vertex_of_draw[v as usize])).collect();
        let positions = pick(&draw.positions);
        let normals = vertex_normals(&positions, &faces);
        let vertices = Vertices {
            positions,
            normals,
            joints: first.iter().map(|&v| draw.joints[v]).collect(),
            weights: first.iter().map(|&v| draw.weights[v]).collect(),
            morphs: draw
                .morphs
                .iter()
                .map(|m| Morph { positions: pick(&m.positions), normals: pick(&m.normals) })
                .collect(),
        };
        let mut pairs: Vec<[u32; 2]> = Vec::with_capacity(6 * faces.len());
        for face in &faces {
            for k in 0..3 {
                let (i, j) = (face[k], face[(k + 1) % 3]);
                if i != j {
                    pairs.extend([[i, j], [j, i]]);
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0u32; first.len() + 1];
        for pair in &pairs {
            starts[pair[0] as usize + 1] += 1;
        }
        for v in 0..first.len() {
            starts[v + 1] += starts[v];
        }
        Self {
            vertices,
            vertex_of_draw,
            faces,
            starts,
            neighbours: pairs.iter().map(|p| p[1]).collect(),
        }
    }

    /// Number of vertices.
    pub fn count(&self) -> usize {
        self.vertices.positions.len()
    }

    /// Neighbours of vertex `v`, ascending.
    pub fn around(&self, v: usize) -> &[u32] {
        &self.neighbours[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// Fills in the normals of draw vertices that have none: those of their welded vertices. They are
/// smooth where glTF asks for flat faces, because a coarse mesh under wrinkles stands for a smooth
/// surface (section 6.1 interpolates normals).
pub fn fill_normals(model: &mut Model, welded: &WeldedMesh) {
    for (v, normal) in model.draw.normals.iter_mut().enumerate() {
        if normal.norm_squared() < 0.25 {
            *normal = welded.vertices.normals[welded.vertex_of_draw[v] as usize];
        }
    }
}

/// Unit normals of vertices, means of their faces weighted by area; zero where there is no face
/// with an area.
pub fn vertex_normals(positions: &[Vec3], faces: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let area = (b - a).cross(&(c - a));
        face.iter().for_each(|&v| normals[v as usize] += area);
    }
    normals.iter().map(|n| n.try_normalize(1e-30).unwrap_or_else(Vec3::zeros)).collect()
}

/// `[V]` group of each draw vertex, and `[groups]` the first vertex of each. Groups are counted in
/// the order of their first members.
fn weld(model: &Model, tolerance: f32) -> (Vec<u32>, Vec<usize>) {
    let positions = &model.draw.positions;
    let low = positions.iter().fold(Vec3::repeat(f32::INFINITY), |a, p| a.inf(p));
    let high = positions.iter().fold(Vec3::repeat(f32::NEG_INFINITY), |a, p| a.sup(p));
    let reach = ((high - low).norm() * tolerance).max(f32::MIN_POSITIVE);
    let motions = Motions::new(model, [low, high], reach);
    let cell =
        |p: &Vec3| [0, 1, 2].map(|k| (f64::from(p[k] - low[k]) / f64::from(reach)).floor() as i64);
    let mut firsts_in_cell: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let (mut groups, mut first) = (Vec::with_capacity(positions.len()), Vec::<usize>::new());
    for (v, p) in positions.iter().enumerate() {
        let here = cell(p);
        let mut found: Option<u32> = None;
        for shift in 0..27 {
            let near =
                [here[0] + shift % 3 - 1, here[1] + shift / 3 % 3 - 1, here[2] + shift / 9 - 1];
            for &g in firsts_in_cell.get(&near).into_iter().flatten() {
                let other = first[g as usize];
                if (positions[other] - p).norm() <= reach && motions.agree(other, v) {
                    found = Some(found.map_or(g, |f| f.min(g)));
                }
            }
        }
        groups.push(found.unwrap_or_else(|| {
            let g = first.len() as u32;
            first.push(v);
            firsts_in_cell.entry(here).or_default().push(g);
            g
        }));
    }
    (groups, first)
}
