//! An animated model: vertices as they are drawn, a hierarchy of nodes, clips. Nothing here changes
//! after it is built.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::{Mat4, Vec2, Vec3};

/// Largest number of joints that move one vertex.
pub const INFLUENCES: usize = 8;

/// Vertices of one set, in structure-of-arrays form: the draw vertices of a model, or its welded
/// vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vertices {
    /// `[V]` positions in the rest pose (m).
    pub positions: Vec<Vec3>,
    /// `[V]` unit normals in the rest pose; zero where no face gives one.
    pub normals: Vec<Vec3>,
    /// `[V][8]` entries of the model's palette that move the vertex; 0 where the weight is 0.
    pub joints: Vec<[u16; INFLUENCES]>,
    /// `[V][8]` weights of these entries, ≥ 0, with sum 1.
    pub weights: Vec<[f32; INFLUENCES]>,
    /// `[targets]` shifts that morph targets add before skinning.
    pub morphs: Vec<Morph>,
}

/// One morph target, dense over all vertices of its set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Morph {
    /// `[V]` shift of positions at weight 1 (m, rest).
    pub positions: Vec<Vec3>,
    /// `[V]` shift of normals at weight 1; may be empty (none).
    pub normals: Vec<Vec3>,
}

/// A node of the hierarchy with its local transform.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The parent's index; parents may come after their children, see [`Model::node_order`].
    pub parent: Option<usize>,
    /// Translation against the parent (m).
    pub translation: Vec3,
    /// Rotation against the parent.
    pub rotation: UnitQuaternion<f32>,
    /// Scale along the node's own axes.
    pub scale: Vec3,
}

impl Node {
    /// Map from the node to its parent.
    pub fn local(&self) -> Mat4 {
        Mat4::new_translation(&self.translation)
            * self.rotation.to_homogeneous()
            * Mat4::new_nonuniform_scaling(&self.scale)
    }
}

impl Default for Node {
    fn default() -> Self {
        Self {
            parent: None,
            translation: Vec3::zeros(),
            rotation: UnitQuaternion::identity(),
            scale: Vec3::repeat(1.0),
        }
    }
}

/// Rule for values between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the last key.
    Step,
    /// Linear; rotations along the great arc.
    Linear,
    /// Cubic Hermite: each key has in-tangent, value and out-tangent.
    Cubic,
}

/// The quantity that a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A node's translation, 3 numbers a key.
    Translation(usize),
    /// A node's rotation (x, y, z, w), 4 numbers a key.
    Rotation(usize),
    /// A node's scale, 3 numbers a key.
    Scale(usize),
    /// Morph weights: first target and their count, that many numbers a key.
    Weights(usize, usize),
}

/// One animated quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The quantity that moves.
    pub target: Target,
    /// Rule for values between keys.
    pub interpolation: Interpolation,
    /// `[keys]` times (s), not descending; where two are the same, the value jumps.
    pub times: Vec<f32>,
    /// `[keys][1 or 3][width]` values; for [`Interpolation::Cubic`] in-tangent, value, out-tangent
    /// of each key.
    pub values: Vec<f32>,
}

/// A named animation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip {
    /// The name the file gives it.
    pub name: String,
    /// The quantities it moves.
    pub channels: Vec<Channel>,
}

impl Clip {
    /// Time of the last key (s); 0 without keys.
    pub fn duration_s(&self) -> f32 {
        self.channels.iter().filter_map(|c| c.times.last()).fold(0.0, |a, &b| a.max(b))
    }

    /// `count` times (s), evenly spaced from the clip's beginning to its end.
    pub fn times(&self, count: u32) -> Vec<f32> {
        (0..count).map(|k| self.duration_s() * k as f32 / (count - 1).max(1) as f32).collect()
    }
}

/// A model as it is drawn and animated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Name of its source, for messages.
    pub name: String,
    /// Draw vertices: split where texture or normals have seams.
    pub draw: Vertices,
    /// `[V]` texture coordinates of the draw vertices.
    pub uvs: Vec<Vec2>,
    /// `[V]` share (0..1) of the given wavelength at each draw vertex, from the file's vertex
    /// colours; see [`crate::wavelength`].
    pub wavelength_share: Option<Vec<f32>>,
    /// `[F][3]` draw vertices of each face, counter-clockwise from outside.
    pub faces: Vec<[u32; 3]>,
    /// `[N]` the hierarchy.
    pub nodes: Vec<Node>,
    /// `[N]` the nodes in an order in which parents come before children.
    pub node_order: Vec<usize>,
    /// `[P]` node of each palette entry.
    pub palette_nodes: Vec<usize>,
    /// `[P]` map from rest space to that node's space in the rest pose.
    pub inverse_binds: Vec<Mat4>,
    /// `[targets]` morph weights where no clip says otherwise.
    pub morph_weights: Vec<f32>,
    /// The animations.
    pub clips: Vec<Clip>,
    /// The base colour image as the file has it (PNG or JPEG bytes).
    pub base_colour: Option<Vec<u8>>,
    /// The reader's notes on what it repaired or left out, one sentence each.
    pub notes: Vec<String>,
}

