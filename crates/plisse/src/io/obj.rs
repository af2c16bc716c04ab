//! OBJ text: the triangles of a mesh, read and written.
//!
//! Read are `v` (with colours, if all have them), `vt` and `f`; faces with more than three corners
//! are cut into triangles. Names, groups, materials, normals, lines and points are passed over,
//! anything else is passed over with a warning. Curves and free-form surfaces are not read.

use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

use super::polygon;
use crate::mesh::{Chart, Vec2, Vec3};
use crate::{Error, Result};

/// The triangles of an OBJ file, in the order of the file. Vertices and texture coordinates are
/// counted from 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Obj {
    /// `[V]` vertex positions (m, if the file was written in metres), all finite.
    pub positions: Vec<Vec3>,
    /// `[V]` red, green and blue as written after the coordinates; `None` unless every vertex has
    /// them, finite.
    pub colours: Option<Vec<[f64; 3]>>,
    /// `[F][3]` vertices of each triangle, as oriented in the file; every index is below `V`, but
    /// may repeat within a face.
    pub faces: Vec<[usize; 3]>,
    /// `[T]` texture coordinates (v up, as OBJ has it), all finite; also those that no face uses.
    pub texture_coordinates: Vec<Vec2>,
    /// `[F][3]` texture coordinate of each corner of each triangle, below `T`; `None` unless every
    /// face has them.
    pub texture_faces: Option<Vec<[usize; 3]>>,
    /// `[F]` line (from 1) on which the face of each triangle begins.
    pub face_lines: Vec<usize>,
    /// The faces that had more than three corners, in the order of the file, and how they were cut.
    pub cuts: Vec<PolygonCut>,
    /// Remarks about what was passed over or fixed: a sentence each that begins with the (first)
    /// line.
    pub warnings: Vec<String>,
}

/// The cut of a face with more than three corners into triangles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PolygonCut {
    /// Number of the face in the file, from 0.
    pub polygon: usize,
    /// Number of its corners.
    pub corners: usize,
    /// Corners (from 0, in the face's own order) of its triangles.
    pub triangles: Vec<[usize; 3]>,
}

/// Reads the OBJ file at `path`.
///
/// # Errors
/// [`Error::File`] if it cannot be read; those of [`parse`]; [`Error::Parse`] for a file that is
/// not UTF-8 text (other encodings are let pass in comments and names).
pub fn read(path: &Path) -> Result<Obj> {
    let bytes = super::disk::read(path).map_err(|source| Error::reading(path, source))?;
    parse(path, &text_of(path, bytes)?)
}

/// Reads the OBJ file at `path`, which has the same faces as `rest` in another shape: its polygons
/// are cut as those of `rest` were, so that triangles correspond.
///
/// # Errors
/// As [`read`]; also [`Error::Parse`] where a face has another number of corners than its
/// counterpart.
pub fn read_pose(path: &Path, rest: &Obj) -> Result<Obj> {
    let bytes = super::disk::read(path).map_err(|source| Error::reading(path, source))?;
    parse_with(path, &text_of(path, bytes)?, Some(&rest.cuts))
}

/// Reads OBJ `text`; `path` is named in errors only.
///
/// ```
/// use std::path::Path;
///
/// let mesh = plisse::io::obj::parse(Path::new("t.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
/// assert_eq!((mesh.positions.len(), mesh.faces), (3, vec![[0, 1, 2]]));
/// # Ok::<(), plisse::Error>(())
/// ```
///
/// # Errors
/// [`Error::Parse`] with the line for: empty text, no vertex, no face, a coordinate that is
/// missing, not a number or not finite, a face with fewer than three (different) corners, an index
/// that is 0, not a number, or beyond the vertices of the file.
pub fn parse(path: &Path, text: &str) -> Result<Obj> {
    parse_with(path, text, None)
}

