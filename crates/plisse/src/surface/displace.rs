//! Moves a subdivided base surface to the wrinkled one, eq. 19 of [Chen 2021]:
//!
//! r = r_b + a cos φ n + a²/8 sin 2φ ∇φ + a sin φ v,
//!
//! with the base surface's normal n and gradient ∇φ = dr_b I_b⁻¹ dφᵀ. The last two are the in-plane
//! corrections v₂ (bulging, evenly strained waves) and v₁ (waves on a curved surface; the paper
//! leaves it out when drawing).

use rayon::prelude::*;

use super::upsample::Upsampled;
use crate::material::Material;
use crate::mesh::normals::vertex_normals;
use crate::mesh::{Mat2, Mat3, Mat3x2, Vec2, Vec3};
use crate::rest::RestFace;

/// In-plane corrections that take part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement<'a> {
    /// The second in-plane correction, a²/8 sin 2φ ∇φ.
    pub v2: bool,
    /// The first in-plane correction, if wanted.
    pub v1: Option<FirstCorrection<'a>>,
}

/// Input of the first in-plane correction, a sin φ v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstCorrection<'a> {
    /// `[F]` second fundamental form (1/m) of each coarse face.
    pub second_forms: &'a [Mat3],
    /// The material.
    pub material: &'a Material,
}

/// Steepest waves, a·|∇φ| (no unit), for which v₂ is taken in full. Steeper ones, on nearly
/// collapsed faces, would shoot out of the surface; so v₂ is never longer than half the amplitude.
const STEEPEST: f64 = 4.0;

/// `[V]` positions (m) of the wrinkled surface.
///
/// ```
/// use plisse::surface::{Displacement, displace, upsample};
/// # use plisse::{Material, Sheet};
/// # use plisse::mesh::Vec3;
/// # // A strip of 20 × 4 squares of 1 cm, pressed together by 2 % along x.
/// # let at = |v: usize| Vec3::new(0.01 * (v % 21) as f64, 0.01 * (v / 21) as f64, 0.0);
/// # let rest: Vec<Vec3> = (0..105).map(at).collect();
/// # let squares = (0..84).filter(|v| v % 21 != 20);
/// # let faces: Vec<[usize; 3]> =
/// #     squares.flat_map(|v| [[v, v + 1, v + 22], [v, v + 22, v + 21]]).collect();
/// # let pose: Vec<Vec3> = rest.iter().map(|p| Vec3::new(0.98 * p.x, p.y, 0.0)).collect();
/// # let sheet = Sheet::from_rest(rest, faces, Material::new(1e6, 0.3, 1e-4)?)?;
/// # let (held, options) = (vec![false; pose.len()], Default::default());
/// # let silent = plisse::progress::Silent;
/// # let field = plisse::field::solve(&sheet, &pose, &held, &options, &silent)?.field;
/// let fine = upsample(&sheet, &pose, &field, 3);
/// let wrinkled = displace(&fine, &Displacement { v2: true, v1: None });
/// assert_eq!(wrinkled.len(), fine.topology.vertex_count);
/// # Ok::<(), plisse::Error>(())
/// ```
pub fn displace(surface: &Upsampled, how: &Displacement<'_>) -> Vec<Vec3> {
    let topology = &surface.topology;
    // Slow vectors per face, then their mean at vertices, by area.
    let per_face = || -> Vec<Slow> {
        (0..topology.face_count()).into_par_iter().map(|f| slow(surface, how, f)).collect()
    };
    let (per_face, normals) = rayon::join(per_face, || vertex_normals(topology, &surface.base));
    let mut sum = vec![(Slow::default(), 0.0); topology.vertex_count];
    let mut phase = vec![0.0; topology.vertex_count];
    for (f, face) in topology.faces.iter().enumerate() {
        if surface.wrinkle_free[f] {
            continue;
        }
        let area = per_face[f].area;
        for (k, &v) in face.iter().enumerate() {
            sum[v].0.gradient += per_face[f].gradient * area;
            sum[v].0.v1 += per_face[f].v1 * area;
            sum[v].1 += area;
            phase[v] = surface.phase[f][k];
        }
    }
    (0..topology.vertex_count)
        .into_par_iter()
        .map(|v| {
            let (slow, weight) = &sum[v];
            let a = surface.amplitude_m[v];
            if *weight <= 0.0 || a == 0.0 {
                return surface.base[v];
            }
            let (sine, cosine) = phase[v].sin_cos();
            let mut moved =
                surface.base[v] + normals[v] * (a * cosine) + slow.v1 * (a * sine / weight);
            if how.v2 {
                let gradient = slow.gradient / *weight;
                let steep = (a * gradient.norm() / STEEPEST).max(1.0);
                moved += gradient * (a * a / 4.0 * sine * cosine / steep);
            }
            moved
        })
        .collect()
}