impl Model {
    /// A model of one node that moves as a whole: every draw vertex hangs on palette entry 0.
    pub fn rigid(name: &str, positions: Vec<Vec3>, uvs: Vec<Vec2>, faces: Vec<[u32; 3]>) -> Self {
        let count = positions.len();
        let mut weights = [0.0; INFLUENCES];
        weights[0] = 1.0;
        let draw = Vertices {
            positions,
            normals: Vec::new(),
            joints: vec![[0; INFLUENCES]; count],
            weights: vec![weights; count],
            morphs: Vec::new(),
        };
        let mut model = Self {
            name: name.to_owned(),
            draw,
            uvs,
            faces,
            nodes: vec![Node::default()],
            node_order: vec![0],
            palette_nodes: vec![0],
            inverse_binds: vec![Mat4::identity()],
            ..Self::default()
        };
        model.draw.normals = vec![Vec3::zeros(); count];
        model
    }

    /// True if the model has texture coordinates; those of models from files without any are all
    /// the same.
    pub fn has_uvs(&self) -> bool {
        self.uvs.iter().any(|uv| *uv != self.uvs[0])
    }

    /// The clip called `name`, or the first one for `None`.
    pub fn clip(&self, name: Option<&str>) -> Option<&Clip> {
        match name {
            Some(name) => self.clips.iter().find(|clip| clip.name == name),
            None => self.clips.first(),
        }
    }
}

/// An order of nodes in which parents come first; `None` if a node is its own ancestor.
pub fn order_nodes(nodes: &[Node]) -> Option<Vec<usize>> {
    let mut children = vec![Vec::new(); nodes.len()];
    let mut order = Vec::with_capacity(nodes.len());
    for (n, node) in nodes.iter().enumerate() {
        match node.parent {
            Some(parent) => children[parent].push(n),
            None => order.push(n),
        }
    }
    let mut next = 0;
    while next < order.len() {
        let n = order[next];
        order.extend_from_slice(&children[n]);
        next += 1;
    }
    (order.len() == nodes.len()).then_some(order)
}

/// Value of `channel` at `time_s`, held before the first and after the last key. Rotations come out
/// normalised.
pub fn sample(channel: &Channel, time_s: f32) -> Vec<f32> {
    let width = match channel.target {
        Target::Translation(_) | Target::Scale(_) => 3,
        Target::Rotation(_) => 4,
        Target::Weights(_, count) => count,
    };
    let cubic = channel.interpolation == Interpolation::Cubic;
    let stride = if cubic { 3 * width } else { width };
    let part = |key: usize, p: usize| &channel.values[key * stride + p * width..][..width];
    let value = |key: usize| part(key, usize::from(cubic));
    let after = channel.times.partition_point(|&t| t <= time_s);
    let mut result = if after == 0 {
        value(0).to_vec()
    } else if after == channel.times.len() || channel.interpolation == Interpolation::Step {
        value(after - 1).to_vec()
    } else {
        let (i, j) = (after - 1, after);
        let step = channel.times[j] - channel.times[i];
        let s = ((time_s - channel.times[i]) / step).clamp(0.0, 1.0);
        if cubic {
            let (s2, s3) = (s * s, s * s * s);
            (0..width)
                .map(|k| {
                    (2.0 * s3 - 3.0 * s2 + 1.0) * value(i)[k]
                        + step * (s3 - 2.0 * s2 + s) * part(i, 2)[k]
                        + (3.0 * s2 - 2.0 * s3) * value(j)[k]
                        + step * (s3 - s2) * part(j, 0)[k]
                })
                .collect()
        } else if matches!(channel.target, Target::Rotation(_)) {
            return slerp(value(i), value(j), s);
        } else {
            (0..width).map(|k| value(i)[k] * (1.0 - s) + value(j)[k] * s).collect()
        }
    };
    if matches!(channel.target, Target::Rotation(_)) {
        result = quaternion(&result).coords.as_slice().to_vec();
    }
    result
}

/// The unit quaternion of (x, y, z, w); the identity for zero.
pub fn quaternion(xyzw: &[f32]) -> UnitQuaternion<f32> {
    let q = Quaternion::new(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    UnitQuaternion::try_new(q, 1e-12).unwrap_or_else(UnitQuaternion::identity)
}

fn slerp(a: &[f32], b: &[f32], s: f32) -> Vec<f32> {
    let (a, b) = (quaternion(a), quaternion(b));
    let turned = a.try_slerp(&b, s, 1e-6).unwrap_or(if s < 0.5 { a } else { b });
    turned.coords.as_slice().to_vec()
}
