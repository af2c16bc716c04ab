//! Triangles of round shapes, for pictures.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::perpendicular;
use crate::mesh::Vec3;

/// Vertices around a body of revolution.
pub(super) const AROUND: usize = 48;
/// Number of times that each face of the icosahedron is cut in four.
const HALVINGS: usize = 4;

/// Unit directions and outward faces (5,120) of an icosahedron, halved and blown up to the sphere.
pub(super) fn unit_sphere() -> (Vec<Vec3>, Vec<[usize; 3]>) {
    icosphere(HALVINGS)
}

/// The icosahedron with each face cut in four `halvings` times.
pub(super) fn icosphere(halvings: usize) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let golden = (1.0 + 5.0f64.sqrt()) / 2.0;
    let mut directions: Vec<Vec3> = Vec::new();
    for k in 0..3 {
        for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            let mut corner = Vec3::zeros();
            corner[k] = s;
            corner[(k + 1) % 3] = t * golden;
            directions.push(corner.normalize());
        }
    }
    // Faces are the triples at the least distance from each other.
    let side = (directions[0] - directions[1]).norm() * 1.01;
    let near = |i: usize, j: usize| (directions[i] - directions[j]).norm() < side;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outward = directions[i].dot(&directions[j].cross(&directions[k])) > 0.0;
                    faces.push(if outward { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    for _ in 0..halvings {
        let mut middles = BTreeMap::new();
        let mut finer = Vec::with_capacity(4 * faces.len());
        for face in &faces {
            let middle = [0, 1, 2].map(|k| {
                let (i, j) = (face[k], face[(k + 1) % 3]);
                *middles.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                    directions.push((directions[i] + directions[j]).normalize());
                    directions.len() - 1
                })
            });
            finer.extend((0..3).map(|k| [face[k], middle[k], middle[(k + 2) % 3]]));
            finer.push(middle);
        }
        faces = finer;
    }
    (directions, faces)
}

/// Two triangles for each of `columns` × `rows` quads over vertices numbered row by row, facing
/// first × second axis.
pub(super) fn grid(columns: usize, rows: usize) -> Vec<[usize; 3]> {
    let quads = (0..rows).flat_map(|j| (0..columns).map(move |i| j * (columns + 1) + i));
    quads
        .flat_map(|v| [[v, v + 1, v + columns + 2], [v, v + columns + 2, v + columns + 1]])
        .collect()
}

/// The body that `outline` (distance along the axis and off it) sweeps around the unit `axis`
/// through `origin`, with a pole at `start` before its first ring and one at `end` after its last,
/// all m.
pub(super) fn revolve(
    origin: &Vec3,
    axis: &Vec3,
    start: f64,
    outline: &[[f64; 2]],
    end: f64,
) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let u = perpendicular(axis);
    let v = axis.cross(&u);
    let mut positions = vec![origin + axis * start];
    for &[along, off] in outline {
        for k in 0..AROUND {
            let (sin, cos) = (TAU * k as f64 / AROUND as f64).sin_cos();
            positions.push(origin + axis * along + (u * cos + v * sin) * off);
        }
    }
    positions.push(origin + axis * end);
    let at = |ring: usize, k: usize| 1 + ring * AROUND + k % AROUND;
    let (last, tip) = (outline.len() - 1, positions.len() - 1);
    let mut faces = Vec::new();
    for k in 0..AROUND {
        faces.push([0, at(0, k + 1), at(0, k)]);
        for ring in 0..last {
            faces.push([at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)]);
            faces.push([at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)]);
        }
        faces.push([at(last, k), at(last, k + 1), tip]);
    }
    (positions, faces)
}
