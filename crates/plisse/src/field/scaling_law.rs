//! Wrinkles by the scaling law of Vandeparre et al. 2011 instead of a solve, as Zuenko & Harders
//! 2019 suggest and figures 8 and 10 of [Chen 2021] show: the wavelength depends on nothing but the
//! distance to the nearest clamped edge, the tension along the wrinkles and the sheet.
//!
//! At a clamped edge wrinkles are infinitely fine and merge in pairs on their way inward. Merging
//! takes the longer the stiffer the sheet is against it, dλ/dx ~ λ/L. Under a tension T (N/m) the
//! length of a merger is L ~ λ²√(T/B), so λ ~ (B/T)^¼ x^½. Without tension the sheet's own
//! stretching resists, L ~ λ^{3/2} δ^¼/h^½, so λ ~ h^⅓ δ^{-1/6} x^⅔ with the compression δ. The
//! finer wavelength of both is taken.
//!
//! The law has no prefactors. Under tension ours, 2√(2π), makes the wavelength in the middle
//! between two clamps that of Cerda & Mahadevan 2003, 2√π (B/T)^¼ √length, for the sheet for which
//! they derived it; without tension it is 1.
//!
//! Limits: the law knows no free edges, no curvature, and nothing of why the sheet is compressed.

use super::WrinkleField;
use super::domain::Domain;
use super::initialise::{compression, first_guess};
use super::solve::{FieldOptions, Period, with_phase};
use crate::material::Material;
use crate::mesh::{Topology, Vec3};
use crate::sheet::Sheet;
use crate::strain::FaceStrain;
use crate::{Error, Result};

/// Prefactor of the law under tension: 2√(2π).
const UNDER_TENSION: f64 = 5.013_256_549_262_001;

/// A field that follows the law.
#[derive(Clone, Debug)]
pub struct ScalingLaw {
    /// The field: amplitudes that take up the compression at the law's wavelength; frequency: the
    /// closed form nearest to the law's.
    pub field: WrinkleField,
    /// `[b₁]` periods, the largest first.
    pub periods: Vec<Period>,
    /// `[F]` distance (m) from the nearest clamped edge, straight through space.
    pub distance_m: Vec<f64>,
    /// `[F]` the law's wavelength (m), before the closed form is fitted to it.
    pub wavelength_m: Vec<f64>,
}

/// The law's wrinkles over a pose (`[V]`, m) with the `held` vertices (`[V]`).
///
/// # Errors
/// [`Error::Value`] if nothing is held, for then there is no edge to begin at.
pub fn scaling_law(
    sheet: &Sheet,
    pose: &[Vec3],
    held: &[bool],
    options: &FieldOptions,
) -> Result<ScalingLaw> {
    let distance_m = distances(&sheet.topology, pose, held)?;
    let strain = sheet.strain(pose);
    let wavelength_m: Vec<f64> =
        strain.iter().zip(&distance_m).map(|(s, &x)| wavelength(&sheet.material, s, x)).collect();
    let domain = Domain::new(&sheet.topology, &strain, held, options);
    let guess = first_guess(sheet, pose, &strain, &domain, &wavelength_m)?;
    let phased = with_phase(sheet, &domain, guess)?;
    Ok(ScalingLaw { field: phased.field, periods: phased.periods, distance_m, wavelength_m })
}

/// The law's wavelength (m) at the distance `x` (m).
fn wavelength(material: &Material, strain: &FaceStrain, x: f64) -> f64 {
    let h = material.thickness_m;
    // Strain is twice Green's, δ is the share of length that must go into waves.
    let delta = 0.5 * compression(strain).max(f64::MIN_POSITIVE);
    let light = h.cbrt() * delta.powf(-1.0 / 6.0) * x.powf(2.0 / 3.0);
    // Nothing resists across the wrinkles, so the tension is that of a pulled strip.
    let tension = material.young_pa * h * 0.5 * strain.principal[1].max(0.0);
    let bending =
        material.young_pa * h.powi(3) / (12.0 * (1.0 - material.poisson * material.poisson));
    let heavy = UNDER_TENSION * (bending / tension).powf(0.25) * x.sqrt();
    light.min(heavy)
}

