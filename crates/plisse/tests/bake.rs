//! Baked maps against closed forms: plane waves on flat sheets, islands, padding, frames.

use std::f64::consts::TAU;

use plisse::bake::{Baked, Coverage, Options, Sample, Surface, bake, field_sampler, png16};
use plisse::field::WrinkleField;
use plisse::mesh::{Topology, Vec2, Vec3};

/// A sheet of `n × n` squares in the unit square, lifted into space by `place`, with uv = (x, y)
/// mapped by `texture`.
struct Sheet {
    topology: Topology,
    flat: Vec<Vec2>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
}

fn sheet(
    n: usize,
    normal: Vec3,
    place: impl Fn(f64, f64) -> Vec3,
    texture: impl Fn(f64, f64) -> Vec2,
) -> Sheet {
    let flat: Vec<Vec2> = (0..(n + 1) * (n + 1))
        .map(|i| Vec2::new((i % (n + 1)) as f64, (i / (n + 1)) as f64) / n as f64)
        .collect();
    let at = |i: usize, j: usize| j * (n + 1) + i;
    let squares = (0..n * n).map(|k| (k % n, k / n));
    let faces = squares
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    Sheet {
        topology: Topology::new(flat.len(), faces).unwrap(),
        positions: flat.iter().map(|p| place(p.x, p.y)).collect(),
        normals: vec![normal; flat.len()],
        uvs: flat.iter().map(|p| texture(p.x, p.y)).collect(),
        flat,
    }
}

impl Sheet {
    fn surface(&self) -> Surface<'_> {
        let faces = &self.topology.faces[..];
        Surface {
            positions: &self.positions,
            normals: &self.normals,
            faces,
            uvs: &self.uvs,
            uv_faces: faces,
        }
    }

    /// A wave along (kx, ky) of the flat sheet, with amplitude a + b·x.
    fn wave(&self, [kx, ky]: [f64; 2], a: f64, b: f64) -> WrinkleField {
        let phase = |v: usize| kx * self.flat[v].x + ky * self.flat[v].y + 0.3;
        WrinkleField {
            amplitude_m: self.flat.iter().map(|p| a + b * p.x).collect(),
            omega: vec![0.0; self.topology.edge_count()],
            phase: self.topology.faces.iter().map(|f| f.map(phase)).collect(),
            wrinkle_free: vec![false; self.topology.face_count()],
        }
    }

    fn baked(&self, field: &WrinkleField, size: usize, padding: usize) -> Baked {
        bake(
            &self.surface(),
            field_sampler(&self.topology, &self.positions, field),
            &Options { size, padding },
        )
        .unwrap()
    }
}

fn unit(n: usize) -> Sheet {
    sheet(n, Vec3::z(), |x, y| Vec3::new(x, y, 0.0), Vec2::new)
}

#[test]
fn a_plane_wave_on_the_unit_square_is_exact_at_every_texel() {
    let (k, a, b, n) = ([5.0 * TAU, -3.0 * TAU], 0.01, 0.02, 128);
    let sheet = unit(7);
    let baked = sheet.baked(&sheet.wave(k, a, b), n, 4);
    assert_eq!((baked.overlapping, baked.missed_faces), (0, 0));
    assert!(baked.coverage.iter().all(|&c| c == Coverage::Covered));
    for row in 0..n {
        for column in 0..n {
            let (x, y) = ((column as f64 + 0.5) / n as f64, 1.0 - (row as f64 + 0.5) / n as f64);
            let (sin, cos) = (k[0] * x + k[1] * y + 0.3).sin_cos();
            let amplitude = a + b * x;
            let at = row * n + column;
            assert!((f64::from(baked.height_m[at]) - amplitude * cos).abs() < 1e-8);
            let gradient = Vec2::new(b * cos - amplitude * k[0] * sin, -amplitude * k[1] * sin);
            let normal = Vec3::new(-gradient.x, -gradient.y, 1.0).normalize();
            assert!(
                (0..3).all(|i| (f64::from(baked.normal[at][i]) - normal[i]).abs() < 1e-6),
                "{normal} {:?}",
                baked.normal[at]
            );
        }
    }
    // The measure tells another wave.
    let other = sheet.baked(&sheet.wave([k[0], -k[1]], a, b), n, 4);
    assert!(other.height_m.iter().zip(&baked.height_m).any(|(x, y)| (x - y).abs() > 0.01));
}

