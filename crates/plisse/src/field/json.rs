//! Wrinkle fields as JSON, for scripts and other tools.

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::WrinkleField;
use crate::mesh::Topology;
use crate::{Error, Result};

/// The file's content.
#[derive(Debug, Serialize)]
struct FieldFile<'a> {
    /// `[V]` amplitude (m).
    amplitude: &'a [f64],
    /// `[E]` end vertices of each edge, lower first.
    edges: &'a [[usize; 2]],
    /// `[E]` frequency one-form (rad) from the lower to the higher vertex; 0 on edges of no
    /// wrinkled face.
    omega: &'a [f64],
    /// `[F][3]` phase (rad) at each corner; 0 on wrinkle-free faces.
    phase: &'a [[f64; 3]],
    /// Numbers of the wrinkle-free faces.
    wrinkle_free: Vec<usize>,
}

/// Writes `field` on `topology`.
///
/// # Errors
/// Those of the writer.
pub fn write<W: Write + ?Sized>(
    out: &mut W,
    topology: &Topology,
    field: &WrinkleField,
) -> std::io::Result<()> {
    let file = FieldFile {
        amplitude: &field.amplitude_m,
        edges: &topology.edges,
        omega: &field.omega,
        phase: &field.phase,
        wrinkle_free: (0..topology.face_count()).filter(|&f| field.wrinkle_free[f]).collect(),
    };
    serde_json::to_writer(&mut *out, &file)?;
    out.write_all(b"\n")
}

/// The file as it is read.
#[derive(Deserialize)]
struct FieldText {
    amplitude: Vec<f64>,
    edges: Vec<[usize; 2]>,
    omega: Vec<f64>,
    phase: Vec<[f64; 3]>,
    wrinkle_free: Vec<usize>,
}

/// Reads the field in the file `path`, which must have been written on `topology`.
///
/// # Errors
/// [`Error::File`] if it cannot be read; [`Error::Mesh`] naming the file if it is no such JSON, or
/// of another mesh.
pub fn read(path: &Path, topology: &Topology) -> Result<WrinkleField> {
    let bytes = crate::io::disk::read(path).map_err(|e| Error::reading(path, e))?;
    let bad = |message: String| Error::mesh(path.display().to_string(), message);
    let file: FieldText = serde_json::from_slice(&bytes)
        .map_err(|e| bad(format!("this is no field file ({e}); write it again")))?;
    let faces = topology.face_count();
    let fits = file.amplitude.len() == topology.vertex_count
        && file.edges == topology.edges
        && file.omega.len() == topology.edge_count()
        && file.phase.len() == faces
        && file.wrinkle_free.iter().all(|&f| f < faces);
    if !fits {
        return Err(bad(
            "the field is of another mesh than the one beside it; write both again".to_owned()
        ));
    }
    let mut wrinkle_free = vec![false; faces];
    file.wrinkle_free.iter().for_each(|&f| wrinkle_free[f] = true);
    Ok(WrinkleField {
        amplitude_m: file.amplitude,
        omega: file.omega,
        phase: file.phase,
        wrinkle_free,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_comes_back_bit_for_bit() {
        let topology = Topology::new(4, vec![[0, 1, 2], [2, 1, 3]]).unwrap();
        let field = WrinkleField {
            amplitude_m: vec![0.0, 1.0 / 3.0, 1e-9, 0.1],
            omega: vec![0.1, -0.2, 0.3, 1e300, std::f64::consts::PI],
            phase: vec![[0.1, 0.2, 0.3], [0.0; 3]],
            wrinkle_free: vec![false, true],
        };
        let mut text = Vec::new();
        write(&mut text, &topology, &field).unwrap();
        let back: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let numbers = |key: &str| -> Vec<f64> {
            back[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
        };
        assert_eq!(numbers("amplitude"), field.amplitude_m);
        assert_eq!(numbers("omega"), field.omega);
        assert_eq!(back["phase"][0][2].as_f64(), Some(0.3));
        assert_eq!(back["wrinkle_free"], serde_json::json!([1]));
        assert_eq!(back["edges"], serde_json::json!(topology.edges));
        let path = std::env::temp_dir().join(format!("plisse-field-{}.json", std::process::id()));
        std::fs::write(&path, &text).unwrap();
        assert_eq!(read(&path, &topology).unwrap(), field);
        let other = Topology::new(4, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        assert!(read(&path, &other).unwrap_err().to_string().contains("another mesh"));
        std::fs::write(&path, "{}").unwrap();
        assert!(read(&path, &topology).is_err());
        std::fs::remove_file(&path).unwrap();
    }
}
