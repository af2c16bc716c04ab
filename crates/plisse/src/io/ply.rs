//! Binary PLY: triangles with named values per vertex, for looking at fields in other programs.
//!
//! Writing only ([`super::ply_mesh`] reads). Positions are doubles, values single precision, all
//! little-endian.

use std::io::{self, Write};

use crate::mesh::Vec3;

/// Writes triangles as binary little-endian PLY: `positions` (`[V]`, m), `faces` (`[F][3]`, from 0)
/// and `values`, each a name and a value per vertex (`[V]`, stored as 32-bit floats).
///
/// # Errors
/// Those of `out`; [`io::ErrorKind::InvalidData`] for values that are not one per vertex, for a
/// name that is not made of ASCII letters, digits and `_`, is `x`, `y` or `z`, or is there twice,
/// and for a vertex index beyond 2³¹ − 1 (the format's integers end there).
pub fn write<W: Write + ?Sized>(
    out: &mut W,
    positions: &[Vec3],
    faces: &[[usize; 3]],
    values: &[(&str, &[f64])],
) -> io::Result<()> {
    let invalid = |message: String| Err(io::Error::new(io::ErrorKind::InvalidData, message));
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment Plisse {}\n",
        env!("CARGO_PKG_VERSION")
    )?;
    write!(
        out,
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
        positions.len()
    )?;
    for (i, (name, list)) in values.iter().enumerate() {
        let word = !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        if !word || ["x", "y", "z"].contains(name) || values[..i].iter().any(|v| v.0 == *name) {
            return invalid(format!(
                "'{name}' cannot name a value; use letters, digits and '_', no name twice, not x, \
                 y or z"
            ));
        }
        if list.len() != positions.len() {
            return invalid(format!(
                "{} values of '{name}' for {} vertices; give one for each",
                list.len(),
                positions.len()
            ));
        }
        writeln!(out, "property float {name}")?;
    }
    write!(
        out,
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        faces.len()
    )?;
    for (i, p) in positions.iter().enumerate() {
        for x in p.iter() {
            out.write_all(&x.to_le_bytes())?;
        }
        for (_, list) in values {
            out.write_all(&(list[i] as f32).to_le_bytes())?;
        }
    }
    for face in faces {
        out.write_all(&[3])?;
        for &v in face {
            let Ok(v) = i32::try_from(v) else {
                return invalid(format!("vertex {v} is beyond PLY's integers; split the mesh"));
            };
            out.write_all(&v.to_le_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_reads_back() {
        let positions = [
            Vec3::new(0.1, -1e-300, 3.0),
            Vec3::new(4.0, 5.0, 6.0),
            Vec3::new(1.0 / 3.0, 8.0, 9.0),
        ];
        let faces = [[0, 1, 2], [2, 1, 0]];
        let amplitude = [0.25, 1e-3, 7.0];
        let phase = [-1.0, 0.0, 1.0];
        let mut bytes = Vec::new();
        write(&mut bytes, &positions, &faces, &[("amplitude", &amplitude), ("phase", &phase)])
            .unwrap();

        let end = b"end_header\n";
        let body = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let header: Vec<&str> = std::str::from_utf8(&bytes[..body])
            .unwrap()
            .lines()
            .filter(|l| !l.starts_with("comment"))
            .collect();
        let expected = "ply|format binary_little_endian 1.0|element vertex 3|property double \
            x|property double y|property double z|\
            property float amplitude|property float phase|element face 2|property list uchar int \
            vertex_indices|end_header";
        assert_eq!(header.join("|"), expected);

        let mut rest = &bytes[body..];
        let mut take = |n: usize| rest.split_off(..n).expect("the body is long enough");
        for i in 0..3 {
            for k in 0..3 {
                assert_eq!(
                    f64::from_le_bytes(take(8).try_into().unwrap()).to_bits(),
                    positions[i][k].to_bits()
                );
            }
            assert_eq!(f32::from_le_bytes(take(4).try_into().unwrap()), amplitude[i] as f32);
            assert_eq!(f32::from_le_bytes(take(4).try_into().unwrap()), phase[i] as f32);
        }
        for face in faces {
            assert_eq!(take(1), [3]);
            assert_eq!(
                face.map(|_| i32::from_le_bytes(take(4).try_into().unwrap()) as usize),
                face
            );
        }
        assert!(rest.is_empty());
    }

    #[test]
    fn unusable_values_are_told() {
        let p = [Vec3::zeros(); 3];
        let message = |values: &[(&str, &[f64])]| {
            write(&mut Vec::new(), &p, &[[0, 1, 2]], values).unwrap_err().to_string()
        };
        assert!(message(&[("a", &[0.0])]).contains("1 values of 'a' for 3 vertices"));
        for name in ["", "two words", "x", "é"] {
            assert!(message(&[(name, &[0.0; 3])]).contains("cannot name a value"), "{name}");
        }
        assert!(message(&[("a", &[0.0; 3]), ("a", &[0.0; 3])]).contains("cannot name a value"));
    }
}