fn parse_with(path: &Path, text: &str, cuts: Option<&[PolygonCut]>) -> Result<Obj> {
    if text.trim_ascii().is_empty() {
        return Err(Error::parse(
            path,
            1,
            "the file is empty; give an OBJ file with 'v' and 'f' lines",
        ));
    }
    let mut raw = Raw::default();
    let line_end = if text.contains('\n') { '\n' } else { '\r' };
    let mut lines = text.split(line_end).enumerate();
    let mut joined = String::new();
    let mut line = 0;
    while let Some((i, first)) = lines.next() {
        line = i + 1;
        let mut statement = first.trim_ascii();
        if statement.ends_with('\\') && !statement.starts_with('#') {
            joined.clear();
            while let Some(part) = statement.strip_suffix('\\') {
                joined.push_str(part);
                joined.push(' ');
                statement = lines.next().map_or("", |(_, next)| next.trim_ascii());
            }
            joined.push_str(statement);
            statement = &joined;
        }
        raw.add(statement, line).map_err(|message| Error::parse(path, line, message))?;
    }
    raw.finish(path, line, cuts)
}

/// Writes triangles as OBJ: `positions` (`[V]`, m), `faces` (`[F][3]`, from 0), and, if given,
/// texture coordinates.
///
/// Numbers are written with as few digits as bring back the very same `f64` when read.
///
/// # Errors
/// Those of `out`; [`io::ErrorKind::InvalidData`] if the texture faces are not as many as the
/// faces.
pub fn write<W: Write + ?Sized>(
    out: &mut W,
    positions: &[Vec3],
    faces: &[[usize; 3]],
    texture: Option<&Chart>,
) -> io::Result<()> {
    for p in positions {
        writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
    }
    let Some(Chart { points: coordinates, faces: texture_faces }) = texture else {
        for face in faces {
            let [a, b, c] = face.map(|v| v + 1);
            writeln!(out, "f {a} {b} {c}")?;
        }
        return Ok(());
    };
    if texture_faces.len() != faces.len() {
        let message = format!(
            "{} texture faces for {} faces; give one for each",
            texture_faces.len(),
            faces.len()
        );
        return Err(io::Error::new(io::ErrorKind::InvalidData, message));
    }
    for t in coordinates {
        writeln!(out, "vt {} {}", t.x, t.y)?;
    }
    for (face, texture_face) in faces.iter().zip(texture_faces) {
        let ([a, b, c], [s, t, u]) = (face.map(|v| v + 1), texture_face.map(|t| t + 1));
        writeln!(out, "f {a}/{s} {b}/{t} {c}/{u}")?;
    }
    Ok(())
}

/// Statements that are passed over in silence.
const PASSED_OVER: [&str; 15] = [
    "vn", "g", "o", "s", "l", "p", "usemtl", "mtllib", "usemap", "maplib", "lod", "bevel",
    "c_interp", "d_interp", "vp",
];

/// Largest number of different unknown statements in the warnings.
const UNKNOWN_TOLD: usize = 8;

/// The bytes as text; a file saved in another encoding may have its own bytes in comments and names
/// only.
fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String> {
    let line_at = |at: usize| 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        let message = "this is not plain text (binary, compressed or UTF-16); give an OBJ file \
            saved as UTF-8 text";
        return Err(Error::parse(path, line_at(at), message));
    }
    let bytes = match String::from_utf8(bytes) {
        Ok(text) => return Ok(without_mark(text)),
        Err(error) => error.into_bytes(),
    };
    let mut text = String::with_capacity(bytes.len());
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let lossy = String::from_utf8_lossy(line);
        let keyword = lossy.split_ascii_whitespace().next().unwrap_or_default();
        if matches!(lossy, std::borrow::Cow::Owned(_))
            && !keyword.starts_with('#')
            && !PASSED_OVER.contains(&keyword)
        {
            return Err(Error::parse(
                path,
                i + 1,
                "this line is not UTF-8 text; give an OBJ file saved as UTF-8 text",
            ));
        }
        text.push_str(&lossy);
        text.push('\n');
    }
    Ok(without_mark(text))
}

/// Text without the byte order mark that some editors put first.
fn without_mark(mut text: String) -> String {
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    text
}

/// A [`Result`] whose error is a sentence, to which the caller adds file and line.
type Parsed<T> = std::result::Result<T, String>;

