//! Agreement of vertices at one place: those that move alike are one vertex, others only touch.

use crate::model::{INFLUENCES, Model, Target};
use crate::{Mat4, Vec3};

/// Largest difference (no unit) of two vertices' weights of one joint; 8-bit weights differ by half
/// of it.
const WEIGHT_DIFFERENCE: f32 = 0.02;
/// Largest difference of two vertices' morph shifts, in the reach of welding; shifts are often
/// stored in 16 bits.
const SHIFT_DIFFERENCE: f32 = 10.0;

/// The motions of a model's vertices, to compare them.
pub(super) struct Motions<'a> {
    model: &'a Model,
    /// `[P]` first palette entry that moves as this one does in all clips.
    like: Vec<u16>,
    /// Largest difference of morph shifts (m).
    shift_m: f32,
}

impl<'a> Motions<'a> {
    /// The motions of `model`, whose vertices lie in the box from `low` to `high`; they are welded
    /// over the distance `reach` (m).
    pub(super) fn new(model: &'a Model, [low, high]: [Vec3; 2], reach: f32) -> Self {
        let parts = rigid_parts(model);
        let corners = [low, Vec3::new(high.x, low.y, low.z), Vec3::new(low.x, high.y, low.z), high];
        let places: Vec<(Option<usize>, [Vec3; 4], f32)> = model
            .palette_nodes
            .iter()
            .zip(&model.inverse_binds)
            .map(|(&node, bind)| {
                let (part, within) = &parts[node];
                let map = within * bind;
                let scale = map.fixed_view::<3, 3>(0, 0).norm();
                (*part, corners.map(|x| map.transform_point(&x.into()).coords), scale)
            })
            .collect();
        // Parts have few different maps, so each list stays short.
        let mut known: std::collections::HashMap<Option<usize>, Vec<usize>> = Default::default();
        let like = (0..places.len())
            .map(|p| {
                let (part, corners, scale) = &places[p];
                let list = known.entry(*part).or_default();
                let near = SHIFT_DIFFERENCE * reach * scale;
                let is_alike =
                    |&q: &usize| (0..4).all(|k| (places[q].1[k] - corners[k]).norm() <= near);
                let found = list.iter().copied().find(is_alike);
                found.unwrap_or_else(|| {
                    list.push(p);
                    p
                }) as u16
            })
            .collect();
        Self { model, like, shift_m: SHIFT_DIFFERENCE * reach }
    }

    /// True if the draw vertices `a` and `b` have the same joints, weights and morph shifts.
    pub(super) fn agree(&self, a: usize, b: usize) -> bool {
        let draw = &self.model.draw;
        let shift = |list: &[Vec3]| (list[a] - list[b]).norm() <= self.shift_m;
        let is_same = draw.joints[a] == draw.joints[b] && draw.weights[a] == draw.weights[b];
        (is_same || self.weights_agree(a, b))
            && draw.morphs.iter().all(|m| m.positions.is_empty() || shift(&m.positions))
    }

    fn weights_agree(&self, a: usize, b: usize) -> bool {
        let draw = &self.model.draw;
        let of = |v: usize, joint: u16| -> f32 {
            let is_it = |&k: &usize| self.like(draw.joints[v][k]) == joint;
            (0..INFLUENCES).filter(is_it).map(|k| draw.weights[v][k]).sum()
        };
        [a, b].into_iter().flat_map(|v| draw.joints[v]).all(|joint| {
            let joint = self.like(joint);
            (of(a, joint) - of(b, joint)).abs() <= WEIGHT_DIFFERENCE
        })
    }

    fn like(&self, joint: u16) -> u16 {
        self.like.get(usize::from(joint)).copied().unwrap_or(joint)
    }
}

/// `[N]` rigid part of each node: the nearest node, itself or above it, that a clip moves (`None`
/// if there is none), and the map from the node to that one.
fn rigid_parts(model: &Model) -> Vec<(Option<usize>, Mat4)> {
    let mut moves = vec![false; model.nodes.len()];
    for channel in model.clips.iter().flat_map(|clip| &clip.channels) {
        match channel.target {
            Target::Translation(n) | Target::Rotation(n) | Target::Scale(n) => moves[n] = true,
            Target::Weights(..) => {}
        }
    }
    let mut parts = vec![(None, Mat4::identity()); model.nodes.len()];
    for &n in &model.node_order {
        parts[n] = if moves[n] {
            (Some(n), Mat4::identity())
        } else {
            let node = &model.nodes[n];
            let (part, above) = node.parent.map_or((None, Mat4::identity()), |p| parts[p]);
            (part, above * node.local())
        };
    }
    parts
}
