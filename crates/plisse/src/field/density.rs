//! The wrinkle energy of one face, eqs. 20–26 of [Chen 2021], as a polynomial with closed-form
//! derivatives.
//!
//! In the orthonormal rest frame, with amplitude a, its gradient d and frequency ω, the density per
//! rest area is
//!
//! ```text
//! A(d) + a² B(d, ω) + a⁴ C(ω)
//! A = k₀ + dᵀPd + k₆|d|⁴     B = ωᵀPω + k₂|ω|²|d|² + k₃(ω·d)² + k₄ + k₅|ω|⁴     C = k₇|ω|⁴
//! ```
//!
//! where only P, k₀ and k₄ differ from face to face. d and ω are constant on a face, so the
//! three-point quadrature (1/6, 1/6, 2/3) of the paper only concerns a² and a⁴. The paper's eq. 1
//! and 37 carry one ½ more than its eq. 20; without it, as here, the membrane part is the St.
//! Venant–Kirchhoff energy in joules.

use nalgebra::{SMatrix, SVector};

use crate::material::Material;
use crate::mesh::{Mat2, Mat3, Vec2};
use crate::rest::RestFace;
use crate::strain::FaceStrain;

/// Terms of eqs. 20–26 that take part. All do by default; switch one off to see its effect (the
/// paper's ablations).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    /// Eq. 21: membrane strain left over after wrinkling.
    pub stretching: bool,
    /// Eq. 22: bending of the crests over a curved base surface.
    pub curvature: bool,
    /// Eq. 23: shear from amplitude that changes along the crests.
    pub mixed: bool,
    /// Eq. 24: steep amplitude.
    pub amplitude_gradient: bool,
    /// Eq. 26: bending of the wrinkles themselves.
    pub bending: bool,
    /// In-plane correction v₁ (eq. 16): lets wrinkles adapt to the base surface's curvature.
    /// Without it the curvature term is ½‖2a ā⁻¹b‖² with the whole second form b (eq. 14 at v₁ =
    /// 0).
    pub v1: bool,
    /// In-plane correction v₂ (eq. 16): spreads strain evenly over a period. Without it eqs. 23 and
    /// 24 are those of eq. 15 at v₂ = 0.
    pub v2: bool,
}

impl Default for Terms {
    fn default() -> Self {
        Self {
            stretching: true,
            curvature: true,
            mixed: true,
            amplitude_gradient: true,
            bending: true,
            v1: true,
            v2: true,
        }
    }
}

impl Terms {
    /// Names that [`Terms::without`] knows.
    pub const NAMES: [&'static str; 7] =
        ["stretching", "curvature", "mixed", "amplitude-gradient", "bending", "v1", "v2"];

    /// These terms without the one called `name`; `None` if there is none of that name.
    #[must_use]
    pub fn without(mut self, name: &str) -> Option<Self> {
        *match name {
            "stretching" => &mut self.stretching,
            "curvature" => &mut self.curvature,
            "mixed" => &mut self.mixed,
            "amplitude-gradient" => &mut self.amplitude_gradient,
            "bending" => &mut self.bending,
            "v1" => &mut self.v1,
            "v2" => &mut self.v2,
            _ => return None,
        } = false;
        Some(self)
    }
}

/// The part of the energy (J) that each term of the paper contributes.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct EnergyTerms {
    /// Eq. 21.
    pub stretching_joule: f64,
    /// Eq. 22.
    pub curvature_joule: f64,
    /// Eq. 23.
    pub mixed_joule: f64,
    /// Eq. 24.
    pub amplitude_gradient_joule: f64,
    /// Second part of eq. 26.
    pub bending_joule: f64,
}

/// Five unknowns of a face: amplitudes at its corners (m), ω along edge 0→1 and along edge 0→2
/// (rad).
pub type Local = SVector<f64, 5>;
/// Second derivatives in the unknowns of [`Local`].
pub type LocalHessian = SMatrix<f64, 5, 5>;

