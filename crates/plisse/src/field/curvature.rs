//! Robust curvature of a coarse surface: a quadric fitted around every vertex (Panozzo et al. 2010,
//! as the paper's E.3).
//!
//! The height field of a fit stands on the tangent plane of its own vertex, not of the whole patch:
//! over the mean plane, the rim of an inflated disk would come out a third too flat.

use nalgebra::{Matrix2, Matrix3x2, Rotation3, SMatrix, SVector};
use rayon::prelude::*;

use crate::adjacency::Csr;
use crate::mesh::normals::vertex_normals;
use crate::mesh::{Mat3, Topology, Vec3};

/// `[F]` second fundamental form (1/m) of the surface at each face, as a symmetric tensor of space:
/// its value on a tangent vector t is tᵀSt. It is the mean of the forms that quadrics, fitted to
/// `rings` rings of vertices around each corner, have there, each turned from its own tangent plane
/// into the face's.
pub fn second_forms(topology: &Topology, positions: &[Vec3], rings: usize) -> Vec<Mat3> {
    let normals = vertex_normals(topology, positions);
    let neighbours = topology.vertex_neighbours();
    let at_vertices: Vec<Fit> = (0..topology.vertex_count)
        .into_par_iter()
        .map_init(
            || vec![false; topology.vertex_count],
            |seen, v| fit(v, positions, &normals, &neighbours, rings, seen),
        )
        .collect();
    topology
        .faces
        .iter()
        .map(|&face| {
            let [a, b, c] = face.map(|v| positions[v]);
            let normal = (b - a).cross(&(c - a));
            let mut sum = Mat3::zeros();
            for v in face {
                let turn = Rotation3::rotation_between(&at_vertices[v].normal, &normal)
                    .unwrap_or_else(Rotation3::identity);
                sum += turn * at_vertices[v].form * turn.transpose();
            }
            sum / 3.0
        })
        .collect()
}

/// A quadric's second fundamental form at a vertex, and its normal there.
struct Fit {
    form: Mat3,
    normal: Vec3,
}

fn fit(
    v: usize,
    positions: &[Vec3],
    normals: &[Vec3],
    neighbours: &Csr,
    rings: usize,
    seen: &mut [bool],
) -> Fit {
    let normal = normals[v];
    let flat = Fit { form: Mat3::zeros(), normal };
    if normal == Vec3::zeros() {
        return flat;
    }
    let mut patch = vec![v];
    seen[v] = true;
    let mut start = 0;
    for _ in 0..rings {
        let end = patch.len();
        for at in start..end {
            for &u in &neighbours[patch[at]] {
                if !seen[u] {
                    seen[u] = true;
                    patch.push(u);
                }
            }
        }
        start = end;
    }
    for &u in &patch {
        seen[u] = false;
    }
    let axis = if normal.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
    let ex = (axis - normal * axis.dot(&normal)).normalize();
    let ey = normal.cross(&ex);
    // z = ½Lx² + Mxy + ½Ny² + dx + ey through the vertex, in units of the patch's size.
    let size = patch.iter().map(|&u| (positions[u] - positions[v]).norm()).fold(0.0, f64::max);
    if size == 0.0 {
        return flat;
    }
    let mut normal_matrix = SMatrix::<f64, 5, 5>::zeros();
    let mut right = SVector::<f64, 5>::zeros();
    for &u in &patch[1..] {
        // What turns away is on another side of the surface: a height field over the tangent plane
        // cannot describe it.
        if normals[u].dot(&normal) <= 0.0 {
            continue;
        }
        let d = (positions[u] - positions[v]) / size;
        let (x, y, z) = (d.dot(&ex), d.dot(&ey), d.dot(&normal));
        let row = SVector::<f64, 5>::from([0.5 * x * x, x * y, 0.5 * y * y, x, y]);
        normal_matrix += row * row.transpose();
        right += row * z;
    }
    // Nearly collinear patches (a strip one face wide) leave a direction undetermined: there the
    // curvature counts as zero.
    let floor = 1e-9 * normal_matrix.trace();
    for i in 0..5 {
        normal_matrix[(i, i)] += floor;
    }
    let Some(cholesky) = normal_matrix.cholesky() else { return flat };
    let q = cholesky.solve(&right);
    // Lifted to the fitted surface: its tangent vectors are (1, 0, d) and (0, 1, e).
    let (d, e) = (q[3], q[4]);
    let tangents = Matrix3x2::from_columns(&[ex + normal * d, ey + normal * e]);
    let Some(inverse) = (tangents.transpose() * tangents).try_inverse() else { return flat };
    let second = Matrix2::new(q[0], q[1], q[1], q[2]) / (size * (1.0 + d * d + e * e).sqrt());
    let lift = tangents * inverse;
    Fit { form: lift * second * lift.transpose(), normal: (normal - ex * d - ey * e).normalize() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An irregular patch of a grid over [−1, 1]², bent by `height`.
    fn bent(n: usize, height: impl Fn(f64, f64) -> f64) -> (Topology, Vec<Vec3>) {
        let jitter = |i: usize, j: usize| {
            0.3 * (((i * 7 + j * 13) as f64 * 0.618).fract() - 0.5) * 2.0 / n as f64
        };
        let mut positions = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let x = 2.0 * i as f64 / n as f64 - 1.0 + jitter(i, j);
                let y = 2.0 * j as f64 / n as f64 - 1.0 + jitter(j + 5, i);
                positions.push(Vec3::new(x, y, height(x, y)));
            }
        }
        let at = |i: usize, j: usize| j * (n + 1) + i;
        let faces = (0..n * n)
            .flat_map(|k| {
                let (i, j) = (k % n, k / n);
                [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ]
            })
            .collect();
        (Topology::new(positions.len(), faces).unwrap(), positions)
    }

    #[test]
    fn a_parabolic_sheet_has_its_curvature_everywhere_near_the_top() {
        let (t, p) = bent(20, |x, y| 0.5 * (0.2 * x * x - 0.1 * y * y));
        for rings in [2, 3, 5] {
            let forms = second_forms(&t, &p, rings);
            for (f, face) in t.faces.iter().enumerate() {
                let c = (p[face[0]] + p[face[1]] + p[face[2]]) / 3.0;
                if c.x.hypot(c.y) < 0.4 {
                    let (kx, ky) = (forms[f][(0, 0)], forms[f][(1, 1)]);
                    assert!(
                        (kx - 0.2).abs() < 0.01 && (ky + 0.1).abs() < 0.01,
                        "{rings} rings: {kx} {ky}"
                    );
                }
            }
        }
    }
}
