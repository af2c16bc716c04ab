//! Binary glTF 2.0: one triangle mesh with one plain material, for viewers, game engines and
//! modelling programs.
//!
//! Writing only, all in one file. glTF stores single precision: a mesh far from the origin loses
//! detail (at 1 km a step is 0.06 mm), so move it near the origin first where that matters; nothing
//! is moved here.

use std::io::{self, Write};

use serde_json::{Value, json};

use crate::mesh::{Chart, Up, Vec3};

/// A triangle mesh with normals, its arrays borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// `[V]` positions (m).
    pub positions: &'a [Vec3],
    /// `[V]` normals of any length (stored with length 1; those without a direction as +z).
    pub normals: &'a [Vec3],
    /// `[F][3]` vertices of each face, counter-clockwise seen from outside.
    pub faces: &'a [[usize; 3]],
    /// Texture coordinates with v up (stored with v down, as glTF has it). Vertices are doubled
    /// where their corners differ.
    pub texture: Option<&'a Chart>,
}

/// Writes `mesh`, in whose coordinates `up` points up, as binary glTF: if that is z, positions and
/// normals are stored as they are, and the node turns them by −90° about x. It has a double-sided
/// material of roughness 0.6, not metallic, in `base_colour` (linear red, green, blue, opacity,
/// each 0..1).
///
/// Without texture coordinates the vertices keep their numbers. With them they are numbered anew:
/// by vertex, then by texture coordinate; those on no face are left out.
///
/// # Errors
/// Those of `out`; [`io::ErrorKind::InvalidData`] for a mesh without faces, lists whose lengths do
/// not match, indices out of range, numbers that are not finite in single precision, a colour
/// outside 0..1, and files beyond the format's 4 GiB.
pub fn write<W: Write + ?Sized>(
    out: &mut W,
    mesh: &Mesh<'_>,
    base_colour: [f32; 4],
    up: Up,
) -> io::Result<()> {
    check(mesh, base_colour)?;
    let split = mesh.texture.map(|texture| split(mesh.faces, &texture.faces));
    let buffer = buffer_of(mesh, split.as_ref());
    write_container(out, &document_of(&buffer, base_colour, up), &buffer.bytes)
}

/// The binary chunk of a file, and the JSON that says what stands in it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    /// Accessors of what vertices carry, by their names.
    attributes: Value,
    /// Accessor of the faces' vertices.
    indices: usize,
}

impl Buffer {
    /// Ends the view of the bytes that were written since the last one.
    fn end_view(&mut self, target: u32) {
        let offset = self.views.last().map_or(0, |v| {
            v["byteOffset"].as_u64().unwrap_or(0) + v["byteLength"].as_u64().unwrap_or(0)
        });
        self.views.push(json!({
            "buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() as u64 - offset,
            "target": target
        }));
    }
}

/// The arrays of `mesh`, whose vertices are `split` if it has texture coordinates.
fn buffer_of(mesh: &Mesh<'_>, split: Option<&Split>) -> Buffer {
    let vertex_count = split.map_or(mesh.positions.len(), |s| s.vertices.len());
    let original = |i: usize| split.map_or(i, |s| s.vertices[i][0]);
    let faces = split.map_or(mesh.faces, |s| &s.faces);
    let mut buffer = Buffer::default();
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for i in 0..vertex_count {
        for (k, x) in single(&mesh.positions[original(i)]).into_iter().enumerate() {
            low[k] = low[k].min(x);
            high[k] = high[k].max(x);
            buffer.bytes.extend(x.to_le_bytes());
        }
    }
    buffer.end_view(ARRAY_BUFFER);
    for i in 0..vertex_count {
        // Divided by its largest entry first, so that no length over- or underflows.
        let n = mesh.normals[original(i)];
        let n = (n / n.amax())
            .try_normalize(0.0)
            .filter(|n| n.iter().all(|x| x.is_finite()))
            .unwrap_or_else(Vec3::z);
        buffer.bytes.extend(single(&n).into_iter().flat_map(f32::to_le_bytes));
    }
    buffer.end_view(ARRAY_BUFFER);
    buffer.accessors = vec![
        json!({
            "bufferView": 0, "componentType": FLOAT, "count": vertex_count, "type": "VEC3",
            "min": low, "max": high
        }),
        json!({"bufferView": 1, "componentType": FLOAT, "count": vertex_count, "type": "VEC3"}),
    ];
    buffer.attributes = json!({"POSITION": 0, "NORMAL": 1});
    if let (Some(split), Some(texture)) = (split, mesh.texture) {
        for &[_, t] in &split.vertices {
            let uv = [texture.points[t].x as f32, (1.0 - texture.points[t].y) as f32];
            buffer.bytes.extend(uv.into_iter().flat_map(f32::to_le_bytes));
        }
        buffer.end_view(ARRAY_BUFFER);
        buffer.attributes["TEXCOORD_0"] = json!(buffer.accessors.len());
        buffer.accessors.push(json!({
            "bufferView": buffer.accessors.len(), "componentType": FLOAT, "count": vertex_count,
            "type": "VEC2"
        }));
    }
    // `check` has seen that every index fits.
    buffer.bytes.extend(faces.iter().flatten().flat_map(|&v| (v as u32).to_le_bytes()));
    buffer.end_view(ELEMENT_ARRAY_BUFFER);
    buffer.indices = buffer.accessors.len();
    buffer.accessors.push(json!({
        "bufferView": buffer.indices, "componentType": UNSIGNED_INT, "count": 3 * faces.len(),
        "type": "SCALAR"
    }));
    buffer
}

