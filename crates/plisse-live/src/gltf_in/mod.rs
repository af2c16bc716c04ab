//! Models from glTF 2.0 files (.glb, or .gltf with its buffers beside it or inside).
//!
//! Broken files end in one sentence. What is left out: points and lines, Draco and meshopt
//! compression, influences beyond the eighth, texture coordinates beyond the first set and their
//! transforms, what clips do to anything but nodes.
//!
//! The red channel of vertex colours (the first set) is taken as share of the wavelength, see
//! [`crate::wavelength`]; white is all of it.
//!
//! A mesh that hangs on a node without a skin counts as skinned to that node alone. Bind-space
//! positions are scaled (uniformly, by the median of edge lengths) to what the nodes' own pose
//! gives: files whose skeleton carries a change of unit would seem to be crushed otherwise.

mod accessors;
mod trim;
mod uri;

use std::borrow::Cow;
use std::fmt::Display;
use std::path::Path;

use gltf::animation::Property;
use gltf::mesh::{Mode, Primitive, Semantic};
use nalgebra::UnitQuaternion;
use plisse::{Error, Result};

use self::accessors::Accessors;
use self::trim::{Image, trim};
use self::uri::{load, short};
use crate::model::{
    Channel, Clip, INFLUENCES, Interpolation, Model, Morph, Node, Target, order_nodes,
};
use crate::skin::{pose, skin};
use crate::unify::{Unified, fill_normals};
use crate::{Mat4, Vec2, Vec3};

/// Reads the model in the file `path`.
///
/// # Errors
/// [`Error::File`] if it cannot be read; [`Error::Mesh`] as [`from_bytes`].
pub fn read(path: &Path) -> Result<Model> {
    let bytes = plisse::io::disk::read(path).map_err(|e| Error::reading(path, e))?;
    from_bytes(&path.display().to_string(), &bytes, path.parent())
}

/// The model in `bytes`; files it names are looked for in `folder`.
///
/// # Errors
/// [`Error::Mesh`] at `place` for whatever makes the file unusable: it is truncated or no glTF, a buffer is missing or too short, a joint or
/// vertex index is out of range, a number is no number, nodes form a ring, nothing has positions
/// and faces.
pub fn from_bytes(place: &str, bytes: &[u8], folder: Option<&Path>) -> Result<Model> {
    let bad = |message: String| Error::mesh(place, message);
    if bytes.starts_with(b"glTF") {
        let length =
            bytes.get(8..12).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
        if length < 20 || length > bytes.len() {
            let message = format!(
                "the GLB says it has {length} bytes but has {}; it was cut off, so export or copy \
                 it again",
                bytes.len()
            );
            return Err(bad(message));
        }
    }
    let invalid =
        |e: &dyn Display| bad(format!("this is no valid glTF 2.0 file ({e}); export it again"));
    let (text, blob) = if bytes.starts_with(b"glTF") {
        let glb = gltf::Glb::from_slice(bytes).map_err(|e| invalid(&e))?;
        (glb.json, glb.bin)
    } else {
        (Cow::Borrowed(bytes), None)
    };
    let mut root = serde_json::from_slice(&text).map_err(|e| invalid(&e))?;
    let image = trim(&mut root).map_err(bad)?;
    let root = serde_json::from_value(root).map_err(|e| invalid(&e))?;
    let file = gltf::Document::from_json(root).map_err(|e| invalid(&e))?;
    let mut buffers = Vec::new();
    for buffer in file.buffers() {
        let n = buffer.index();
        let data = match buffer.source() {
            gltf::buffer::Source::Bin => blob
                .as_ref()
                .ok_or_else(|| bad(format!("buffer {n} is missing; export it again as GLB")))?
                .to_vec(),
            gltf::buffer::Source::Uri(uri) => load(uri, folder).ok_or_else(|| {
                bad(format!("buffer {n} ({}) cannot be read; put it beside the file", short(uri)))
            })?,
        };
        if data.len() < buffer.length() {
            let message = format!(
                "buffer {n} has {} bytes instead of {}; export the file again",
                data.len(),
                buffer.length()
            );
            return Err(bad(message));
        }
        buffers.push(data);
    }
    let mut reader = Reader {
        accessors: Accessors { place, buffers },
        model: Model { name: place.to_owned(), ..Model::default() },
        target_of_node: Vec::new(),
    };
    reader.nodes(&file)?;
    let mut instances = Vec::new();
    for node in file.nodes().filter(|n| n.mesh().is_some()) {
        let first = [
            reader.model.draw.positions.len(),
            reader.model.palette_nodes.len(),
            reader.model.faces.len(),
        ];
        reader.instance(&node)?;
        if node.skin().is_some() {
            instances.push((
                first,
                [
                    reader.model.draw.positions.len(),
                    reader.model.palette_nodes.len(),
                    reader.model.faces.len(),
                ],
            ));
        }
    }
    if reader.model.faces.is_empty() {
        return Err(bad(
            "no mesh has positions and triangles; export a model with a surface".to_owned()
        ));
    }
    reader.pad();
    reader.clips(&file)?;
    let image = image.and_then(|image| match image {
        Image::View(v) => {
            let view = file.views().nth(v)?;
            let end = view.offset().checked_add(view.length())?;
            reader.accessors.buffers[view.buffer().index()]
                .get(view.offset()..end)
                .map(<[u8]>::to_vec)
        }
        Image::Uri(uri) => load(&uri, folder),
    });
    let mut model = reader.model;
    model.base_colour = image;
    for (first, end) in instances {
        scale_rest(&mut model, first, end);
    }
    let unified = Unified::new(&model, 1e-5);
    fill_normals(&mut model, &unified);
    Ok(model)
}

