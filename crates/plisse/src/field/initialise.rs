//! First guess of a wrinkle field from the base surface's strain (E.2 of [Chen 2021], with combing
//! and a weighted fit).
//!
//! On a face that is pressed by ε along w, eq. 8 asks for ½a²|dφ|² = ε. The paper shares that out
//! as a = k√(2ε), |dφ| = 1/k with a fixed k in metres. Here k is [`first_wavelength_m`]/2π, which
//! follows the sheet's size and thickness, so that the user's units do not matter.

use super::closest_closed_form::ClosestClosedForm;
use super::comb::comb;
use super::domain::Domain;
use crate::Result;
use crate::material::Material;
use crate::mesh::{Vec2, Vec3};
use crate::sheet::Sheet;
use crate::strain::FaceStrain;

/// A wrinkle field before its phase is rounded to whole turns.
pub struct Unrounded {
    /// `[V]` amplitude (m).
    pub amplitude_m: Vec<f64>,
    /// `[V]` phase (rad).
    pub phases: Vec<f64>,
    /// `[b₁]` coefficients (rad).
    pub coefficients: Vec<f64>,
}

/// Wavelength to start from (m): 2π√(h·size), with the size of a cube whose vertices are as far
/// from their centre as those of the base surface are on average. The wavelength of wrinkles under
/// tension goes as the root of thickness times length (Cerda & Mahadevan 2003); the solve corrects
/// the factor by [`FieldProblem::rescale`](super::problem::FieldProblem::rescale).
pub fn first_wavelength_m(material: &Material, positions: &[Vec3]) -> f64 {
    let count = positions.len() as f64;
    let centre = positions.iter().sum::<Vec3>() / count;
    let size =
        (12.0 * positions.iter().map(|p| (p - centre).norm_squared()).sum::<f64>() / count).sqrt();
    std::f64::consts::TAU * (material.thickness_m * size).sqrt()
}

/// Compression of a face along its first principal direction: ε = −λ where that is pressed, else
/// zero. A face pressed both ways wrinkles along the stronger compression.
pub fn compression(strain: &FaceStrain) -> f64 {
    (-strain.principal[0]).max(0.0)
}

/// The first guess over a pose (`[V]`, m) with this `strain` (`[F]`), with `wavelength_m` (`[F]`)
/// on each face of the domain.
///
/// # Errors
/// Only if the factorisation's memory cannot be had.
pub fn first_guess(
    sheet: &Sheet,
    pose: &[Vec3],
    strain: &[FaceStrain],
    domain: &Domain,
    wavelength_m: &[f64],
) -> Result<Unrounded> {
    let Sheet { topology, rest, .. } = sheet;
    let Domain { wrinkle_free, still, forms } = domain;
    let k: Vec<f64> = wavelength_m.iter().map(|length| length / std::f64::consts::TAU).collect();
    let amount: Vec<f64> = (0..topology.face_count())
        .map(|f| if wrinkle_free[f] { 0.0 } else { compression(&strain[f]) })
        .collect();
    let in_space: Vec<Vec3> = (0..topology.face_count())
        .map(|f| {
            (strain[f].deformation * strain[f].directions[0])
                .try_normalize(0.0)
                .unwrap_or_else(Vec3::zeros)
                * amount[f]
        })
        .collect();
    let sign = comb(topology, pose, &in_space, wrinkle_free);
    let target: Vec<Vec2> = (0..topology.face_count())
        .map(|f| {
            if amount[f] > 0.0 { strain[f].directions[0] * (sign[f] / k[f]) } else { Vec2::zeros() }
        })
        .collect();
    // Strongly pressed faces decide; the others must only not make the equations singular.
    let largest = amount.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let weight: Vec<f64> = (0..topology.face_count())
        .map(|f| if wrinkle_free[f] { 0.0 } else { amount[f] / largest + 1e-6 })
        .collect();
    let (phases, coefficients) =
        ClosestClosedForm::new(topology, rest, forms, &weight)?.with_free_periods(&target);

    let (mut sum, mut area) = (vec![0.0; topology.vertex_count], vec![0.0; topology.vertex_count]);
    for f in (0..topology.face_count()).filter(|&f| !wrinkle_free[f]) {
        for v in topology.faces[f] {
            sum[v] += rest.faces[f].area_m2 * k[f] * (2.0 * amount[f]).sqrt();
            area[v] += rest.faces[f].area_m2;
        }
    }
    let amplitude_m = (0..topology.vertex_count)
        .map(|v| if still[v] || area[v] == 0.0 { 0.0 } else { sum[v] / area[v] })
        .collect();
    Ok(Unrounded { amplitude_m, phases, coefficients })
}
