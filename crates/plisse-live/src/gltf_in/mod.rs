//! Models from glTF 2.0 files (.glb, or .gltf with its buffers beside it or inside).
//!
//! Broken files end in one sentence. Not read are: points and lines, Draco and meshopt compression,
//! influences beyond the eighth, texture coordinates beyond the first set and their transforms,
//! animation of anything but nodes.
//!
//! The red channel of the vertex colours (the first set) is the share of the wavelength, see
//! [`mod@crate::wavelength`]; white is all of it.
//!
//! A mesh that hangs on a node without a skin counts as skinned to that node alone. Bind-space
//! positions are scaled (uniformly, by the median of edge lengths) to the size that the nodes' own
//! pose gives: files whose skeleton carries a change of unit would seem to be compressed otherwise.
//! Faces of mirrored nodes are turned, so that they show the same side as the file's.

mod accessors;
mod clips;
mod formats;
mod instancing;
mod mirror;
mod primitive;
mod scenes;
mod text;
mod trim;
mod uri;

use std::borrow::Cow;
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;

use nalgebra::UnitQuaternion;
use plisse::{Error, Result};

use self::accessors::Accessors;
use self::primitive::Instance;
use self::trim::{Image, trim};
use self::uri::{load, short};
use crate::model::{Model, Morph, Node, order_nodes};
use crate::skin::{pose, skin};
use crate::weld::{WeldedMesh, fill_normals};
use crate::{Mat4, Vec3};

/// Largest number of draw vertices of all meshes and copies together.
const MOST_VERTICES: usize = 1 << 25;

/// Reads the model in the file `path`: its default scene.
///
/// # Errors
/// [`Error::File`] if it cannot be read; [`Error::Mesh`] as [`from_bytes`].
pub fn read(path: &Path) -> Result<Model> {
    read_scene(path, None)
}

/// Reads the scene of this name or number in the file `path`; the default one without.
///
/// # Errors
/// As [`read`]; [`Error::Mesh`] for a scene that is not there.
pub fn read_scene(path: &Path, scene: Option<&str>) -> Result<Model> {
    let bytes = plisse::io::disk::read(path).map_err(|e| Error::reading(path, e))?;
    scene_from_bytes(&path.display().to_string(), &bytes, path.parent(), scene)
}

/// The model in `bytes`; files it names are looked for in `folder`.
///
/// # Errors
/// [`Error::Mesh`] at `place` for an unusable file: it is truncated or no glTF, a buffer is missing
/// or too short, a joint or vertex index is out of range, a number is no number, nodes form a ring,
/// nothing has positions and faces.
pub fn from_bytes(place: &str, bytes: &[u8], folder: Option<&Path>) -> Result<Model> {
    scene_from_bytes(place, bytes, folder, None)
}

/// The scene of this name or number in `bytes`, or the default one; otherwise as [`from_bytes`].
///
/// # Errors
/// As [`from_bytes`]; [`Error::Mesh`] for a scene that is not there.
pub fn scene_from_bytes(
    place: &str,
    bytes: &[u8],
    folder: Option<&Path>,
    scene: Option<&str>,
) -> Result<Model> {
    let bad = |message: String| Error::mesh(place, message);
    if let Some(sentence) = formats::other_format(bytes, place) {
        return Err(bad(sentence));
    }
    check_length(bytes).map_err(bad)?;
    let invalid =
        |e: &dyn Display| bad(format!("this is no valid glTF 2.0 file ({e}); export it again"));
    let (text, blob) = if bytes.starts_with(b"glTF") {
        let glb = gltf::Glb::from_slice(bytes).map_err(|e| invalid(&e))?;
        (glb.json, glb.bin)
    } else {
        (Cow::Borrowed(bytes), None)
    };
    let (mut root, note) = text::parse(&text).map_err(|e| invalid(&e))?;
    if root["asset"]["version"].as_str().is_some_and(|v| v.starts_with(['0', '1'])) {
        return Err(bad(formats::gltf_1()));
    }
    let mut notes: Vec<String> = note.into_iter().collect();
    let shown = scenes::shown(&root, scene).map_err(bad)?;
    notes.extend(shown.note);
    let copies = instancing::copies(&root);
    let image = trim(&mut root, &mut notes).map_err(bad)?;
    let root = serde_json::from_value(root).map_err(|e| invalid(&e))?;
    let file = gltf::Document::from_json(root).map_err(|e| invalid(&e))?;
    let buffers = read_buffers(&file, blob.as_deref(), folder).map_err(bad)?;
    let mut reader = Reader {
        accessors: Accessors { place, buffers },
        model: Model { name: place.to_owned(), notes, ..Model::default() },
        targets_of_node: Vec::new(),
        copies_of_node: Vec::new(),
    };
    reader.nodes(&file)?;
    reader.copies(&file, &copies)?;
    let mut skinned = Vec::new();
    for node in file.nodes().filter(|n| n.mesh().is_some() && shown.nodes[n.index()]) {
        let first = Counts::of(&reader.model);
        reader.instance(&node)?;
        if node.skin().is_some() {
            skinned.push([first, Counts::of(&reader.model)]);
        }
    }
    if reader.model.faces.is_empty() {
        return Err(bad(
            "no mesh has positions and triangles; export a model with a surface".to_owned()
        ));
    }
    reader.pad();
    reader.clips(&file);
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
    for [first, end] in skinned {
        scale_rest(&mut model, first, end);
        mirror::unmirror(&mut model, first, end);
    }
    let welded = WeldedMesh::new(&model, 1e-5);
    fill_normals(&mut model, &welded);
    Ok(model)
}