/// The contents of the lines, before the number of vertices is known: polygons of any size, indices
/// unchecked.
#[derive(Default)]
struct Raw {
    positions: Vec<Vec3>,
    /// Of the first vertices, until one has none.
    colours: Vec<[f64; 3]>,
    texture_coordinates: Vec<Vec2>,
    /// Vertices of all corners of all polygons, one after the other.
    corners: Vec<u32>,
    /// Their texture coordinates, while every corner so far has one.
    corner_textures: Vec<u32>,
    /// Corners and line of each polygon.
    polygons: Vec<(u32, usize)>,
    /// Line of the first polygon without, and number of the polygons with texture coordinates.
    untextured_line: Option<usize>,
    textured: usize,
    /// Statement, first line and number of what is not known.
    unknown: Vec<(String, usize, usize)>,
}

impl Raw {
    fn add(&mut self, statement: &str, line: usize) -> Parsed<()> {
        let mut words = statement.split_ascii_whitespace();
        match words.next() {
            None => {}
            Some("v") => {
                let [x, y, z] =
                    numbers(words.clone(), 3, "a vertex needs three coordinates (v x y z)")?;
                if self.colours.len() == self.positions.len() {
                    self.colours.extend(colour(words.skip(3)));
                }
                self.positions.push(Vec3::new(x, y, z));
            }
            Some("vt") => {
                let [u, v, _] =
                    numbers(words.take(2), 1, "a texture coordinate needs a number (vt u v)")?;
                self.texture_coordinates.push(Vec2::new(u, v));
            }
            Some("f") => self.add_face(words, line)?,
            Some(keyword) if keyword.starts_with('#') || PASSED_OVER.contains(&keyword) => {}
            Some(keyword) => match self.unknown.iter().position(|u| u.0 == shown(keyword)) {
                Some(i) => self.unknown[i].2 += 1,
                None if self.unknown.len() < UNKNOWN_TOLD => {
                    self.unknown.push((shown(keyword), line, 1))
                }
                None => {}
            },
        }
        Ok(())
    }