/// The energy density of one face.
#[derive(Clone, Copy, Debug)]
pub struct Density {
    inverse_root: Mat2,
    area: f64,
    p: Mat2,
    k0: f64,
    k2: f64,
    k3: f64,
    k4: f64,
    k5: f64,
    k6: f64,
    k7: f64,
}

/// Amplitude at the three quadrature points.
const QUADRATURE: [[f64; 3]; 3] =
    [[1. / 6., 1. / 6., 2. / 3.], [1. / 6., 2. / 3., 1. / 6.], [2. / 3., 1. / 6., 1. / 6.]];

impl Density {
    /// The density of a face with this rest metric and strain, whose base surface has the second
    /// fundamental form `second_form` (1/m; a symmetric tensor of space, used on tangent vectors).
    pub fn new(
        rest: &RestFace,
        strain: &FaceStrain,
        second_form: &Mat3,
        material: &Material,
        terms: &Terms,
    ) -> Self {
        let (alpha, beta, h) = (material.alpha(), material.beta(), material.thickness_m);
        let on = |flag: bool| if flag { h / 4.0 } else { 0.0 };
        let gamma = alpha / 2.0 + beta;
        let e = strain.strain;
        let p = (Mat2::identity() * (alpha / 2.0 * e.trace()) + e * beta) * on(terms.stretching);
        let k0 = on(terms.stretching) * material.norm_squared(&e);
        let mut k2 = on(terms.stretching) * alpha / 4.0;
        let mut k3 = on(terms.stretching) * beta / 2.0;
        let mut k7 = on(terms.stretching) * gamma / 4.0;
        let mixed = on(terms.mixed) / if terms.v2 { 32.0 } else { 8.0 };
        k2 += mixed * 2.0 * beta;
        k3 += mixed * 2.0 * (alpha + beta);
        let steep = on(terms.amplitude_gradient) / 8.0;
        if !terms.v2 {
            k2 -= steep * alpha;
            k3 -= steep * 2.0 * beta;
            k7 += steep * gamma;
        }
        let k6 = on(terms.stretching) * gamma / 4.0 + steep * gamma;
        let k5 = if terms.bending { h * h * h / 24.0 * gamma } else { 0.0 };
        // Only in a mixed state is there a crest direction along tension (paper, 4.2).
        let form = strain.deformation.transpose() * second_form * strain.deformation;
        let k4 = if !strain.is_mixed() {
            0.0
        } else if terms.v1 {
            let crest = strain.directions[1];
            let bend = crest.dot(&(form * crest));
            on(terms.curvature) * 4.0 * beta * (alpha + beta) / (alpha + 2.0 * beta) * bend * bend
        } else {
            on(terms.curvature) * 2.0 * material.norm_squared(&form)
        };
        Self { inverse_root: rest.inverse_root, area: rest.area_m2, p, k0, k2, k3, k4, k5, k6, k7 }
    }

    /// The face's energy (J).
    pub fn energy(&self, x: &Local) -> f64 {
        let (d, w) = self.slow(x);
        let (s, t, u) = (w.norm_squared(), d.norm_squared(), w.dot(&d));
        let a = self.k0 + d.dot(&(self.p * d)) + self.k6 * t * t;
        let b =
            w.dot(&(self.p * w)) + self.k2 * s * t + self.k3 * u * u + self.k4 + self.k5 * s * s;
        let (m2, m4) = moments(x);
        self.area * (a + m2 * b + m4 * self.k7 * s * s)
    }

