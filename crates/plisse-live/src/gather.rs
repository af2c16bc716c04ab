//! Stage "Gather": the data of each face's corners side by side, so that Render needs vertex
//! attributes only.
//!
//! Positions and waves are those of the welded vertices, so that no seam opens or shows. Normals
//! and texture coordinates are those of the draw vertices, so that hard edges and texture seams
//! stay.

use rayon::prelude::*;

use crate::live::Frame;
use crate::model::Model;
use crate::render::Corner;
use crate::weld::WeldedMesh;
use crate::{CHUNK, Vec2};

/// `[F]` corners of each face of `model` in `frame`. Of its draw vertices, only the normals are
/// read.
pub fn gather(model: &Model, welded: &WeldedMesh, frame: &Frame<'_>) -> Vec<[Corner; 3]> {
    let Frame { state, drawn } = *frame;
    let corner = |draw: u32| {
        let (draw, v) = (draw as usize, welded.vertex_of_draw[draw as usize] as usize);
        Corner {
            position: state.posed.positions[v],
            normal: drawn.normals[draw],
            uv: model.uvs.get(draw).copied().unwrap_or_else(Vec2::zeros),
            amplitude_m: state.waves.amplitude_m[v],
            wave: state.waves.wave[v],
            phase: state.phase[v],
        }
    };
    model.faces.par_iter().with_min_len(CHUNK).map(|face| face.map(corner)).collect()
}
