//! Bending of triangles with mid-edge normals (appendix A of [Chen 2021]; Grinspun et al. 2003 and
//! 2006; Weischedel 2012), for shells that are flat at rest. Unlike [`super::quadratic_bending`] it
//! follows the stretch of the faces and tells Gaussian from mean curvature; it is not quadratic in
//! positions.
//!
//! The normal of a face runs linearly between the normals n̂ₖ at the middles of its edges, each
//! along the average of the two face normals there (on the boundary the face's own). Only the part
//! of n̂ₖ along the face's plane bends it, and that part is perpendicular to edge k, so in the
//! orthonormal rest frame the second fundamental form is
//!
//! II = Σₖ sₖ·ĝₖĝₖᵀ, with sₖ = ⅔·Hₖ·(2 sin(θₖ/2) + tan(θₖ/2)),
//!
//! where ĝₖ is the gradient of the barycentric coordinate of the corner opposite edge k, Hₖ (m) the
//! height *in the pose* of that corner over the edge and θₖ the signed dihedral angle: 0 when flat,
//! positive when both faces rise towards their outside. sₖ (m) is the *bend* of the hinge; it is 0
//! on the boundary. The energy h³/12·‖II‖²_SV·area is then ½sᵀQs with a constant positive
//! semidefinite Q, and its Gauss–Newton Hessian is convex without repair.
//!
//! The length of n̂ₖ makes the function of θₖ, and all choices agree up to θ³: the average itself,
//! as in [Chen 2021], gives sin θₖ, the unit average 2·sin(θₖ/2), a part of 1 along the face's own
//! normal 2·tan(θₖ/2). But the first lets a fold beyond a right angle shut for nothing, and the
//! second changes its sign at θ = ±π: where a face comes to lie on its neighbour the energy has a
//! jump, from which no Newton step leads on. The tangent grows without bound there and keeps the
//! faces apart, and is too stiff before. The sum above does that, too, and is Hₖ·θₖ up to θ⁵.
//!
//! Limits: a hinge on a face whose area fell below [`LEAST_AREA`] of its rest area counts as flat;
//! a side on the boundary adds nothing, which errs by the order of the edge length. The average of
//! two face normals is the normal of the smooth surface only where the two faces form a
//! parallelogram: on a regular lattice the energy converges to that of a plate, on an irregular
//! mesh it stays too high (on our panels by some 14 % for a roll, 31 % for a saddle, 7 % for a
//! dome) however fine the mesh.

use std::ops::AddAssign;

use nalgebra::{SMatrix, SVector};

use crate::linalg::PsdProjection;
use crate::material::Material;
use crate::mesh::{Mat3, NONE, Topology, Vec3};
use crate::rest::RestMetric;

/// Share of its rest area (no unit) below which a face has no normal to speak of, and its hinges
/// count as flat.
pub const LEAST_AREA: f64 = 1e-6;

/// cos(θ/2) (no unit) below which a hinge counts as shut: its energy grows no further.
const SHUT: f64 = 1e-8;

/// Gradient (J/m) in the coordinates of an element's six vertices: x, y, z of the first, of the
/// second, ….
pub type ElementGradient = SVector<f64, 18>;
/// Hessian (J/m²) in the same coordinates.
pub type ElementHessian = SMatrix<f64, 18, 18>;

/// The bending energy of a mesh, a sum over elements: each is one face with the far corners of its
/// neighbours.
#[derive(Clone, Debug)]
pub struct MidEdgeBending {
    elements: Vec<Element>,
}

#[derive(Clone, Copy, Debug)]
struct Element {
    vertices: [usize; 6],
    /// Q (J/m²): the energy is ½sᵀQs in the bends s of the face's sides 0→1, 1→2, 2→0.
    stiffness: Mat3,
    /// Twice the least area (m²) that the face, and the neighbour across each side, must keep.
    least_own: f64,
    least_across: [f64; 3],
}

