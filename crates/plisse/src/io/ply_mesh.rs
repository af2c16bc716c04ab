//! PLY meshes read: triangles with named numbers per vertex, as painted in other programs.
//!
//! Text and both binary orders are read, any scalar type, faces of any size (cut into triangles).
//! Elements other than vertices and faces are passed over.

use std::path::Path;

use super::polygon;
use crate::mesh::{Vec2, Vec3};
use crate::{Error, Result};

/// Names of the texture coordinates of vertices in use.
const TEXTURES: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];

/// The triangles of a PLY file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyMesh {
    /// `[V]` vertices (m, if the file was written in metres), all finite.
    pub positions: Vec<Vec3>,
    /// `[F][3]` vertices of each triangle, as oriented in the file.
    pub faces: Vec<[usize; 3]>,
    /// `[V]` texture coordinates (v up), if vertices have s and t, u and v, or texture_u and
    /// texture_v.
    pub texture: Option<Vec<Vec2>>,
    /// Every other property of vertices: its name and `[V]` its values; those of unsigned bytes are
    /// divided by 255.
    pub attributes: Vec<(String, Vec<f64>)>,
    /// Number of faces that had more than three corners.
    pub cut: usize,
}

/// Reads the PLY file at `path`.
///
/// # Errors
/// [`Error::File`] if it cannot be read; as [`parse`].
pub fn read(path: &Path) -> Result<PlyMesh> {
    let bytes = super::disk::read(path).map_err(|source| Error::reading(path, source))?;
    parse(path, &bytes)
}

/// Reads a PLY file's `bytes`; `path` is named in errors only.
///
/// # Errors
/// [`Error::Mesh`] with the file for: no PLY header, a type or format that there is not, a file
/// that ends too early, vertices without x, y or z, a coordinate or value that is not finite, no
/// face, a face with fewer than three corners or a vertex that there is not.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<PlyMesh> {
    mesh(bytes).map_err(|message| Error::mesh(path.display().to_string(), message))
}