/// Checks that a GLB is as long as it says.
///
/// # Errors
/// A sentence without its place, if it is not.
fn check_length(bytes: &[u8]) -> std::result::Result<(), String> {
    if bytes.starts_with(b"glTF") {
        let length =
            bytes.get(8..12).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
        if length < 20 || length > bytes.len() {
            let message = format!(
                "the GLB says it has {length} bytes but has {}; it was cut off, so export or copy \
                 it again",
                bytes.len()
            );
            return Err(message);
        }
    }
    Ok(())
}

/// The bytes of all buffers of `file`.
///
/// # Errors
/// A sentence without its place, for a buffer that is missing or too short.
fn read_buffers(
    file: &gltf::Document,
    blob: Option<&[u8]>,
    folder: Option<&Path>,
) -> std::result::Result<Vec<Vec<u8>>, String> {
    let mut buffers = Vec::new();
    for buffer in file.buffers() {
        let n = buffer.index();
        let data = match buffer.source() {
            gltf::buffer::Source::Bin => blob
                .ok_or_else(|| format!("buffer {n} is missing; export it again as GLB"))?
                .to_vec(),
            gltf::buffer::Source::Uri(uri) => load(uri, folder).ok_or_else(|| {
                format!("buffer {n} ({}) cannot be read; put it beside the file", short(uri))
            })?,
        };
        if data.len() < buffer.length() {
            return Err(format!(
                "buffer {n} has {} bytes instead of {}; export the file again",
                data.len(),
                buffer.length()
            ));
        }
        buffers.push(data);
    }
    Ok(buffers)
}

/// Numbers of draw vertices, palette entries and faces that were read.
#[derive(Clone, Copy)]
struct Counts {
    vertices: usize,
    palette: usize,
    faces: usize,
}

impl Counts {
    fn of(model: &Model) -> Self {
        Self {
            vertices: model.draw.positions.len(),
            palette: model.palette_nodes.len(),
            faces: model.faces.len(),
        }
    }
}

struct Reader<'a> {
    accessors: Accessors<'a>,
    model: Model,
    /// `[N]` morph targets of the mesh on each node.
    targets_of_node: Vec<Range<usize>>,
    /// `[N]` nodes at which the mesh of each node is drawn: itself, if it has no copies.
    copies_of_node: Vec<Vec<usize>>,
}