/// `[F]` distance (m) of each face's centroid from the nearest edge with both ends held; from the
/// nearest held vertex if there is none.
fn distances(topology: &Topology, positions: &[Vec3], held: &[bool]) -> Result<Vec<f64>> {
    let mut pieces: Vec<[Vec3; 2]> = topology
        .edges
        .iter()
        .filter(|e| e.iter().all(|&v| held[v]))
        .map(|e| e.map(|v| positions[v]))
        .collect();
    if pieces.is_empty() {
        pieces = (0..positions.len()).filter(|&v| held[v]).map(|v| [positions[v]; 2]).collect();
    }
    if pieces.is_empty() {
        return Err(Error::value(
            "clamps",
            "the scaling law begins at clamped edges, and nothing is held; clamp an edge",
        ));
    }
    let nearest = |face: &[usize; 3]| {
        let centre = face.iter().map(|&v| positions[v]).sum::<Vec3>() / 3.0;
        pieces.iter().map(|piece| to_segment(centre, *piece)).fold(f64::INFINITY, f64::min)
    };
    Ok(topology.faces.iter().map(nearest).collect())
}

/// Distance of `p` from the segment between two points.
fn to_segment(p: Vec3, [from, to]: [Vec3; 2]) -> f64 {
    let along = to - from;
    let share = if along == Vec3::zeros() {
        0.0
    } else {
        ((p - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
    };
    (p - from - along * share).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mat2;
    use crate::mesh::Mat3x2;

    /// A face pulled along x and pressed along y (strains as Green's).
    fn face(pull: f64, press: f64) -> FaceStrain {
        let mut deformation = Mat3x2::zeros();
        deformation[(0, 0)] = (1.0 + 2.0 * pull).sqrt();
        deformation[(1, 1)] = (1.0 - 2.0 * press).sqrt();
        let strain = FaceStrain::new(deformation);
        assert!((strain.strain - Mat2::new(2.0 * pull, 0.0, 0.0, -2.0 * press)).norm() < 1e-12);
        strain
    }

    #[test]
    fn under_tension_the_middle_has_the_wavelength_of_cerda_and_mahadevan() {
        let material = Material::new(1e6, 0.5, 1e-4).unwrap();
        let (length, pull) = (0.25, 0.05);
        let bending = 1e6 * 1e-12 / (12.0 * 0.75);
        let expected = 2.0
            * std::f64::consts::PI.sqrt()
            * f64::powf(bending / (1e6 * 1e-4 * pull), 0.25)
            * f64::sqrt(length);
        assert!(
            (wavelength(&material, &face(pull, 0.01), 0.5 * length) / expected - 1.0).abs() < 1e-9
        );
    }

    #[test]
    fn wavelengths_grow_with_the_root_under_tension_and_faster_without() {
        let material = Material::new(1e6, 0.3, 1e-4).unwrap();
        let ratio = |s: &FaceStrain| wavelength(&material, s, 0.4) / wavelength(&material, s, 0.1);
        assert!((ratio(&face(0.2, 0.01)) - 2.0).abs() < 1e-9);
        assert!((ratio(&face(0.0, 0.01)) - 4.0_f64.powf(2.0 / 3.0)).abs() < 1e-9);
        // Thickness: h^½ and h^⅓.
        let thick = Material::new(1e6, 0.3, 8e-4).unwrap();
        let ratio = |s: &FaceStrain| wavelength(&thick, s, 0.1) / wavelength(&material, s, 0.1);
        assert!((ratio(&face(0.0, 0.01)) - 2.0).abs() < 1e-9);
        assert!((ratio(&face(0.2, 0.01)) - 8.0_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn distances_are_to_held_edges() {
        let segment = [Vec3::zeros(), Vec3::new(2.0, 0.0, 0.0)];
        assert_eq!(to_segment(Vec3::new(1.0, 3.0, 0.0), segment), 3.0);
        assert_eq!(to_segment(Vec3::new(5.0, 0.0, 4.0), segment), 5.0);
        assert_eq!(to_segment(Vec3::new(0.0, 0.0, 4.0), [Vec3::zeros(); 2]), 4.0);
        let topology = Topology::new(3, vec![[0, 1, 2]]).unwrap();
        let positions = [Vec3::zeros(), Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];
        assert_eq!(distances(&topology, &positions, &[true, true, false]).unwrap(), [1.0]);
        assert!(
            (distances(&topology, &positions, &[true, false, false]).unwrap()[0] - 2.0_f64.sqrt())
                .abs()
                < 1e-15
        );
        assert!(distances(&topology, &positions, &[false; 3]).is_err());
    }
}