impl MidEdgeBending {
    /// The bending of `topology` with this rest metric.
    pub fn new(topology: &Topology, rest: &RestMetric, material: &Material) -> Self {
        let least = |f: usize| 2.0 * LEAST_AREA * rest.faces[f].area_m2;
        let element = |f: usize| {
            let face = topology.faces[f];
            let (mut vertices, mut least_across) =
                ([face[0], face[1], face[2], NONE, NONE, NONE], [0.0; 3]);
            for k in 0..3 {
                if let Some(g) = topology.neighbour(f, k) {
                    let side = topology.face_edges[g]
                        .iter()
                        .position(|&e| e == topology.face_edges[f][k])
                        .expect("they share the edge");
                    vertices[3 + k] = topology.faces[g][(side + 2) % 3];
                    least_across[k] = least(g);
                }
            }
            // ‖Σ sₖ·ggᵀ‖²_SV = Σ sₖsₗ·(α/2·|gₖ|²|gₗ|² + β·(gₖ·gₗ)²).
            let corner = rest.faces[f].barycentric_gradients();
            let g = [corner[2], corner[0], corner[1]];
            let scale = material.thickness_m.powi(3) / 6.0 * rest.faces[f].area_m2;
            let stiffness = Mat3::from_fn(|k, l| {
                scale
                    * (material.alpha() / 2.0 * g[k].norm_squared() * g[l].norm_squared()
                        + material.beta() * g[k].dot(&g[l]).powi(2))
            });
            Element { vertices, stiffness, least_own: least(f), least_across }
        };
        Self { elements: (0..topology.face_count()).map(element).collect() }
    }

    /// The vertices on which the energy of face `f` depends: its three corners, then the far corner
    /// of the neighbour across sides 0→1, 1→2, 2→0, [`NONE`] on the boundary. A vertex may occur
    /// twice (where three faces meet): its shares add up.
    pub fn vertices(&self, f: usize) -> [usize; 6] {
        self.elements[f].vertices
    }

    /// Energy (J) of face `f` with the vertices at `pose` (`[V]`, m).
    pub fn energy(&self, f: usize, pose: &[Vec3]) -> f64 {
        let element = &self.elements[f];
        let bends = bends(&element.hinges(pose));
        0.5 * bends.dot(&(element.stiffness * bends))
    }

    /// Gradient (J/m) of the energy of face `f`, as in [`MidEdgeBending::derivatives`].
    pub fn gradient(&self, f: usize, pose: &[Vec3]) -> ElementGradient {
        let element = &self.elements[f];
        let hinges = element.hinges(pose);
        let moments = element.stiffness * bends(&hinges);
        let mut gradient = ElementGradient::zeros();
        for (k, hinge) in hinges.iter().enumerate() {
            let Some(hinge) = hinge else { continue };
            for (place, slope) in
                [k, (k + 1) % 3, (k + 2) % 3, 3 + k].into_iter().zip(hinge.gradient())
            {
                gradient.fixed_rows_mut::<3>(3 * place).add_assign(&(slope * moments[k]));
            }
        }
        gradient
    }

    /// Energy (J), gradient and Hessian of face `f` with the vertices at `pose` (`[V]`, m), in the
    /// coordinates of [`MidEdgeBending::vertices`]; rows of missing vertices are 0. With
    /// [`PsdProjection::None`] the Hessian is the true one, Σ Qₖₗ·∇sₖ∇sₗᵀ + Σ (Qs)ₖ·∇²sₖ; otherwise
    /// it is the first sum alone (Gauss–Newton), which is positive semidefinite and true where the
    /// surface is flat.
    pub fn derivatives(
        &self,
        f: usize,
        pose: &[Vec3],
        projection: PsdProjection,
    ) -> (f64, ElementGradient, ElementHessian) {
        let element = &self.elements[f];
        let hinges = element.hinges(pose);
        let bends = bends(&hinges);
        let moments = element.stiffness * bends;
        let mut jacobian = SMatrix::<f64, 18, 3>::zeros();
        let mut hessian = ElementHessian::zeros();
        for (k, hinge) in hinges.iter().enumerate() {
            let Some(hinge) = hinge else { continue };
            // Places in the element of the ends of the side, its own far corner and the
            // neighbour's.
            let places = [k, (k + 1) % 3, (k + 2) % 3, 3 + k];
            for (place, slope) in places.into_iter().zip(hinge.gradient()) {
                jacobian.fixed_view_mut::<3, 1>(3 * place, k).copy_from(&slope);
            }
            if projection == PsdProjection::None {
                hinge.add_hessian(moments[k], places, &mut hessian);
            }
        }
        hessian.gemm(1.0, &(jacobian * element.stiffness), &jacobian.transpose(), 1.0);
        (0.5 * bends.dot(&moments), jacobian * moments, hessian)
    }
}

