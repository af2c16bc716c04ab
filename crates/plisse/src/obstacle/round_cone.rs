//! The convex hull of two balls of which neither contains the other: a cone's slant between two
//! caps, smooth all over.

use super::sphere::around_point;
use super::{LEAST_RELATIVE_RADIUS, Nearby, perpendicular, tessellate};
use crate::mesh::Vec3;

#[derive(Clone, Debug)]
pub(super) struct RoundCone {
    from: Vec3,
    to: Vec3,
    radius: f64,
    end_radius: f64,
    /// Unit, from `from` to `to`.
    axis: Vec3,
    length: f64,
    /// Sine and cosine of the angle by which the slant's normal leans towards `to`.
    sine: f64,
    cosine: f64,
}

/// The part of the surface that is closest, with what its distance needs.
enum Region {
    /// The cap around `from`.
    Start,
    /// The cap around `to`.
    End,
    /// The slant: offset from the axis, and its length.
    Slant(Vec3, f64),
}

impl RoundCone {
    /// Nothing if one ball contains the other.
    pub(super) fn new(from: Vec3, to: Vec3, radius: f64, end_radius: f64) -> Option<Self> {
        let length = (to - from).norm();
        let narrowing = radius - end_radius;
        // With all of them positive, this is 0 < length² − narrowing², without loss.
        let slant_squared = (length - narrowing) * (length + narrowing);
        if !(slant_squared > 0.0 && length > narrowing.abs()) {
            return None;
        }
        let axis = (to - from) / length;
        let (sine, cosine) = (narrowing / length, slant_squared.sqrt() / length);
        Some(Self { from, to, radius, end_radius, axis, length, sine, cosine })
    }

    /// The region of `p` with its signed distance. Regions part along the slant's normals at its
    /// two ends.
    fn locate(&self, p: &Vec3) -> (Region, f64) {
        let offset = p - self.from;
        let along = offset.dot(&self.axis);
        let across = offset - self.axis * along;
        let off_axis = across.norm();
        let along_slant = self.cosine * along - self.sine * off_axis;
        if along_slant < 0.0 {
            (Region::Start, offset.norm() - self.radius)
        } else if along_slant > self.cosine * self.length {
            (Region::End, (p - self.to).norm() - self.end_radius)
        } else {
            (
                Region::Slant(across, off_axis),
                self.sine * along + self.cosine * off_axis - self.radius,
            )
        }
    }

    pub(super) fn distance_m(&self, p: &Vec3) -> f64 {
        self.locate(p).1
    }

    pub(super) fn nearby(&self, p: &Vec3, reach_m: f64) -> Option<Nearby> {
        match self.locate(p) {
            (_, distance_m) if distance_m > reach_m => None,
            (Region::Start, _) => around_point(&(p - self.from), self.radius, reach_m),
            (Region::End, _) => around_point(&(p - self.to), self.end_radius, reach_m),
            (Region::Slant(across, off_axis), distance_m) => {
                // On the axis every direction around it is as good.
                let outward = if off_axis > f64::EPSILON * self.length {
                    across / off_axis
                } else {
                    perpendicular(&self.axis)
                };
                let around = self.axis.cross(&outward);
                let gradient = (self.axis * self.sine + outward * self.cosine).normalize();
                let bend = self.cosine
                    / off_axis.max(LEAST_RELATIVE_RADIUS * self.radius.min(self.end_radius));
                Some(Nearby { distance_m, gradient, hessian: around * around.transpose() * bend })
            }
        }
    }

    pub(super) fn surface(&self) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        const CAP_RINGS: usize = 12;
        let lean = self.sine.asin();
        let quarter = std::f64::consts::FRAC_PI_2;
        // The outline from the pole of `from` to that of `to`: distance along and off the axis.
        let mut outline = Vec::new();
        for k in 1..=CAP_RINGS {
            let angle = -quarter + (lean + quarter) * k as f64 / CAP_RINGS as f64;
            outline.push([self.radius * angle.sin(), self.radius * angle.cos()]);
        }
        let slant_start = outline[CAP_RINGS - 1];
        let slant_end = [self.length + self.end_radius * self.sine, self.end_radius * self.cosine];
        let width =
            self.radius.max(self.end_radius) * std::f64::consts::TAU / tessellate::AROUND as f64;
        let pieces = (self.length * self.cosine / width).ceil().clamp(1.0, 28.0) as usize;
        for k in 1..pieces {
            let t = k as f64 / pieces as f64;
            outline.push([0, 1].map(|i| slant_start[i] + t * (slant_end[i] - slant_start[i])));
        }
        for k in 0..CAP_RINGS {
            let angle = lean + (quarter - lean) * k as f64 / CAP_RINGS as f64;
            outline
                .push([self.length + self.end_radius * angle.sin(), self.end_radius * angle.cos()]);
        }
        tessellate::revolve(
            &self.from,
            &self.axis,
            -self.radius,
            &outline,
            self.length + self.end_radius,
        )
    }
}
