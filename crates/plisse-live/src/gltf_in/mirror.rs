//! Meshes whose joints mirror them.

use nalgebra::Vector3;

use super::Counts;
use crate::model::Model;
use crate::skin::pose;
use crate::{Mat4, Vec3};

/// Mirrors the rest shape of one skinned instance, which reaches from the counts `first` to the
/// counts `end`, if all its joints mirror it in the nodes' own pose: its faces would be inside out
/// otherwise. No posed vertex moves.
pub(super) fn unmirror(model: &mut Model, first: Counts, end: Counts) {
    let palette = &pose(model, None, 0.0).palette[first.palette..end.palette];
    let mirrors = |m: &Mat4| m.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
    if palette.is_empty() || !palette.iter().all(mirrors) {
        return;
    }
    let flip = |list: &mut [Vec3]| {
        let part = list.len().min(first.vertices)..list.len().min(end.vertices);
        list[part].iter_mut().for_each(|x| x.x = -x.x);
    };
    flip(&mut model.draw.positions);
    flip(&mut model.draw.normals);
    for morph in &mut model.draw.morphs {
        flip(&mut morph.positions);
        flip(&mut morph.normals);
    }
    let mirror = Mat4::new_nonuniform_scaling(&Vector3::new(-1.0, 1.0, 1.0));
    model.inverse_binds[first.palette..end.palette].iter_mut().for_each(|m| *m *= mirror);
    model.faces[first.faces..end.faces].iter_mut().for_each(|f| f.swap(1, 2));
}