impl Element {
    /// The hinges at the three sides; none where the boundary is, or a face without area.
    fn hinges(&self, pose: &[Vec3]) -> [Option<Hinge>; 3] {
        std::array::from_fn(|k| {
            let [i, j, c] = [k, (k + 1) % 3, (k + 2) % 3].map(|corner| pose[self.vertices[corner]]);
            let far = *pose.get(self.vertices[3 + k])?;
            Some(Hinge::new(
                Wing::new(i, j, c, self.least_own)?,
                Wing::new(j, i, far, self.least_across[k])?,
            ))
        })
    }
}

fn bends(hinges: &[Option<Hinge>; 3]) -> Vec3 {
    Vec3::from_fn(|k, _| hinges[k].as_ref().map_or(0.0, Hinge::bend))
}

/// One face seen from its edge i→j, as a flap with tip c.
///
/// When the vertices move by di, dj, dc, the tip moves against its foot on the edge by δ = dc −
/// (1−t)di − t·dj and the edge changes by de = dj − di: everything below is written in these two.
/// To first order the height grows by m·δ and the flap turns about the edge by n·δ/H.
#[derive(Clone, Copy, Debug)]
struct Wing {
    /// t (no unit): foot of the tip on the edge, 0 at i and 1 at j.
    foot: f64,
    /// H (m): distance of the tip from the edge.
    height: f64,
    /// Length of the edge (m).
    length: f64,
    /// Orthonormal and right-handed: along the edge, from the edge to the tip (m), face normal (n).
    along: Vec3,
    inward: Vec3,
    normal: Vec3,
}

impl Wing {
    fn new(i: Vec3, j: Vec3, tip: Vec3, least_double_area: f64) -> Option<Self> {
        let (edge, side) = (j - i, tip - i);
        let cross = edge.cross(&side);
        let (double_area, length) = (cross.norm(), edge.norm());
        if double_area.is_nan() || double_area <= least_double_area {
            return None;
        }
        let (along, normal) = (edge / length, cross / double_area);
        let foot = side.dot(&along) / length;
        Some(Self {
            foot,
            height: double_area / length,
            length,
            along,
            inward: normal.cross(&along),
            normal,
        })
    }

    /// Weights of di, dj and dc in δ.
    fn tip_weights(&self) -> [f64; 3] {
        [self.foot - 1.0, -self.foot, 1.0]
    }
}

/// Weights of di, dj and dc in de.
const EDGE_WEIGHTS: [f64; 3] = [-1.0, 1.0, 0.0];

/// Two faces at an edge: the element's own, and the neighbour, which runs along the edge the other
/// way.
#[derive(Clone, Copy, Debug)]
struct Hinge {
    own: Wing,
    other: Wing,
    /// sin(θ/2), cos(θ/2), and their ratio tan(θ/2).
    half_sin: f64,
    half_cos: f64,
    tangent: f64,
}

impl Hinge {
    fn new(own: Wing, other: Wing) -> Self {
        // Half sums and differences of unit normals: no inverse functions, accurate at θ = 0 and at
        // θ = ±π.
        let half_sin =
            (0.5 * (own.normal - other.normal).norm()).copysign(other.normal.dot(&own.inward));
        let half_cos = (0.5 * (own.normal + other.normal).norm()).max(SHUT);
        Self { own, other, half_sin, half_cos, tangent: half_sin / half_cos }
    }

    /// s = ⅔·H·(2 sin(θ/2) + tan(θ/2)) (m).
    fn bend(&self) -> f64 {
        self.own.height * self.slopes()[0]
    }

