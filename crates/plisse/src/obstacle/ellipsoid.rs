//! The ellipsoid: exact distance by the foot of the normal through a point.
//!
//! In units of the smallest radius and in the ellipsoid's own axes, let e be the radii (≥ 1), y the
//! point's coordinates without their signs, and x its foot. Lagrange's condition y − x = t·x/e²
//! gives x = e²·g with g = y/(t + e²), and the foot lies on the ellipsoid where G = Σ (e·g)² = 1;
//! see [Eberly 2013, *Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid*]. We
//! take u = t + 1 for unknown, which keeps its relative precision however close t is to the pole at
//! −1, and Newton on 1/√G = 1, which is concave and nearly straight, as is done for trust regions:
//! from below it ascends to the root, in a few steps. The normal is g/|g|, and the distance t·|g|
//! does not cancel near the surface.

use nalgebra::Rotation3;

use super::{Nearby, tangent_projection, tessellate};
use crate::mesh::{Mat3, Vec3};

/// Coordinates below this (in smallest radii) are taken for 0, so that their powers do not vanish.
const TINY: f64 = 1e-90;
/// Least value of (1 + dκ₁)(1 + dκ₂), which is 0 at focal points deep inside.
const LEAST_SPREAD: f64 = 1e-9;

#[derive(Clone, Debug)]
pub(super) struct Ellipsoid {
    centre: Vec3,
    radii: Vec3,
    /// Takes the ellipsoid's axes to those of space.
    turn: Mat3,
    least: f64,
    /// e = radius / least radius.
    e: Vec3,
    /// e² − 1.
    shift: Vec3,
    /// The axis of the least radius.
    shortest: usize,
}

impl Ellipsoid {
    pub(super) fn new(centre: Vec3, radii: [f64; 3], turn: Rotation3<f64>) -> Self {
        let radii = Vec3::from(radii);
        let shortest = radii.imin();
        let least = radii[shortest];
        let e = radii / least;
        Self {
            centre,
            radii,
            turn: turn.into_inner(),
            least,
            e,
            shift: e.map(|e| (e - 1.0) * (e + 1.0)),
            shortest,
        }
    }

    /// The vector g along the outward normal, in the ellipsoid's axes, and the signed distance,
    /// both in least radii.
    fn foot(&self, p: &Vec3) -> (Vec3, f64) {
        let local = self.turn.tr_mul(&(p - self.centre)) / self.least;
        let y = local.map(|x| if x.abs() < TINY { 0.0 } else { x.abs() });
        // Where no shortest coordinate holds u above 0, the root may be the pole itself: the foot
        // is then off the plane of the longer axes, on either side.
        let held = (0..3).any(|k| self.shift[k] == 0.0 && y[k] > 0.0);
        if !held {
            let mut g =
                Vec3::from_fn(|k, _| if self.shift[k] == 0.0 { 0.0 } else { y[k] / self.shift[k] });
            let left = 1.0 - self.e.component_mul(&g).norm_squared();
            if left >= 0.0 {
                g[self.shortest] = left.sqrt();
                return (g.zip_map(&local, f64::copysign), -g.norm());
            }
        }
        let weight = self.e.component_mul(&y);
        // Each coordinate by itself says where the root is at least.
        let mut u =
            (0..3).filter(|&k| y[k] > 0.0).map(|k| weight[k] - self.shift[k]).fold(0.0, f64::max);
        for _ in 0..60 {
            let (mut g2, mut g3) = (0.0, 0.0);
            for k in 0..3 {
                if y[k] > 0.0 {
                    let part = weight[k] / (u + self.shift[k]);
                    g2 += part * part;
                    g3 += part * part / (u + self.shift[k]);
                }
            }
            let step = g2 * (g2.sqrt() - 1.0) / g3;
            u += step.max(0.0);
            if step.is_nan() || step <= 0.5 * f64::EPSILON * u {
                break;
            }
        }
        let g = Vec3::from_fn(|k, _| if y[k] > 0.0 { y[k] / (u + self.shift[k]) } else { 0.0 });
        (g.zip_map(&local, f64::copysign), (u - 1.0) * g.norm())
    }

    /// At most the distance of `p` (m) if it is outside, for next to nothing: where |x/radii| = s >
    /// 1, x is (s − 1) least radii away or more.
    pub(super) fn at_least_m(&self, p: &Vec3) -> f64 {
        let local = self.turn.tr_mul(&(p - self.centre));
        (local.component_div(&self.radii).norm() * (1.0 - 1e-12) - 1.0) * self.least
    }

    pub(super) fn distance_m(&self, p: &Vec3) -> f64 {
        self.foot(p).1 * self.least
    }

    pub(super) fn nearby(&self, p: &Vec3, reach_m: f64) -> Option<Nearby> {
        if self.at_least_m(p) > reach_m {
            return None;
        }
        let (g, distance) = self.foot(p);
        let distance_m = distance * self.least;
        if distance_m > reach_m {
            return None;
        }
        let steepness = g.norm();
        let normal = g / steepness;
        // Shape operator at the foot, P·diag(1/e²)·P/|g| with P the projection to the tangent
        // plane, and its determinant there.
        let flat = tangent_projection(&normal);
        let inverse = self.e.map(|e| 1.0 / (e * e));
        let bend = flat * Mat3::from_diagonal(&inverse) * flat / steepness;
        let gauss = inverse.product() / steepness.powi(4);
        // S(I + dS)⁻¹ of a 2×2 map is (S + d·det S·I) / det(I + dS).
        let spread = (1.0 + distance * (bend.trace() + distance * gauss)).max(LEAST_SPREAD);
        let hessian = (bend + flat * (distance * gauss)) / (spread * self.least);
        let hessian = self.turn * hessian * self.turn.transpose();
        Some(Nearby {
            distance_m,
            gradient: self.turn * normal,
            hessian: (hessian + hessian.transpose()) * 0.5,
        })
    }

    pub(super) fn surface(&self) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let (directions, faces) = tessellate::unit_sphere();
        (
            directions
                .into_iter()
                .map(|u| self.centre + self.turn * u.component_mul(&self.radii))
                .collect(),
            faces,
        )
    }
}
