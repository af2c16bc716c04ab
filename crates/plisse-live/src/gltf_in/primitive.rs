//! Primitives: the triangles of a mesh with the attributes of their vertices.

use gltf::mesh::{Mode, Primitive, Semantic};
use plisse::Result;

use super::Reader;
use crate::model::INFLUENCES;
use crate::{Mat4, Vec2, Vec3};

/// One mesh on one node, as its primitives need it.
pub(super) struct Instance {
    /// True if the node has a skin.
    pub(super) is_skinned: bool,
    /// First palette entry of the node's joints.
    pub(super) first_joint: usize,
    /// Number of the joints.
    pub(super) joint_count: usize,
    /// First of the mesh's morph targets.
    pub(super) first_target: usize,
    /// Map from the mesh to the world, for nodes without a skin.
    pub(super) own: Mat4,
}

/// Influences of the vertices of one primitive: `[V][8]` palette entries and weights.
struct Influences {
    joints: Vec<[u16; INFLUENCES]>,
    weights: Vec<[f32; INFLUENCES]>,
}

impl Reader<'_> {
    /// Adds the triangles of `primitive`; `place` names it in errors.
    pub(super) fn primitive(
        &mut self,
        primitive: &Primitive<'_>,
        place: &str,
        instance: &Instance,
    ) -> Result<()> {
        let Some(accessor) = primitive.get(&Semantic::Positions) else { return Ok(()) };
        let base = self.model.draw.positions.len();
        let positions = self.accessors.vectors(&accessor, &format!("{place}, positions"))?;
        let count = positions.len();
        let Some(triangles) = self.triangles(primitive, place, count)? else { return Ok(()) };
        let own = &instance.own;
        let linear = own.fixed_view::<3, 3>(0, 0).into_owned();
        let normal_map = linear.try_inverse().map_or(linear, |i| i.transpose());
        let mut normals = match primitive.get(&Semantic::Normals) {
            Some(accessor) => self.accessors.vectors(&accessor, &format!("{place}, normals"))?,
            None => Vec::new(),
        };
        normals.resize(count, Vec3::zeros());
        let uvs = self.uvs(primitive, place, count)?;
        self.wavelength_shares(primitive, place, count)?;
        let Influences { joints, weights } = self.influences(primitive, place, count, instance)?;
        for (t, target) in primitive.morph_targets().enumerate() {
            let name = format!("{place}, morph target {t}");
            let mut shifts = [Vec::new(), Vec::new()];
            for (k, accessor) in [target.positions(), target.normals()].into_iter().enumerate() {
                if let Some(accessor) = accessor {
                    shifts[k] = self.accessors.vectors(&accessor, &name)?;
                }
                shifts[k].resize(count, Vec3::zeros());
            }
            let morph = &mut self.model.draw.morphs[instance.first_target + t];
            morph.positions.resize(base, Vec3::zeros());
            morph.normals.resize(base, Vec3::zeros());
            morph.positions.extend(shifts[0].iter().map(|x| linear * x));
            morph.normals.extend(shifts[1].iter().map(|x| normal_map * x));
        }
        let draw = &mut self.model.draw;
        draw.positions.extend(positions.iter().map(|x| own.transform_point(&(*x).into()).coords));
        let unit = |n: &Vec3| (normal_map * n).try_normalize(1e-20).unwrap_or_else(Vec3::zeros);
        draw.normals.extend(normals.iter().map(unit));
        draw.joints.extend(joints);
        draw.weights.extend(weights);
        self.model.uvs.extend(uvs);
        let is_mirrored = linear.determinant() < 0.0;
        let turned = |[a, b, c]: [u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        self.model.faces.extend(triangles.iter().map(|&f| turned(f).map(|v| v + base as u32)));
        Ok(())
    }

    /// The triangles over `count` vertices; `None` for points and lines.
    fn triangles(
        &self,
        primitive: &Primitive<'_>,
        place: &str,
        count: usize,
    ) -> Result<Option<Vec<[u32; 3]>>> {
        let indices: Vec<u32> = match primitive.indices() {
            Some(accessor) => self
                .accessors
                .raw(&accessor, &format!("{place}, indices"))?
                .iter()
                .map(|&x| x as u32)
                .collect(),
            None => (0..count as u32).collect(),
        };
        if let Some(&i) = indices.iter().find(|&&i| i as usize >= count) {
            return self.bad(format!(
                "{place} names vertex {i}, but there are only {count}; export the file again"
            ));
        }
        Ok(Some(match primitive.mode() {
            Mode::Triangles => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
            Mode::TriangleStrip => indices
                .windows(3)
                .enumerate()
                .map(|(i, c)| if i % 2 == 0 { [c[0], c[1], c[2]] } else { [c[1], c[0], c[2]] })
                .collect(),
            Mode::TriangleFan => indices
                .get(1..)
                .unwrap_or(&[])
                .windows(2)
                .map(|c| [indices[0], c[0], c[1]])
                .collect(),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return Ok(None),
        }))
    }

    /// Texture coordinates of the first set; zeros without any.
    fn uvs(&self, primitive: &Primitive<'_>, place: &str, count: usize) -> Result<Vec<Vec2>> {
        let mut uvs: Vec<Vec2> = match primitive.get(&Semantic::TexCoords(0)) {
            Some(accessor) => self
                .accessors
                .numbers(&accessor, 2, &format!("{place}, texture coordinates"))?
                .chunks_exact(2)
                .map(Vec2::from_column_slice)
                .collect(),
            None => Vec::new(),
        };
        uvs.resize(count, Vec2::zeros());
        Ok(uvs)
    }

    /// Adds the shares of the wavelength that the vertex colours give, if there are colours.
    fn wavelength_shares(
        &mut self,
        primitive: &Primitive<'_>,
        place: &str,
        count: usize,
    ) -> Result<()> {
        let Some(accessor) = primitive.get(&Semantic::Colors(0)) else { return Ok(()) };
        let width = accessor.dimensions().multiplicity().clamp(3, 4);
        let colours = self.accessors.numbers(&accessor, width, &format!("{place}, colours"))?;
        let shares = self.model.wavelength_share.get_or_insert_default();
        // Vertices without colours, before these and after them, have the whole wavelength.
        shares.resize(self.model.draw.positions.len(), 1.0);
        shares.extend(colours.chunks_exact(width).take(count).map(|c| c[0].clamp(0.0, 1.0)));
        Ok(())
    }

    /// Joints and weights, with sum 1; vertices without weights hang on the first joint.
    fn influences(
        &self,
        primitive: &Primitive<'_>,
        place: &str,
        count: usize,
        instance: &Instance,
    ) -> Result<Influences> {
        let &Instance { is_skinned, first_joint, joint_count, .. } = instance;
        let (mut joints, mut weights) =
            (vec![[first_joint as u16; INFLUENCES]; count], vec![[0f32; INFLUENCES]; count]);
        for set in 0..if is_skinned { INFLUENCES / 4 } else { 0 } {
            let (Some(j), Some(w)) = (
                primitive.get(&Semantic::Joints(set as u32)),
                primitive.get(&Semantic::Weights(set as u32)),
            ) else {
                break;
            };
            let j = self.accessors.raw(&j, &format!("{place}, joints"))?;
            let w = self.accessors.numbers(&w, 4, &format!("{place}, weights"))?;
            if j.len() < 4 * count || w.len() < 4 * count {
                return self.bad(format!(
                    "{place} has fewer joints or weights than vertices; export the file again"
                ));
            }
            for v in 0..count {
                for k in 0..4 {
                    let (joint, weight) = (j[4 * v + k] as usize, w[4 * v + k].max(0.0));
                    if weight > 0.0 {
                        if joint >= joint_count {
                            return self.bad(format!(
                                "{place}, vertex {v} hangs on joint {joint}, but the \
                                    skin has {joint_count}; bind it again"
                            ));
                        }
                        joints[v][4 * set + k] = (first_joint + joint) as u16;
                        weights[v][4 * set + k] = weight;
                    }
                }
            }
        }
        for w in &mut weights {
            let sum: f32 = w.iter().sum();
            if sum > 0.0 && sum.is_finite() {
                w.iter_mut().for_each(|x| *x /= sum);
            } else {
                *w = [0.0; INFLUENCES];
                w[0] = 1.0;
            }
        }
        Ok(Influences { joints, weights })
    }
}