type Parsed<T> = std::result::Result<T, String>;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn named(word: &str) -> Parsed<Self> {
        Ok(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => {
                return Err(format!(
                    "its header names the type '{word}', which PLY does not have; export it anew"
                ));
            }
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// A property: its name, its type, and the type of its count if it is a list.
struct Property {
    name: String,
    kind: Kind,
    count: Option<Kind>,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// The part of a file that follows the header.
enum Body<'a> {
    Text(std::str::SplitAsciiWhitespace<'a>),
    Bytes { left: &'a [u8], big: bool },
}

impl Body<'_> {
    fn number(&mut self, kind: Kind) -> Parsed<f64> {
        const SHORT: &str = "it ends before all that its header promises; export it anew";
        match self {
            Self::Text(words) => {
                let word = words.next().ok_or(SHORT)?;
                word.parse().map_err(|_| format!("'{word}' is not a number; export it anew"))
            }
            Self::Bytes { left, big } => {
                let (own, rest) = left.split_at_checked(kind.size()).ok_or(SHORT)?;
                *left = rest;
                let mut bytes = [0; 8];
                // Lowest byte first.
                for (to, from) in bytes.iter_mut().zip(0..own.len()) {
                    *to = own[if *big { own.len() - 1 - from } else { from }];
                }
                let [a, b, c, d, ..] = bytes;
                Ok(match kind {
                    Kind::I8 => f64::from(i8::from_le_bytes([a])),
                    Kind::U8 => f64::from(a),
                    Kind::I16 => f64::from(i16::from_le_bytes([a, b])),
                    Kind::U16 => f64::from(u16::from_le_bytes([a, b])),
                    Kind::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
                    Kind::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
                    Kind::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
                    Kind::F64 => f64::from_le_bytes(bytes),
                })
            }
        }
    }

    /// A number that counts or names something.
    fn whole(&mut self, kind: Kind) -> Parsed<usize> {
        let number = self.number(kind)?;
        if number >= 0.0 && number.fract() == 0.0 && number < f64::from(u32::MAX) {
            return Ok(number as usize);
        }
        Err(format!("{number} counts or names nothing; export it anew"))
    }
}

fn mesh(bytes: &[u8]) -> Parsed<PlyMesh> {
    let (elements, mut body) = header(bytes)?;
    let mut mesh = PlyMesh::default();
    let mut polygons: Vec<Vec<usize>> = Vec::new();
    for element in &elements {
        match element.name.as_str() {
            "vertex" => vertices(element, &mut body, &mut mesh)?,
            "face" => {
                for _ in 0..element.count {
                    for property in &element.properties {
                        let list = list(property, &mut body)?;
                        if ["vertex_indices", "vertex_index"].contains(&property.name.as_str()) {
                            polygons.push(list);
                        }
                    }
                }
            }
            _ => {
                for _ in 0..element.count {
                    for property in &element.properties {
                        let count = property.count.map_or(Ok(1), |kind| body.whole(kind))?;
                        for _ in 0..count {
                            body.number(property.kind)?;
                        }
                    }
                }
            }
        }
    }
    if polygons.is_empty() {
        return Err(
            "it has no faces (vertex_indices); export the mesh with its faces, not as points"
                .to_owned(),
        );
    }
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (f, polygon) in polygons.iter().enumerate() {
        if let Some(v) = polygon.iter().find(|&&v| v >= mesh.positions.len()) {
            return Err(format!(
                "face {f} names vertex {v}, but there are {}; export it anew",
                mesh.positions.len()
            ));
        }
        if polygon.len() < 3 {
            return Err(format!("face {f} has {} corners; remove it", polygon.len()));
        }
        triangles.clear();
        if polygon.len() == 3 {
            triangles.push([0, 1, 2]);
        } else {
            points.clear();
            points.extend(polygon.iter().map(|&v| mesh.positions[v]));
            polygon::triangulate(&points, &mut triangles);
            mesh.cut += 1;
        }
        mesh.faces.extend(triangles.iter().map(|t| t.map(|k| polygon[k])));
    }
    Ok(mesh)
}

fn list(property: &Property, body: &mut Body<'_>) -> Parsed<Vec<usize>> {
    let indices = ["vertex_indices", "vertex_index"].contains(&property.name.as_str());
    let count = property.count.map_or(Ok(1), |kind| body.whole(kind))?;
    let mut list = Vec::new();
    for _ in 0..count {
        if indices {
            list.push(body.whole(property.kind)?);
        } else {
            body.number(property.kind)?;
        }
    }
    Ok(list)
}

fn vertices(element: &Element, body: &mut Body<'_>, mesh: &mut PlyMesh) -> Parsed<()> {
    if let Some(property) = element.properties.iter().find(|p| p.count.is_some()) {
        return Err(format!("vertices have a list, '{}'; export it without", property.name));
    }
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); element.properties.len()];
    for v in 0..element.count {
        for (column, property) in columns.iter_mut().zip(&element.properties) {
            let value = body.number(property.kind)?;
            if !value.is_finite() {
                return Err(format!(
                    "'{}' of vertex {v} is not finite; repair the mesh where it was made",
                    property.name
                ));
            }
            column.push(if property.kind == Kind::U8 { value / 255.0 } else { value });
        }
    }
    let find = |name: &str| element.properties.iter().position(|p| p.name == name);
    let [x, y, z] = match ["x", "y", "z"].map(find) {
        [Some(x), Some(y), Some(z)] => [x, y, z],
        _ => return Err("its vertices have no x, y and z; export it with positions".to_owned()),
    };
    mesh.positions = (0..element.count)
        .map(|v| Vec3::new(columns[x][v], columns[y][v], columns[z][v]))
        .collect();
    let texture = TEXTURES.iter().find_map(|[s, t]| find(s).zip(find(t)));
    mesh.texture = texture.map(|(s, t)| {
        (0..element.count).map(|v| Vec2::new(columns[s][v], columns[t][v])).collect()
    });
    let used: Vec<usize> =
        [x, y, z].into_iter().chain(texture.into_iter().flat_map(|(s, t)| [s, t])).collect();
    let rest = columns.into_iter().enumerate().filter(|(p, _)| !used.contains(p));
    mesh.attributes =
        rest.map(|(p, column)| (element.properties[p].name.clone(), column)).collect();
    Ok(())
}

fn header(bytes: &[u8]) -> Parsed<(Vec<Element>, Body<'_>)> {
    const NONE: &str = "it is no PLY file (no 'ply' and 'end_header'); give a PLY or OBJ file";
    let mark = b"end_header";
    let end = bytes
        .windows(mark.len())
        .position(|w| w == mark)
        .filter(|_| bytes.starts_with(b"ply"))
        .ok_or(NONE)?;
    let after = bytes[end..].iter().position(|&b| b == b'\n').ok_or(NONE)?;
    let (head, rest) =
        (String::from_utf8_lossy(&bytes[..end]).into_owned(), &bytes[end + after + 1..]);
    let (mut elements, mut format): (Vec<Element>, Option<String>) = (Vec::new(), None);
    for line in head.lines() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let broken = || {
            format!(
                "its header has the line '{}', which PLY does not have; export it anew",
                line.trim()
            )
        };
        match words[..] {
            ["format", name, _] => format = Some(name.to_owned()),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| broken())?;
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", "list", count, kind, name] => {
                let own = Property {
                    name: name.to_owned(),
                    kind: Kind::named(kind)?,
                    count: Some(Kind::named(count)?),
                };
                elements.last_mut().ok_or_else(broken)?.properties.push(own);
            }
            ["property", kind, name] => {
                let own = Property { name: name.to_owned(), kind: Kind::named(kind)?, count: None };
                elements.last_mut().ok_or_else(broken)?.properties.push(own);
            }
            ["property" | "element", ..] => return Err(broken()),
            _ => {}
        }
    }
    let body = match format.as_deref() {
        Some("ascii") => {
            let text = std::str::from_utf8(rest)
                .map_err(|_| "what follows its header is no text; export it anew")?;
            Body::Text(text.split_ascii_whitespace())
        }
        Some("binary_little_endian") => Body::Bytes { left: rest, big: false },
        Some("binary_big_endian") => Body::Bytes { left: rest, big: true },
        _ => return Err("its header names no format that PLY has; export it anew".to_owned()),
    };
    Ok((elements, body))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty double \
        z\nproperty uchar red\nproperty float grow\n\
        element face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty short \
        a\nend_header\n";

    fn square() -> PlyMesh {
        let text = format!(
            "ply\nformat ascii 1.0\ncomment x\n{HEAD}0 0 0 0 1.5\n1 0 0 51 2\n1 1 0 255 -1\n0 1 \
             0.25 0 0\n4 0 1 2 3\n7\n"
        );
        parse(Path::new("a.ply"), text.as_bytes()).unwrap()
    }

    #[test]
    fn text_and_both_byte_orders_read_alike() {
        let mesh = square();
        assert_eq!(
            (mesh.positions[3], mesh.faces.len(), mesh.cut),
            (Vec3::new(0.0, 1.0, 0.25), 2, 1)
        );
        assert_eq!(mesh.attributes[0], ("red".to_owned(), vec![0.0, 0.2, 1.0, 0.0]));
        assert_eq!(mesh.attributes[1], ("grow".to_owned(), vec![1.5, 2.0, -1.0, 0.0]));
        for big in [false, true] {
            let name = if big { "big" } else { "little" };
            let mut bytes = format!("ply\nformat binary_{name}_endian 1.0\n{HEAD}").into_bytes();
            let mut put = |value: &[u8]| bytes.extend(value.iter().copied());
            for (p, red, grow) in [
                ([0.0, 0.0, 0.0], 0u8, 1.5f32),
                ([1.0, 0.0, 0.0], 51, 2.0),
                ([1.0, 1.0, 0.0], 255, -1.0),
                ([0.0, 1.0, 0.25], 0, 0.0),
            ] {
                let single = |x: f32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
                put(&single(p[0] as f32));
                put(&single(p[1] as f32));
                put(&if big { f64::to_be_bytes(p[2]) } else { f64::to_le_bytes(p[2]) });
                put(&[red]);
                put(&single(grow));
            }
            put(&[4]);
            for v in 0..4i32 {
                put(&if big { v.to_be_bytes() } else { v.to_le_bytes() });
            }
            put(&if big { 7i16.to_be_bytes() } else { 7i16.to_le_bytes() });
            assert_eq!(parse(Path::new("a.ply"), &bytes).unwrap(), mesh, "{name}");
            bytes.truncate(bytes.len() - 3);
            let text = parse(Path::new("a.ply"), &bytes).unwrap_err().to_string();
            assert!(text.contains("a.ply: it ends before all that its header promises"), "{text}");
        }
    }

    #[test]
    fn what_we_write_reads_back() {
        let mesh = square();
        let mut bytes = Vec::new();
        super::super::ply::write(
            &mut bytes,
            &mesh.positions,
            &mesh.faces,
            &[("grow", &mesh.attributes[1].1)],
        )
        .unwrap();
        let back = parse(Path::new("b.ply"), &bytes).unwrap();
        assert_eq!(
            (back.positions, back.faces, &back.attributes[0]),
            (mesh.positions.clone(), mesh.faces.clone(), &mesh.attributes[1])
        );
    }

    #[test]
    fn what_is_no_mesh_is_told() {
        let whole = format!(
            "ply\nformat ascii 1.0\n{HEAD}0 0 0 0 1\n1 0 0 0 1\n1 1 0 0 1\n0 1 0 0 1\n3 0 1 2\n7\n"
        );
        assert!(parse(Path::new("a.ply"), whole.as_bytes()).is_ok());
        for (from, to, says) in [
            ("ply\n", "obj\n", "no PLY file"),
            ("ascii", "gzip", "no format that PLY has"),
            ("double", "triple", "the type 'triple'"),
            ("property float x", "property float w", "no x, y and z"),
            ("3 0 1 2", "3 0 1 9", "face 0 names vertex 9, but there are 4"),
            ("3 0 1 2", "2 0 1", "face 0 has 2 corners"),
            ("3 0 1 2", "3 0 1 b", "'b' is not a number"),
            ("1 1 0 0 1", "1 nan 0 0 1", "'y' of vertex 2 is not finite"),
            ("element face 1", "element part 1", "it has no faces"),
        ] {
            let text = parse(Path::new("a.ply"), whole.replacen(from, to, 1).as_bytes())
                .unwrap_err()
                .to_string();
            assert!(text.starts_with("a.ply: ") && text.contains(says), "{to}: {text}");
        }
    }
}