    fn add_face<'a>(&mut self, words: impl Iterator<Item = &'a str>, line: usize) -> Parsed<()> {
        let first = self.corners.len();
        let mut textured = true;
        for word in words.take_while(|w| !w.starts_with('#')) {
            let mut parts = word.split('/');
            let vertex = parts.next().unwrap_or_default();
            self.corners.push(index(vertex, word, self.positions.len(), "vertex")?);
            match parts.next().filter(|t| !t.is_empty()) {
                Some(texture) => {
                    let texture =
                        index(texture, word, self.texture_coordinates.len(), "texture coordinate")?;
                    if self.untextured_line.is_none() {
                        self.corner_textures.push(texture);
                    }
                }
                None => textured = false,
            }
        }
        let count = self.corners.len() - first;
        if count < 3 {
            return Err(format!(
                "a face needs at least three corners, this one has {count}; add the missing ones \
                 or remove the line"
            ));
        }
        if textured {
            self.textured += 1;
        } else if self.untextured_line.is_none() {
            self.untextured_line = Some(line);
            self.corner_textures = Vec::new();
        }
        let count = u32::try_from(count)
            .map_err(|_| "the face has too many corners; split it".to_string())?;
        self.polygons.push((count, line));
        Ok(())
    }

    fn finish(self, path: &Path, last_line: usize, cuts: Option<&[PolygonCut]>) -> Result<Obj> {
        if self.positions.is_empty() {
            let message =
                "the file ends without any vertex ('v x y z'); check that it is an OBJ file";
            return Err(Error::parse(path, last_line, message));
        }
        if self.polygons.is_empty() {
            let message = "the file ends without any face ('f 1 2 3'); export the mesh with its \
                faces, not as points";
            return Err(Error::parse(path, last_line, message));
        }
        let has_texture = self.untextured_line.is_none();
        let triangle_count = self.polygons.iter().map(|p| p.0 as usize - 2).sum();
        let mut obj = Obj {
            faces: Vec::with_capacity(triangle_count),
            face_lines: Vec::with_capacity(triangle_count),
            texture_faces: has_texture.then(|| Vec::with_capacity(triangle_count)),
            ..Obj::default()
        };
        let (mut repeated, mut unsound) = (Occurrences::default(), Occurrences::default());
        let (mut points, mut triangles, mut kept) = (Vec::new(), Vec::new(), Vec::new());
        let mut next = 0;
        for (polygon, &(count, line)) in self.polygons.iter().enumerate() {
            let corners = next..next + count as usize;
            next = corners.end;
            self.keep_corners(path, polygon, corners.clone(), cuts.is_some(), &mut kept)?;
            triangles.clear();
            if count == 3 {
                triangles.push([0, 1, 2]);
            } else {
                repeated.count(kept.len() < count as usize, line);
                match cuts.map(|cuts| {
                    cuts.get(obj.cuts.len())
                        .filter(|c| c.polygon == polygon && c.corners == count as usize)
                }) {
                    Some(Some(cut)) => triangles.extend_from_slice(&cut.triangles),
                    Some(None) => {
                        let message = format!(
                            "this face has {count} corners, its counterpart in the rest shape \
                             another number; export both from the same mesh"
                        );
                        return Err(Error::parse(path, line, message));
                    }
                    None => {
                        points.clear();
                        points
                            .extend(kept.iter().map(|&c| self.positions[self.corners[c] as usize]));
                        unsound.count(!polygon::triangulate(&points, &mut triangles), line);
                    }
                }
                let own = |k: usize| kept[k] - corners.start;
                let triangles = triangles.iter().map(|t| t.map(own)).collect();
                obj.cuts.push(PolygonCut { polygon, corners: count as usize, triangles });
            }
            for triangle in &triangles {
                obj.faces.push(triangle.map(|k| self.corners[kept[k]] as usize));
                obj.face_lines.push(line);
                if let Some(texture_faces) = &mut obj.texture_faces {
                    texture_faces.push(triangle.map(|k| self.corner_textures[kept[k]] as usize));
                }
            }
        }
        self.warn(&mut obj.warnings);
        repeated.warn(
            "face names a corner twice in a row; the repetition was dropped",
            &mut obj.warnings,
        );
        unsound.warn(
            "polygon crosses itself, has no area or is far from flat; its triangles may overlap",
            &mut obj.warnings,
        );
        obj.colours = (self.colours.len() == self.positions.len()).then_some(self.colours);
        obj.positions = self.positions;
        obj.texture_coordinates = self.texture_coordinates;
        Ok(obj)
    }

    /// Puts the different corners of a polygon into `kept`: all of them if it is a triangle (one
    /// with a repeated corner stays, for the mesh checks to name) or is to be cut as another one
    /// (`as_given`), else without immediate repetitions.
    fn keep_corners(
        &self,
        path: &Path,
        polygon: usize,
        corners: Range<usize>,
        as_given: bool,
        kept: &mut Vec<usize>,
    ) -> Result<()> {
        let (count, line) = self.polygons[polygon];
        let beyond = |what: &str, i: u32, n: usize| {
            let message = format!(
                "the face names {what} {}, but the file has only {n} of them; correct the index",
                u64::from(i) + 1
            );
            Error::parse(path, line, message)
        };
        let has_texture = self.untextured_line.is_none();
        kept.clear();
        for c in corners.clone() {
            let vertex = self.corners[c];
            if vertex as usize >= self.positions.len() {
                return Err(beyond("vertex", vertex, self.positions.len()));
            }
            if has_texture && self.corner_textures[c] as usize >= self.texture_coordinates.len() {
                let (texture, n) = (self.corner_textures[c], self.texture_coordinates.len());
                return Err(beyond("texture coordinate", texture, n));
            }
            let before = if c == corners.start { corners.end - 1 } else { c - 1 };
            if count == 3 || as_given || vertex != self.corners[before] {
                kept.push(c);
            }
        }
        if kept.len() < 3 {
            let message =
                "the face has fewer than three different corners in a row; remove the line";
            return Err(Error::parse(path, line, message));
        }
        Ok(())
    }

    /// Warnings about what was passed over.
    fn warn(&self, warnings: &mut Vec<String>) {
        for (keyword, line, count) in &self.unknown {
            warnings.push(format!(
                "line {line}: '{keyword}' is no known statement and was passed over ({count} in \
                 all)"
            ));
        }
        if let Some(line) = self.untextured_line.filter(|_| self.textured > 0) {
            warnings.push(format!(
                "line {line}: this face has no texture coordinates, others have; those of all \
                 faces were passed over"
            ));
        }
    }
}

