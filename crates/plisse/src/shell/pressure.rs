//! Pressure inside a closed surface (Skouras et al. 2014): the energy −p·V, V being the volume
//! enclosed.
//!
//! V is the sum over faces of x₀·(x₁ × x₂)/6, which for a closed surface does not depend on the
//! origin. The Hessian of a face does, and only the sum over all faces has a meaning; it is
//! indefinite.

use super::tension_field::{FaceGradient, FaceHessian};
use crate::mesh::{Mat3, Topology, Vec3};

/// Volume (m³) that the closed surface encloses; positive if faces run counter-clockwise seen from
/// outside.
pub fn volume_m3(topology: &Topology, pose: &[Vec3]) -> f64 {
    let origin = pose[0];
    topology.faces.iter().map(|face| signed_volume(&face.map(|v| pose[v] - origin))).sum()
}

/// A face's part of the volume: of the tetrahedron with the origin.
pub(super) fn signed_volume(x: &[Vec3; 3]) -> f64 {
    x[0].dot(&x[1].cross(&x[2])) / 6.0
}

/// Gradient of [`signed_volume`] in the nine coordinates of the face's corners.
pub(super) fn gradient(x: &[Vec3; 3]) -> FaceGradient {
    let mut out = FaceGradient::zeros();
    for k in 0..3 {
        out.fixed_rows_mut::<3>(3 * k).copy_from(&(x[(k + 1) % 3].cross(&x[(k + 2) % 3]) / 6.0));
    }
    out
}

/// Hessian of [`signed_volume`].
pub(super) fn hessian(x: &[Vec3; 3]) -> FaceHessian {
    let mut out = FaceHessian::zeros();
    for k in 0..3 {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        let block: Mat3 = x[last].cross_matrix() / -6.0;
        out.fixed_view_mut::<3, 3>(3 * k, 3 * next).copy_from(&block);
        out.fixed_view_mut::<3, 3>(3 * next, 3 * k).copy_from(&block.transpose());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::{gradient_error, hessian_error};

    #[test]
    fn derivatives_agree_with_differences() {
        let x = [0.3, -0.2, 0.9, 1.1, 0.4, -0.3, -0.6, 0.8, 0.5];
        let at =
            |y: &[f64]| std::array::from_fn(|k| Vec3::new(y[3 * k], y[3 * k + 1], y[3 * k + 2]));
        assert!(
            gradient_error(&x, 1.0, gradient(&at(&x)).as_slice(), |y| signed_volume(&at(y))) < 1e-8
        );
        assert!(
            hessian_error(&x, 1.0, hessian(&at(&x)).as_slice(), |y| gradient(&at(y))
                .as_slice()
                .to_vec())
                < 1e-8
        );
    }

    #[test]
    fn a_tetrahedron_has_its_volume_wherever_it_is() {
        let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let topology = Topology::new(4, faces).unwrap();
        for shift in [Vec3::zeros(), Vec3::new(3.0, -2.0, 7.0)] {
            let pose = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()].map(|p| p + shift);
            assert!((volume_m3(&topology, &pose) - 1.0 / 6.0).abs() < 1e-14);
        }
    }
}