    /// Energy (J), gradient and Hessian in the unknowns of [`Local`].
    pub fn derivatives(&self, x: &Local) -> (f64, Local, LocalHessian) {
        let (d, w) = self.slow(x);
        let (s, t, u) = (w.norm_squared(), d.norm_squared(), w.dot(&d));
        let (pd, pw) = (self.p * d, self.p * w);
        let b = w.dot(&pw) + self.k2 * s * t + self.k3 * u * u + self.k4 + self.k5 * s * s;
        let c = self.k7 * s * s;
        let a = self.k0 + d.dot(&pd) + self.k6 * t * t;
        let a_d = (pd + d * (2.0 * self.k6 * t)) * 2.0;
        let b_w = (pw + w * (self.k2 * t + 2.0 * self.k5 * s) + d * (self.k3 * u)) * 2.0;
        let b_d = (d * (self.k2 * s) + w * (self.k3 * u)) * 2.0;
        let c_w = w * (4.0 * self.k7 * s);
        let (ww, dd, wd) = (w * w.transpose(), d * d.transpose(), w * d.transpose());
        let one = Mat2::identity();
        let a_dd = self.p * 2.0 + (one * t + dd * 2.0) * (4.0 * self.k6);
        let b_ww = self.p * 2.0
            + one * (2.0 * self.k2 * t + 4.0 * self.k5 * s)
            + dd * (2.0 * self.k3)
            + ww * (8.0 * self.k5);
        let b_dd = one * (2.0 * self.k2 * s) + ww * (2.0 * self.k3);
        let b_wd = wd * (4.0 * self.k2) + (one * u + wd.transpose()) * (2.0 * self.k3);
        let c_ww = (one * s + ww * 2.0) * (4.0 * self.k7);

        let (m2, m4) = moments(x);
        let (g2, g4, h2, h4) = moment_derivatives(x);
        let mut gradient = Local::zeros();
        let mut hessian = LocalHessian::zeros();
        // d = D·a with the constant 2×3 matrix of barycentric gradients, ω = R·(ω₀₁, ω₀₂) with R =
        // L⁻¹.
        let r = self.inverse_root;
        let gradients =
            [-(r.column(0) + r.column(1)), r.column(0).into_owned(), r.column(1).into_owned()];
        let f_d = a_d + b_d * m2;
        let f_w = b_w * m2 + c_w * m4;
        let f_dd = a_dd + b_dd * m2;
        let f_ww = r.transpose() * (b_ww * m2 + c_ww * m4) * r;
        let f_wd = r.transpose() * b_wd * m2;
        let (r_b_w, r_c_w) = (r.transpose() * b_w, r.transpose() * c_w);
        for i in 0..3 {
            gradient[i] = g2[i] * b + g4[i] * c + f_d.dot(&gradients[i]);
            for j in 0..3 {
                hessian[(i, j)] = h2[i][j] * b
                    + h4[i][j] * c
                    + g2[i] * b_d.dot(&gradients[j])
                    + g2[j] * b_d.dot(&gradients[i])
                    + gradients[i].dot(&(f_dd * gradients[j]));
            }
            let cross: Vec2 = f_wd * gradients[i] + r_b_w * g2[i] + r_c_w * g4[i];
            for k in 0..2 {
                hessian[(i, 3 + k)] = cross[k];
                hessian[(3 + k, i)] = cross[k];
            }
        }
        let along = r.transpose() * f_w;
        for k in 0..2 {
            gradient[3 + k] = along[k];
            for l in 0..2 {
                hessian[(3 + k, 3 + l)] = f_ww[(k, l)];
            }
        }
        (self.area * (a + m2 * b + m4 * c), gradient * self.area, hessian * self.area)
    }

    /// Amplitude gradient (no unit) and frequency (rad/m) in the rest frame.
    fn slow(&self, x: &Local) -> (Vec2, Vec2) {
        (
            self.inverse_root * Vec2::new(x[1] - x[0], x[2] - x[0]),
            self.inverse_root * Vec2::new(x[3], x[4]),
        )
    }
}