/// Number of times that something happened, and the line of the first time.
#[derive(Default)]
struct Occurrences {
    count: usize,
    first_line: usize,
}

impl Occurrences {
    fn count(&mut self, happened: bool, line: usize) {
        if happened {
            self.count += 1;
            if self.count == 1 {
                self.first_line = line;
            }
        }
    }

    fn warn(&self, what: &str, warnings: &mut Vec<String>) {
        if self.count > 0 {
            warnings.push(format!("line {}: this {what} ({} in all)", self.first_line, self.count));
        }
    }
}

/// The first three words as finite numbers; words beyond are not looked at, those missing beyond
/// `needed` are 0.
fn numbers<'a>(
    words: impl Iterator<Item = &'a str>,
    needed: usize,
    need: &str,
) -> Parsed<[f64; 3]> {
    let mut values = [0.0; 3];
    let mut found = 0;
    for word in words.take_while(|w| !w.starts_with('#')).take(3) {
        let value: f64 =
            word.parse().map_err(|_| format!("'{}' is not a number; {need}", shown(word)))?;
        if !value.is_finite() {
            return Err(format!(
                "'{}' is not a finite number; {need}, so repair the mesh where it was made",
                shown(word)
            ));
        }
        values[found] = value;
        found += 1;
    }
    if found < needed {
        Err(format!("{need}, this one has {found}; add what is missing"))
    } else {
        Ok(values)
    }
}

/// Three finite numbers, if there are as many.
fn colour<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<[f64; 3]> {
    let mut number = || words.next()?.parse().ok().filter(|x: &f64| x.is_finite());
    Some([number()?, number()?, number()?])
}

/// The index in `part` of the corner `word`, counted from 0, when `count` of what it counts have
/// been read so far.
fn index(part: &str, word: &str, count: usize, what: &str) -> Parsed<u32> {
    let Ok(number) = part.parse::<i64>() else {
        return Err(format!(
            "'{}' names no {what}; write corners as 'v', 'v/vt', 'v//vn' or 'v/vt/vn'",
            shown(word)
        ));
    };
    let from_zero = match number {
        0 => {
            return Err(format!(
                "'{}' names {what} 0, but OBJ counts from 1; correct the index",
                shown(word)
            ));
        }
        1.. => number - 1,
        // No file has so many that this wraps.
        _ => count as i64 + number,
    };
    u32::try_from(from_zero).map_err(|_| {
        format!(
            "'{}' names {what} {number}, but only {count} of them have been read up to here; \
            correct the index",
            shown(word)
        )
    })
}

