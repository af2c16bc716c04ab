//! PLY files in: text or binary (little or big end first), places, texture coordinates where they are, and faces of any number of
//! corners, cut into fans.

use plisse::{Error, Result};
use plisse_live::model::Model;
use plisse_live::{Vec2, Vec3};

/// Most vertices or faces.
const MOST: usize = 50_000_000;

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Little,
    Big,
}

#[derive(Clone, Copy)]
enum Number {
    Int(usize, bool),
    Float(usize),
}

struct Property {
    name: String,
    /// Type of a list's length, where it is one.
    list: Option<Number>,
    number: Number,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// The model called `name` in `bytes`.
///
/// # Errors
/// [`Error::Mesh`] at `place` for what is no PLY, is cut off, names vertices that are not there, or has no faces.
pub fn parse(place: &str, name: &str, bytes: &[u8]) -> Result<Model> {
    let bad = |message: String| Error::mesh(place, message);
    let (form, elements, body) = header(bytes).map_err(&bad)?;
    let mut source = Reader { form, rest: body };
    let (mut positions, mut uvs, mut faces) = (Vec::new(), Vec::new(), Vec::<[u32; 3]>::new());
    for element in &elements {
        let at = |names: &[&str]| element.properties.iter().position(|p| names.contains(&p.name.as_str()));
        let (xyz, uv) = ([at(&["x"]), at(&["y"]), at(&["z"])], [at(&["s", "u", "texture_u"]), at(&["t", "v", "texture_v"])]);
        let corners = at(&["vertex_indices", "vertex_index"]);
        for row in 0..element.count {
            let cut = || bad(format!("it is cut off in {} {row} of {}; copy or export it again", element.name, element.count));
            let values: Vec<Vec<f64>> = element.properties.iter().map(|p| source.property(p).ok_or_else(cut)).collect::<Result<_>>()?;
            let one = |p: Option<usize>| p.and_then(|p| values[p].first()).copied();
            if element.name == "vertex" {
                let [Some(x), Some(y), Some(z)] = xyz.map(one) else {
                    return Err(bad("its vertices have no x, y and z; export them".into()));
                };
                let position = Vec3::new(x as f32, y as f32, z as f32);
                if position.iter().any(|x| !x.is_finite()) {
                    return Err(bad(format!("vertex {row} has a coordinate that is no number; correct it")));
                }
                positions.push(position);
                let [u, v] = uv.map(|p| one(p).unwrap_or(0.0) as f32);
                // As OBJ has it: v points up.
                uvs.push(if uv[1].is_some() { Vec2::new(u, 1.0 - v) } else { Vec2::zeros() });
            } else if let (true, Some(corners)) = (element.name == "face", corners) {
                let list = &values[corners];
                if list.len() < 3 || list.iter().any(|&v| v < 0.0 || v >= positions.len() as f64) {
                    return Err(bad(format!("face {row} has too few corners, or names a vertex that is not there; correct it")));
                }
                faces.extend((1..list.len() - 1).map(|k| [list[0] as u32, list[k] as u32, list[k + 1] as u32]));
            }
        }
    }
    if faces.is_empty() {
        return Err(bad("it has no faces; export a mesh, not a cloud of points".into()));
    }
    Ok(Model::rigid(name, positions, uvs, faces))
}

fn header(bytes: &[u8]) -> std::result::Result<(Form, Vec<Element>, &[u8]), String> {
    let broken = |what: &str| Err(format!("this is no PLY file that can be read ({what}); export it again"));
    let mut elements: Vec<Element> = Vec::new();
    let mut form = None;
    let mut rest = bytes;
    for number in 0.. {
        let Some(end) = rest.iter().position(|&b| b == b'\n') else { return broken("its header does not end") };
        let line = String::from_utf8_lossy(&rest[..end]).trim().to_owned();
        rest = &rest[end + 1..];
        let words: Vec<&str> = line.split_whitespace().collect();
        match (number, words.as_slice()) {
            (0, ["ply"]) => {}
            (0, _) => return broken("it does not begin with \"ply\""),
            (_, ["format", kind, ..]) => {
                form = match *kind {
                    "ascii" => Some(Form::Text),
                    "binary_little_endian" => Some(Form::Little),
                    "binary_big_endian" => Some(Form::Big),
                    _ => return broken("its format is unknown"),
                }
            }
            (_, ["element", name, count]) => match count.parse::<usize>() {
                Ok(count) if count <= MOST => elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() }),
                _ => return broken("an element has no sensible count"),
            },
            (_, ["property", "list", length, kind, name]) => {
                let (Some(length), Some(kind), Some(element)) = (number_type(length), number_type(kind), elements.last_mut()) else {
                    return broken("a list has an unknown type");
                };
                element.properties.push(Property { name: (*name).to_owned(), list: Some(length), number: kind });
            }
            (_, ["property", kind, name]) => {
                let (Some(kind), Some(element)) = (number_type(kind), elements.last_mut()) else {
                    return broken("a property has an unknown type");
                };
                element.properties.push(Property { name: (*name).to_owned(), list: None, number: kind });
            }
            (_, ["end_header"]) => break,
            (_, ["comment" | "obj_info", ..] | []) => {}
            _ => return broken("its header has a strange line"),
        }
    }
    match form {
        Some(form) => Ok((form, elements, rest)),
        None => broken("its format is missing"),
    }
}