    /// s = H·f(θ): f, f′ and f″.
    fn slopes(&self) -> [f64; 3] {
        let (sin, cos, tan) = (self.half_sin, self.half_cos, self.tangent);
        let secant_squared = 1.0 + tan * tan;
        [
            (4.0 * sin + 2.0 * tan) / 3.0,
            (2.0 * cos + secant_squared) / 3.0,
            (tan * secant_squared - sin) / 3.0,
        ]
    }

    /// ∇H and ∇θ in i, j, own tip, other tip.
    fn height_and_angle(&self) -> ([Vec3; 4], [Vec3; 4]) {
        let ([i, j, tip], [other_j, other_i, far]) =
            (self.own.tip_weights(), self.other.tip_weights());
        let (m, own, other) = (
            self.own.inward,
            self.own.normal / self.own.height,
            self.other.normal / self.other.height,
        );
        (
            [m * i, m * j, m * tip, Vec3::zeros()],
            [own * i + other * other_i, own * j + other * other_j, own * tip, other * far],
        )
    }

    /// ∇s = f·∇H + H·f′·∇θ.
    fn gradient(&self) -> [Vec3; 4] {
        let (height, angle) = self.height_and_angle();
        let [by_height, slope, _] = self.slopes();
        let by_angle = self.own.height * slope;
        std::array::from_fn(|v| height[v] * by_height + angle[v] * by_angle)
    }

