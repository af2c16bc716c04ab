//! The characters' arrays as the stages' buffers hold them: one character after the other, so that
//! all are done in one pass.

use bytemuck::{Pod, Zeroable};
use plisse::{Error, Result};
use plisse_live::Vec3;
use plisse_live::live_model::LiveModel;
use plisse_live::model::{INFLUENCES, Model, Vertices};
use plisse_live::skin::Pose;
use plisse_live::weld::WeldedMesh;

/// One model that moves.
#[derive(Clone, Copy)]
pub struct Character<'a> {
    /// The model, with its normals filled in.
    pub model: &'a Model,
    /// Its welded vertices.
    pub welded: &'a WeldedMesh,
    /// `[U]` wavelength (m, rest), or one for all.
    pub wavelength_m: &'a [f32],
    /// `[U]` painted bias (section 7), or empty.
    pub bias: &'a [Vec3],
}

impl<'a> Character<'a> {
    /// The character of `live`.
    pub fn of(live: &'a LiveModel) -> Self {
        Self {
            model: &live.model,
            welded: &live.welded,
            wavelength_m: &live.options.wavelength_m,
            bias: &live.options.bias,
        }
    }
}

/// A rest or posed vertex as WGSL lays it out; the wavelength is that of rest vertices.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Vertex {
    pub(crate) position: [f32; 3],
    pub(crate) wavelength_m: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) unused: f32,
}

/// The shift that one morph target adds to one vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Shift {
    position: [f32; 3],
    target: u32,
    normal: [f32; 3],
    unused: f32,
}

/// The ranges of one character: first item and the one after the last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CharacterRanges {
    pub(crate) welded: [usize; 2],
    pub(crate) faces: [usize; 2],
}

/// All characters' arrays. Skinned vertices are the welded vertices of all characters, then the
/// draw vertices of all.
#[derive(Debug, Default)]
pub(crate) struct Arrays {
    pub(crate) ranges: Vec<CharacterRanges>,
    pub(crate) welded_count: usize,
    pub(crate) groups: usize,
    pub(crate) rest: Vec<Vertex>,
    pub(crate) joints: Vec<[u16; 4]>,
    pub(crate) weights: Vec<[f32; 4]>,
    pub(crate) shift_starts: Vec<u32>,
    pub(crate) shifts: Vec<Shift>,
    pub(crate) starts: Vec<u32>,
    pub(crate) neighbours: Vec<u32>,
    pub(crate) bias: Vec<[f32; 4]>,
    pub(crate) corners: Vec<u32>,
    pub(crate) vertex_of_draw: Vec<u32>,
    pub(crate) uvs: Vec<[f32; 2]>,
    pub(crate) palette_count: usize,
    pub(crate) target_count: usize,
}

impl Arrays {
    /// Lines the `characters` up.
    pub(crate) fn new(characters: &[Character<'_>]) -> Result<Self> {
        let few = |set: &Vertices| set.weights.iter().all(|w| w[4..].iter().all(|&x| x == 0.0));
        let groups = if characters.iter().all(|c| few(&c.model.draw) && few(&c.welded.vertices)) {
            1
        } else {
            INFLUENCES / 4
        };
        let mut arrays = Self { groups, shift_starts: vec![0], starts: vec![0], ..Self::default() };
        for character in characters {
            let first = arrays.rest.len();
            arrays.push_vertices(&character.welded.vertices, |v| {
                *character.wavelength_m.get(v).unwrap_or(&character.wavelength_m[0])
            })?;
            let ring = arrays.neighbours.len() as u32;
            arrays.starts.extend(character.welded.starts[1..].iter().map(|s| ring + s));
            arrays.neighbours.extend(character.welded.neighbours.iter().map(|n| first as u32 + n));
            let bias = |v: usize| character.bias.get(v).map_or([0.0; 4], |p| [p.x, p.y, p.z, 0.0]);
            arrays.bias.extend((0..character.welded.count()).map(bias));
            arrays
                .ranges
                .push(CharacterRanges { welded: [first, arrays.rest.len()], faces: [0; 2] });
            arrays.palette_count += character.model.palette_nodes.len();
            arrays.target_count += character.model.draw.morphs.len();
        }
        if characters.iter().all(|c| c.bias.is_empty()) {
            arrays.bias.clear();
        }
        arrays.welded_count = arrays.rest.len();
        (arrays.palette_count, arrays.target_count) = (0, 0);
        for (c, character) in characters.iter().enumerate() {
            let first = (arrays.rest.len() - arrays.welded_count) as u32;
            let face = arrays.corners.len() / 3;
            arrays.push_vertices(&character.model.draw, |_| 0.0)?;
            arrays.corners.extend(character.model.faces.iter().flatten().map(|v| first + v));
            let welded = arrays.ranges[c].welded[0] as u32;
            arrays
                .vertex_of_draw
                .extend(character.welded.vertex_of_draw.iter().map(|v| welded + v));
            let uv = |v: usize| character.model.uvs.get(v).map_or([0.0; 2], |t| [t.x, t.y]);
            arrays.uvs.extend((0..character.model.draw.positions.len()).map(uv));
            arrays.ranges[c].faces = [face, arrays.corners.len() / 3];
            arrays.palette_count += character.model.palette_nodes.len();
            arrays.target_count += character.model.draw.morphs.len();
        }
        Ok(arrays)
    }

    fn push_vertices(&mut self, set: &Vertices, wavelength_m: impl Fn(usize) -> f32) -> Result<()> {
        for v in 0..set.positions.len() {
            let (p, n) = (set.positions[v], set.normals[v]);
            self.rest.push(Vertex {
                position: p.into(),
                wavelength_m: wavelength_m(v),
                normal: n.into(),
                unused: 0.0,
            });
            for group in 0..self.groups {
                let mut entries = [0u16; 4];
                for k in 0..4 {
                    let entry = self.palette_count + usize::from(set.joints[v][4 * group + k]);
                    entries[k] = u16::try_from(entry).map_err(|_| {
                        Error::numeric(
                            "GPU",
                            "all characters together have more than 65,536 \
                            joints; draw fewer of them in one pass",
                        )
                    })?;
                }
                self.joints.push(entries);
                self.weights.push(std::array::from_fn(|k| set.weights[v][4 * group + k]));
            }
            for (t, morph) in set.morphs.iter().enumerate() {
                let normal = morph.normals.get(v).copied().unwrap_or_else(Vec3::zeros);
                if morph.positions[v] != Vec3::zeros() || normal != Vec3::zeros() {
                    let target = (self.target_count + t) as u32;
                    self.shifts.push(Shift {
                        position: morph.positions[v].into(),
                        target,
                        normal: normal.into(),
                        unused: 0.0,
                    });
                }
            }
            self.shift_starts.push(self.shifts.len() as u32);
        }
        Ok(())
    }
}

/// Rows of the palettes of `poses`, one after the other, and their morph weights.
pub(crate) fn frame(poses: &[&Pose]) -> (Vec<[f32; 12]>, Vec<f32>) {
    let rows = |m: &plisse_live::Mat4| std::array::from_fn(|i| m[(i / 4, i % 4)]);
    let palette = poses.iter().flat_map(|pose| &pose.palette).map(rows).collect();
    (palette, poses.iter().flat_map(|pose| pose.morph_weights.iter().copied()).collect())
}
