//! The rest metric: what length every edge wants to have. It belongs to faces, so that the panels
//! of a sewn garment and duplicates along a seam need no special case.

use crate::Result;
use crate::error::MeshError;
use crate::mesh::{Mat2, Mat3x2, Vec2, Vec3};

/// The rest metric of one face.
///
/// The first fundamental form ā (m²) is given in the face's barycentric frame (edge 0→1, edge 0→2)
/// as ā = L Lᵀ. In the orthonormal rest frame that L defines, a vector with barycentric components
/// b is Lᵀb, a one-form ω is L⁻¹ω and a form M is L⁻¹ M L⁻ᵀ; the first frame vector points along
/// edge 0→1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestFace {
    /// L⁻¹ (1/m), lower triangular.
    pub inverse_root: Mat2,
    /// Area (m²).
    pub area_m2: f64,
}

impl RestFace {
    /// The metric of a triangle with these corners (m), in the plane or in space.
    pub fn from_corners(corners: [Vec3; 3]) -> Self {
        let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
        Self::from_form(Mat2::new(u.norm_squared(), u.dot(&v), u.dot(&v), v.norm_squared()))
    }

    /// The metric with first fundamental form `form` (m²), symmetric positive definite, in the
    /// barycentric frame.
    pub fn from_form(form: Mat2) -> Self {
        let l11 = form[(0, 0)].sqrt();
        let l21 = form[(1, 0)] / l11;
        let l22 = (form[(1, 1)] - l21 * l21).max(0.0).sqrt();
        let inverse_root = Mat2::new(1.0 / l11, 0.0, -l21 / (l11 * l22), 1.0 / l22);
        Self { inverse_root, area_m2: 0.5 * l11 * l22 }
    }

    /// The two edges 0→1 and 0→2 (m) laid out in the orthonormal rest frame: the columns of Lᵀ.
    pub fn edges(&self) -> [Vec2; 2] {
        let l11 = 1.0 / self.inverse_root[(0, 0)];
        let l22 = 1.0 / self.inverse_root[(1, 1)];
        [Vec2::new(l11, 0.0), Vec2::new(-self.inverse_root[(1, 0)] * l11 * l22, l22)]
    }

    /// Gradients (1/m) of the three barycentric coordinates in the orthonormal rest frame.
    pub fn barycentric_gradients(&self) -> [Vec2; 3] {
        let (g1, g2) = (self.one_form(1.0, 0.0), self.one_form(0.0, 1.0));
        [-(g1 + g2), g1, g2]
    }

    /// A one-form, given by its values along edge 0→1 and edge 0→2, in the orthonormal rest frame
    /// (value's unit per metre).
    pub fn one_form(&self, along_01: f64, along_02: f64) -> Vec2 {
        self.inverse_root * Vec2::new(along_01, along_02)
    }

    /// F (no unit): the differential of the face's embedding with these corners (m), from the
    /// orthonormal rest frame.
    pub fn deformation(&self, corners: [Vec3; 3]) -> Mat3x2 {
        Mat3x2::from_columns(&[corners[1] - corners[0], corners[2] - corners[0]])
            * self.inverse_root.transpose()
    }
}

/// `[F]` the rest metric of every face.
#[derive(Clone, Debug, PartialEq)]
pub struct RestMetric {
    /// One metric a face.
    pub faces: Vec<RestFace>,
}

impl RestMetric {
    /// The metric of a rest shape: `positions` (m) of its vertices and the `[F][3]` corners of its
    /// faces. The rest shape may have more vertices than the surface (panels, seam duplicates);
    /// only its faces correspond.
    ///
    /// # Errors
    /// [`MeshError::NoRestArea`] naming the first face without area.
    pub fn from_shape(positions: &[Vec3], faces: &[[usize; 3]]) -> Result<Self> {
        let faces: Vec<RestFace> =
            faces.iter().map(|f| RestFace::from_corners(f.map(|v| positions[v]))).collect();
        let no_area =
            |f: &RestFace| !(f.area_m2 > 0.0 && f.inverse_root.iter().all(|v| v.is_finite()));
        if let Some(face) = faces.iter().position(no_area) {
            return Err(MeshError::NoRestArea { face }.into());
        }
        Ok(Self { faces })
    }

    /// Total area (m²).
    pub fn area_m2(&self) -> f64 {
        self.faces.iter().map(|f| f.area_m2).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    fn triangle() -> [Vec3; 3] {
        [Vec3::new(0.3, -1.0, 2.0), Vec3::new(1.3, 0.2, 2.5), Vec3::new(-0.4, 0.9, 1.1)]
    }

    #[test]
    fn the_frame_keeps_lengths_angles_and_area() {
        let c = triangle();
        let face = RestFace::from_corners(c);
        let [u, v] = face.edges();
        let (x, y) = (c[1] - c[0], c[2] - c[0]);
        assert!((u.dot(&v) - x.dot(&y)).abs() < 1e-14);
        assert!((v.norm() - y.norm()).abs() < 1e-14);
        assert!((face.area_m2 - 0.5 * x.cross(&y).norm()).abs() < 1e-14);
        // A one-form that is the differential of a linear function gives back its values on the
        // edges.
        let form = face.one_form(0.7, -1.1);
        assert!((form.dot(&u) - 0.7).abs() < 1e-14 && (form.dot(&v) + 1.1).abs() < 1e-14);
    }

    #[test]
    fn an_undeformed_face_has_unit_deformation() {
        let c = triangle();
        let f = RestFace::from_corners(c).deformation(c);
        assert!((f.transpose() * f - Mat2::identity()).norm() < 1e-13);
    }

    #[test]
    fn a_face_without_area_is_named() {
        let p = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::x() * 2.0];
        let error = RestMetric::from_shape(&p, &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert!(matches!(error, Error::Mesh { problem: MeshError::NoRestArea { face: 1 }, .. }));
    }
}
