//! Membrane energy of one face that resists tension but not compression: the relaxed St.
//! Venant–Kirchhoff energy of appendix B of [Chen 2021].
//!
//! With the principal strains λ₁ ≥ λ₂ of Ê = FᵀF − I the density is 0 where both are negative
//! (slack), the energy of uniaxial stress Y/2·λ₁² where λ₂ < −νλ₁ (it would wrinkle), and the St.
//! Venant–Kirchhoff one elsewhere (taut). It is convex in F, so its Hessian needs no repair. Times
//! h/4 and the rest area it is an energy in joules.

use nalgebra::{SMatrix, SVector};

use crate::linalg::PsdProjection;
use crate::material::Material;
use crate::mesh::{Mat2, Mat3, Mat3x2, Vec2, Vec3};
use crate::rest::RestFace;
use crate::strain::principal_pair;

/// Gradient in the nine coordinates of a face's corners.
pub type FaceGradient = SVector<f64, 9>;
/// Hessian in the nine coordinates of a face's corners.
pub type FaceHessian = SMatrix<f64, 9, 9>;

/// The membrane of one face.
#[derive(Clone, Copy, Debug)]
pub struct Membrane {
    gradients: [Vec2; 3],
    /// h/4 times rest area (m³).
    scale: f64,
    alpha: f64,
    beta: f64,
    poisson: f64,
    young: f64,
    compressive_stiffness: f64,
}

/// State of a face by its strain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceState {
    /// Pressed both ways: no force.
    Slack,
    /// Pulled one way, pressed the other.
    Mixed,
    /// Pulled both ways.
    Taut,
}

impl Membrane {
    /// The membrane of a face with this rest metric. `compressive_stiffness` (no unit, 0 to 1) is
    /// the share of the ordinary St. Venant–Kirchhoff resistance that is left against compression:
    /// 0 is tension field theory, a little (1e-3) keeps triangles from collapsing.
    pub fn new(rest: &RestFace, material: &Material, compressive_stiffness: f64) -> Self {
        Self {
            gradients: rest.barycentric_gradients(),
            scale: material.thickness_m / 4.0 * rest.area_m2,
            alpha: material.alpha(),
            beta: material.beta(),
            poisson: material.poisson,
            young: material.young_pa,
            compressive_stiffness,
        }
    }

    /// The face's state with its corners at `x` (m).
    pub fn state(&self, x: &[Vec3; 3]) -> FaceState {
        let f = self.deformation(x);
        self.state_of(&principal_pair(&(f.transpose() * f - Mat2::identity())).0)
    }

    /// Energy (J) with the corners at `x` (m).
    pub fn energy(&self, x: &[Vec3; 3]) -> f64 {
        let f = self.deformation(x);
        let e = f.transpose() * f - Mat2::identity();
        let full = |e: &Mat2| self.alpha / 2.0 * e.trace().powi(2) + self.beta * (e * e).trace();
        if self.compressive_stiffness == 1.0 {
            return self.scale * full(&e);
        }
        let (principal, _) = principal_pair(&e);
        let density = match self.state_of(&principal) {
            FaceState::Slack => self.compressive_stiffness * full(&e),
            FaceState::Mixed => {
                (1.0 - self.compressive_stiffness) * self.young / 2.0 * principal[1].powi(2)
                    + self.compressive_stiffness * full(&e)
            }
            FaceState::Taut => full(&e),
        };
        self.scale * density
    }

    /// Gradient (N) of the energy with the corners at `x` (m).
    pub fn gradient(&self, x: &[Vec3; 3]) -> FaceGradient {
        let f = self.deformation(x);
        let e = f.transpose() * f - Mat2::identity();
        let s = self.compressive_stiffness;
        // The energy's slope is F·(stress) along each corner's gradient.
        let mut stress = self.stress(&e);
        if s < 1.0 {
            let (principal, low) = principal_pair(&e);
            let state = self.state_of(&principal);
            stress *= if state == FaceState::Taut { 1.0 } else { s };
            if state == FaceState::Mixed {
                let high = Vec2::new(low.y, -low.x);
                stress += high * high.transpose() * ((1.0 - s) * self.young * principal[1]);
            }
        }
        let force = f * stress * (2.0 * self.scale);
        let mut gradient = FaceGradient::zeros();
        for k in 0..3 {
            gradient.fixed_rows_mut::<3>(3 * k).copy_from(&(force * self.gradients[k]));
        }
        gradient
    }

