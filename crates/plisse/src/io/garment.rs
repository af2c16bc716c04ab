//! A garment: a posed mesh with its rest shape, the pair of files that pattern programs and
//! simulators export.
//!
//! Both have the same faces in the same order. The posed mesh is welded where its file keeps
//! vertices twice along seams; the rest shape keeps its own vertices, because rest lengths belong
//! to faces.

use std::path::Path;

use super::obj;
use crate::error::MeshError;
use crate::mesh::check::{check_rest_faces, weld};
use crate::mesh::{Chart, RestShape, Topology, Vec3};
use crate::{At, Error, Result};

/// The source of a garment's rest shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestSource<'a> {
    /// An OBJ file with the same faces in the same order: flat pieces or any unstrained shape,
    /// possibly with more vertices.
    File(&'a Path),
    /// The texture coordinates of the posed mesh, which are flat pieces.
    Texture {
        /// Length of one unit of texture (m).
        metres_per_uv: f64,
    },
}

/// A posed mesh with its rest shape. V vertices, F faces, R rest vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Garment {
    /// Connectivity of the welded mesh.
    pub topology: Topology,
    /// `[V]` pose (m).
    pub positions: Vec<Vec3>,
    /// `[vertices of the file]` welded vertex of each.
    pub vertex_of_input: Vec<usize>,
    /// The rest shape.
    pub rest_shape: RestShape,
    /// `[V]` red, green and blue of the posed file's vertices, if it has them.
    pub colours: Option<Vec<[f64; 3]>>,
    /// Texture coordinates (v up), of the posed file or else of the rest file.
    pub texture: Option<Chart>,
    /// Remarks about what was passed over, fixed, welded or cut: a sentence each, with the file.
    pub notes: Vec<String>,
}

/// Reads the posed mesh at `path` and its rest shape. Coordinates of both files (not of texture)
/// are multiplied by `metres_per_unit`.
///
/// # Errors
/// Those of [`obj::read`] and [`obj::read_pose`]; [`Error::Mesh`] with the file for: files with
/// different numbers of triangles, a posed mesh without texture coordinates where they are the rest
/// shape, a rest face without area or flipped against its panel, and what [`Topology::new`] finds
/// in the welded mesh.
pub fn read(path: &Path, rest: RestSource<'_>, metres_per_unit: f64) -> Result<Garment> {
    let name = path.display().to_string();
    let Pair { posed, mut rest_shape, rest_texture, mut notes } = read_pair(path, rest)?;
    let mut welded = weld(&posed.positions, &posed.faces);
    let topology = Topology::new(welded.positions.len(), welded.faces).at(&name)?;
    if metres_per_unit != 1.0 {
        welded.positions.iter_mut().for_each(|p| *p *= metres_per_unit);
        if let RestSource::File(_) = rest {
            rest_shape.positions.iter_mut().for_each(|p| *p *= metres_per_unit);
        }
    }
    notes.extend(posed.warnings.iter().map(|w| format!("{name}: {w}")));
    let merged = posed.positions.len() - topology.vertex_count;
    if merged > 0 {
        notes.push(format!("{merged} vertices of {name} at the same place as others were welded"));
    }
    if !posed.cuts.is_empty() {
        notes.push(format!("{} polygons of {name} were cut into triangles", posed.cuts.len()));
    }
    let own_texture =
        posed.texture_faces.map(|faces| Chart { points: posed.texture_coordinates, faces });
    let (positions, vertex_of_input) = (welded.positions, welded.vertex_of_input);
    // Where several became one, the last one's.
    let colours = posed.colours.map(|own| {
        let mut colours = vec![[0.0; 3]; positions.len()];
        own.iter().zip(&vertex_of_input).for_each(|(colour, &v)| colours[v] = *colour);
        colours
    });
    Ok(Garment {
        topology,
        positions,
        vertex_of_input,
        rest_shape,
        colours,
        texture: own_texture.or(rest_texture),
        notes,
    })
}

/// The two shapes as they stand in their files.
struct Pair {
    posed: obj::Obj,
    rest_shape: RestShape,
    /// Texture coordinates of the rest file.
    rest_texture: Option<Chart>,
    notes: Vec<String>,
}

