//! Procedural maps: functions of the place on the starting surface, seeded and the same on every
//! machine. They give one number for each vertex, such as an amount of growth or a wavelength λ, or
//! a direction.

use std::f64::consts::TAU;

use crate::mesh::Vec3;
use crate::random::Random;
use crate::{Error, Result};

/// Octaves of fractal noise at most.
const MOST_OCTAVES: usize = 16;

/// A map with values from 0 (low) to 1 (high). Borders are soft over a length (m): 0 cuts sharply.
#[derive(Clone, Debug, PartialEq)]
pub enum ProceduralMap {
    /// 1 everywhere.
    Uniform,
    /// From 0 at `from` to 1 at `to` (m) and beyond, linear between.
    Ramp {
        /// Point with the value 0 (m).
        from: Vec3,
        /// Point with the value 1 (m).
        to: Vec3,
    },
    /// 1 in the slab within half of `width_m` of the plane through `centre` with this normal.
    Band {
        /// A point of the middle plane (m).
        centre: Vec3,
        /// Normal of the middle plane, any length.
        normal: Vec3,
        /// Width (m).
        width_m: f64,
        /// Length (m) over which it falls to 0 beyond the slab.
        soft_m: f64,
    },
    /// 1 within half of `width_m` of the circle of `radius_m` about the axis.
    Ring {
        /// A point of the axis (m).
        centre: Vec3,
        /// Direction of the axis, any length.
        axis: Vec3,
        /// Radius (m).
        radius_m: f64,
        /// Width (m).
        width_m: f64,
        /// Length (m) over which it falls to 0 beyond.
        soft_m: f64,
    },
    /// 1 on the axis through `centre`, falling linearly to 0 at `radius_m`.
    Radial {
        /// A point of the axis (m).
        centre: Vec3,
        /// Direction of the axis, any length.
        axis: Vec3,
        /// Radius (m).
        radius_m: f64,
    },
    /// Round smooth spots at given places.
    Spots {
        /// Their middles (m).
        centres: Vec<Vec3>,
        /// Their radius (m).
        radius_m: f64,
    },
    /// Smooth noise between 0 and 1, in space.
    Noise {
        /// Size of one lump (m).
        size_m: f64,
        /// Seed.
        seed: u64,
    },
    /// Noise on ever smaller scales, each half as large and half as strong as the one before;
    /// between 0 and 1.
    Fractal {
        /// Size of the largest lumps (m).
        size_m: f64,
        /// Number of scales.
        octaves: usize,
        /// Seed.
        seed: u64,
    },
}

impl ProceduralMap {
    /// Checks sizes and directions.
    ///
    /// # Errors
    /// [`Error::Value`] naming the number that cannot be used.
    pub fn check(&self, place: &str) -> Result<()> {
        let positive = |name: &str, value: f64| {
            let fine = value.is_finite() && value > 0.0;
            let message = || format!("{value} is no length; give a positive number of metres");
            if fine { Ok(()) } else { Err(Error::value(format!("{place}.{name}"), message())) }
        };
        let softness = |value: f64| {
            let message = || format!("{value} is no length; give 0 or a positive number of metres");
            if value.is_finite() && value >= 0.0 {
                Ok(())
            } else {
                Err(Error::value(format!("{place}.soft_m"), message()))
            }
        };
        let direction = |name: &str, d: &Vec3| {
            if d.iter().all(|x| x.is_finite()) && d.norm() > 0.0 {
                return Ok(());
            }
            Err(Error::value(
                format!("{place}.{name}"),
                "it has no direction; give a vector that is not zero",
            ))
        };
        match self {
            Self::Uniform => Ok(()),
            Self::Ramp { from, to } => direction("to", &(to - from)),
            Self::Band { normal, width_m, soft_m, .. } => {
                direction("normal", normal)?;
                softness(*soft_m)?;
                positive("width_m", *width_m)
            }
            Self::Ring { axis, radius_m, width_m, soft_m, .. } => {
                direction("axis", axis)?;
                softness(*soft_m)?;
                positive("radius_m", *radius_m)?;
                positive("width_m", *width_m)
            }
            Self::Radial { axis, radius_m, .. } => {
                direction("axis", axis)?;
                positive("radius_m", *radius_m)
            }
            Self::Spots { radius_m, .. } => positive("radius_m", *radius_m),
            Self::Noise { size_m, .. } => positive("size_m", *size_m),
            Self::Fractal { size_m, octaves, .. } => {
                if !(1..=MOST_OCTAVES).contains(octaves) {
                    let message =
                        format!("{octaves} is no number of scales; give 1 to {MOST_OCTAVES}");
                    return Err(Error::value(format!("{place}.octaves"), message));
                }
                positive("size_m", *size_m)
            }
        }
    }