/// Energy by terms of a face whose density with some of the terms is `density`; their sum is
/// [`Density::energy`] with all of `terms`.
pub fn energy_terms(density: impl Fn(&Terms) -> Density, terms: &Terms, x: &Local) -> EnergyTerms {
    let none = Terms {
        stretching: false,
        curvature: false,
        mixed: false,
        amplitude_gradient: false,
        bending: false,
        ..*terms
    };
    let part = |only: Terms| density(&only).energy(x);
    EnergyTerms {
        stretching_joule: part(Terms { stretching: terms.stretching, ..none }),
        curvature_joule: part(Terms { curvature: terms.curvature, ..none }),
        mixed_joule: part(Terms { mixed: terms.mixed, ..none }),
        amplitude_gradient_joule: part(Terms {
            amplitude_gradient: terms.amplitude_gradient,
            ..none
        }),
        bending_joule: part(Terms { bending: terms.bending, ..none }),
    }
}

/// Means of a² and a⁴ by quadrature.
fn moments(x: &Local) -> (f64, f64) {
    let (mut m2, mut m4) = (0.0, 0.0);
    for n in QUADRATURE {
        let a = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
        m2 += a * a;
        m4 += a * a * a * a;
    }
    (m2 / 3.0, m4 / 3.0)
}

type Moments = ([f64; 3], [f64; 3], [[f64; 3]; 3], [[f64; 3]; 3]);