#[test]
fn tangent_space_follows_turned_scaled_and_mirrored_texture() {
    // The sheet stands upright in space, three times as large; its wave runs along its own x.
    let place = |x: f64, y: f64| Vec3::new(0.0, 3.0 * x, 3.0 * y);
    let normal = Vec3::x();
    type Unwrapping = fn(f64, f64) -> Vec2;
    let list: [(Unwrapping, Vec2); 3] = [
        (|x, y| Vec2::new(0.1 + 0.5 * x, 0.2 + 0.5 * y), Vec2::new(1.0, 0.0)),
        (|x, y| Vec2::new(0.9 - 0.5 * y, 0.1 + 0.5 * x), Vec2::new(0.0, 1.0)),
        (|x, y| Vec2::new(0.9 - 0.5 * x, 0.1 + 0.5 * y), Vec2::new(-1.0, 0.0)),
    ];
    for (texture, along) in list {
        let sheet = sheet(5, normal, place, texture);
        let baked = sheet.baked(&sheet.wave([4.0 * TAU, 0.0], 0.05, 0.0), 100, 0);
        let covered: Vec<usize> =
            (0..100 * 100).filter(|&i| baked.coverage[i] == Coverage::Covered).collect();
        assert!((2300..2700).contains(&covered.len()), "{}", covered.len());
        let mut steepest = 0.0f64;
        for i in covered {
            let [x, y, z] = baked.normal[i].map(f64::from);
            assert!((x * along.y - y * along.x).abs() < 1e-6, "across the wave it is level");
            let slope = -(x * along.x + y * along.y) / z;
            let cos = f64::from(baked.height_m[i]) / 0.05;
            assert!(
                (slope.abs() - 0.05 * 4.0 * TAU / 3.0 * (1.0 - cos * cos).max(0.0).sqrt()).abs()
                    < 1e-3
            );
            steepest = steepest.max(slope);
        }
        assert!(steepest > 0.4);
    }
}

#[test]
fn the_green_channel_points_up_the_picture() {
    // Height grows with v: the normal leans down, away from it.
    let sheet = unit(2);
    let ramp = |_: usize, _: [f64; 3]| Sample { height_m: 0.0, gradient: Vec3::new(0.2, 1.0, 0.0) };
    let baked = bake(&sheet.surface(), ramp, &Options { size: 4, padding: 0 }).unwrap();
    assert!(baked.normal.iter().all(|n| n[1] < -0.6 && n[0] < -0.1 && n[2] > 0.6));
}

#[test]
fn islands_are_padded_without_holes() {
    let near = sheet(
        3,
        Vec3::z(),
        |x, y| Vec3::new(x, y, 0.0),
        |x, y| Vec2::new(0.1 + 0.3 * x, 0.3 + 0.4 * y),
    );
    let far = sheet(
        3,
        Vec3::z(),
        |x, y| Vec3::new(x, y, 0.0),
        |x, y| Vec2::new(0.6 + 0.3 * x, 0.3 + 0.4 * y),
    );
    let shift = near.positions.len();
    let join = |a: &[Vec3], b: &[Vec3]| [a, b].concat();
    let (positions, normals) =
        (join(&near.positions, &far.positions), join(&near.normals, &far.normals));
    let uvs = [&near.uvs[..], &far.uvs[..]].concat();
    let mut faces = near.topology.faces.clone();
    faces.extend(far.topology.faces.iter().map(|f| f.map(|v| v + shift)));
    let surface = Surface {
        positions: &positions,
        normals: &normals,
        faces: &faces,
        uvs: &uvs,
        uv_faces: &faces,
    };
    let half = near.topology.face_count();
    let value = |f: usize, _: [f64; 3]| Sample {
        height_m: if f < half { 1.0 } else { -2.0 },
        gradient: Vec3::new(0.5, 0.0, 0.0),
    };
    let (n, padding) = (100, 6);
    let baked = bake(&surface, value, &Options { size: n, padding }).unwrap();
    let gap = |x: f64, low: f64, high: f64| (low - x).max(x - high).max(0.0);
    for at in 0..n * n {
        let (u, v) = (((at % n) as f64 + 0.5) / n as f64, 1.0 - ((at / n) as f64 + 0.5) / n as f64);
        let distance = |low: f64| n as f64 * gap(u, low, low + 0.3).max(gap(v, 0.3, 0.7));
        let (to_near, to_far) = (distance(0.1), distance(0.6));
        let nearest = to_near.min(to_far);
        let wanted = if nearest <= 1e-6 {
            Coverage::Covered
        } else if nearest < padding as f64 {
            Coverage::Padded
        } else {
            Coverage::None
        };
        assert_eq!(baked.coverage[at], wanted, "({u}, {v})");
        let height = match (wanted, to_near < to_far) {
            (Coverage::None, _) => 0.0,
            (_, true) => 1.0,
            (_, false) => -2.0,
        };
        assert!((baked.height_m[at] - height).abs() < 1e-5);
        let [x, y, z] = baked.normal[at];
        assert!(
            (x * x + y * y + z * z - 1.0).abs() < 1e-5 && (wanted == Coverage::None) == (z == 1.0)
        );
    }
}

