//! What may differ from place to place on a surface that grows.

use super::expansion::Expansion;
use super::rigid_bands::check_bands;
use crate::{Error, Result};

/// How each vertex of a surface grows, and folds while it does.
#[derive(Clone, Debug)]
pub struct GrowthMaps {
    /// How it grows.
    pub expansion: Expansion,
    /// `[V]` spacing λ (m) of the folds, as seen on the starting surface.
    pub wavelength_m: Vec<f64>,
    /// `[V]` coherence length Λ (m): how far crests run straight; 0 leaves only what the film's own
    /// stiffness gives.
    pub coherence_m: Vec<f64>,
    /// `[V]` offset that the surface prefers, in wavelengths: positive pushes folds out along the
    /// normals (k_pi of eq. 5).
    pub bias: Vec<f64>,
    /// `[V]` how much harder than out the surface goes in (no unit): 0 for folds both ways, 100 for
    /// what sticks to a hard ground.
    pub stickiness: Vec<f64>,
    /// `[V]` how much of the foundation there is (no unit): 1 as λ asks, 0 for a surface that
    /// nothing holds to its start.
    pub hold: Vec<f64>,
    /// `[V]` axes along which each vertex is frozen.
    pub frozen: Vec<[bool; 3]>,
    /// Sets of vertices that move as one.
    pub bands: Vec<Vec<usize>>,
}

impl GrowthMaps {
    /// The same λ and Λ (m) everywhere, without bias, sticking or anything frozen.
    pub fn even(expansion: Expansion, wavelength_m: f64, coherence_m: f64) -> Self {
        let n = expansion.vertices.len();
        Self {
            expansion,
            wavelength_m: vec![wavelength_m; n],
            coherence_m: vec![coherence_m; n],
            bias: vec![0.0; n],
            stickiness: vec![0.0; n],
            hold: vec![1.0; n],
            frozen: vec![[false; 3]; n],
            bands: Vec::new(),
        }
    }

    /// Largest logarithm of a factor of length that is asked for, up or down.
    pub fn most_growth(&self) -> f64 {
        let log = |v: &super::expansion::GrowthTensor| {
            v.principal().0.map(|factor| factor.ln().abs()).into_iter().fold(0.0, f64::max)
        };
        self.expansion.vertices.iter().map(log).fold(0.0, f64::max)
    }

    /// Whether a surface of `n` vertices can grow like this.
    ///
    /// # Errors
    /// [`Error::Value`] naming the map and the vertex whose value cannot be used, or the band; or if all is frozen.
    pub(super) fn check(&self, n: usize) -> Result<()> {
        let map = |name: &str, values: &[f64], allowed: fn(f64) -> bool, mend: &str| match values
            .iter()
            .position(|&x| !allowed(x))
        {
            Some(v) => Err(Error::value(
                format!("growth.{name}"),
                format!("it is {} at vertex {v}; {mend}", values[v]),
            )),
            None if values.len() == n => Ok(()),
            None => Err(Error::value(
                format!("growth.{name}"),
                format!("it has {} values; give one for each of {n} vertices", values.len()),
            )),
        };
        map(
            "wavelength_m",
            &self.wavelength_m,
            |x| x.is_finite() && x > 0.0,
            "give a positive number of metres",
        )?;
        map(
            "coherence_m",
            &self.coherence_m,
            |x| x.is_finite() && x >= 0.0,
            "give 0 or a positive number of metres",
        )?;
        map(
            "bias",
            &self.bias,
            |x| x.is_finite() && x.abs() <= 1.0,
            "give a share of the wavelength from -1 to 1",
        )?;
        map(
            "stickiness",
            &self.stickiness,
            |x| x.is_finite() && x >= 0.0,
            "give 0 or a positive number",
        )?;
        check_bands(&self.bands, &self.frozen)?;
        map(
            "hold",
            &self.hold,
            |x| x.is_finite() && x >= 0.0,
            "give 0, 1 or another positive number",
        )?;
        if self.frozen.iter().flatten().all(|&frozen| frozen) {
            return Err(Error::value(
                "growth.freeze",
                "every vertex is frozen, so nothing can fold; leave some free",
            ));
        }
        Ok(())
    }
}