fn moment_derivatives(x: &Local) -> Moments {
    let (mut g2, mut g4, mut h2, mut h4) = ([0.0; 3], [0.0; 3], [[0.0; 3]; 3], [[0.0; 3]; 3]);
    for n in QUADRATURE {
        let a = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
        for i in 0..3 {
            g2[i] += 2.0 / 3.0 * a * n[i];
            g4[i] += 4.0 / 3.0 * a * a * a * n[i];
            for j in 0..3 {
                h2[i][j] += 2.0 / 3.0 * n[i] * n[j];
                h4[i][j] += 4.0 * a * a * n[i] * n[j];
            }
        }
    }
    (g2, g4, h2, h4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::{gradient_error, hessian_error};
    use crate::mesh::{Mat3x2, Vec3};

    /// A face in some random state.
    struct Case {
        rest: RestFace,
        strain: FaceStrain,
        second_form: Mat3,
        material: Material,
    }

    fn random(seed: u32) -> impl FnMut() -> f64 {
        let mut state = f64::from(seed) * 0.618_033_988 + 0.1;
        move || {
            state = (state * 9301.0 + 0.492_97).fract();
            state - 0.5
        }
    }

    fn case(seed: u32) -> (Case, Local) {
        let mut r = random(seed);
        let corner = |r: &mut dyn FnMut() -> f64, x: f64, y: f64| {
            Vec3::new(x + 0.3 * r(), y + 0.3 * r(), 0.0)
        };
        let rest = RestFace::from_corners([
            corner(&mut r, 0.0, 0.0),
            corner(&mut r, 1.0, 0.0),
            corner(&mut r, 0.0, 1.0),
        ]);
        let strain = FaceStrain::new(Mat3x2::new(
            0.9 + 0.1 * r(),
            0.2 * r(),
            0.2 * r(),
            1.05 + 0.1 * r(),
            0.1 * r(),
            0.1 * r(),
        ));
        let m = Mat3::from_fn(|_, _| r());
        let case = Case {
            rest,
            strain,
            second_form: m + m.transpose(),
            material: Material::new(3.0, 0.3 + 0.2 * r(), 0.4).unwrap(),
        };
        (case, Local::from_fn(|_, _| r()))
    }

    fn all_switches() -> Vec<Terms> {
        let mut list = vec![Terms::default()];
        list.extend(Terms::NAMES.iter().map(|n| Terms::default().without(n).unwrap()));
        list
    }

    #[test]
    fn derivatives_agree_with_differences_for_every_switch() {
        for seed in 0..20 {
            let (c, x) = case(seed);
            for terms in all_switches() {
                let density = Density::new(&c.rest, &c.strain, &c.second_form, &c.material, &terms);
                let (energy, gradient, hessian) = density.derivatives(&x);
                assert!((energy - density.energy(&x)).abs() <= 1e-14 * energy.abs());
                let at = |y: &[f64]| Local::from_column_slice(y);
                let e = gradient_error(x.as_slice(), 1.0, gradient.as_slice(), |y| {
                    density.energy(&at(y))
                });
                assert!(e < 1e-8, "gradient {e:e} {terms:?}");
                let e = hessian_error(x.as_slice(), 1.0, hessian.as_slice(), |y| {
                    density.derivatives(&at(y)).1.as_slice().to_vec()
                });
                assert!(e < 1e-7, "hessian {e:e} {terms:?}");
            }
        }
    }

    /// Eqs. 20–26 written down as the paper has them, with matrices in the orthonormal rest frame.
    fn paper_density(c: &Case, a: f64, d: Vec2, w: Vec2, terms: &Terms) -> f64 {
        let m = &c.material;
        let (alpha, beta, h) = (m.alpha(), m.beta(), m.thickness_m);
        let (dd, ww, wd) = (d * d.transpose(), w * w.transpose(), w * d.transpose());
        let sym = wd + wd.transpose();
        let w1 = m.norm_squared(&(c.strain.strain + dd * 0.5 + ww * (0.5 * a * a)));
        let crest = c.strain.directions[1];
        let f = c.strain.deformation;
        let tangent = f * crest;
        let kappa = tangent.dot(&(c.second_form * tangent)) / tangent.norm_squared();
        let stretch = tangent.norm_squared();
        let w2 = if !c.strain.is_mixed() {
            0.0
        } else if terms.v1 {
            4.0 * a * a * kappa * kappa * beta * (alpha + beta) / (alpha + 2.0 * beta)
                * stretch
                * stretch
        } else {
            0.5 * m.norm_squared(&(f.transpose() * c.second_form * f * (-2.0 * a)))
        };
        let (w3, w4) = if terms.v2 {
            (a * a / 32.0 * m.norm_squared(&sym), m.norm_squared(&dd) / 8.0)
        } else {
            (a * a / 8.0 * m.norm_squared(&sym), m.norm_squared(&(dd - ww * (a * a))) / 8.0)
        };
        let wb = a * a / 2.0 * m.norm_squared(&ww);
        let on = |f: bool, v: f64| if f { v } else { 0.0 };
        h / 4.0
            * (on(terms.stretching, w1)
                + on(terms.curvature, w2)
                + on(terms.mixed, w3)
                + on(terms.amplitude_gradient, w4))
            + h * h * h / 12.0 * on(terms.bending, wb)
    }

    #[test]
    fn the_polynomial_is_the_papers_energy() {
        for seed in 0..20 {
            let (c, x) = case(seed);
            for terms in all_switches() {
                let density = Density::new(&c.rest, &c.strain, &c.second_form, &c.material, &terms);
                let d = c.rest.one_form(x[1] - x[0], x[2] - x[0]);
                let w = c.rest.one_form(x[3], x[4]);
                let expected: f64 = QUADRATURE
                    .iter()
                    .map(|n| {
                        paper_density(&c, n[0] * x[0] + n[1] * x[1] + n[2] * x[2], d, w, &terms)
                    })
                    .sum::<f64>()
                    * c.rest.area_m2
                    / 3.0;
                let energy = density.energy(&x);
                assert!(
                    (energy - expected).abs() < 1e-13 * expected.abs().max(1e-3),
                    "{energy} {expected} {terms:?}"
                );
                let parts = energy_terms(
                    |only| Density::new(&c.rest, &c.strain, &c.second_form, &c.material, only),
                    &terms,
                    &x,
                );
                let sum = parts.stretching_joule
                    + parts.curvature_joule
                    + parts.mixed_joule
                    + parts.amplitude_gradient_joule
                    + parts.bending_joule;
                assert!((sum - energy).abs() < 1e-13 * energy.abs().max(1e-3));
            }
        }
    }
}