    /// The map at `p` (m), from 0 to 1.
    pub fn value(&self, p: &Vec3) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Ramp { from, to } => {
                let way = to - from;
                ((p - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0)
            }
            Self::Band { centre, normal, width_m, soft_m } => {
                edge((p - centre).dot(&normal.normalize()).abs() - 0.5 * width_m, *soft_m)
            }
            Self::Ring { centre, axis, radius_m, width_m, soft_m } => {
                edge((from_axis(p, centre, axis) - radius_m).abs() - 0.5 * width_m, *soft_m)
            }
            Self::Radial { centre, axis, radius_m } => {
                (1.0 - from_axis(p, centre, axis) / radius_m).clamp(0.0, 1.0)
            }
            Self::Spots { centres, radius_m } => {
                let spot = |c: &Vec3| {
                    let r = ((p - c).norm() / radius_m).min(1.0);
                    (1.0 - r * r).powi(2)
                };
                centres.iter().map(spot).fold(0.0, f64::max)
            }
            Self::Noise { size_m, seed } => noise(&(p / *size_m), *seed),
            Self::Fractal { size_m, octaves, seed } => {
                let (mut sum, mut whole, mut weight, mut place) = (0.0, 0.0, 1.0, p / *size_m);
                for octave in 0..*octaves {
                    sum += weight * noise(&place, seed.wrapping_add(octave as u64));
                    whole += weight;
                    weight *= 0.5;
                    place *= 2.0;
                }
                sum / whole
            }
        }
    }

    /// `[V]` the map between `low` (where it is 0) and `high` (where it is 1), in their unit, at
    /// `positions` (m).
    pub fn map(&self, positions: &[Vec3], low: f64, high: f64) -> Vec<f64> {
        let between = |p: &Vec3| match self.value(p) {
            // Exactly the ends.
            0.0 => low,
            1.0 => high,
            s => low + (high - low) * s,
        };
        positions.iter().map(between).collect()
    }
}

/// Direction in which the surface grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DirectionField {
    /// The same everywhere.
    Fixed(Vec3),
    /// Away from an axis.
    Outward {
        /// A point of the axis (m).
        centre: Vec3,
        /// Direction of the axis, any length.
        axis: Vec3,
    },
    /// Around an axis.
    Around {
        /// A point of the axis (m).
        centre: Vec3,
        /// Direction of the axis, any length.
        axis: Vec3,
    },
}

impl DirectionField {
    /// The direction at `p` (m), of any length; 0 on the axis.
    pub fn at(&self, p: &Vec3) -> Vec3 {
        match self {
            Self::Fixed(direction) => *direction,
            Self::Outward { centre, axis } => away(p, centre, axis),
            Self::Around { centre, axis } => axis.cross(&away(p, centre, axis)),
        }
    }
}

fn away(p: &Vec3, centre: &Vec3, axis: &Vec3) -> Vec3 {
    let (d, unit) = (p - centre, axis.normalize());
    d - unit * unit.dot(&d)
}

fn from_axis(p: &Vec3, centre: &Vec3, axis: &Vec3) -> f64 {
    away(p, centre, axis).norm()
}

/// 1 where `beyond` (m) is not positive, falling smoothly to 0 over `soft_m`.
fn edge(beyond: f64, soft_m: f64) -> f64 {
    if beyond <= 0.0 {
        return 1.0;
    }
    if beyond >= soft_m {
        return 0.0;
    }
    let s = 1.0 - beyond / soft_m;
    s * s * (3.0 - 2.0 * s)
}

/// Smooth noise between 0 and 1: random numbers at the corners of unit cubes, joined smoothly.
fn noise(p: &Vec3, seed: u64) -> f64 {
    let (cell, part) = (p.map(f64::floor), p.map(|x| x - x.floor()));
    let ease = part.map(|t| t * t * t * (t * (6.0 * t - 15.0) + 10.0));
    let mut sum = 0.0;
    for corner in 0..8_u64 {
        let (mut weight, mut state) = (1.0, seed);
        for axis in 0..3 {
            let side = (corner >> axis) & 1;
            weight *= if side == 1 { ease[axis] } else { 1.0 - ease[axis] };
            state = state.rotate_left(23)
                ^ ((cell[axis] as i64).wrapping_add(side as i64) as u64)
                    .wrapping_mul(0x9E37_79B9_7F4A_7C15);
            // One step of the generator mixes all bits.
            state = (Random(state).unit() * 2.0_f64.powi(53)) as u64;
        }
        sum += weight * Random(state).unit();
    }
    sum
}

