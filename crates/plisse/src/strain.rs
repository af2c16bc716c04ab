//! Strain of a pose against the rest metric, per face: where the surface is shorter than it wants
//! to be.

use crate::mesh::{Mat2, Mat3x2, Topology, Vec2, Vec3};
use crate::rest::RestMetric;

/// Strain of one face, in its orthonormal rest frame.
///
/// The strain here is Ê = L⁻¹(a − ā)L⁻ᵀ = FᵀF − I, as in eq. 2 of [Chen 2021]: *twice* the Green
/// strain.
#[derive(Clone, Copy, Debug)]
pub struct FaceStrain {
    /// Ê (no unit), symmetric.
    pub strain: Mat2,
    /// F (no unit): differential of the pose from the orthonormal rest frame.
    pub deformation: Mat3x2,
    /// Principal strains, lower first.
    pub principal: [f64; 2],
    /// Unit principal directions in the rest frame, in the order of [`FaceStrain::principal`]; the
    /// second is the first turned by +90°.
    pub directions: [Vec2; 2],
}

impl FaceStrain {
    /// Strain of a face whose differential from the orthonormal rest frame is `deformation`.
    pub fn new(deformation: Mat3x2) -> Self {
        let strain = deformation.transpose() * deformation - Mat2::identity();
        let (principal, first) = principal_pair(&strain);
        Self { strain, deformation, principal, directions: [first, Vec2::new(-first.y, first.x)] }
    }

    /// True if the face is in a mixed state: pressed in one principal direction, not in the other.
    pub fn is_mixed(&self) -> bool {
        self.principal[0] <= 0.0 && self.principal[1] >= 0.0
    }
}

/// `[F]` strain of the pose `positions` (`[V]`, m).
pub fn strain(topology: &Topology, rest: &RestMetric, positions: &[Vec3]) -> Vec<FaceStrain> {
    topology
        .faces
        .iter()
        .zip(&rest.faces)
        .map(|(face, rest)| FaceStrain::new(rest.deformation(face.map(|v| positions[v]))))
        .collect()
}

/// Eigenvalues (lower first) of a symmetric `m` and the unit eigenvector of the lower one.
pub fn principal_pair(m: &Mat2) -> ([f64; 2], Vec2) {
    let (mean, half) = (0.5 * m.trace(), 0.5 * (m[(0, 0)] - m[(1, 1)]));
    let radius = half.hypot(m[(0, 1)]);
    if radius == 0.0 {
        return ([mean, mean], Vec2::x());
    }
    // The direction of the higher eigenvalue is at half the angle of (half, off-diagonal).
    let angle = 0.5 * m[(0, 1)].atan2(half);
    let (s, c) = angle.sin_cos();
    ([mean - radius, mean + radius], Vec2::new(-s, c))
}

/// `[V]` largest compression (%) of `pose` (`[V]`, m) in the faces around each vertex; 0 where
/// nothing is compressed.
pub fn compression_percent(topology: &Topology, rest: &RestMetric, pose: &[Vec3]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; pose.len()];
    for (face, strain) in topology.faces.iter().zip(strain(topology, rest, pose)) {
        // Ê is twice the strain.
        let percent = 50.0 * (-strain.principal[0]).max(0.0);
        face.iter().for_each(|&v| largest[v] = largest[v].max(percent));
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_values_and_directions_rebuild_the_matrix() {
        for k in 0..40 {
            let v = |s: f64| (k as f64 * s).sin();
            let m = Mat2::new(v(1.3), v(0.7), v(0.7), v(2.1));
            let ([low, high], d) = principal_pair(&m);
            let e = Vec2::new(-d.y, d.x);
            assert!(low <= high);
            assert!((d * d.transpose() * low + e * e.transpose() * high - m).norm() < 1e-14);
        }
    }

    #[test]
    fn a_shortened_sheet_is_pressed_along_the_short_way() {
        let deformation = Mat3x2::new(0.9, 0.0, 0.0, 1.2, 0.0, 0.0);
        let s = FaceStrain::new(deformation);
        assert!(
            (s.principal[0] - (0.81 - 1.0)).abs() < 1e-15 && (s.principal[1] - 0.44).abs() < 1e-15
        );
        assert!(s.directions[0].x.abs() > 1.0 - 1e-12 && s.is_mixed());
    }
}
