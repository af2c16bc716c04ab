//! The half-space below a plane.

use super::{Nearby, perpendicular, tessellate};
use crate::mesh::{Mat3, Vec3};

/// Quads along each side of the picture.
const QUADS: usize = 24;
/// Margin of the picture around the shadow on each side, in widths of the shadow.
const MARGIN: f64 = 0.25;

#[derive(Clone, Debug)]
pub(super) struct Plane {
    point: Vec3,
    /// Unit, out of the solid.
    normal: Vec3,
}

impl Plane {
    pub(super) fn new(point: Vec3, normal: Vec3) -> Self {
        Self { point, normal }
    }

    pub(super) fn distance_m(&self, p: &Vec3) -> f64 {
        (p - self.point).dot(&self.normal)
    }

    pub(super) fn nearby(&self, p: &Vec3, reach_m: f64) -> Option<Nearby> {
        let distance_m = self.distance_m(p);
        (distance_m <= reach_m).then(|| Nearby {
            distance_m,
            gradient: self.normal,
            hessian: Mat3::zeros(),
        })
    }

    pub(super) fn surface(&self, low: &Vec3, high: &Vec3) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let u = perpendicular(&self.normal);
        let v = self.normal.cross(&u);
        let corners = (0..8).map(|mask| {
            Vec3::from_fn(|k, _| if mask >> k & 1 == 1 { high[k] } else { low[k] }) - self.point
        });
        let shadow: Vec<[f64; 2]> = corners.map(|c| [c.dot(&u), c.dot(&v)]).collect();
        let bounds = [0, 1].map(|k| {
            shadow
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s[k]), h.max(s[k])))
        });
        let width = bounds.iter().map(|(l, h)| h - l).fold(0.0, f64::max);
        let margin = if width > 0.0 { MARGIN * width } else { 1.0 };
        let at = |k: usize, i: usize| {
            let (l, h) = (bounds[k].0 - margin, bounds[k].1 + margin);
            l + (h - l) * i as f64 / QUADS as f64
        };
        let ways = (0..=QUADS).flat_map(|j| (0..=QUADS).map(move |i| (i, j)));
        let positions = ways.map(|(i, j)| self.point + u * at(0, i) + v * at(1, j)).collect();
        (positions, tessellate::grid(QUADS, QUADS))
    }
}