struct Reader<'a> {
    accessors: Accessors<'a>,
    model: Model,
    /// `[N]` first morph target and their count of the mesh on each node.
    target_of_node: Vec<(usize, usize)>,
}

impl Reader<'_> {
    fn bad<T>(&self, message: impl Into<String>) -> Result<T> {
        accessors::bad(self.accessors.place, message)
    }

    fn nodes(&mut self, file: &gltf::Document) -> Result<()> {
        for node in file.nodes() {
            let (t, r, s) = node.transform().decomposed();
            if t.iter().chain(&r).chain(&s).any(|x| !x.is_finite()) {
                return self.bad(format!(
                    "node {} has a transform that is no number; correct it",
                    node.index()
                ));
            }
            let rotation = crate::model::quaternion(&r);
            self.model.nodes.push(Node {
                parent: None,
                translation: t.into(),
                rotation: UnitQuaternion::new_normalize(*rotation),
                scale: s.into(),
            });
        }
        for node in file.nodes() {
            for child in node.children() {
                if self.model.nodes[child.index()].parent.replace(node.index()).is_some() {
                    return self.bad(format!(
                        "node {} has two parents; export the file again",
                        child.index()
                    ));
                }
            }
        }
        self.target_of_node = vec![(0, 0); self.model.nodes.len()];
        match order_nodes(&self.model.nodes) {
            Some(order) => self.model.node_order = order,
            None => return self.bad(
                "nodes form a ring, each the parent of the next; break it or export the file again",
            ),
        }
        Ok(())
    }

    /// Adds the mesh on `node` with all its triangles.
    fn instance(&mut self, node: &gltf::Node<'_>) -> Result<()> {
        let mesh = node.mesh().expect("only nodes with meshes are asked");
        let first_joint = self.model.palette_nodes.len();
        let mut own = Mat4::identity();
        let joint_count = if let Some(skin) = node.skin() {
            let joints: Vec<usize> = skin.joints().map(|j| j.index()).collect();
            let mut binds = vec![Mat4::identity(); joints.len()];
            if let Some(accessor) = skin.inverse_bind_matrices() {
                let values = self.accessors.numbers(&accessor, 16, "inverse bind matrices")?;
                if values.len() < 16 * joints.len() {
                    return self.bad(format!(
                        "skin {} has fewer inverse bind matrices than joints; \
                        export the file again",
                        skin.index()
                    ));
                }
                binds = values
                    .chunks_exact(16)
                    .take(joints.len())
                    .map(Mat4::from_column_slice)
                    .collect();
            }
            self.model.palette_nodes.extend(&joints);
            self.model.inverse_binds.extend(binds);
            joints.len()
        } else {
            let mut at = Some(node.index());
            while let Some(n) = at {
                let node = &self.model.nodes[n];
                own = Mat4::new_translation(&node.translation)
                    * node.rotation.to_homogeneous()
                    * Mat4::new_nonuniform_scaling(&node.scale)
                    * own;
                at = node.parent;
            }
            let back = own.try_inverse().unwrap_or_else(|| {
                own = Mat4::identity();
                own
            });
            self.model.palette_nodes.push(node.index());
            self.model.inverse_binds.push(back);
            1
        };
        if first_joint + joint_count > usize::from(u16::MAX) {
            return self.bad("the file has more than 65535 joints in all; split it");
        }
        let targets = mesh.primitives().map(|p| p.morph_targets().count()).max().unwrap_or(0);
        let first_target = self.model.draw.morphs.len();
        self.target_of_node[node.index()] = (first_target, targets);
        let weights = node.weights().or(mesh.weights()).unwrap_or(&[]);
        for t in 0..targets {
            self.model.draw.morphs.push(Morph::default());
            self.model
                .morph_weights
                .push(weights.get(t).copied().filter(|w| w.is_finite()).unwrap_or(0.0));
        }
        for primitive in mesh.primitives() {
            let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
            self.primitive(
                &primitive,
                &place,
                node.skin().is_some(),
                (first_joint, joint_count),
                first_target,
                &own,
            )?;
        }
        Ok(())
    }

    fn primitive(
        &mut self,
        primitive: &Primitive<'_>,
        place: &str,
        skinned: bool,
        (first_joint, joint_count): (usize, usize),
        first_target: usize,
        own: &Mat4,
    ) -> Result<()> {
        let Some(accessor) = primitive.get(&Semantic::Positions) else { return Ok(()) };
        let base = self.model.draw.positions.len();
        let positions = self.accessors.vectors(&accessor, &format!("{place}, positions"))?;
        let count = positions.len();
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
        let triangles: Vec<[u32; 3]> = match primitive.mode() {
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
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return Ok(()),
        };
        let linear = own.fixed_view::<3, 3>(0, 0).into_owned();
        let normal_map = linear.try_inverse().map_or(linear, |i| i.transpose());
        let mut normals = match primitive.get(&Semantic::Normals) {
            Some(accessor) => self.accessors.vectors(&accessor, &format!("{place}, normals"))?,
            None => Vec::new(),
        };
        normals.resize(count, Vec3::zeros());
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
        if let Some(accessor) = primitive.get(&Semantic::Colors(0)) {
            let width = accessor.dimensions().multiplicity().clamp(3, 4);
            let colours = self.accessors.numbers(&accessor, width, &format!("{place}, colours"))?;
            let shares = self.model.wavelength_share.get_or_insert_default();
            // What came before without colours has the whole wavelength, as has what comes after.
            shares.resize(base, 1.0);
            shares.extend(colours.chunks_exact(width).take(count).map(|c| c[0].clamp(0.0, 1.0)));
        }
        let (mut joints, mut weights) =
            (vec![[first_joint as u16; INFLUENCES]; count], vec![[0f32; INFLUENCES]; count]);
        for set in 0..if skinned { INFLUENCES / 4 } else { 0 } {
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
        for (t, target) in primitive.morph_targets().enumerate() {
            let name = format!("{place}, morph target {t}");
            let mut shifts = [Vec::new(), Vec::new()];
            for (k, accessor) in [target.positions(), target.normals()].into_iter().enumerate() {
                if let Some(accessor) = accessor {
                    shifts[k] = self.accessors.vectors(&accessor, &name)?;
                }
                shifts[k].resize(count, Vec3::zeros());
            }
            let morph = &mut self.model.draw.morphs[first_target + t];
            morph.positions.resize(base, Vec3::zeros());
            morph.normals.resize(base, Vec3::zeros());
            morph.positions.extend(shifts[0].iter().map(|x| linear * x));
            morph.normals.extend(shifts[1].iter().map(|x| normal_map * x));
        }
        let draw = &mut self.model.draw;
        draw.positions.extend(positions.iter().map(|x| own.transform_point(&(*x).into()).coords));
        draw.normals.extend(
            normals
                .iter()
                .map(|n| (normal_map * n).try_normalize(1e-20).unwrap_or_else(Vec3::zeros)),
        );
        draw.joints.extend(joints);
        draw.weights.extend(weights);
        self.model.uvs.extend(uvs);
        self.model.faces.extend(triangles.iter().map(|f| f.map(|v| v + base as u32)));
        Ok(())
    }

    fn pad(&mut self) {
        let count = self.model.draw.positions.len();
        for morph in &mut self.model.draw.morphs {
            morph.positions.resize(count, Vec3::zeros());
            morph.normals.resize(count, Vec3::zeros());
        }
        if let Some(shares) = &mut self.model.wavelength_share {
            shares.resize(count, 1.0);
        }
    }

    fn clips(&mut self, file: &gltf::Document) -> Result<()> {
        for animation in file.animations() {
            let name =
                animation.name().map_or_else(|| animation.index().to_string(), str::to_owned);
            let mut clip = Clip { name: name.clone(), channels: Vec::new() };
            for channel in animation.channels() {
                let node = channel.target().node().index();
                let (target, width) = match channel.target().property() {
                    Property::Translation => (Target::Translation(node), 3),
                    Property::Rotation => (Target::Rotation(node), 4),
                    Property::Scale => (Target::Scale(node), 3),
                    Property::MorphTargetWeights => {
                        let (first, count) = self.target_of_node[node];
                        if count == 0 {
                            continue;
                        }
                        (Target::Weights(first, count), count)
                    }
                };
                let sampler = channel.sampler();
                let what = format!("clip \"{name}\", channel {}", channel.index());
                let times = self.accessors.numbers(&sampler.input(), 1, &what)?;
                let output_width = if matches!(target, Target::Weights(..)) { 1 } else { width };
                let values = self.accessors.numbers(&sampler.output(), output_width, &what)?;
                let (interpolation, parts) = match sampler.interpolation() {
                    gltf::animation::Interpolation::Step => (Interpolation::Step, 1),
                    gltf::animation::Interpolation::Linear => (Interpolation::Linear, 1),
                    gltf::animation::Interpolation::CubicSpline => (Interpolation::Cubic, 3),
                };
                if times.is_empty()
                    || times.windows(2).any(|t| t[1] <= t[0])
                    || values.len() != times.len() * parts * width
                {
                    return self.bad(format!(
                        "{what} has no keys, keys out of order, or not one \
                        value per key; export the file again"
                    ));
                }
                clip.channels.push(Channel { target, interpolation, times, values });
            }
            self.model.clips.push(clip);
        }
        Ok(())
    }
}

