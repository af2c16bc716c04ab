//! Growth maps: the values at each vertex of a surface that grows.

use super::expansion::{Expansion, GrowthTensor};
use super::rigid_bands::check_bands;
use crate::{Error, Result};

/// Growth, and the properties of folds, at one vertex.
///
/// A number that is added here gets its line in [`SCALAR_MAPS`]: from there it is checked, read
/// from scenes and carried through remeshing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthAt {
    /// Growth tensor τ.
    pub growth: GrowthTensor,
    /// Spacing λ (m) of the folds, as seen on the starting surface.
    pub wavelength_m: f64,
    /// Coherence length Λ (m): the distance over which crests run straight; 0 leaves only what the
    /// film's own stiffness gives.
    pub coherence_m: f64,
    /// Offset that the surface prefers, in wavelengths: positive pushes folds out along the normals
    /// (k_pi of eq. 5).
    pub bias: f64,
    /// Extra stiffness of the foundation below the surface, over that above (no unit): 0 for folds
    /// both ways, 100 for a surface that sticks to a hard ground.
    pub stickiness: f64,
    /// Share of the foundation (no unit): 1 as λ asks, 0 for a surface that nothing holds to its
    /// start.
    pub hold: f64,
    /// Axes along which the vertex is frozen.
    pub frozen: [bool; 3],
}

impl GrowthAt {
    /// Free growth with folds λ apart (m), without coherence, bias or sticking.
    pub fn new(growth: GrowthTensor, wavelength_m: f64) -> Self {
        Self {
            growth,
            wavelength_m,
            coherence_m: 0.0,
            bias: 0.0,
            stickiness: 0.0,
            hold: 1.0,
            frozen: [false; 3],
        }
    }

    /// True for a foundation that is equally stiff above and below, as the reference mode needs.
    pub(super) fn is_symmetric(&self) -> bool {
        self.stickiness == 0.0
    }
}

/// A map with one number at each vertex.
#[derive(Clone, Copy, Debug)]
pub struct ScalarMap {
    /// Name of the map in scenes and in messages.
    pub name: &'static str,
    field: fn(&mut GrowthAt) -> &mut f64,
    allowed: fn(f64) -> bool,
    /// Advice for a value that is not allowed.
    fix: &'static str,
}

impl ScalarMap {
    /// Value of this map in `at`.
    pub fn get(&self, at: &GrowthAt) -> f64 {
        let mut at = *at;
        *(self.field)(&mut at)
    }

    /// Sets the value of this map in `at`.
    pub fn set(&self, at: &mut GrowthAt, value: f64) {
        *(self.field)(at) = value;
    }
}

/// All maps with one number at each vertex; λ is the first.
pub const SCALAR_MAPS: [ScalarMap; 5] = [
    ScalarMap {
        name: "wavelength_m",
        field: |at| &mut at.wavelength_m,
        allowed: |x| x.is_finite() && x > 0.0,
        fix: "give a positive number of metres",
    },
    ScalarMap {
        name: "coherence_m",
        field: |at| &mut at.coherence_m,
        allowed: |x| x.is_finite() && x >= 0.0,
        fix: "give 0 or a positive number of metres",
    },
    ScalarMap {
        name: "bias",
        field: |at| &mut at.bias,
        allowed: |x| x.is_finite() && x.abs() <= 1.0,
        fix: "give a share of the wavelength from -1 to 1",
    },
    ScalarMap {
        name: "stickiness",
        field: |at| &mut at.stickiness,
        allowed: |x| x.is_finite() && x >= 0.0,
        fix: "give 0 or a positive number",
    },
    ScalarMap {
        name: "hold",
        field: |at| &mut at.hold,
        allowed: |x| x.is_finite() && x >= 0.0,
        fix: "give 0, 1 or another positive number",
    },
];

/// The growth maps of a surface.
#[derive(Clone, Debug)]
pub struct GrowthMaps {
    /// `[V]` values at each vertex.
    pub vertices: Vec<GrowthAt>,
    /// Sets of vertices that move as rigid bodies.
    pub bands: Vec<Vec<usize>>,
}

impl GrowthMaps {
    /// The same λ and Λ (m) everywhere, without bias, sticking or anything frozen.
    pub fn even(expansion: &Expansion, wavelength_m: f64, coherence_m: f64) -> Self {
        let at = |growth: &GrowthTensor| GrowthAt {
            coherence_m,
            ..GrowthAt::new(*growth, wavelength_m)
        };
        Self { vertices: expansion.vertices.iter().map(at).collect(), bands: Vec::new() }
    }

    /// Growth tensors of all vertices.
    pub fn expansion(&self) -> Expansion {
        Expansion { vertices: self.vertices.iter().map(|at| at.growth).collect() }
    }

    /// Replaces the growth tensors of all vertices.
    pub fn set_expansion(&mut self, expansion: &Expansion) {
        for (at, growth) in self.vertices.iter_mut().zip(&expansion.vertices) {
            at.growth = *growth;
        }
    }

    /// Largest logarithm of a factor of length that is asked for, up or down.
    pub fn most_growth(&self) -> f64 {
        let log = |at: &GrowthAt| {
            at.growth.principal().0.map(|factor| factor.ln().abs()).into_iter().fold(0.0, f64::max)
        };
        self.vertices.iter().map(log).fold(0.0, f64::max)
    }

    /// Checks that a surface of `n` vertices can grow like this.
    ///
    /// # Errors
    /// [`Error::Value`] naming the map and the vertex whose value cannot be used, or the band; or
    /// if everything is frozen.
    pub(super) fn check(&self, n: usize) -> Result<()> {
        if self.vertices.len() != n {
            let message =
                format!("it has {} values; give one for each of {n} vertices", self.vertices.len());
            return Err(Error::value("growth.maps", message));
        }
        for map in &SCALAR_MAPS {
            let bad = self.vertices.iter().position(|at| !(map.allowed)(map.get(at)));
            if let Some(v) = bad {
                let value = map.get(&self.vertices[v]);
                return Err(Error::value(
                    format!("growth.{}", map.name),
                    format!("it is {value} at vertex {v}; {}", map.fix),
                ));
            }
        }
        check_bands(&self.bands, &self.vertices)?;
        if self.vertices.iter().flat_map(|at| at.frozen).all(|frozen| frozen) {
            return Err(Error::value(
                "growth.freeze",
                "every vertex is frozen, so nothing can fold; leave some free",
            ));
        }
        Ok(())
    }
}
