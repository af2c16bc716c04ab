//! Stage "Gather": what the corners of each face carry, side by side, so that Render needs vertex
//! attributes only.
//!
//! Positions and waves are the unified vertices', so that no seam opens or shows; normals and
//! texture coordinates the draw vertices', so that hard edges and texture seams stay.

use rayon::prelude::*;

use crate::crush::Crushed;
use crate::model::Model;
use crate::render::Corner;
use crate::skin::Skinned;
use crate::unify::Unified;
use crate::{CHUNK, Vec2};

/// `[F]` corners of each face of `model`: `posed` and `crushed` and `phase` (`[U]`, rad) of its
/// unified vertices, `posed_draw` of its draw vertices (of which only the normals are read).
pub fn gather(
    model: &Model,
    unified: &Unified,
    posed: &Skinned,
    posed_draw: &Skinned,
    crushed: &Crushed,
    phase: &[f32],
) -> Vec<[Corner; 3]> {
    let corner = |draw: u32| {
        let (draw, v) = (draw as usize, unified.vertex_of_draw[draw as usize] as usize);
        Corner {
            position: posed.positions[v],
            normal: posed_draw.normals[draw],
            uv: model.uvs.get(draw).copied().unwrap_or_else(Vec2::zeros),
            amplitude_m: crushed.amplitude_m[v],
            wave: crushed.wave[v],
            phase: phase[v],
        }
    };
    model.faces.par_iter().with_min_len(CHUNK).map(|face| face.map(corner)).collect()
}