    /// Adds `scale`·∇²s to the `hessian` of an element in which i, j and the two tips have these
    /// places: ∇²s = f·∇²H + f′·(∇H∇θᵀ + ∇θ∇Hᵀ) + H·f″·∇θ∇θᵀ + H·f′·∇²θ.
    ///
    /// With the flap's H, and twice because second derivatives are symmetric, the second variations
    /// are d²H = (n·δ)²/H − 2(e·δ)(m·de)/|e| − H(m·de)²/|e|² and, summed over both flaps, d²θ =
    /// −2(m·δ)(n·δ)/H² − 2(e·δ)(n·de)/(|e|H) − (m·de)(n·de)/|e|², with the unit vector e along the
    /// edge. The latter are the hinge derivatives of Tamstorf & Grinspun 2013, in other letters.
    fn add_hessian(&self, scale: f64, places: [usize; 4], hessian: &mut ElementHessian) {
        let (height, angle) = self.height_and_angle();
        let mut add = |v: usize, u: usize, block: &Mat3| {
            let (row, column) = (3 * places[v], 3 * places[u]);
            hessian.fixed_view_mut::<3, 3>(row, column).add_assign(block);
            if u != v {
                hessian.fixed_view_mut::<3, 3>(column, row).add_assign(&block.transpose());
            }
        };
        let [by_height, mixed, bend] = self.slopes().map(|slope| slope * scale);
        let (by_angle, squared) = (self.own.height * mixed, self.own.height * bend);
        for v in 0..4 {
            let (left, right) = (angle[v] * mixed, height[v] * mixed + angle[v] * squared);
            for u in 0..=v {
                add(v, u, &(left * height[u].transpose() + right * angle[u].transpose()));
            }
        }
        for (wing, by_height, corners) in
            [(&self.own, by_height, [0, 1, 2]), (&self.other, 0.0, [1, 0, 3])]
        {
            let (e, m, n) = (wing.along, wing.inward, wing.normal);
            let (h, length) = (wing.height, wing.length);
            let shear = m * n.transpose() + n * m.transpose();
            // Second variation: δ·(tips δ) + 2δ·(both de) + de·(edges de).
            let tips = n * n.transpose() * (by_height / h) - shear * (by_angle / (h * h));
            let both = e * (m * by_height + n * (by_angle / h)).transpose() / -length;
            let edges = (m * m.transpose() * (by_height * h) + shear * (0.5 * by_angle))
                / (-length * length);
            let tip = wing.tip_weights();
            for v in 0..3 {
                let (by_tip, by_edge) = (
                    tips * tip[v] + both.transpose() * EDGE_WEIGHTS[v],
                    both * tip[v] + edges * EDGE_WEIGHTS[v],
                );
                for u in 0..=v {
                    add(corners[v], corners[u], &(by_tip * tip[u] + by_edge * EDGE_WEIGHTS[u]));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::{gradient_error, hessian_error};
    use crate::linalg::psd_projection::eigen;
    use crate::mesh::Mat2;
    use crate::mesh::panel::{Outline, Panel};

    fn random(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// A face (0) with three neighbours (on two boundary edges each), a random pose in which the
    /// neighbours are folded by `fold` (rad).
    fn rosette(seed: u64, fold: [f64; 3]) -> (MidEdgeBending, Vec<Vec3>) {
        let mut r = random(seed);
        let rest: [[f64; 2]; 6] =
            [[0.0, 0.0], [1.0, 0.1], [0.3, 0.8], [0.6, -0.7], [1.1, 0.9], [-0.6, 0.5]];
        let faces = vec![[0, 1, 2], [1, 0, 3], [2, 1, 4], [0, 2, 5]];
        let topology = Topology::new(6, faces).unwrap();
        let flat = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
        let metric = RestMetric::from_shape(&flat, &topology.faces).unwrap();
        let mut pose = flat.map(|p| p + 0.15 * Vec3::new(r(), r(), 0.0)).to_vec();
        for k in 0..3 {
            let (i, along) = (pose[k], (pose[(k + 1) % 3] - pose[k]).normalize());
            let turn = nalgebra::Rotation3::new(along * -fold[k]);
            pose[3 + k] = i + turn * (pose[3 + k] - i);
        }
        let turn = nalgebra::Rotation3::new(2.0 * Vec3::new(r(), r(), r()));
        pose.iter_mut().for_each(|p| *p = turn * *p + Vec3::x());
        (MidEdgeBending::new(&topology, &metric, &Material::new(12.0, 0.4, 1.0).unwrap()), pose)
    }

    const FOLDS: [[f64; 3]; 5] =
        [[0.0; 3], [0.3, -0.2, 0.1], [1.2, 1.3, -0.7], [2.5, -2.5, 0.0], [-2.4, -2.2, -2.5]];

    #[test]
    fn derivatives_agree_with_differences_inside_and_at_the_boundary() {
        for (seed, fold) in (0..20).zip(FOLDS.iter().cycle()) {
            let (bending, pose) = rosette(seed, *fold);
            for f in 0..4 {
                // The element's coordinates, with zeros for missing vertices, and back.
                let vertices = bending.vertices(f);
                let x: Vec<f64> = vertices
                    .iter()
                    .flat_map(|&v| pose.get(v).map_or([0.0; 3], |p| [p.x, p.y, p.z]))
                    .collect();
                let at = |x: &[f64]| {
                    let mut pose = pose.clone();
                    vertices
                        .iter()
                        .zip(x.chunks(3))
                        .filter(|(v, _)| **v != NONE)
                        .for_each(|(v, p)| pose[*v].copy_from_slice(p));
                    pose
                };
                let (energy, gradient, hessian) =
                    bending.derivatives(f, &pose, PsdProjection::None);
                assert_eq!(energy, bending.energy(f, &pose));
                if energy > 1e-20 {
                    let e =
                        gradient_error(&x, 1.0, gradient.as_slice(), |y| bending.energy(f, &at(y)));
                    assert!(e < 1e-7, "gradient {e:e} face {f} {fold:?}");
                }
                let slope = |y: &[f64]| {
                    bending.derivatives(f, &at(y), PsdProjection::None).1.as_slice().to_vec()
                };
                let e = hessian_error(&x, 1.0, hessian.as_slice(), slope);
                assert!(e < 1e-7, "hessian {e:e} face {f} {fold:?}");
            }
        }
    }

    #[test]
    fn gauss_newton_is_convex_and_true_where_flat() {
        for (seed, fold) in (0..10).zip(FOLDS.iter().cycle()) {
            let (bending, pose) = rosette(seed, *fold);
            for f in 0..4 {
                let (_, _, h) = bending.derivatives(f, &pose, PsdProjection::Clamp);
                let lowest = eigen(&h).0.into_iter().fold(f64::INFINITY, f64::min);
                assert!(lowest >= -1e-13 * h.norm(), "{lowest:e}");
                let differs =
                    (bending.derivatives(f, &pose, PsdProjection::None).2 - h).norm() / h.norm();
                assert_eq!(
                    differs < 1e-13,
                    *fold == [0.0; 3] || (f == 3 && fold[2] == 0.0),
                    "{differs:e} {fold:?}"
                );
            }
        }
    }

    #[test]
    fn a_single_hinge_has_its_closed_form() {
        let (topology, flat) = (
            Topology::new(4, vec![[0, 1, 2], [1, 0, 3]]).unwrap(),
            [[0.0, 0.0], [2.0, 0.0], [0.6, 1.5], [1.1, -1.0]],
        );
        let flat = flat.map(|[x, y]| Vec3::new(x, y, 0.0));
        let rest = RestMetric::from_shape(&flat, &topology.faces).unwrap();
        let material = Material::new(12.0, 0.25, 0.1).unwrap();
        let bending = MidEdgeBending::new(&topology, &rest, &material);
        for theta in [-2.5_f64, -0.1, 0.7, 2.0, 3.1] {
            let mut pose = flat;
            pose[3] = Vec3::new(1.1, -theta.cos(), theta.sin());
            for (f, height) in [(0, 1.5), (1, 1.0)] {
                let curvature =
                    2.0 / 3.0 * (2.0 * (theta / 2.0).sin() + (theta / 2.0).tan()) / height;
                let plate = 1e-3 / 12.0
                    * (material.alpha() / 2.0 + material.beta())
                    * curvature
                    * curvature
                    * height;
                assert!((bending.energy(f, &pose) / plate - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn rigid_motions_and_mirrors_change_nothing_and_stretching_is_free() {
        let (bending, pose) = rosette(3, FOLDS[2]);
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.8, 1.3);
        let moved: Vec<Vec3> = pose.iter().map(|p| turn * p + Vec3::new(1.0, -2.0, 3.0)).collect();
        let mirrored: Vec<Vec3> = pose.iter().map(|p| Vec3::new(-p.x, p.y, p.z)).collect();
        let (_, flat) = rosette(4, FOLDS[0]);
        let stretched: Vec<Vec3> = flat
            .iter()
            .map(|p| Mat3::new(1.3, 0.2, 0.0, -0.4, 0.6, 0.1, 0.0, 0.3, 1.1) * p)
            .collect();
        for f in 0..4 {
            let energy = bending.energy(f, &pose);
            assert!((bending.energy(f, &moved) / energy - 1.0).abs() < 1e-12);
            assert!((bending.energy(f, &mirrored) / energy - 1.0).abs() < 1e-12);
            assert!(bending.energy(f, &stretched) < 1e-28 * energy);
        }
    }

    #[test]
    fn poses_without_area_stay_finite() {
        let (bending, good) = rosette(5, FOLDS[1]);
        let folded_shut =
            rosette(6, [std::f64::consts::PI, -std::f64::consts::PI, std::f64::consts::PI - 1e-7])
                .1;
        let on_a_line: Vec<Vec3> = good.iter().map(|p| Vec3::new(p.x, 0.0, 0.0)).collect();
        let (mut no_edge, mut thin) = (good.clone(), good.clone());
        no_edge[1] = no_edge[0];
        thin[2] = 0.5 * (thin[0] + thin[1]) + 1e-9 * (thin[2] - thin[0]);
        for pose in [folded_shut, vec![Vec3::x(); 6], on_a_line, no_edge, thin] {
            for f in 0..4 {
                let (energy, gradient, hessian) =
                    bending.derivatives(f, &pose, PsdProjection::None);
                assert!(
                    energy.is_finite()
                        && gradient.iter().chain(hessian.iter()).all(|v| v.is_finite())
                );
            }
        }
    }

    /// A sheet 2 m × 1 m large: an irregular panel, or a regular lattice of parallelograms.
    fn sheet(edge: f64, regular: bool) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        if !regular {
            let panel =
                Panel::new(&Outline::Rectangle { width_m: 2.0, height_m: 1.0 }, edge, 3).unwrap();
            return (
                panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect(),
                panel.faces,
            );
        }
        let n = (1.0 / edge).round() as usize;
        let row = 2 * n + 1;
        let at = |v: usize| {
            Vec3::new((v % row) as f64 + 0.3 * (v / row) as f64, (v / row) as f64, 0.0) * edge
        };
        let corners = (0..n * row).filter(|v| (v + 1) % row != 0);
        (
            (0..row * (n + 1)).map(at).collect(),
            corners.flat_map(|v| [[v, v + 1, v + row], [v + 1, v + row + 1, v + row]]).collect(),
        )
    }

    /// Stored over closed-form energy, less 1, of a sheet with this pose and second form: of all
    /// faces, and of those that have three neighbours.
    fn plate_error(
        edge: f64,
        regular: bool,
        form: Mat2,
        pose: impl Fn(f64, f64) -> Vec3,
    ) -> [f64; 2] {
        let (flat, faces) = sheet(edge, regular);
        let topology = Topology::new(flat.len(), faces).unwrap();
        let rest = RestMetric::from_shape(&flat, &topology.faces).unwrap();
        let material = Material::new(1e6, 0.3, 1e-2).unwrap();
        let bending = MidEdgeBending::new(&topology, &rest, &material);
        let posed: Vec<Vec3> = flat.iter().map(|p| pose(p.x, p.y)).collect();
        let density = material.thickness_m.powi(3) / 12.0 * material.norm_squared(&form);
        [false, true].map(|inner| {
            let faces = (0..topology.face_count())
                .filter(|&f| !inner || !bending.vertices(f).contains(&NONE));
            let (energy, area) = faces.fold((0.0, 0.0), |(e, a), f| {
                (e + bending.energy(f, &posed), a + rest.faces[f].area_m2)
            });
            energy / (density * area) - 1.0
        })
    }

    /// The surface z = ½pᵀ·form·p over p = (x, y).
    fn graph(form: Mat2) -> impl Fn(f64, f64) -> Vec3 {
        move |x, y| {
            Vec3::new(
                x,
                y,
                0.5 * form[(0, 0)] * x * x + form[(0, 1)] * x * y + 0.5 * form[(1, 1)] * y * y,
            )
        }
    }

    #[test]
    fn a_bent_lattice_stores_the_energy_of_a_plate() {
        // Faces on the boundary lack a neighbour: with them the error falls with the edge length,
        // without them with its square.
        let r = 1.5;
        let roll = |x: f64, y: f64| Vec3::new(r * (x / r).sin(), y, r * (x / r).cos());
        let [coarse, fine] = [0.1, 0.05]
            .map(|edge| plate_error(edge, true, Mat2::new(1.0 / r, 0.0, 0.0, 0.0), roll));
        assert!(
            fine[0].abs() < 0.02 && fine[0].abs() < 0.55 * coarse[0].abs(),
            "{coarse:?} {fine:?}"
        );
        assert!(
            fine[1].abs() < 2e-4 && fine[1].abs() < 0.27 * coarse[1].abs(),
            "{coarse:?} {fine:?}"
        );
        // A saddle, a dome, and something between.
        for form in [
            Mat2::new(0.0, 1e-3, 1e-3, 0.0),
            Mat2::identity() * 1e-3,
            Mat2::new(1e-3, 5e-4, 5e-4, -2e-3),
        ] {
            let [all, inner] = plate_error(0.05, true, form, graph(form));
            assert!(all.abs() < 0.05 && inner.abs() < 1e-4, "{all} {inner} {form}");
        }
    }

    #[test]
    fn an_irregular_sheet_is_too_stiff_however_fine_it_is() {
        let (roll, saddle, dome) = (
            Mat2::new(1e-3, 0.0, 0.0, 0.0),
            Mat2::new(0.0, 1e-3, 1e-3, 0.0),
            Mat2::identity() * 1e-3,
        );
        for (form, too_much) in [(roll, 0.14), (saddle, 0.31), (dome, 0.065)] {
            for edge in [0.1, 0.05, 0.025] {
                let [_, inner] = plate_error(edge, false, form, graph(form));
                assert!((inner - too_much).abs() < 0.03, "{inner} {form}");
            }
        }
    }
}