impl Reader<'_> {
    fn bad<T>(&self, message: impl Into<String>) -> Result<T> {
        accessors::bad(self.accessors.place, message)
    }

    fn nodes(&mut self, file: &gltf::Document) -> Result<()> {
        for node in file.nodes() {
            let (t, r, s) = decomposed(&node.transform());
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
        self.targets_of_node = vec![0..0; self.model.nodes.len()];
        self.copies_of_node = (0..self.model.nodes.len()).map(|n| vec![n]).collect();
        match order_nodes(&self.model.nodes) {
            Some(order) => self.model.node_order = order,
            None => return self.bad(
                "nodes form a ring, each the parent of the next; break it or export the file again",
            ),
        }
        Ok(())
    }

    /// Adds the mesh on `node` with all its triangles, as often as it is drawn.
    fn instance(&mut self, node: &gltf::Node<'_>) -> Result<()> {
        let mesh = node.mesh().expect("only nodes with meshes are asked");
        let targets = mesh.primitives().map(|p| p.morph_targets().count()).max().unwrap_or(0);
        let first_target = self.model.draw.morphs.len();
        self.targets_of_node[node.index()] = first_target..first_target + targets;
        let weights = node.weights().or(mesh.weights()).unwrap_or(&[]);
        for t in 0..targets {
            self.model.draw.morphs.push(Morph::default());
            self.model
                .morph_weights
                .push(weights.get(t).copied().filter(|w| w.is_finite()).unwrap_or(0.0));
        }
        for copy in self.copies_of_node[node.index()].clone() {
            let first_joint = self.model.palette_nodes.len();
            let own = match node.skin() {
                Some(skin) => {
                    self.skin(&skin)?;
                    Mat4::identity()
                }
                None => self.own_joint(copy),
            };
            let joint_count = self.model.palette_nodes.len() - first_joint;
            if first_joint + joint_count > usize::from(u16::MAX) {
                return self
                    .bad("the file has more than 65535 joints or copies of meshes; split it");
            }
            let is_skinned = node.skin().is_some();
            let instance = Instance { is_skinned, first_joint, joint_count, first_target, own };
            for primitive in mesh.primitives() {
                let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
                self.primitive(&primitive, &place, &instance)?;
            }
            if self.model.draw.positions.len() > MOST_VERTICES {
                return self.bad(format!(
                    "its meshes and their copies have more than {MOST_VERTICES} vertices; split it"
                ));
            }
        }
        Ok(())
    }

    /// Adds the joints of `skin` to the palette.
    fn skin(&mut self, skin: &gltf::Skin<'_>) -> Result<()> {
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
            binds =
                values.chunks_exact(16).take(joints.len()).map(Mat4::from_column_slice).collect();
        }
        self.model.palette_nodes.extend(&joints);
        self.model.inverse_binds.extend(binds);
        Ok(())
    }

    /// Adds the node to the palette as its own joint; its map to the world. A node that is scaled
    /// to nothing, from which a clip lets it grow, counts as one of full size.
    fn own_joint(&mut self, node: usize) -> Mat4 {
        let mut own = Mat4::identity();
        let mut at = Some(node);
        while let Some(n) = at {
            let mut node = self.model.nodes[n].clone();
            if node.scale == Vec3::zeros() {
                node.scale = Vec3::repeat(1.0);
            }
            own = node.local() * own;
            at = node.parent;
        }
        let back = own.try_inverse().unwrap_or_else(|| {
            own = Mat4::identity();
            own
        });
        self.model.palette_nodes.push(node);
        self.model.inverse_binds.push(back);
        own
    }

    /// Pads the lists that only some primitives lengthened.
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
}

/// Translation, rotation and scale of a node; a matrix without a volume has no rotation.
fn decomposed(transform: &gltf::scene::Transform) -> ([f32; 3], [f32; 4], [f32; 3]) {
    let parts = transform.clone().decomposed();
    let gltf::scene::Transform::Matrix { matrix } = transform else { return parts };
    let is_finite = |list: &[f32]| list.iter().all(|x| x.is_finite());
    if is_finite(&parts.1) || !matrix.iter().all(|column| is_finite(column)) {
        return parts;
    }
    let length = |c: usize| Vec3::from_column_slice(&matrix[c][..3]).norm();
    ([matrix[3][0], matrix[3][1], matrix[3][2]], [0.0, 0.0, 0.0, 1.0], [0, 1, 2].map(length))
}

/// Scales the rest positions of one skinned instance to the size that the nodes' pose gives. The
/// instance reaches from the counts `first` to the counts `end`.
fn scale_rest(model: &mut Model, first: Counts, end: Counts) {
    let posed = skin(&model.draw, &pose(model, None, 0.0)).positions;
    let mut ratios = Vec::new();
    for face in &model.faces[first.faces..end.faces] {
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
    let vertices = first.vertices..end.vertices;
    model.draw.positions[vertices.clone()].iter_mut().for_each(|x| *x *= scale);
    for morph in &mut model.draw.morphs {
        morph.positions[vertices.clone()].iter_mut().for_each(|x| *x *= scale);
    }
    model.inverse_binds[first.palette..end.palette]
        .iter_mut()
        .for_each(|m| *m *= Mat4::new_scaling(1.0 / scale));
}
