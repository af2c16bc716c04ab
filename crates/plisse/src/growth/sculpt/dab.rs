//! One touch of a brush, and its effect on the values of a vertex.

use super::SculptOptions;
use crate::growth::expansion::{Expansion, GrowthTensor};
use crate::growth::maps::GrowthAt;
use crate::mesh::{Mat2, Topology, Vec3};
use crate::{Error, Result};

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The face on which it lies.
    pub face: usize,
    /// Shares of the face's corners; they add up to 1.
    pub weights: [f64; 3],
}

impl SurfacePoint {
    /// The place of vertex `v` of `topology`; none if there is no such vertex. Looks through all
    /// faces.
    pub fn vertex(topology: &Topology, v: usize) -> Option<Self> {
        let face = topology.faces.iter().position(|face| face.contains(&v))?;
        let weights = topology.faces[face].map(|u| if u == v { 1.0 } else { 0.0 });
        Some(Self { face, weights })
    }
}

/// Effect of a brush.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// Lengths grow by this factor more, along this direction in space or, without one, in all
    /// directions.
    Growth {
        /// Factor of length; below 1 it shrinks.
        factor: f64,
        /// Direction in space; any length but 0.
        direction: Option<Vec3>,
    },
    /// λ becomes this (m).
    Wavelength(f64),
    /// Λ becomes this (m).
    Coherence(f64),
    /// The preferred offset becomes this, in wavelengths.
    Bias(f64),
    /// The stickiness becomes this.
    Stickiness(f64),
    /// All axes are frozen where the vertex now is, or freed, where the brush has half of its
    /// strength and more.
    Freeze(bool),
}

/// One touch of a brush.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dab {
    /// Its middle.
    pub spot: SurfacePoint,
    /// Radius (m) along the starting surface.
    pub radius_m: f64,
    /// Share of the radius within which it has its full strength; from there it falls off smoothly.
    pub core: f64,
    /// Its effect.
    pub paint: Paint,
}

impl Dab {
    /// Strength (0 to 1) at `distance_m` (m) from its middle.
    pub fn strength(&self, distance_m: f64) -> f64 {
        let part =
            (distance_m / self.radius_m - self.core) / (1.0 - self.core).max(f64::MIN_POSITIVE);
        if distance_m >= self.radius_m {
            0.0
        } else {
            0.5 + 0.5 * (std::f64::consts::PI * part.clamp(0.0, 1.0)).cos()
        }
    }

    /// # Errors
    /// [`Error::Value`] for values that no brush can have.
    pub(super) fn check(&self, face_count: usize) -> Result<()> {
        let value = |name: &str, message: String| Err(Error::value(format!("dab.{name}"), message));
        if self.spot.face >= face_count {
            return value(
                "spot",
                format!(
                    "there is no face {} but only {face_count}; give a face of the surface",
                    self.spot.face
                ),
            );
        }
        let sum: f64 = self.spot.weights.iter().sum();
        if !((sum - 1.0).abs() < 1e-6 && self.spot.weights.iter().all(|w| *w >= -1e-6)) {
            return value(
                "spot",
                format!(
                    "the shares {:?} name no point of a face; give three of 0 and more, of sum 1",
                    self.spot.weights
                ),
            );
        }
        if !(self.radius_m.is_finite() && self.radius_m > 0.0) {
            return value(
                "radius_m",
                format!("{} is no radius; give a positive number of metres", self.radius_m),
            );
        }
        if !(0.0..=1.0).contains(&self.core) {
            return value("core", format!("{} is no share; give a number from 0 to 1", self.core));
        }
        match self.paint {
            Paint::Growth { factor, .. } if !(0.1..=10.0).contains(&factor) => value(
                "factor",
                format!("{factor} is no growth of one dab; give a factor of length from 0.1 to 10"),
            ),
            Paint::Growth { direction: Some(d), .. }
                if !(d.norm() > 0.0 && d.iter().all(|x| x.is_finite())) =>
            {
                value("direction", "it has no length; give a direction in space".to_owned())
            }
            _ => Ok(()),
        }
    }
}

impl Paint {
    /// The values `at` a vertex after this paint has acted on them with a `strength` (0 to 1).
    pub(super) fn apply(&self, at: &GrowthAt, strength: f64, options: &SculptOptions) -> GrowthAt {
        let blend = |from: f64, to: f64| from + strength * (to - from);
        let mut at = *at;
        match *self {
            Self::Growth { factor, direction } => {
                at.growth = grown(&at.growth, factor.powf(strength), direction, options);
            }
            Self::Wavelength(to) => at.wavelength_m *= (to / at.wavelength_m).powf(strength),
            Self::Coherence(to) => at.coherence_m = blend(at.coherence_m, to),
            Self::Bias(to) => at.bias = blend(at.bias, to),
            Self::Stickiness(to) => at.stickiness = blend(at.stickiness, to),
            Self::Freeze(frozen) if strength >= 0.5 => at.frozen = [frozen; 3],
            Self::Freeze(_) => {}
        }
        at
    }
}

/// `growth` followed by a growth by `factor` along `direction`, or in all directions without one.
/// Unchanged where that would exceed the limits, or where the direction is normal to the surface.
fn grown(
    growth: &GrowthTensor,
    factor: f64,
    direction: Option<Vec3>,
    options: &SculptOptions,
) -> GrowthTensor {
    let later = match direction {
        None => GrowthTensor { form: Mat2::identity() * (factor * factor), ..*growth },
        Some(direction) => {
            let normal = growth.along.cross(&growth.across);
            let flat = direction - normal * normal.dot(&direction);
            let Some(along) = flat.try_normalize(1e-6 * direction.norm()) else { return *growth };
            GrowthTensor {
                along,
                across: normal.cross(&along),
                form: Mat2::new(factor * factor, 0.0, 0.0, 1.0),
            }
        }
    };
    let one = |growth: GrowthTensor| Expansion { vertices: vec![growth] };
    let whole = one(*growth).then(&one(later)).vertices[0];
    let ([most, least], _) = whole.principal();
    let further = most > options.growth_limit && factor > 1.0
        || least < 1.0 / options.growth_limit && factor < 1.0;
    if further { *growth } else { whole }
}