/// Rough noise of mean 0 and about unit size at `p` (m), with lumps of `size_m` (m): two scales of
/// noise, shifted at random.
pub(crate) fn roughness(p: &Vec3, size_m: f64, seed: u64) -> f64 {
    let (mut sum, mut random) = (0.0, Random(seed ^ 0x5DEE_CE66));
    for octave in 0..2 {
        let size = size_m / (1.0 + octave as f64);
        sum +=
            2.0 * noise(
                &(p / size + Vec3::new(random.unit(), random.unit(), random.unit()) * TAU),
                seed.wrapping_add(octave),
            ) - 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_where_they_should_be() {
        let (x, z) = (Vec3::x(), Vec3::z());
        let band =
            ProceduralMap::Band { centre: x * 0.5, normal: x * 2.0, width_m: 0.2, soft_m: 0.1 };
        assert_eq!([0.5, 0.59, 0.71].map(|s| band.value(&(x * s))), [1.0, 1.0, 0.0]);
        assert!((band.value(&(x * 0.65)) - 0.5).abs() < 1e-12);
        let ring = ProceduralMap::Ring {
            centre: Vec3::zeros(),
            axis: z,
            radius_m: 1.0,
            width_m: 0.2,
            soft_m: 0.0,
        };
        assert_eq!([0.0, 0.95, 1.05, 1.2].map(|s| ring.value(&(x * s + z))), [0.0, 1.0, 1.0, 0.0]);
        let ramp = ProceduralMap::Ramp { from: Vec3::zeros(), to: x * 2.0 };
        assert_eq!(ramp.map(&[x * -1.0, x, x * 3.0], 1.0, 3.0), [1.0, 2.0, 3.0]);
        let spots = ProceduralMap::Spots { centres: vec![x, z], radius_m: 0.5 };
        assert_eq!(
            (spots.value(&x), spots.value(&z), spots.value(&Vec3::zeros())),
            (1.0, 1.0, 0.0)
        );
        let radial = ProceduralMap::Radial { centre: z, axis: z, radius_m: 2.0 };
        assert_eq!(radial.value(&x), 0.5);
        let around = DirectionField::Around { centre: Vec3::zeros(), axis: z };
        assert_eq!(
            (around.at(&x), DirectionField::Outward { centre: z, axis: z }.at(&x)),
            (Vec3::y(), x)
        );
    }

    #[test]
    fn noise_is_smooth_seeded_and_fills_its_range() {
        for procedure in [
            |seed| ProceduralMap::Noise { size_m: 0.1, seed },
            |seed| ProceduralMap::Fractal { size_m: 0.3, octaves: 4, seed },
        ] {
            let at =
                |seed, k: usize| procedure(seed).value(&Vec3::new(k as f64 * 0.003, 0.2, -0.7));
            let values: Vec<f64> = (0..3000).map(|k| at(1, k)).collect();
            let (low, high) =
                values.iter().fold((1.0_f64, 0.0_f64), |(l, h), &v| (l.min(v), h.max(v)));
            assert!(low >= 0.0 && high <= 1.0 && high - low > 0.4, "{low} {high}");
            assert!(values.windows(2).all(|w| (w[1] - w[0]).abs() < 0.15));
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            assert!((mean - 0.5).abs() < 0.1, "{mean}");
            assert!(
                values.iter().enumerate().all(|(k, v)| at(1, k) == *v)
                    && values.iter().enumerate().any(|(k, v)| at(2, k) != *v)
            );
        }
    }

    #[test]
    fn sizes_that_are_none_are_named() {
        let told = |p: ProceduralMap| p.check("growth.amount").unwrap_err().to_string();
        assert!(
            told(ProceduralMap::Noise { size_m: 0.0, seed: 1 }).contains("growth.amount.size_m")
        );
        assert!(
            told(ProceduralMap::Fractal { size_m: 1.0, octaves: 0, seed: 1 }).contains("octaves")
        );
        assert!(
            told(ProceduralMap::Ramp { from: Vec3::x(), to: Vec3::x() }).contains("no direction")
        );
        assert!(
            told(ProceduralMap::Spots { centres: vec![], radius_m: f64::NAN }).contains("radius_m")
        );
    }
}