    /// Energy (J), gradient and Hessian with the corners at `x` (m). The Hessian is positive
    /// semidefinite unless there is a compressive stiffness and `projection` is
    /// [`PsdProjection::None`]: else the geometric part takes only tension into account.
    pub fn derivatives(
        &self,
        x: &[Vec3; 3],
        projection: PsdProjection,
    ) -> (f64, FaceGradient, FaceHessian) {
        let f = self.deformation(x);
        let e = f.transpose() * f - Mat2::identity();
        let s = self.compressive_stiffness;
        if s == 1.0 {
            let (energy, gradient, hessian) = self.ordinary(&f, &e, projection);
            return (energy * self.scale, gradient * self.scale, hessian * self.scale);
        }
        let (principal, low) = principal_pair(&e);
        let state = self.state_of(&principal);
        let (mut energy, mut gradient, mut hessian) =
            (0.0, FaceGradient::zeros(), FaceHessian::zeros());
        if state == FaceState::Mixed {
            let (w, g, h) = self.uniaxial(&f, &principal, low);
            energy += (1.0 - s) * w;
            gradient += g * (1.0 - s);
            hessian += h * (1.0 - s);
        }
        let share = if state == FaceState::Taut { 1.0 } else { s };
        if share > 0.0 {
            let (w, g, h) = self.ordinary(&f, &e, projection);
            energy += share * w;
            gradient += g * share;
            hessian += h * share;
        }
        (energy * self.scale, gradient * self.scale, hessian * self.scale)
    }

    fn state_of(&self, principal: &[f64; 2]) -> FaceState {
        if principal[1] < 0.0 {
            FaceState::Slack
        } else if principal[0] < -self.poisson * principal[1] {
            FaceState::Mixed
        } else {
            FaceState::Taut
        }
    }

    fn deformation(&self, x: &[Vec3; 3]) -> Mat3x2 {
        let g = &self.gradients;
        x[0] * g[0].transpose() + x[1] * g[1].transpose() + x[2] * g[2].transpose()
    }

    /// Y/2·λ₁² with λ₁ = |Fw₁|² − 1.
    fn uniaxial(
        &self,
        f: &Mat3x2,
        principal: &[f64; 2],
        low: Vec2,
    ) -> (f64, FaceGradient, FaceHessian) {
        let high = Vec2::new(low.y, -low.x);
        let (u, v) = (f * high, f * low);
        let (c, lambda) = (self.young / 2.0, principal[1]);
        let spread = principal[1] - principal[0];
        let turn = if spread > 0.0 { 2.0 * lambda / spread } else { 0.0 };
        let (mut gradient, mut hessian) = (FaceGradient::zeros(), FaceHessian::zeros());
        let along = self.gradients.map(|g| g.dot(&high));
        let across = self.gradients.map(|g| g.dot(&low));
        let shear: [Vec3; 3] = std::array::from_fn(|k| u * across[k] + v * along[k]);
        for k in 0..3 {
            gradient.fixed_rows_mut::<3>(3 * k).copy_from(&(u * (4.0 * c * lambda * along[k])));
            for l in 0..3 {
                let block = (u * u.transpose()) * (8.0 * c * along[k] * along[l])
                    + Mat3::identity() * (4.0 * c * lambda * along[k] * along[l])
                    + shear[k] * shear[l].transpose() * (2.0 * c * turn);
                hessian.fixed_view_mut::<3, 3>(3 * k, 3 * l).copy_from(&block);
            }
        }
        (c * lambda * lambda, gradient, hessian)
    }

    /// Derivative of the density of [`Membrane::ordinary`] by Ê (Pa).
    fn stress(&self, e: &Mat2) -> Mat2 {
        Mat2::identity() * (self.alpha * e.trace()) + e * (2.0 * self.beta)
    }

    /// α/2·tr²Ê + β·tr(Ê²).
    fn ordinary(
        &self,
        f: &Mat3x2,
        e: &Mat2,
        projection: PsdProjection,
    ) -> (f64, FaceGradient, FaceHessian) {
        let (alpha, beta) = (self.alpha, self.beta);
        let trace = e.trace();
        let stress = self.stress(e);
        let tension =
            if projection == PsdProjection::None { stress } else { positive_part(&stress) };
        let (mut gradient, mut hessian) = (FaceGradient::zeros(), FaceHessian::zeros());
        let moved = self.gradients.map(|g| f * g);
        let spread = f * f.transpose();
        for k in 0..3 {
            gradient
                .fixed_rows_mut::<3>(3 * k)
                .copy_from(&(f * (stress * self.gradients[k]) * 2.0));
            for l in 0..3 {
                let block = moved[k] * moved[l].transpose() * (4.0 * alpha)
                    + (spread * self.gradients[k].dot(&self.gradients[l])
                        + moved[l] * moved[k].transpose())
                        * (4.0 * beta)
                    + Mat3::identity()
                        * (2.0 * self.gradients[k].dot(&(tension * self.gradients[l])));
                hessian.fixed_view_mut::<3, 3>(3 * k, 3 * l).copy_from(&block);
            }
        }
        (alpha / 2.0 * trace * trace + beta * (e * e).trace(), gradient, hessian)
    }
}