#[test]
fn overlaps_and_missed_faces_are_counted() {
    let one = unit(1);
    let twice = [one.topology.faces.clone(), one.topology.faces.clone()].concat();
    let surface = Surface { faces: &twice, uv_faces: &twice, ..one.surface() };
    let first = |f: usize, _: [f64; 3]| Sample { height_m: f as f64, ..Sample::default() };
    let baked = bake(&surface, first, &Options { size: 10, padding: 2 }).unwrap();
    // The diagonal's 10 texels lie on an edge of both.
    assert_eq!((baked.overlapping, baked.missed_faces), (90, 2));
    assert!(baked.height_m.iter().all(|&h| h < 2.0));
    let flat = vec![Vec2::new(0.5, 0.5); 4];
    let baked =
        bake(&Surface { uvs: &flat, ..one.surface() }, first, &Options { size: 10, padding: 2 })
            .unwrap();
    assert_eq!((baked.missed_faces, baked.overlapping), (2, 0));
    assert!(baked.coverage.iter().all(|&c| c == Coverage::None));
}

#[test]
fn bad_input_is_told_in_one_sentence() {
    let sheet = sheet(1, Vec3::z(), |x, y| Vec3::new(x, y, 0.0), |x, y| Vec2::new(2.0 * x, y));
    let zero = |_: usize, _: [f64; 3]| Sample::default();
    let message =
        bake(&sheet.surface(), zero, &Options { size: 8, padding: 0 }).unwrap_err().to_string();
    assert!(message.contains("(2.0000, 0.0000)") && message.contains("; pack"), "{message}");
    let good = unit(1);
    for size in [0, 100_000] {
        assert!(
            bake(&good.surface(), zero, &Options { size, padding: 0 })
                .unwrap_err()
                .to_string()
                .contains("give 1 to")
        );
    }
    assert!(
        bake(&Surface { normals: &[], ..good.surface() }, zero, &Options { size: 8, padding: 0 })
            .is_err()
    );
    assert!(
        bake(
            &Surface { uv_faces: &[[0, 1, 9]; 2], ..good.surface() },
            zero,
            &Options { size: 8, padding: 0 }
        )
        .is_err()
    );
    let nan = |_: usize, _: [f64; 3]| Sample { height_m: 0.0, gradient: Vec3::repeat(f64::NAN) };
    let baked = bake(&good.surface(), nan, &Options { size: 8, padding: 1 }).unwrap();
    assert!(baked.normal.iter().flatten().all(|x| x.is_finite()));
}

#[test]
fn maps_come_back_from_their_files() {
    let sheet = unit(3);
    let baked = sheet.baked(&sheet.wave([TAU, 0.0], 0.02, 0.0), 16, 0);
    let decoded = |file: &[u8]| {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height, info.bit_depth), (16, 16, png::BitDepth::Sixteen));
        let texts: Vec<(String, String)> = reader
            .info()
            .uncompressed_latin1_text
            .iter()
            .map(|t| (t.keyword.clone(), t.text.clone()))
            .collect();
        let values: Vec<f64> = bytes
            .chunks_exact(2)
            .map(|b| (f64::from(u16::from_be_bytes([b[0], b[1]])) - 32768.0) / 32767.0)
            .collect();
        (values, texts)
    };
    let mut file = Vec::new();
    png16::write_height(&mut file, &baked, 0.025).unwrap();
    let (values, texts) = decoded(&file);
    let scale: f64 = texts.iter().find(|t| t.0 == png16::SCALE_KEY).unwrap().1.parse().unwrap();
    assert_eq!(scale, 0.025);
    assert!(
        values
            .iter()
            .zip(&baked.height_m)
            .all(|(v, &h)| (v * scale - f64::from(h)).abs() < 0.025 / 65000.0)
    );
    let mut file = Vec::new();
    png16::write_normal(&mut file, &baked).unwrap();
    let (values, _) = decoded(&file);
    assert!(
        values
            .iter()
            .zip(baked.normal.iter().flatten())
            .all(|(v, &x)| (v - f64::from(x)).abs() < 1.6e-5)
    );
    assert!(png16::write_height(&mut Vec::new(), &baked, 0.0).is_err());
}
