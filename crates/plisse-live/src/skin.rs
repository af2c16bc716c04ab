//! Stage "Skin" (4.1): nodes → palette → posed positions and normals.
//!
//! It departs from the paper in one point: normals are turned by the cofactors of the blended
//! matrix, not by the matrix itself, so that they stay perpendicular where joints stretch or
//! squeeze.

use rayon::prelude::*;

use crate::model::{Clip, INFLUENCES, Model, Target, Vertices, quaternion, sample};
use crate::{CHUNK, Mat4, Vec3};

/// The motion of a model in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// `[P]` map from rest space to posed space of each palette entry.
    pub palette: Vec<Mat4>,
    /// `[targets]` morph weights.
    pub morph_weights: Vec<f32>,
}

/// Vertices in posed space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PosedVertices {
    /// `[V]` positions (m).
    pub positions: Vec<Vec3>,
    /// `[V]` unit normals; zero where the rest pose has none.
    pub normals: Vec<Vec3>,
}

/// The pose of `model` at `time_s` of `clip` (held after its end); without a clip, the pose of its
/// nodes.
pub fn pose(model: &Model, clip: Option<&Clip>, time_s: f32) -> Pose {
    let mut nodes = model.nodes.clone();
    let mut morph_weights = model.morph_weights.clone();
    for channel in clip.iter().flat_map(|c| &c.channels) {
        let value = sample(channel, time_s);
        match channel.target {
            Target::Translation(n) => nodes[n].translation = Vec3::from_column_slice(&value),
            Target::Rotation(n) => nodes[n].rotation = quaternion(&value),
            Target::Scale(n) => nodes[n].scale = Vec3::from_column_slice(&value),
            Target::Weights(first, count) => {
                morph_weights[first..first + count].copy_from_slice(&value)
            }
        }
    }
    let mut world = vec![Mat4::identity(); nodes.len()];
    for &n in &model.node_order {
        let (node, local) = (&nodes[n], nodes[n].local());
        world[n] = node.parent.map_or(local, |p| world[p] * local);
    }
    let palette = model
        .palette_nodes
        .iter()
        .zip(&model.inverse_binds)
        .map(|(&n, bind)| world[n] * bind)
        .collect();
    Pose { palette, morph_weights }
}

/// Moves `vertices` into `pose`.
pub fn skin(vertices: &Vertices, pose: &Pose) -> PosedVertices {
    let place = |v: usize| {
        let (mut x, mut n) = (vertices.positions[v], vertices.normals[v]);
        for (morph, &weight) in vertices.morphs.iter().zip(&pose.morph_weights) {
            x += morph.positions[v] * weight;
            if let Some(shift) = morph.normals.get(v) {
                n += shift * weight;
            }
        }
        let mut m = Mat4::zeros();
        for k in 0..INFLUENCES {
            if vertices.weights[v][k] > 0.0 {
                m += pose.palette[vertices.joints[v][k] as usize] * vertices.weights[v][k];
            }
        }
        let column = |c: usize| Vec3::new(m[(0, c)], m[(1, c)], m[(2, c)]);
        let [a, b, c] = [column(0), column(1), column(2)];
        let position = a * x.x + b * x.y + c * x.z + column(3);
        // Cofactors of the matrix, with the determinant's sign: the direction of M⁻ᵀn.
        let turned = b.cross(&c) * n.x + c.cross(&a) * n.y + a.cross(&b) * n.z;
        let sign = if b.cross(&c).dot(&a) < 0.0 { -1.0 } else { 1.0 };
        (position, (turned * sign).try_normalize(1e-30).unwrap_or_else(Vec3::zeros))
    };
    let (positions, normals) =
        (0..vertices.positions.len()).into_par_iter().with_min_len(CHUNK).map(place).unzip();
    PosedVertices { positions, normals }
}
