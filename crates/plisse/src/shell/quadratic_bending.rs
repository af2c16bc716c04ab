//! Quadratic bending (Bergou et al. 2006, eq. 28 of [Chen 2021]): an energy quadratic in positions,
//! for shells that are flat at rest.
//!
//! E = h³/12·(α/2 + β)·Σ_v |(Kx)_v|²/A_v, where (Kx)_v is the integral of the Laplacian over the
//! cell of vertex v. The cell's boundary integral is the sum, over half of each *inner* edge at v,
//! of the jump of the normal derivative. Taking inner edges only is the free-boundary correction
//! (Wang et al. 2015): it makes linear functions, and so rigid and affine motions, free of energy
//! at the boundary too. Edge jumps come from the rest metric of the two faces, so seams between
//! panels need no special case.
//!
//! The paper writes α for the coefficient; the bending stiffness of a sheet that bends without
//! stretching is h³/12·(α/2 + β) = half of Yh³/(12(1 − ν²)), which is used here (with α alone a
//! sheet with ν = 0 would not resist bending).
//!
//! Limit: harmonic functions, saddles among them, cost nothing. The membrane must forbid what is
//! not isometric; a strip with free edges that hardly resists compression (tension field theory)
//! hangs from a clamp like a limp one.

use crate::material::Material;
use crate::mesh::{NONE, Topology};
use crate::rest::RestMetric;

/// The bending energy of a mesh: a weighted sum of squares of sparse linear functions of the
/// positions.
#[derive(Clone, Debug)]
pub struct QuadraticBending {
    /// `[V][…]` vertices and coefficients (1/m, times √J) of each square.
    pub rows: Vec<Vec<(usize, f64)>>,
}

impl QuadraticBending {
    /// The bending of `topology` with this rest metric.
    pub fn new(topology: &Topology, rest: &RestMetric, material: &Material) -> Self {
        let stiffness =
            material.thickness_m.powi(3) / 12.0 * (material.alpha() / 2.0 + material.beta());
        let mut cell = vec![0.0; topology.vertex_count];
        for (face, rest) in topology.faces.iter().zip(&rest.faces) {
            for &v in face {
                cell[v] += rest.area_m2 / 3.0;
            }
        }
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); topology.vertex_count];
        for e in 0..topology.edge_count() {
            let [f, g] = topology.edge_faces[e];
            if g == NONE {
                continue;
            }
            let mut jump: Vec<(usize, f64)> = Vec::with_capacity(6);
            for face in [f, g] {
                jump.extend(outflow(topology, rest, face, e));
            }
            for v in topology.edges[e] {
                rows[v].extend(jump.iter().map(|&(u, c)| (u, 0.5 * c)));
            }
        }
        for (v, row) in rows.iter_mut().enumerate() {
            row.sort_by_key(|&(u, _)| u);
            row.dedup_by(|next, kept| {
                let same = next.0 == kept.0;
                if same {
                    kept.1 += next.1;
                }
                same
            });
            let scale = (stiffness / cell[v]).sqrt();
            for (_, c) in row.iter_mut() {
                *c *= scale;
            }
        }
        Self { rows }
    }
}

/// Outflow of a function's gradient from face `f` through its edge `e`, as coefficients of the
/// function at the corners: cot γⱼ(xᵢ − xₖ) + cot γᵢ(xⱼ − xₖ) for e = ij and the opposite corner k.
fn outflow(topology: &Topology, rest: &RestMetric, f: usize, e: usize) -> [(usize, f64); 3] {
    let side =
        topology.face_edges[f].iter().position(|&x| x == e).expect("the edge belongs to the face");
    let [u, v] = rest.faces[f].edges();
    let corner = [crate::mesh::Vec2::zeros(), u, v];
    let (i, j, k) = (side, (side + 1) % 3, (side + 2) % 3);
    let double_area = 2.0 * rest.faces[f].area_m2;
    let cotangent = |at: usize, p: usize, q: usize| {
        (corner[p] - corner[at]).dot(&(corner[q] - corner[at])) / double_area
    };
    let (at_i, at_j) = (cotangent(i, j, k), cotangent(j, i, k));
    let face = topology.faces[f];
    [(face[i], at_j), (face[j], at_i), (face[k], -at_i - at_j)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Vec3;
    use crate::mesh::panel::{Outline, Panel};

    fn energy(bending: &QuadraticBending, x: &[Vec3]) -> f64 {
        bending
            .rows
            .iter()
            .map(|row| row.iter().map(|&(v, c)| x[v] * c).sum::<Vec3>().norm_squared())
            .sum()
    }

    fn sheet(edge: f64) -> (Topology, RestMetric, Vec<Vec3>, Material) {
        let panel =
            Panel::new(&Outline::Rectangle { width_m: 2.0, height_m: 1.0 }, edge, 3).unwrap();
        let flat: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(flat.len(), panel.faces).unwrap();
        let rest = RestMetric::from_shape(&flat, &topology.faces).unwrap();
        (topology, rest, flat, Material::new(1e6, 0.3, 1e-2).unwrap())
    }

    #[test]
    fn affine_motions_are_free_also_at_the_boundary() {
        let (topology, rest, flat, material) = sheet(0.1);
        let bending = QuadraticBending::new(&topology, &rest, &material);
        let moved: Vec<Vec3> = flat
            .iter()
            .map(|p| {
                Vec3::new(1.1 * p.x + 0.2 * p.y + 3.0, -0.4 * p.x + p.y, 0.7 * p.x - 0.2 * p.y)
            })
            .collect();
        let bent: Vec<Vec3> = flat.iter().map(|p| Vec3::new(p.x, p.y, p.x * p.x)).collect();
        assert!(energy(&bending, &moved) < 1e-20 * energy(&bending, &bent));
    }

    #[test]
    fn a_rolled_sheet_stores_the_energy_of_a_bent_plate() {
        // On a cylinder of radius r the energy is ½·Yh³/(12(1 − ν²))·area/r²; the error falls as
        // the mesh is refined.
        let r = 1.5;
        let error = |edge: f64| {
            let (topology, rest, flat, material) = sheet(edge);
            let bending = QuadraticBending::new(&topology, &rest, &material);
            let rolled: Vec<Vec3> = flat
                .iter()
                .map(|p| Vec3::new(r * (p.x / r).sin(), p.y, r * (p.x / r).cos()))
                .collect();
            let plate = material.young_pa * material.thickness_m.powi(3) / (12.0 * (1.0 - 0.09));
            energy(&bending, &rolled) / (0.5 * plate * 2.0 / (r * r)) - 1.0
        };
        let (coarse, fine) = (error(0.1), error(0.03));
        assert!(fine.abs() < 0.02 && fine.abs() < coarse.abs(), "{coarse} {fine}");
    }
}
