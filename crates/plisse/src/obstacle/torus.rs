//! The solid torus.

use std::f64::consts::TAU;

use super::{LEAST_RELATIVE_RADIUS, Nearby, perpendicular, tangent_projection, tessellate::AROUND};
use crate::mesh::{Mat3, Vec3};

/// Vertices around the tube in pictures.
const ROUND_TUBE: usize = 24;

#[derive(Clone, Debug)]
pub(super) struct Torus {
    centre: Vec3,
    /// Unit.
    axis: Vec3,
    /// Of the circle in the middle of the tube.
    radius: f64,
    tube: f64,
}

impl Torus {
    pub(super) fn new(centre: Vec3, axis: Vec3, radius: f64, tube: f64) -> Self {
        Self { centre, axis, radius, tube }
    }

    /// Outward unit vector from the axis at `p`, and how far from it `p` is. On the axis every
    /// direction is as good.
    fn out(&self, p: &Vec3) -> (Vec3, f64) {
        let offset = p - self.centre;
        let off = offset - self.axis * self.axis.dot(&offset);
        let distance = off.norm();
        (
            if distance > f64::MIN_POSITIVE { off / distance } else { perpendicular(&self.axis) },
            distance,
        )
    }

    pub(super) fn distance_m(&self, p: &Vec3) -> f64 {
        let (out, _) = self.out(p);
        (p - self.centre - out * self.radius).norm() - self.tube
    }

    pub(super) fn nearby(&self, p: &Vec3, reach_m: f64) -> Option<Nearby> {
        let (out, off) = self.out(p);
        let from_middle = p - self.centre - out * self.radius;
        let length = from_middle.norm();
        let distance_m = length - self.tube;
        if distance_m > reach_m {
            return None;
        }
        let gradient = if length > f64::MIN_POSITIVE { from_middle / length } else { self.axis };
        // Around the tube as around a point in its cross-section, around the axis as fast as the
        // middle's direction turns: the gradient's part along `out`, over the distance from the
        // axis.
        let around = self.axis.cross(&out);
        let section: Mat3 = tangent_projection(&gradient) - around * around.transpose();
        let least = LEAST_RELATIVE_RADIUS * self.tube;
        let hessian = section / length.max(least)
            + around * around.transpose() * (gradient.dot(&out) / off.max(least));
        Some(Nearby { distance_m, gradient, hessian })
    }

    pub(super) fn surface(&self) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let u = perpendicular(&self.axis);
        let v = self.axis.cross(&u);
        let angle = |k: usize, count: usize| (TAU * k as f64 / count as f64).sin_cos();
        let mut positions = Vec::with_capacity(2 * AROUND * ROUND_TUBE);
        for j in 0..ROUND_TUBE {
            for i in 0..2 * AROUND {
                let ((sine, cosine), (up, far)) = (angle(i, 2 * AROUND), angle(j, ROUND_TUBE));
                let off = self.radius + self.tube * far;
                positions.push(
                    self.centre + (u * cosine + v * sine) * off + self.axis * (self.tube * up),
                );
            }
        }
        let at = |i: usize, j: usize| (j % ROUND_TUBE) * 2 * AROUND + i % (2 * AROUND);
        let quads = (0..ROUND_TUBE).flat_map(|j| (0..2 * AROUND).map(move |i| (i, j)));
        let faces = quads.flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        });
        (positions, faces.collect())
    }
}
