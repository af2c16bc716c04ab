//! The ball.

use super::{LEAST_RELATIVE_RADIUS, Nearby, tangent_projection, tessellate};
use crate::mesh::Vec3;

#[derive(Clone, Debug)]
pub(super) struct Sphere {
    centre: Vec3,
    radius: f64,
}

impl Sphere {
    pub(super) fn new(centre: Vec3, radius: f64) -> Self {
        Self { centre, radius }
    }

    pub(super) fn distance_m(&self, p: &Vec3) -> f64 {
        (p - self.centre).norm() - self.radius
    }

    pub(super) fn nearby(&self, p: &Vec3, reach_m: f64) -> Option<Nearby> {
        around_point(&(p - self.centre), self.radius, reach_m)
    }

    pub(super) fn surface(&self) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let (directions, faces) = tessellate::unit_sphere();
        (directions.into_iter().map(|u| self.centre + u * self.radius).collect(), faces)
    }
}

/// Distance to a sphere around the origin, at `offset`.
pub(super) fn around_point(offset: &Vec3, radius: f64, reach_m: f64) -> Option<Nearby> {
    let from_centre = offset.norm();
    let distance_m = from_centre - radius;
    if distance_m > reach_m {
        return None;
    }
    // At the very centre every direction is as good.
    let gradient = if from_centre > f64::MIN_POSITIVE { offset / from_centre } else { Vec3::z() };
    let hessian = tangent_projection(&gradient) / from_centre.max(LEAST_RELATIVE_RADIUS * radius);
    Some(Nearby { distance_m, gradient, hessian })
}