/// Reads both shapes and checks the rest shape, and that the two have the same number of faces.
fn read_pair(path: &Path, rest: RestSource<'_>) -> Result<Pair> {
    let name = path.display().to_string();
    let (rest_name, pair) = match rest {
        RestSource::File(rest_path) => {
            let rest = obj::read(rest_path)?;
            let posed = obj::read_pose(path, &rest)?;
            let rest_name = rest_path.display().to_string();
            let notes = rest.warnings.iter().map(|w| format!("{rest_name}: {w}")).collect();
            let pair = Pair {
                posed,
                rest_shape: RestShape { positions: rest.positions, faces: rest.faces },
                rest_texture: rest
                    .texture_faces
                    .map(|faces| Chart { points: rest.texture_coordinates, faces }),
                notes,
            };
            (rest_name, pair)
        }
        RestSource::Texture { metres_per_uv } => {
            let posed = obj::read(path)?;
            let Some(faces) = posed.texture_faces.clone() else {
                let message = "its faces have no texture coordinates to take the rest shape from; \
                    export it with them, or give a rest mesh";
                return Err(Error::mesh(name, message));
            };
            let positions = posed
                .texture_coordinates
                .iter()
                .map(|t| Vec3::new(t.x, t.y, 0.0) * metres_per_uv)
                .collect();
            let rest_shape = RestShape { positions, faces };
            let pair = Pair { posed, rest_shape, rest_texture: None, notes: Vec::new() };
            (format!("{name}, texture coordinates"), pair)
        }
    };
    if pair.rest_shape.faces.len() != pair.posed.faces.len() {
        let problem = MeshError::FaceCountsDiffer {
            rest_faces: pair.rest_shape.faces.len(),
            pose: name,
            pose_faces: pair.posed.faces.len(),
        };
        return Err(Error::from(problem).at(&rest_name));
    }
    check_rest_faces(&pair.rest_shape.positions, &pair.rest_shape.faces).at(&rest_name)?;
    Ok(pair)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles that meet along a seam, where each has its own vertices.
    const WORN: &str = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv -1 1 5\nvt 0 0\nvt 0 1\nvt \
        1 0\nvt 3 1\nvt 3 0\nvt 2 1\nf 1/1 3/3 2/2\nf 4/4 6/6 5/5\n";
    const FLAT: &str = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 3 1 0\nv 3 0 0\nv 2 1 0\nf 1 3 2\nf 4 6 5\n";

    /// The pair read from files with this text.
    fn pair(test: &str, worn: &str, rest: &str, metres_per_unit: f64) -> Result<Garment> {
        let folder =
            std::env::temp_dir().join(format!("plisse-worn-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (worn_path, rest_path) = (folder.join("worn.obj"), folder.join("rest.obj"));
        std::fs::write(&worn_path, worn).unwrap();
        std::fs::write(&rest_path, rest).unwrap();
        let rest = if rest.is_empty() {
            RestSource::Texture { metres_per_uv: 2.0 }
        } else {
            RestSource::File(&rest_path)
        };
        let read = read(&worn_path, rest, metres_per_unit);
        std::fs::remove_dir_all(&folder).unwrap();
        read
    }

    #[test]
    fn pieces_are_welded_and_keep_their_rest_shape() {
        let worn = pair("file", WORN, FLAT, 0.01).unwrap();
        assert_eq!((worn.topology.vertex_count, worn.topology.edge_count()), (4, 5));
        assert_eq!(worn.vertex_of_input, [0, 1, 2, 1, 0, 3]);
        assert_eq!(worn.positions[3], Vec3::new(-1.0, 1.0, 5.0) * 0.01);
        assert_eq!(
            (worn.rest_shape.positions[3], worn.rest_shape.faces[1]),
            (Vec3::new(3.0, 1.0, 0.0) * 0.01, [3, 5, 4])
        );
        assert_eq!(worn.texture.unwrap().faces[1], [3, 5, 4]);
        assert!(
            worn.notes[0].contains("2 vertices of") && worn.notes.len() == 1,
            "{:?}",
            worn.notes
        );
        let textured = pair("texture", WORN, "", 0.01).unwrap();
        assert_eq!(
            (textured.rest_shape.positions[3], textured.rest_shape.faces[1]),
            (Vec3::new(6.0, 2.0, 0.0), [3, 5, 4])
        );
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let says = |worn: &str, rest: &str| pair("bad", worn, rest, 1.0).unwrap_err().to_string();
        let text = says(WORN, &FLAT.replace("f 4 6 5\n", ""));
        assert!(
            text.contains("rest.obj: it has 1 triangles, but ") && text.contains("worn.obj has 2;"),
            "{text}"
        );
        let text = says(&WORN.replace("4/4 6/6 5/5", "4 6 5"), "");
        assert!(text.contains("worn.obj: its faces have no texture coordinates"), "{text}");
        assert!(says(WORN, &FLAT.replace("f 4 6 5", "f 4 6 6")).contains("rest.obj: face 1"));
        let text = says(&WORN.replace("4/4 6/6 5/5", "4/4 6/4 5/5"), "");
        assert!(text.contains("worn.obj, texture coordinates: face 1"), "{text}");
    }
}