/// Scales the rest positions of one skinned instance (its ranges of vertices, palette and faces) to
/// what the nodes' pose gives.
fn scale_rest(model: &mut Model, first: [usize; 3], end: [usize; 3]) {
    let posed = skin(&model.draw, &pose(model, None, 0.0)).positions;
    let mut ratios = Vec::new();
    for face in &model.faces[first[2]..end[2]] {
        for k in 0..3 {
            let (i, j) = (face[k] as usize, face[(k + 1) % 3] as usize);
            let rest = (model.draw.positions[i] - model.draw.positions[j]).norm();
            if rest > 0.0 {
                ratios.push((posed[i] - posed[j]).norm() / rest);
            }
        }
    }
    if ratios.is_empty() {
        return;
    }
    ratios.sort_by(f32::total_cmp);
    let scale = ratios[ratios.len() / 2];
    if !(scale.is_finite() && scale > 0.0) || (scale - 1.0).abs() < 0.2 {
        return;
    }
    let vertices = first[0]..end[0];
    model.draw.positions[vertices.clone()].iter_mut().for_each(|x| *x *= scale);
    for morph in &mut model.draw.morphs {
        morph.positions[vertices.clone()].iter_mut().for_each(|x| *x *= scale);
    }
    model.inverse_binds[first[1]..end[1]]
        .iter_mut()
        .for_each(|m| *m *= Mat4::new_scaling(1.0 / scale));
}