/// Quantities that vary slowly over a face.
#[derive(Clone, Copy, Default)]
struct Slow {
    /// ∇φ (rad/m) in space.
    gradient: Vec3,
    /// dr_b I_b⁻¹ v (no unit) of eqs. 16–18.
    v1: Vec3,
    area: f64,
}

fn slow(surface: &Upsampled, how: &Displacement<'_>, f: usize) -> Slow {
    if surface.wrinkle_free[f] {
        return Slow::default();
    }
    let rest = RestFace::from_corners(surface.rest_shape.corners(f));
    let base = rest.deformation(surface.topology.faces[f].map(|v| surface.base[v]));
    let [p0, p1, p2] = surface.phase[f];
    let frequency = rest.one_form(p1 - p0, p2 - p0);
    // A collapsed face of the base surface has no gradient.
    let Some(raise) = (base.transpose() * base).try_inverse().map(|inverse| base * inverse) else {
        return Slow::default();
    };
    let v1 = match how.v1 {
        Some(FirstCorrection { second_forms, material }) => {
            let share = 4_usize.pow(surface.levels as u32);
            raise * first_correction(&base, &second_forms[f / share], &frequency, material)
        }
        None => Vec3::zeros(),
    };
    let slow = Slow { gradient: raise * frequency, v1, area: rest.area_m2 };
    if slow.gradient.iter().chain(slow.v1.iter()).all(|x| x.is_finite()) {
        slow
    } else {
        Slow::default()
    }
}

