//! Wrinkles of the rest pose (section 7): one vector per welded vertex, in rest space and
//! tangential, along which the surface counts as shortened by |p|². Painted, read from a file, or
//! random.
//!
//! The file is JSON, `{"bias": [[x, y, z], …]}`: a vector (no unit) for each welded vertex, in
//! their order; of a length below 1.

use std::io::Write;
use std::path::Path;

use plisse::{Error, Result};
use serde_json::Value;

use crate::Vec3;
use crate::relax::random_phases;
use crate::weld::WeldedMesh;

/// Number of rounds in which random vectors are averaged with their neighbours'.
const ROUNDS: usize = 12;
/// Length of the longest random vector (no unit); at 1 a surface would count as fully compressed.
const LONGEST: f32 = 0.95;

/// Random vectors `[U]`, smooth over some edges: the longest has the length `amount` (0 to 0.95; 0
/// gives none), others are shorter. The same for the same `seed` on every machine.
pub fn random(welded: &WeldedMesh, amount: f32, seed: u64) -> Vec<Vec3> {
    let (angles, lengths) =
        (random_phases(welded.count(), seed), random_phases(welded.count(), seed ^ 0x5EED));
    let tangential = |v: usize, x: Vec3| {
        let n = &welded.vertices.normals[v];
        x - n * n.dot(&x)
    };
    let mut vectors: Vec<Vec3> = (0..welded.count())
        .map(|v| {
            let n = welded.vertices.normals[v];
            let axis = if n.x.abs() < 0.7 { Vec3::x() } else { Vec3::y() };
            let Some(t) =
                tangential(v, axis).try_normalize(1e-6).filter(|_| n.norm_squared() > 0.25)
            else {
                return Vec3::zeros();
            };
            let (sin, cos) = angles[v].sin_cos();
            (t * cos + n.cross(&t) * sin) * (0.5 + lengths[v] / std::f32::consts::TAU)
        })
        .collect();
    for _ in 0..ROUNDS {
        vectors = (0..welded.count())
            .map(|v| {
                let around = welded.around(v);
                // A bias has no sign, so neighbours are turned alike before they are mixed.
                let turned = |&n: &u32| {
                    if vectors[n as usize].dot(&vectors[v]) < 0.0 {
                        -vectors[n as usize]
                    } else {
                        vectors[n as usize]
                    }
                };
                let sum = around.iter().map(turned).fold(vectors[v], |a, b| a + b);
                tangential(v, sum / (around.len() + 1) as f32)
            })
            .collect();
    }
    let longest = vectors.iter().map(|p| p.norm()).fold(0.0, f32::max);
    let scale = if longest > 0.0 && amount.is_finite() {
        amount.clamp(0.0, LONGEST) / longest
    } else {
        0.0
    };
    vectors.iter().map(|p| p * scale).collect()
}

/// Reads the file `path` for a model of `count` welded vertices.
///
/// # Errors
/// [`Error::File`] if it cannot be read; [`Error::Value`] naming file and vertex for: no such JSON,
/// another number of vectors, a vector that has not three numbers or is not shorter than 1.
pub fn read(path: &Path, count: usize) -> Result<Vec<Vec3>> {
    let text = plisse::io::disk::read(path).map_err(|e| Error::reading(path, e))?;
    let bad = |message: String| Error::value(path.display().to_string(), message);
    let file: Value = serde_json::from_slice(&text)
        .map_err(|e| bad(format!("this is no JSON ({e}); write {{\"bias\": [[x, y, z], …]}}")))?;
    let Some(list) = file["bias"].as_array() else {
        return Err(bad("there is no list \"bias\"; write {\"bias\": [[x, y, z], …]}".into()));
    };
    if list.len() != count {
        let message = format!(
            "it has {} vectors, but the model has {count} welded vertices; give one for each",
            list.len()
        );
        return Err(bad(message));
    }
    let vector = |(v, value): (usize, &Value)| {
        let numbers: Option<Vec<f32>> =
            value.as_array().and_then(|a| a.iter().map(|x| x.as_f64().map(|x| x as f32)).collect());
        match numbers.as_deref() {
            Some(&[x, y, z]) if Vec3::new(x, y, z).norm() < 1.0 => Ok(Vec3::new(x, y, z)),
            _ => Err(bad(format!(
                "vector {v} is {value}; give three numbers, together shorter than 1"
            ))),
        }
    };
    list.iter().enumerate().map(vector).collect()
}

/// Writes `bias` (`[U]`) as [`read`] takes it.
///
/// # Errors
/// Any error of `out`.
pub fn write<W: Write + ?Sized>(out: &mut W, bias: &[Vec3]) -> std::io::Result<()> {
    let list: Vec<[f32; 3]> = bias.iter().map(|&p| p.into()).collect();
    serde_json::to_writer(&mut *out, &serde_json::json!({"bias": list}))?;
    out.write_all(b"\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_vectors_are_tangential_smooth_and_short() {
        let welded = WeldedMesh::new(&crate::models::sleeve(), 1e-5);
        let bias = random(&welded, 0.6, 3);
        let longest = bias.iter().map(|p| p.norm()).fold(0.0, f32::max);
        assert!((longest - 0.6).abs() < 1e-4);
        assert!((0..bias.len()).all(|v| bias[v].dot(&welded.vertices.normals[v]).abs() < 1e-4));
        // Neighbours agree in direction, up to sign; vectors of unsmoothed noise do so by 2/π only.
        let pairs =
            (0..bias.len()).flat_map(|v| welded.around(v).iter().map(move |&n| (v, n as usize)));
        let agree: Vec<f32> =
            pairs.map(|(v, n)| bias[v].normalize().dot(&bias[n].normalize()).abs()).collect();
        let mean = agree.iter().sum::<f32>() / agree.len() as f32;
        assert!(mean > 0.85, "{mean}");
        assert_eq!(bias, random(&welded, 0.6, 3));
        assert_ne!(bias, random(&welded, 0.6, 4));
        assert!(random(&welded, 0.0, 3).iter().all(|p| *p == Vec3::zeros()));
        assert!(random(&welded, 5.0, 3).iter().all(|p| p.norm() < 1.0));
    }

    #[test]
    fn files_come_back_and_bad_ones_are_told() {
        let path = std::env::temp_dir().join(format!("plisse-bias-{}.json", std::process::id()));
        let bias = vec![Vec3::new(0.1, -0.2, 0.3), Vec3::zeros()];
        let mut file = Vec::new();
        write(&mut file, &bias).unwrap();
        std::fs::write(&path, &file).unwrap();
        assert_eq!(read(&path, 2).unwrap(), bias);
        assert!(read(&path, 3).unwrap_err().to_string().contains("one for each"));
        for text in [
            "",
            "[]",
            "{\"bias\": [[1, 0, 0]]}",
            "{\"bias\": [[0, 0]]}",
            "{\"bias\": [\"x\"]}",
            "{\"bias\": [[0, 0, null]]}",
        ] {
            std::fs::write(&path, text).unwrap();
            let message = read(&path, 1).unwrap_err().to_string();
            assert!(message.contains(';') && !message.contains('\n'), "{message}");
        }
        std::fs::remove_file(&path).unwrap();
        assert!(read(&path, 1).is_err());
    }
}