/// A word short enough for a message.
fn shown(word: &str) -> String {
    if word.chars().count() <= 40 {
        word.to_string()
    } else {
        word.chars().take(40).chain(['…']).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Obj {
        parse(Path::new("m.obj"), text).unwrap()
    }

    fn message(text: &str) -> String {
        parse(Path::new("m.obj"), text).unwrap_err().to_string()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

    #[test]
    fn what_is_written_reads_back_bit_for_bit() {
        // Numbers over the whole range of f64, from a fixed sequence; and those that are easily
        // lost.
        let mut state = 1_u64;
        let mut number = || loop {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let x = f64::from_bits(state ^ (state >> 29));
            if x.is_finite() {
                return x;
            }
        };
        let mut positions: Vec<Vec3> =
            (0..300).map(|_| Vec3::new(number(), number(), number())).collect();
        positions.push(Vec3::new(-0.0, f64::MIN_POSITIVE / 8.0, f64::MAX));
        positions.push(Vec3::new(0.1 + 0.2, 1.0 / 3.0, -5e-324));
        let points: Vec<Vec2> = (0..50).map(|_| Vec2::new(number(), number())).collect();
        let faces: Vec<[usize; 3]> = (0..300).map(|i| [i, i + 1, (i * 7) % 302]).collect();
        let texture_faces: Vec<[usize; 3]> =
            (0..300).map(|i| [i % 50, (i + 1) % 50, (i * 3) % 50]).collect();
        let mut chart = Chart { points, faces: texture_faces };
        for texture in [None, Some(&chart)] {
            let mut text = Vec::new();
            write(&mut text, &positions, &faces, texture).unwrap();
            let obj = parsed(std::str::from_utf8(&text).unwrap());
            let bits = |p: &[Vec3]| -> Vec<[u64; 3]> {
                p.iter().map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect()
            };
            assert_eq!(bits(&obj.positions), bits(&positions));
            assert_eq!(obj.faces, faces);
            assert_eq!(obj.texture_faces.as_ref(), texture.map(|t| &t.faces));
            assert_eq!(
                obj.texture_coordinates,
                texture.map(|t| t.points.clone()).unwrap_or_default()
            );
            assert!(obj.warnings.is_empty());
        }
        chart.faces.remove(0);
        assert!(write(&mut Vec::new(), &positions, &faces, Some(&chart)).is_err());
    }

    #[test]
    fn every_form_of_a_face_names_the_same_triangle() {
        for (face, textured) in [
            ("f 1 2 3", false),
            ("f 1/1 2/2 3/3", true),
            ("f 1//1 2//1 3//1", false),
            ("f 1/1/9 2/2/9 3/3/9", true),
            ("f -4 -3 -2", false),
            ("f -4/-4 -3/-3/-1 3/3", true),
            ("f 1/ 2/ 3/", false),
        ] {
            let obj = parsed(&format!("{SQUARE}{face}"));
            assert_eq!(obj.faces, [[0, 1, 2]], "{face}");
            assert_eq!(obj.texture_faces, textured.then(|| vec![[0, 1, 2]]), "{face}");
        }
    }

    #[test]
    fn ends_of_lines_and_other_statements_do_not_matter() {
        let plain = parsed(&format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
        let dressed = format!(
            "o quilt\n# C:\\mesh\\\n{SQUARE}vn 0 0 1\ng a b\nusemtl x\ns off\nl 1 2\np 1\nf 1 2 \
             \\\n 3 # corner\n\n\tf\t1 3 4"
        );
        for text in [dressed.clone(), dressed.replace('\n', "\r\n"), dressed.replace('\n', "\r")] {
            let obj = parsed(&text);
            assert_eq!((&obj.positions, &obj.faces), (&plain.positions, &plain.faces));
            assert_eq!(obj.face_lines, [17, 20]);
            assert!(obj.warnings.is_empty(), "{:?}", obj.warnings);
        }
        let extra = "v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 1 1 0 # tip\nf 1 2 3\nwobble 3\nwobble 4";
        assert_eq!(parsed(extra).positions[..], plain.positions[..3]);
        assert_eq!(
            parsed(extra).warnings,
            ["line 5: 'wobble' is no known statement and was passed over (2 in all)"]
        );
    }

    #[test]
    fn faces_may_come_before_their_vertices() {
        assert_eq!(parsed(&format!("f 1 2 4\n{SQUARE}")).faces, [[0, 1, 3]]);
        assert!(
            message(&format!("f 1 2 5\n{SQUARE}"))
                .contains("line 1: the face names vertex 5, but the file has only 4")
        );
    }

    #[test]
    fn polygons_become_triangles_that_know_their_line_and_texture() {
        let obj =
            parsed(&format!("{SQUARE}v 2 0.5 0\nvt 2 0.5\nf 1/1 2/2 3/3\nf 1/2 2/3 5/4 3/5 4/1\n"));
        assert_eq!(obj.cuts.len(), 1);
        assert_eq!(obj.faces, [[0, 1, 2], [0, 1, 4], [0, 4, 2], [0, 2, 3]]);
        assert_eq!(obj.texture_faces.unwrap(), [[0, 1, 2], [1, 2, 3], [1, 3, 4], [1, 4, 0]]);
        assert_eq!(obj.face_lines, [11, 12, 12, 12]);
    }

    #[test]
    fn fixed_faces_are_reported() {
        let repeated = parsed(&format!("{SQUARE}f 1 2 3 3\nf 1 1 3 4\n"));
        assert_eq!(repeated.faces, [[0, 1, 2], [0, 2, 3]]);
        assert!(
            repeated.warnings[0].starts_with("line 9: this face names a corner twice")
                && repeated.warnings[0].contains("2 in all")
        );
        let partial = parsed(&format!("{SQUARE}f 1/1 2/2 3/3\nf 1 3 4\n"));
        assert_eq!(partial.texture_faces, None);
        assert!(partial.warnings[0].starts_with("line 10: this face has no texture coordinates"));
        let crossed = parsed(&format!("{SQUARE}f 1 3 2 4\n"));
        assert!(crossed.warnings[0].starts_with("line 9: this polygon crosses itself"));
    }

    #[test]
    fn errors_name_the_line_and_what_is_wrong() {
        assert!(
            message("v 0 0 0\nv 1 nan 0\n").contains("m.obj, line 2: 'nan' is not a finite number")
        );
        assert!(
            message("v 0 0 0\n\nv 1e999 0 0\n").contains("line 3: '1e999' is not a finite number")
        );
        assert!(message("v 0 0,5 0").contains("line 1: '0,5' is not a number"));
        assert!(message("v 0 0 # 0").contains("three coordinates (v x y z), this one has 2"));
        assert!(message("vt\n").contains("line 1: a texture coordinate needs a number"));
        assert!(
            message(&format!("{SQUARE}f 0 1 2"))
                .contains("line 9: '0' names vertex 0, but OBJ counts from 1")
        );
        assert!(
            message(&format!("{SQUARE}f 1 2 7"))
                .contains("line 9: the face names vertex 7, but the file has only 4")
        );
        assert!(
            message(&format!("{SQUARE}f 1 2 -5"))
                .contains("line 9: '-5' names vertex -5, but only 4")
        );
        assert!(
            message(&format!("{SQUARE}f 1/1 2/2 3/5"))
                .contains("names texture coordinate 5, but the file has only 4")
        );
        assert!(
            message(&format!("{SQUARE}f 1 2 99999999999")).contains("names vertex 99999999999")
        );
        assert!(message(&format!("{SQUARE}f 1 2 x/1")).contains("'x/1' names no vertex"));
        assert!(
            message(&format!("{SQUARE}f 1 2"))
                .contains("line 9: a face needs at least three corners, this one has 2")
        );
        assert!(
            message(&format!("{SQUARE}f 1 1 2 2"))
                .contains("line 9: the face has fewer than three different corners")
        );
        assert!(message(SQUARE).contains("line 9: the file ends without any face"));
        assert!(message("# nothing\n").contains("without any vertex"));
        assert!(message(" \n").contains("line 1: the file is empty"));
        assert!(message(&format!("v {} 0 0", "x".repeat(10_000))).len() < 300);
    }

    #[test]
    fn other_encodings_pass_in_comments_only() {
        let from =
            |bytes: &[u8]| text_of(Path::new("m.obj"), bytes.to_vec()).map_err(|e| e.to_string());
        assert_eq!(from(b"\xef\xbb\xbfv 0 0 0").unwrap(), "v 0 0 0");
        assert!(from(b"# Gr\xfc\xdfe\ng Stra\xdfe\nv 0 0 0").unwrap().contains("v 0 0 0"));
        assert!(from(b"# ok\nv \xff 0 0").unwrap_err().contains("line 2: this line is not UTF-8"));
        assert!(
            from(b"glTF\x02\x00\x00\x00").unwrap_err().contains("line 1: this is not plain text")
        );
        let missing = read(Path::new("/nowhere/m.obj")).unwrap_err().to_string();
        assert!(
            missing.contains("/nowhere/m.obj") && missing.contains("check the path's spelling")
        );
    }

    #[test]
    fn a_poses_polygons_are_cut_as_the_rest_shapes_were() {
        let path = Path::new("m.obj");
        // The short diagonal is 1-3 at rest and 2-4 in the pose.
        let rest =
            parse(path, "v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 1 2 3\nf 1 2 3 4\n").unwrap();
        let posed = "v 0 0 0\nv 1 -0.1 0\nv 9 0 0\nv 1 0.1 0\nf 1 2 3\nf 1 2 3 4\n";
        assert_ne!(parse(path, posed).unwrap().faces, rest.faces);
        assert_eq!(parse_with(path, posed, Some(&rest.cuts)).unwrap().faces, rest.faces);
        let other = parse_with(
            path,
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 2 3\n",
            Some(&rest.cuts),
        );
        assert!(other.unwrap_err().to_string().contains("line 5"));
    }
}