/// The JSON chunk of a file with one mesh of one material.
fn document_of(buffer: &Buffer, base_colour: [f32; 4], up: Up) -> Value {
    let mut node = json!({"mesh": 0});
    if up == Up::Z {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        node["rotation"] = json!([-half, 0.0, 0.0, half]);
    }
    let primitive =
        json!({"attributes": buffer.attributes, "indices": buffer.indices, "material": 0});
    json!({
        "asset": {"version": "2.0", "generator": concat!("Plissé ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node],
        "meshes": [{"primitives": [primitive]}],
        "materials": [{
            "doubleSided": true,
            "alphaMode": if base_colour[3] < 1.0 { "BLEND" } else { "OPAQUE" },
            "pbrMetallicRoughness": {
                "baseColorFactor": base_colour, "metallicFactor": 0.0, "roughnessFactor": 0.6
            },
        }],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": buffer.bytes.len()}],
    })
}

/// Writes a file header and two chunks with theirs. Every list in `bytes` is made of 4-byte
/// numbers, so it needs no padding.
fn write_container<W: Write + ?Sized>(
    out: &mut W,
    document: &Value,
    bytes: &[u8],
) -> io::Result<()> {
    let mut document = serde_json::to_vec(document)?;
    document.resize(document.len().next_multiple_of(4), b' ');
    let length = |n: usize| {
        u32::try_from(n)
            .map_err(|_| invalid("the mesh is too large for the format's 4 GiB; split it".into()))
    };
    let total = length(12 + 8 + document.len() + 8 + bytes.len())?;
    out.write_all(b"glTF")?;
    for number in [2, total, length(document.len())?] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&document)?;
    out.write_all(&length(bytes.len())?.to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(bytes)
}

// Numbers of the glTF 2.0 specification.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, message)
}

fn single(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn check(mesh: &Mesh<'_>, base_colour: [f32; 4]) -> io::Result<()> {
    let (v, f) = (mesh.positions.len(), mesh.faces.len());
    if f == 0 {
        return Err(invalid("the mesh has no faces".into()));
    }
    if mesh.normals.len() != v {
        return Err(invalid(format!(
            "{} normals for {v} vertices; give one for each",
            mesh.normals.len()
        )));
    }
    if v >= u32::MAX as usize {
        return Err(invalid(format!(
            "{v} vertices are beyond the format's integers; split the mesh"
        )));
    }
    if let Some(i) = mesh.positions.iter().position(|p| !single(p).iter().all(|x| x.is_finite())) {
        return Err(invalid(format!(
            "the position of vertex {i} is not finite in single precision"
        )));
    }
    if let Some(i) = mesh.faces.iter().position(|face| face.iter().any(|&i| i >= v)) {
        return Err(invalid(format!("face {i} names a vertex beyond the {v} there are")));
    }
    if !base_colour.iter().all(|c| (0.0..=1.0).contains(c)) {
        return Err(invalid(format!("the base colour {base_colour:?} is not within 0..1")));
    }
    if let Some(Chart { points: coordinates, faces: texture_faces }) = mesh.texture {
        let t = coordinates.len();
        if texture_faces.len() != f {
            return Err(invalid(format!(
                "{} texture faces for {f} faces; give one for each",
                texture_faces.len()
            )));
        }
        if let Some(i) =
            coordinates.iter().position(|c| !((c.x as f32).is_finite() && (c.y as f32).is_finite()))
        {
            return Err(invalid(format!(
                "texture coordinate {i} is not finite in single precision"
            )));
        }
        if let Some(i) = texture_faces.iter().position(|face| face.iter().any(|&i| i >= t)) {
            return Err(invalid(format!(
                "face {i} names a texture coordinate beyond the {t} there are"
            )));
        }
    }
    Ok(())
}

/// Vertices that have one texture coordinate each.
struct Split {
    /// `[V']` vertex and texture coordinate, ascending.
    vertices: Vec<[usize; 2]>,
    /// `[F][3]` in the numbers of `vertices`.
    faces: Vec<[usize; 3]>,
}

fn split(faces: &[[usize; 3]], texture_faces: &[[usize; 3]]) -> Split {
    let corners =
        || faces.iter().flatten().zip(texture_faces.iter().flatten()).map(|(&v, &t)| [v, t]);
    let mut vertices: Vec<[usize; 2]> = corners().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let number = |corner| vertices.binary_search(&corner).expect("every corner was collected");
    let numbers: Vec<usize> = corners().map(number).collect();
    let faces = numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    Split { vertices, faces }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vec2;

    const COLOUR: [f32; 4] = [0.8, 0.5, 0.25, 1.0];

    /// A GLB taken apart by its own offsets, its headers checked on the way.
    struct Parts {
        json: Value,
        bytes: Vec<u8>,
    }

    impl Parts {
        fn of(glb: &[u8]) -> Self {
            let number =
                |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
            assert_eq!((&glb[..4], number(4), number(8)), (&b"glTF"[..], 2, glb.len()));
            let bin = 20 + number(12);
            assert_eq!((&glb[16..20], number(12) % 4), (&b"JSON"[..], 0));
            assert_eq!(
                (&glb[bin + 4..bin + 8], number(bin) % 4, number(bin)),
                (&b"BIN\0"[..], 0, glb.len() - bin - 8)
            );
            Self {
                json: serde_json::from_slice(&glb[20..bin]).unwrap(),
                bytes: glb[bin + 8..].to_vec(),
            }
        }

        /// The 4-byte numbers of accessor `a`, `n` for each element; the view must hold exactly
        /// those.
        fn numbers(&self, a: &Value, n: usize) -> Vec<[u8; 4]> {
            let accessor = &self.json["accessors"][a.as_u64().unwrap() as usize];
            let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
            let at = |v: &Value, key: &str| v[key].as_u64().unwrap() as usize;
            let (start, length) = (at(view, "byteOffset"), at(view, "byteLength"));
            assert_eq!((start % 4, length), (0, 4 * n * at(accessor, "count")));
            assert_eq!(self.json["buffers"][0]["byteLength"], self.bytes.len());
            self.bytes[start..start + length]
                .chunks_exact(4)
                .map(|b| b.try_into().unwrap())
                .collect()
        }

        fn attribute<const N: usize>(&self, name: &str) -> Vec<[f32; N]> {
            let numbers =
                self.numbers(&self.json["meshes"][0]["primitives"][0]["attributes"][name], N);
            numbers
                .chunks_exact(N)
                .map(|c| std::array::from_fn(|k| f32::from_le_bytes(c[k])))
                .collect()
        }

        fn indices(&self) -> Vec<usize> {
            let numbers = self.numbers(&self.json["meshes"][0]["primitives"][0]["indices"], 1);
            numbers.into_iter().map(|b| u32::from_le_bytes(b) as usize).collect()
        }
    }

    fn square() -> (Vec<Vec3>, Vec<Vec3>, Vec<[usize; 3]>) {
        let p = vec![
            Vec3::new(0.1, 0.0, -2.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(1.0, 1.5, 0.3),
            Vec3::new(0.0, 1.0, 0.0),
        ];
        let n = vec![
            Vec3::new(0.0, 0.0, 2.0),
            Vec3::new(3e-200, 0.0, 4e-200),
            Vec3::zeros(),
            Vec3::new(0.0, 1e200, 0.0),
        ];
        (p, n, vec![[0, 1, 2], [0, 2, 3]])
    }

    fn written(mesh: &Mesh<'_>, up: Up) -> Parts {
        let mut glb = Vec::new();
        write(&mut glb, mesh, COLOUR, up).unwrap();
        Parts::of(&glb)
    }

    #[test]
    fn a_plain_mesh_keeps_its_vertices() {
        let (positions, normals, faces) = square();
        let parts = written(
            &Mesh { positions: &positions, normals: &normals, faces: &faces, texture: None },
            Up::Y,
        );
        assert_eq!(
            parts.attribute::<3>("POSITION"),
            positions.iter().map(single).collect::<Vec<_>>()
        );
        assert_eq!(
            parts.attribute::<3>("NORMAL"),
            [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
        );
        assert_eq!(parts.indices(), [0, 1, 2, 0, 2, 3]);
        let accessor = &parts.json["accessors"][0];
        let bound = |key: &str| -> Vec<f32> {
            accessor[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap() as f32).collect()
        };
        assert_eq!((bound("min"), bound("max")), (vec![0.0, 0.0, -2.0], vec![1.0, 1.5, 0.3]));
        assert_eq!(parts.json["accessors"].as_array().unwrap().len(), 3);
        assert!(parts.json["asset"]["generator"].as_str().unwrap().starts_with("Plissé "));
        let material = &parts.json["materials"][0];
        assert_eq!(
            (&material["doubleSided"], &material["pbrMetallicRoughness"]["baseColorFactor"][2]),
            (&json!(true), &json!(0.25))
        );
        assert_eq!(parts.json["nodes"][0]["rotation"], Value::Null);
    }

    #[test]
    fn the_node_turns_z_up_to_y_up() {
        let (positions, normals, faces) = square();
        let parts = written(
            &Mesh { positions: &positions, normals: &normals, faces: &faces, texture: None },
            Up::Z,
        );
        let q: Vec<f64> = parts.json["nodes"][0]["rotation"]
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect();
        let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
            q[3], q[0], q[1], q[2],
        ));
        assert!(
            (turn * Vec3::z() - Vec3::y()).norm() < 1e-6
                && (turn * Vec3::x() - Vec3::x()).norm() < 1e-6
        );
        assert_eq!(parts.attribute::<3>("POSITION")[0], single(&positions[0]));
    }

    #[test]
    fn seams_double_vertices_and_corners_keep_what_they_had() {
        let (positions, normals, faces) = square();
        let points = [[0.0, 0.0], [1.0, 0.25], [1.0, 1.0], [0.5, 0.0]].map(Vec2::from).to_vec();
        let texture = Chart { points, faces: vec![[0, 1, 2], [3, 2, 1]] };
        let mesh = Mesh {
            positions: &positions,
            normals: &normals,
            faces: &faces,
            texture: Some(&texture),
        };
        let parts = written(&mesh, Up::Y);
        let (p, uv, indices) =
            (parts.attribute::<3>("POSITION"), parts.attribute::<2>("TEXCOORD_0"), parts.indices());
        // Only vertex 0 has two texture coordinates.
        assert_eq!((p.len(), uv.len(), parts.attribute::<3>("NORMAL").len()), (5, 5, 5));
        for (c, &i) in indices.iter().enumerate() {
            let t = texture.corners(c / 3)[c % 3];
            assert_eq!(
                (p[i], uv[i]),
                (single(&positions[faces[c / 3][c % 3]]), [t.x as f32, 1.0 - t.y as f32])
            );
        }
    }

    #[test]
    fn unusable_meshes_are_told() {
        let (positions, normals, faces) = square();
        let good = Mesh { positions: &positions, normals: &normals, faces: &faces, texture: None };
        let message =
            |mesh: Mesh<'_>| write(&mut Vec::new(), &mesh, COLOUR, Up::Y).unwrap_err().to_string();
        assert!(message(Mesh { faces: &[], ..good }).contains("no faces"));
        assert!(
            message(Mesh { faces: &[[0, 1, 4]], ..good })
                .contains("face 0 names a vertex beyond the 4")
        );
        assert!(
            message(Mesh { normals: &normals[1..], ..good }).contains("3 normals for 4 vertices")
        );
        assert!(
            message(Mesh { positions: &[Vec3::new(0.0, 1e39, 0.0); 4], ..good })
                .contains("vertex 0 is not finite")
        );
        let chart =
            |faces: &[[usize; 3]]| Chart { points: vec![Vec2::zeros()], faces: faces.to_vec() };
        assert!(
            message(Mesh { texture: Some(&chart(&[[0; 3]])), ..good })
                .contains("1 texture faces for 2 faces")
        );
        assert!(
            message(Mesh { texture: Some(&chart(&[[0; 3], [0, 1, 0]])), ..good })
                .contains("face 1 names a texture coordinate")
        );
        assert!(write(&mut Vec::new(), &good, [f32::NAN; 4], Up::Y).is_err());
    }
}
