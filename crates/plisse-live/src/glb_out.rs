//! Binary glTF 2.0 out: one mesh with one material, its image and morph targets.

use std::io::{self, Write};

use serde_json::{Value, json};

use crate::Vec3;
use crate::fine_mesh::FineMesh;

// Numbers of the glTF 2.0 specification.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// A file in the making, list by list. Every list is padded to 4 bytes.
#[derive(Default)]
pub(crate) struct Glb {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    images: Vec<Value>,
}

/// The JSON around the lists.
#[derive(Default)]
pub(crate) struct Document {
    /// The one primitive.
    pub(crate) primitive: Value,
    /// Its material.
    pub(crate) material: Value,
    /// More fields of the mesh, or null.
    pub(crate) mesh: Value,
    /// More fields of the document, or null.
    pub(crate) document: Value,
}

/// Numbers of one accessor: the layout of its elements and its use.
struct Layout {
    /// Kind of an element as glTF names it.
    kind: &'static str,
    /// Numbers of an element.
    width: usize,
    /// True if the accessor gives its least and largest values.
    bounds: bool,
    /// Use of the buffer view, for vertex data.
    target: Option<u32>,
}

/// An error about data that cannot be written.
pub(crate) fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, message)
}

/// Adds the lists of `fine`; the primitive without material and targets.
pub(crate) fn mesh_attributes(glb: &mut Glb, fine: &FineMesh) -> io::Result<Value> {
    let count = fine.positions.len();
    if fine.faces.is_empty() || fine.normals.len() != count || fine.uvs.len() != count {
        return Err(invalid(
            "the mesh has no faces, or not one normal and texture coordinate for each vertex"
                .into(),
        ));
    }
    if fine.faces.iter().flatten().any(|&v| v as usize >= count) {
        return Err(invalid("a face names a vertex that is not there".into()));
    }
    let position = glb.vectors(&fine.positions, true, "a position")?;
    let normal = glb.vectors(&fine.normals, false, "a normal")?;
    let uvs: Vec<f32> = fine.uvs.iter().flat_map(|uv| [uv.x, uv.y]).collect();
    let layout = Layout { kind: "VEC2", width: 2, bounds: false, target: Some(ARRAY_BUFFER) };
    let uv = glb.floats(&uvs, layout, "a texture coordinate")?;
    let view = glb.view(
        fine.faces.iter().flatten().flat_map(|v| v.to_le_bytes()).collect(),
        Some(ELEMENT_ARRAY_BUFFER),
    );
    glb.accessors.push(json!({
        "bufferView": view,
        "componentType": UNSIGNED_INT,
        "count": 3 * fine.faces.len(),
        "type": "SCALAR",
    }));
    let indices = glb.accessors.len() - 1;
    Ok(json!({
        "attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv},
        "indices": indices,
        "material": 0,
    }))
}

impl Glb {
    /// Adds a list of vectors, with its bounds if it holds `positions`; its accessor.
    pub(crate) fn vectors(
        &mut self,
        list: &[Vec3],
        positions: bool,
        what: &str,
    ) -> io::Result<usize> {
        let numbers: Vec<f32> = list.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
        let layout =
            Layout { kind: "VEC3", width: 3, bounds: positions, target: Some(ARRAY_BUFFER) };
        self.floats(&numbers, layout, what)
    }

    /// Adds a list of numbers of an animation; its accessor.
    pub(crate) fn numbers(&mut self, list: &[f32], bounds: bool) -> io::Result<usize> {
        self.floats(list, Layout { kind: "SCALAR", width: 1, bounds, target: None }, "a key")
    }

    fn floats(&mut self, list: &[f32], layout: Layout, what: &str) -> io::Result<usize> {
        let Layout { kind, width, bounds, target } = layout;
        if let Some(i) = list.iter().position(|x| !x.is_finite()) {
            return Err(invalid(format!("{what} ({}) is not finite", i / width)));
        }
        let view = self.view(list.iter().flat_map(|x| x.to_le_bytes()).collect(), target);
        let mut accessor = json!({
            "bufferView": view,
            "componentType": FLOAT,
            "count": list.len() / width,
            "type": kind,
        });
        if bounds {
            let of = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
                (0..width)
                    .map(|k| {
                        list.iter().skip(k).step_by(width).copied().reduce(pick).unwrap_or(0.0)
                    })
                    .collect()
            };
            (accessor["min"], accessor["max"]) = (json!(of(f32::min)), json!(of(f32::max)));
        }
        self.accessors.push(accessor);
        Ok(self.accessors.len() - 1)
    }

    fn view(&mut self, bytes: Vec<u8>, target: Option<u32>) -> usize {
        let mut view =
            json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    /// A rough, double-sided material with the image `base_colour` (PNG or JPEG bytes; anything
    /// else is left out).
    pub(crate) fn material(&mut self, base_colour: Option<&[u8]>) -> Value {
        let mut surface = json!({"metallicFactor": 0.0, "roughnessFactor": 0.8});
        let kind = |bytes: &[u8]| match bytes {
            [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
            [0xFF, 0xD8, 0xFF, ..] => Some("image/jpeg"),
            _ => None,
        };
        if let Some((bytes, kind)) = base_colour.and_then(|bytes| Some((bytes, kind(bytes)?))) {
            let view = self.view(bytes.to_vec(), None);
            self.images.push(json!({"bufferView": view, "mimeType": kind}));
            surface["baseColorTexture"] = json!({"index": 0});
        }
        json!({"doubleSided": true, "pbrMetallicRoughness": surface})
    }

    /// Writes the file.
    pub(crate) fn write<W: Write + ?Sized>(
        self,
        out: &mut W,
        Document { primitive, material, mesh, document }: Document,
    ) -> io::Result<()> {
        let mut whole = json!({
            "asset": {"version": "2.0", "generator": concat!("Plissé ", env!("CARGO_PKG_VERSION"))},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [primitive]}],
            "materials": [material],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.bytes.len()}],
        });
        if !self.images.is_empty() {
            whole["images"] = json!(self.images);
            whole["textures"] = json!([{"source": 0}]);
        }
        for (target, more) in [("/meshes/0", mesh), ("", document)] {
            let target = whole.pointer_mut(target).and_then(Value::as_object_mut);
            if let (Some(target), Value::Object(more)) = (target, more) {
                target.extend(more);
            }
        }
        let mut text = serde_json::to_vec(&whole)?;
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = |n: usize| {
            u32::try_from(n).map_err(|_| {
                invalid("the file is beyond the format's 4 GiB; write fewer frames".into())
            })
        };
        let total = length(12 + 8 + text.len() + 8 + self.bytes.len())?;
        out.write_all(b"glTF")?;
        for number in [2, total, length(text.len())?] {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(b"JSON")?;
        out.write_all(&text)?;
        out.write_all(&length(self.bytes.len())?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(&self.bytes)
    }
}