/// `m` with its negative eigenvalues set to zero.
fn positive_part(m: &Mat2) -> Mat2 {
    let mean = 0.5 * m.trace();
    let radius = (0.5 * (m[(0, 0)] - m[(1, 1)])).hypot(m[(0, 1)]);
    let (low, high) = (mean - radius, mean + radius);
    if low >= 0.0 {
        *m
    } else if high <= 0.0 {
        Mat2::zeros()
    } else {
        // The projector onto the direction of the higher one is (m − low)/(high − low).
        (m - Mat2::identity() * low) * (high / (2.0 * radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::{gradient_error, hessian_error};
    use crate::linalg::psd_projection::eigen;

    fn membrane(stiffness: f64) -> Membrane {
        let rest = RestFace::from_corners([
            Vec3::zeros(),
            Vec3::new(1.0, 0.1, 0.0),
            Vec3::new(0.3, 0.8, 0.0),
        ]);
        Membrane::new(&rest, &Material::new(2.0, 0.4, 1.0).unwrap(), stiffness)
    }

    /// The rest triangle stretched by (1+p, 1+q), then turned in space.
    fn posed(p: f64, q: f64) -> [Vec3; 3] {
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, -0.8, 1.3);
        [[0.0, 0.0], [1.0, 0.1], [0.3, 0.8]].map(|[x, y]| {
            turn * Vec3::new(x * (1.0 + p) + 0.02 * y, y * (1.0 + q), 0.0) + Vec3::x()
        })
    }

    const STATES: [(f64, f64, FaceState); 4] = [
        (-0.1, -0.2, FaceState::Slack),
        (0.1, -0.2, FaceState::Mixed),
        (-0.3, 0.05, FaceState::Mixed),
        (0.1, 0.07, FaceState::Taut),
    ];

    #[test]
    fn derivatives_agree_with_differences_in_every_state() {
        for stiffness in [0.0, 0.01, 1.0] {
            let m = membrane(stiffness);
            for (p, q, state) in STATES {
                let x = posed(p, q);
                assert_eq!(m.state(&x), state);
                let flat: Vec<f64> = x.iter().flat_map(|v| v.iter().copied()).collect();
                let at = |y: &[f64]| {
                    std::array::from_fn(|k| Vec3::new(y[3 * k], y[3 * k + 1], y[3 * k + 2]))
                };
                let (energy, gradient, hessian) = m.derivatives(&x, PsdProjection::None);
                assert!((energy - m.energy(&x)).abs() <= 1e-14 * energy.abs());
                assert!((gradient - m.gradient(&x)).norm() <= 1e-14 * gradient.norm());
                let convex = m.derivatives(&x, PsdProjection::Clamp).2;
                assert!(eigen(&convex).0.into_iter().all(|value| value >= -1e-12 * convex.norm()));
                if energy > 0.0 {
                    let e = gradient_error(&flat, 1.0, gradient.as_slice(), |y| m.energy(&at(y)));
                    assert!(e < 1e-8, "gradient {e:e} {state:?} {stiffness}");
                    let e = hessian_error(&flat, 1.0, hessian.as_slice(), |y| {
                        m.derivatives(&at(y), PsdProjection::None).1.as_slice().to_vec()
                    });
                    assert!(e < 1e-7, "hessian {e:e} {state:?} {stiffness}");
                }
            }
        }
    }

    #[test]
    fn the_tension_field_is_convex() {
        let m = membrane(0.0);
        for (p, q, _) in STATES {
            let (_, _, h) = m.derivatives(&posed(p, q), PsdProjection::None);
            let lowest = eigen(&h).0.into_iter().fold(f64::INFINITY, f64::min);
            assert!(lowest >= -1e-12 * h.norm(), "{lowest}");
        }
    }

    #[test]
    fn energy_is_continuous_where_states_meet() {
        let m = membrane(0.0);
        // Uniaxial stress: λ₂ = −νλ₁ is the border between mixed and taut.
        let border = |extra: f64| {
            let lambda: f64 = 0.1;
            let rest = RestFace::from_corners([Vec3::zeros(), Vec3::x(), Vec3::y()]);
            let m = Membrane::new(&rest, &Material::new(2.0, 0.4, 1.0).unwrap(), 0.0);
            m.energy(&[
                Vec3::zeros(),
                Vec3::x() * (1.0 + lambda).sqrt(),
                Vec3::y() * (1.0 - 0.4 * lambda + extra).sqrt(),
            ])
        };
        assert!((border(1e-9) - border(-1e-9)).abs() < 1e-15);
        assert_eq!(m.energy(&posed(-0.1, -0.1)), 0.0);
    }

    #[test]
    fn compressive_stiffness_of_one_is_the_ordinary_shell() {
        let x = posed(-0.1, -0.2);
        assert!(membrane(1.0).energy(&x) > 0.0);
        assert!((membrane(0.25).energy(&x) / membrane(1.0).energy(&x) - 0.25).abs() < 1e-14);
    }
}