/// v of eqs. 17 and 18 as a one-form in the orthonormal rest frame.
fn first_correction(
    base: &Mat3x2,
    second_form: &Mat3,
    frequency: &Vec2,
    material: &Material,
) -> Vec2 {
    let square = frequency.norm_squared();
    if square == 0.0 {
        return Vec2::zeros();
    }
    let form: Mat2 = base.transpose() * second_form * base;
    let (alpha, beta) = (material.alpha(), material.beta());
    let across = Vec2::new(-frequency.y, frequency.x);
    let along = alpha / (alpha + 2.0 * beta) * form.trace() / square
        + 2.0 * beta / (alpha + 2.0 * beta) * frequency.dot(&(form * frequency))
            / (square * square);
    frequency * along + across * (2.0 * frequency.dot(&(form * across)) / (square * square))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{RestShape, Topology};
    use std::f64::consts::TAU;

    #[test]
    fn nothing_shoots_out_of_a_nearly_collapsed_base() {
        for squeeze in [0.5, 1e-2, 1e-4] {
            let (a, surface) = (0.01, waves(400, 0.01, 20.0, squeeze));
            let moved = displace(&surface, &Displacement { v2: true, v1: None });
            let farthest =
                moved.iter().zip(&surface.base).map(|(p, b)| (p - b).norm()).fold(0.0, f64::max);
            assert!(farthest <= 1.12 * a, "{squeeze}: {farthest}");
        }
    }

    /// A flat strip with waves along x, finely resolved, squeezed so that the waves take up the
    /// strain.
    fn waves(n: usize, a: f64, frequency: f64, squeeze: f64) -> Upsampled {
        let (mut rest_positions, mut faces, mut phase) = (Vec::new(), Vec::new(), Vec::new());
        for j in 0..3 {
            for i in 0..=n {
                rest_positions.push(Vec3::new(i as f64 / n as f64, j as f64 * 0.01, 0.0));
            }
        }
        for j in 0..2 {
            for i in 0..n {
                let at = |i: usize, j: usize| j * (n + 1) + i;
                for face in [
                    [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                    [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
                ] {
                    phase.push(face.map(|v| frequency * rest_positions[v].x));
                    faces.push(face);
                }
            }
        }
        let base =
            rest_positions.iter().map(|p: &Vec3| Vec3::new(p.x * squeeze, p.y, 0.0)).collect();
        let topology = Topology::new(rest_positions.len(), faces.clone()).unwrap();
        Upsampled {
            wrinkle_free: vec![false; faces.len()],
            amplitude_m: vec![a; rest_positions.len()],
            levels: 0,
            topology,
            base,
            phase,
            rest_shape: RestShape { positions: rest_positions, faces },
        }
    }

    fn length(p: &[Vec3], n: usize) -> (f64, f64) {
        let steps: Vec<f64> = (0..n).map(|i| (p[i + 1] - p[i]).norm() * n as f64).collect();
        let mean = steps.iter().sum::<f64>() / n as f64;
        (mean, steps.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n as f64)
    }

    #[test]
    fn wrinkles_give_back_the_length_that_compression_took() {
        // ε = a²|dφ|²/2 with ε = −λ = 1 − squeeze² (eq. 8).
        let (n, frequency) = (4000, 10.0 * TAU);
        let squeeze: f64 = 0.97;
        let a = (2.0 * (1.0 - squeeze * squeeze)).sqrt() / frequency;
        let surface = waves(n, a, frequency, squeeze);
        let plain = length(&displace(&surface, &Displacement { v2: false, v1: None }), n);
        let full = length(&displace(&surface, &Displacement { v2: true, v1: None }), n);
        assert!((full.0 - 1.0).abs() < 2e-3, "length {}", full.0);
        // v₂ spreads the strain evenly over a period.
        assert!(full.1 < 0.02 * plain.1, "{full:?} {plain:?}");
    }

    #[test]
    fn no_amplitude_no_movement() {
        let surface = waves(50, 0.0, 30.0, 0.9);
        assert_eq!(displace(&surface, &Displacement { v2: true, v1: None }), surface.base);
    }

    #[test]
    fn v1_evens_the_strain_of_waves_around_a_cylinder() {
        // Waves travel around a cylinder of radius r: crests are stretched, valleys pressed, unless
        // material moves to the crests.
        let (n, r) = (4000, 1.0 / TAU);
        let frequency = 20.0 * TAU;
        let mut surface = waves(n, 2e-4, frequency, 1.0);
        for p in &mut surface.base {
            *p = Vec3::new(r * (p.x / r).cos(), r * (p.x / r).sin(), p.y);
        }
        let material = Material::new(1e6, 0.3, 1e-4).unwrap();
        let forms: Vec<Mat3> = surface
            .topology
            .faces
            .iter()
            .map(|f| {
                let angle = (surface.rest_shape.positions[f[0]].x + 0.5 / n as f64) / r;
                let tangent = Vec3::new(-angle.sin(), angle.cos(), 0.0);
                tangent * tangent.transpose() * (-1.0 / r)
            })
            .collect();
        let plain = length(&displace(&surface, &Displacement { v2: true, v1: None }), n);
        let v1 = Some(FirstCorrection { second_forms: &forms, material: &material });
        let full = length(&displace(&surface, &Displacement { v2: true, v1 }), n);
        assert!(full.1 < 0.02 * plain.1, "{full:?} {plain:?}");
    }
}