fn number_type(word: &str) -> Option<Number> {
    Some(match word {
        "char" | "int8" => Number::Int(1, true),
        "uchar" | "uint8" => Number::Int(1, false),
        "short" | "int16" => Number::Int(2, true),
        "ushort" | "uint16" => Number::Int(2, false),
        "int" | "int32" => Number::Int(4, true),
        "uint" | "uint32" => Number::Int(4, false),
        "float" | "float32" => Number::Float(4),
        "double" | "float64" => Number::Float(8),
        _ => return None,
    })
}

struct Reader<'a> {
    form: Form,
    rest: &'a [u8],
}

impl Reader<'_> {
    fn property(&mut self, property: &Property) -> Option<Vec<f64>> {
        let count = match property.list {
            None => 1,
            Some(length) => Some(self.number(length)?).filter(|c| (0.0..=1e6).contains(c))? as usize,
        };
        (0..count).map(|_| self.number(property.number)).collect()
    }

    fn number(&mut self, kind: Number) -> Option<f64> {
        if self.form == Form::Text {
            let begin = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
            let length = self.rest[begin..].iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len() - begin);
            let word = std::str::from_utf8(&self.rest[begin..begin + length]).ok()?;
            self.rest = &self.rest[begin + length..];
            return word.parse().ok();
        }
        let (Number::Int(size, _) | Number::Float(size)) = kind;
        let (head, tail) = self.rest.split_at_checked(size)?;
        self.rest = tail;
        let mut bytes = [0u8; 8];
        bytes[..size].copy_from_slice(head);
        if self.form == Form::Big {
            bytes[..size].reverse();
        }
        Some(match kind {
            Number::Float(4) => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            Number::Float(_) => f64::from_le_bytes(bytes),
            Number::Int(1, true) => f64::from(bytes[0] as i8),
            Number::Int(2, true) => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
            Number::Int(4, true) => f64::from(i32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            Number::Int(..) => u64::from_le_bytes(bytes) as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_both_binaries_say_the_same() {
        let head = |form: &str| {
            format!("ply\nformat {form} 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n").into_bytes()
        };
        let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]];
        let (mut text, mut little, mut big) = (head("ascii"), head("binary_little_endian"), head("binary_big_endian"));
        for c in corners {
            text.extend(format!("{} {} {}\n", c[0], c[1], c[2]).into_bytes());
            c.iter().for_each(|x| little.extend(x.to_le_bytes()));
            c.iter().for_each(|x| big.extend(x.to_be_bytes()));
        }
        text.extend(b"4 0 1 2 3\n");
        little.push(4);
        big.push(4);
        (0i32..4).for_each(|v| little.extend(v.to_le_bytes()));
        (0i32..4).for_each(|v| big.extend(v.to_be_bytes()));
        for bytes in [&text, &little, &big] {
            let model = parse("a.ply", "a", bytes).unwrap();
            assert_eq!(model.draw.positions, corners.map(Vec3::from));
            assert_eq!(model.faces, [[0, 1, 2], [0, 2, 3]]);
            let text = parse("a.ply", "a", &bytes[..bytes.len() - 3]).unwrap_err().to_string();
            assert!(text.starts_with("a.ply: ") && text.contains(';'), "{text}");
        }
    }

    #[test]
    fn broken_files_end_in_a_sentence() {
        for bytes in
            [&b""[..], b"ply\n", b"obj\n", b"ply\nformat ascii 1.0\nelement vertex x\nend_header\n", b"ply\nformat ascii 1.0\nend_header\n"]
        {
            let text = parse("b.ply", "b", bytes).unwrap_err().to_string();
            assert!(text.starts_with("b.ply: ") && !text.contains('\n'), "{text}");
        }
    }
}
