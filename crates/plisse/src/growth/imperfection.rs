//! Random imperfections from which folds begin: rough on the scale of the folds, without longer
//! waves.
//!
//! Noise of lumps as small as half a fold has long waves, too, as strong as any other; where
//! imperfections are large, these would be the largest relief while growth is small. So the noise
//! passes twice through the high-pass filter 1 − (1 − ℓ²Δ)⁻¹ on the starting surface, with ℓ =
//! λ/2π. A wave of wave number q is reduced by the factor (ℓ²q²/(1 + ℓ²q²))², which is ¼ for folds
//! and 0.01 for waves three times as long.

use std::f64::consts::TAU;

use super::procedural_map::roughness;
use super::surface::GrowingSurface;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::sparse::SymmetricPattern;
use crate::rest::RestMetric;
use crate::{Error, Result};

/// Size of the noise's lumps, in wavelengths.
const LUMP: f64 = 0.5;
/// Number of passes of the high-pass filter.
const PASSES: usize = 2;

/// `[V]` imperfections of about unit size (no unit) on the starting surface, whose metric is
/// `metric` and on which each vertex has `area_m2` (`[V]`, m²). They depend on places, not on the
/// numbering of vertices, so a finer mesh has the same ones.
///
/// # Errors
/// [`Error::Numeric`] if the matrix is not positive definite, as on a mesh with very bad triangles.
pub(super) fn band_limited(
    surface: &GrowingSurface,
    metric: &RestMetric,
    area_m2: &[f64],
    seed: u64,
) -> Result<Vec<f64>> {
    let lump = |v: usize| LUMP * surface.maps.vertices[v].wavelength_m;
    let mut rough: Vec<f64> =
        (0..area_m2.len()).map(|v| roughness(&surface.places[v], lump(v), seed)).collect();
    let before = size(&rough, area_m2);
    remove_long_waves(surface, metric, area_m2, &mut rough)?;
    let after = size(&rough, area_m2);
    if after > 0.0 {
        rough.iter_mut().for_each(|w| *w *= before / after);
    }
    Ok(rough)
}

/// Removes waves that are longer than folds from `rough` (`[V]`).
fn remove_long_waves(
    surface: &GrowingSurface,
    metric: &RestMetric,
    area_m2: &[f64],
    rough: &mut [f64],
) -> Result<()> {
    let n = area_m2.len();
    let pattern =
        SymmetricPattern::from_elements(n, surface.topology.faces.iter().map(|face| &face[..]));
    let mut values = vec![0.0; pattern.entry_count()];
    for (face, rest) in surface.topology.faces.iter().zip(&metric.faces) {
        let sum = face.iter().map(|&v| surface.maps.vertices[v].wavelength_m).sum::<f64>();
        let reach_m = sum / (3.0 * TAU);
        let slopes = rest.barycentric_gradients();
        for k in 0..3 {
            for l in 0..=k {
                values[pattern.slot(face[k], face[l])] +=
                    reach_m * reach_m * rest.area_m2 * slopes[k].dot(&slopes[l]);
            }
        }
    }
    for v in 0..n {
        values[pattern.slot(v, v)] += area_m2[v];
    }
    let mut cholesky = Cholesky::new(pattern)?;
    if !cholesky.factorise(&values) {
        return Err(Error::numeric(
            "grow",
            "the starting surface's Laplacian is not positive definite; give the mesh better \
             triangles",
        ));
    }
    for _ in 0..PASSES {
        let mut long: Vec<f64> = rough.iter().zip(area_m2).map(|(w, area)| w * area).collect();
        cholesky.solve(&mut long);
        rough.iter_mut().zip(&long).for_each(|(w, long)| *w -= long);
    }
    Ok(())
}

/// Root of the mean square.
fn size(rough: &[f64], area_m2: &[f64]) -> f64 {
    let square: f64 = rough.iter().zip(area_m2).map(|(w, area)| w * w * area).sum();
    (square / area_m2.iter().sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::growth::{Expansion, GrowthMaps};
    use crate::mesh::grid::{Diagonal, grid};
    use crate::mesh::{Topology, Vec3};

    #[test]
    fn waves_are_left_by_their_length() {
        let panel = grid([1.0, 0.2], 0.01, [None, None], Diagonal::Rising).unwrap();
        let start: Vec<Vec3> = panel.positions.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        let topology = Topology::new(start.len(), panel.faces).unwrap();
        let rest = RestMetric::from_shape(&start, &topology.faces).unwrap();
        let expansion = Expansion::none(&topology, &start).unwrap();
        let maps = GrowthMaps::even(&expansion, 0.2, 0.0);
        let surface = GrowingSurface::new(topology, rest.clone(), start.clone(), maps);
        let mut area_m2 = vec![0.0; start.len()];
        for (face, rest) in surface.topology.faces.iter().zip(&rest.faces) {
            face.iter().for_each(|&v| area_m2[v] += rest.area_m2 / 3.0);
        }
        // Cosines are level at the rims, so they keep their shape: (r/(1 + r))² is left, r = (0.2 ·
        // waves)².
        for waves in [0.0, 1.0, 2.0, 5.0, 10.0] {
            let wave: Vec<f64> = start.iter().map(|p| (TAU * waves * p.x).cos()).collect();
            let mut left = wave.clone();
            remove_long_waves(&surface, &rest, &area_m2, &mut left).unwrap();
            let (r, whole) = ((0.2 * waves).powi(2), size(&wave, &area_m2));
            let share = (r / (1.0 + r)).powi(2);
            assert!(
                (size(&left, &area_m2) / whole - share).abs() < 0.02 * share + 1e-9,
                "{waves}: {}",
                size(&left, &area_m2) / whole
            );
        }
        // Noise keeps its size.
        let raw: Vec<f64> = start.iter().map(|p| roughness(p, LUMP * 0.2, 1)).collect();
        let limited = band_limited(&surface, &rest, &area_m2, 1).unwrap();
        assert!((size(&limited, &area_m2) / size(&raw, &area_m2) - 1.0).abs() < 1e-12);
        let mean: f64 = limited.iter().zip(&area_m2).map(|(w, area)| w * area).sum::<f64>()
            / area_m2.iter().sum::<f64>();
        assert!(mean.abs() < 0.01 * size(&limited, &area_m2), "{mean}");
    }
}
