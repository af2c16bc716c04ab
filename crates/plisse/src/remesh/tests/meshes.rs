//! Meshes to try remeshing on. All coordinates are multiples of 2⁻²⁰, so that middles, and linear
//! functions of them, are exact.

use super::super::SurfaceMesh;
use crate::mesh::panel::{Outline, Panel};
use crate::mesh::{Vec2, Vec3};
pub(super) use crate::random::Random;
use crate::rest::RestMetric;

fn round(p: Vec3) -> Vec3 {
    p.map(|x| (x * 1048576.0).round() / 1048576.0)
}

/// A linear function of the place; exact for rounded ones.
pub(super) fn linear(p: &Vec3) -> f64 {
    3.0 * p.x - 2.0 * p.y + 0.5 * p.z + 1.0
}

/// A sheet at rest, with a linear channel 2 beside λ = 1 m and a growth of 1.
pub(super) fn sheet(positions: Vec<Vec3>, faces: Vec<[usize; 3]>) -> SurfaceMesh {
    let positions: Vec<Vec3> = positions.into_iter().map(round).collect();
    let rest = RestMetric::from_shape(&positions, &faces).unwrap().faces;
    let n = positions.len();
    let channels = vec![vec![1.0; n], vec![1.0; n], positions.iter().map(linear).collect()];
    SurfaceMesh {
        faces,
        rest,
        start: positions.clone(),
        positions,
        channels,
        frozen: vec![[false; 3]; n],
        uvs: None,
    }
}

/// The unit sphere: an octahedron whose faces are divided in `n`² parts, shaken by `jitter` of an
/// edge.
pub(super) fn sphere(n: usize, jitter: f64, random: &mut Random) -> SurfaceMesh {
    let axis = |k: usize, s: f64| Vec3::ith(k, s);
    let mut positions: Vec<Vec3> = Vec::new();
    let mut faces = Vec::new();
    let mut vertex = |p: Vec3| match positions.iter().position(|q| (q - p).norm() < 1e-9) {
        Some(v) => v,
        None => {
            positions.push(p);
            positions.len() - 1
        }
    };
    for octant in 0..8 {
        let sign = |k: usize| if octant >> k & 1 == 0 { 1.0 } else { -1.0 };
        let (a, mut b, mut c) = (axis(0, sign(0)), axis(1, sign(1)), axis(2, sign(2)));
        if sign(0) * sign(1) * sign(2) < 0.0 {
            (b, c) = (c, b);
        }
        let mut at = |i: usize, j: usize| {
            vertex((a * (n - i - j) as f64 + b * i as f64 + c * j as f64) / n as f64)
        };
        for i in 0..n {
            for j in 0..n - i {
                faces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < n {
                    faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    let size = jitter * 1.5 / n as f64;
    let shaken = |p: Vec3| {
        (p.normalize() + Vec3::new(random.signed(), random.signed(), random.signed()) * size)
            .normalize()
    };
    sheet(positions.into_iter().map(shaken).collect(), faces)
}

/// A torus of radii 1 m and 0.4 m, `n` by `m` cells, shaken.
pub(super) fn torus(n: usize, m: usize, jitter: f64, random: &mut Random) -> SurfaceMesh {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let (u, v) = (i as f64 + jitter * random.signed(), j as f64 + jitter * random.signed());
            let (u, v) =
                (u * std::f64::consts::TAU / n as f64, v * std::f64::consts::TAU / m as f64);
            let r = 1.0 + 0.4 * v.cos();
            positions.push(Vec3::new(r * u.cos(), r * u.sin(), 0.4 * v.sin()));
            let at = |i: usize, j: usize| (i % n) * m + j % m;
            faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    sheet(positions, faces)
}

/// An irregular unit square of edges about `edge` (m).
pub(super) fn square(edge: f64, seed: u64) -> SurfaceMesh {
    let panel =
        Panel::new(&Outline::Rectangle { width_m: 1.0, height_m: 1.0 }, edge, seed).unwrap();
    sheet(panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect(), panel.faces)
}

/// An irregular annulus: a boundary of two loops.
pub(super) fn annulus(edge: f64, seed: u64) -> SurfaceMesh {
    let panel =
        Panel::new(&Outline::Annulus { inner_radius_m: 0.4, outer_radius_m: 1.0 }, edge, seed)
            .unwrap();
    sheet(panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect(), panel.faces)
}

/// Texture places in two islands: faces whose middle is left of x = 0.5 m lie elsewhere than the
/// others.
pub(super) fn with_seam(mut sheet: SurfaceMesh) -> SurfaceMesh {
    let uv = |face: &[usize; 3]| {
        let middle = face.iter().map(|&v| sheet.start[v].x).sum::<f64>() / 3.0;
        let shift = if middle < 0.5 { 0.0 } else { 4.0 };
        face.map(|v| Vec2::new(sheet.start[v].x + shift, 2.0 * sheet.start[v].y))
    };
    sheet.uvs = Some(sheet.faces.iter().map(uv).collect());
    sheet
}
