//! From where a surface is looked at, and how it fills a view. Orthographic, so a length means the
//! same everywhere.

use super::Subject;
use crate::mesh::{Mat3, Up, Vec3};

/// A direction of view, and the part of space it should show.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Rows: right, up and toward the viewer, as unit vectors of the world.
    view_from_world: Mat3,
    bounds: Bounds,
}

impl Camera {
    /// A view of `positions` (m) from `azimuth_deg` (degrees; 0 is the front of `up`, positive
    /// walks to the viewer's right) and `elevation_deg` (degrees; 90 is straight from above).
    /// Positions that are not finite do not count.
    pub fn fit(positions: &[Vec3], up: Up, azimuth_deg: f64, elevation_deg: f64) -> Self {
        let (up, front) = up_and_front(up);
        let right = up.cross(&front);
        let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
        let (sin_elevation, cos_elevation) = elevation_deg.to_radians().sin_cos();
        let toward =
            (front * cos_azimuth + right * sin_azimuth) * cos_elevation + up * sin_elevation;
        Self::looking(positions, right * cos_azimuth - front * sin_azimuth, toward)
    }

    /// A sensible view of `positions` (m). A nearly flat surface is seen from its upper or front
    /// side, 25° off its normal so that relief shows, with its longer extent across the picture;
    /// any other one from azimuth 30°, elevation 20°.
    pub fn automatic(positions: &[Vec3], up: Up) -> Self {
        match flat_frame(positions, up) {
            Some((right, normal)) => {
                let (sin, cos) = 25f64.to_radians().sin_cos();
                Self::looking(positions, right, normal * cos - normal.cross(&right) * sin)
            }
            None => Self::fit(positions, up, 30.0, 20.0),
        }
    }

    fn looking(positions: &[Vec3], right: Vec3, toward: Vec3) -> Self {
        let view_from_world = Mat3::from_rows(&[
            right.transpose(),
            toward.cross(&right).transpose(),
            toward.transpose(),
        ]);
        let bounds =
            positions.iter().fold(Bounds::EMPTY, |bounds, p| bounds.with(view_from_world * p));
        Self { view_from_world, bounds }
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }
}

/// A box in view space: right, up (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    const EMPTY: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    fn with(mut self, p: Vec3) -> Self {
        if p.iter().all(|x| x.is_finite()) {
            for k in 0..2 {
                self.low[k] = self.low[k].min(p[k]);
                self.high[k] = self.high[k].max(p[k]);
            }
        }
        self
    }

    /// The box that also holds `subject`.
    pub(super) fn including(self, camera: &Camera, subject: Subject) -> Self {
        subject.positions.iter().fold(self, |bounds, p| bounds.with(camera.view_from_world * p))
    }

    /// Half width and half height (m), positive even if there is nothing to see.
    pub(super) fn half_extent(&self) -> [f64; 2] {
        let half = [0, 1].map(|k| ((self.high[k] - self.low[k]) / 2.0).clamp(0.0, 1e150));
        let least = 1e-3 * half[0].max(half[1]).max(1e-9);
        half.map(|h| h.max(least))
    }

    fn centre(&self) -> [f64; 2] {
        [0, 1].map(|k| {
            if self.low[k] <= self.high[k] { self.low[k] / 2.0 + self.high[k] / 2.0 } else { 0.0 }
        })
    }
}

/// A camera, a scale and a view of known size in pixels: the map from space to pixels.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub(super) view_from_world: Mat3,
    centre: [f64; 2],
    pixels_per_metre: f64,
    /// Width and height (pixels).
    pub(super) size: (usize, usize),
}

impl Frame {
    pub(super) fn new(camera: &Camera, bounds: &Bounds, size: (usize, usize)) -> Self {
        let half = bounds.half_extent();
        // Two pixels of air on each side, so that a silhouette is anti-aliased on both of its
        // sides.
        let room = [size.0, size.1].map(|n| (n as f64 / 2.0 - 2.0).max(0.5));
        let pixels_per_metre = (room[0] / half[0]).min(room[1] / half[1]);
        Self {
            view_from_world: camera.view_from_world,
            centre: bounds.centre(),
            pixels_per_metre,
            size,
        }
    }

    pub(super) fn pixels_per_metre(&self) -> f64 {
        self.pixels_per_metre
    }

    /// `p` (m) in pixels: right and down from the view's upper left corner, and toward the viewer.
    pub(super) fn pixel_from_world(&self, p: &Vec3) -> [f64; 3] {
        let view = self.view_from_world * p;
        [
            self.size.0 as f64 / 2.0 + (view.x - self.centre[0]) * self.pixels_per_metre,
            self.size.1 as f64 / 2.0 - (view.y - self.centre[1]) * self.pixels_per_metre,
            view.z * self.pixels_per_metre,
        ]
    }
}

fn up_and_front(up: Up) -> (Vec3, Vec3) {
    match up {
        Up::Y => (Vec3::y(), Vec3::z()),
        Up::Z => (Vec3::z(), -Vec3::y()),
    }
}

/// The direction across the picture and the normal of a nearly flat surface; `None` if it is
/// thicker than a tenth of its width.
fn flat_frame(positions: &[Vec3], up: Up) -> Option<(Vec3, Vec3)> {
    let finite = || positions.iter().filter(|p| p.iter().all(|x| x.is_finite()));
    let count = finite().count();
    if count < 3 {
        return None;
    }
    let mean = finite().fold(Vec3::zeros(), |sum, p| sum + p / count as f64);
    let size = finite().fold(0f64, |size, p| size.max((p - mean).amax()));
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let covariance = finite().fold(Mat3::zeros(), |sum, p| {
        let d = (p - mean) / size;
        sum + d * d.transpose()
    });
    let eigen = covariance.symmetric_eigen();
    let mut normal: Vec3 = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    let width = |direction: &Vec3| {
        let (low, high) = finite()
            .map(|p| (p - mean).dot(direction))
            .fold((0f64, 0f64), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let (up, front) = up_and_front(up);
    let seed = [Vec3::x(), Vec3::y(), Vec3::z()]
        .map(|axis| axis - normal * axis.dot(&normal))
        .into_iter()
        .fold(
            Vec3::zeros(),
            |best, axis| if axis.norm() > best.norm() + 1e-6 { axis } else { best },
        )
        .normalize();
    if normal.dot(&up).abs() > 0.3 {
        normal *= normal.dot(&up).signum();
    } else if normal.dot(&front).abs() > 0.3 {
        normal *= normal.dot(&front).signum();
    } else if normal[normal.iamax()] < 0.0 {
        normal = -normal;
    }
    // The narrowest rectangle around the surface, but a coordinate axis unless another direction is
    // clearly better.
    let mut best = (f64::INFINITY, seed, [1.0, 1.0]);
    let some: Vec<Vec3> = finite().step_by(count.div_ceil(20_000)).map(|p| p - mean).collect();
    for degrees in 0..90 {
        let right = seed * f64::from(degrees).to_radians().cos()
            + normal.cross(&seed) * f64::from(degrees).to_radians().sin();
        let extent = [right, normal.cross(&right)].map(|direction| {
            let (low, high) = some
                .iter()
                .map(|d| d.dot(&direction))
                .fold((0f64, 0f64), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        });
        let area = extent[0] * extent[1];
        if area < best.0 {
            best = (if degrees == 0 { 0.97 * area } else { area }, right, extent);
        }
    }
    let (_, mut right, extent) = best;
    if width(&normal) > 0.1 * extent[0].max(extent[1]) {
        return None;
    }
    if extent[1] > 1.05 * extent[0] {
        right = normal.cross(&right);
    }
    let rise = normal.cross(&right).dot(&up);
    if rise < -0.3 || (rise < 0.3 && right[right.iamax()] < 0.0) {
        right = -right;
    }
    Some((right, normal))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(camera: &Camera) -> [Vec3; 3] {
        [0, 1, 2].map(|k| camera.view_from_world.row(k).transpose())
    }

    fn sheet(a: Vec3, b: Vec3) -> Vec<Vec3> {
        (0..=20)
            .flat_map(|i| {
                (0..=20).map(move |j| a * (f64::from(i) / 20.0) + b * (f64::from(j) / 20.0))
            })
            .collect()
    }

    #[test]
    fn a_view_is_a_rotation() {
        for (up, azimuth, elevation) in [(Up::Y, 200.0, -35.0), (Up::Z, 30.0, 20.0)] {
            let m = Camera::fit(&[], up, azimuth, elevation).view_from_world;
            assert!((m * m.transpose() - Mat3::identity()).amax() < 1e-14);
            assert!((m.determinant() - 1.0).abs() < 1e-14);
        }
        let [right, up, toward] = rows(&Camera::fit(&[], Up::Y, 0.0, 0.0));
        assert_eq!((right, up, toward), (Vec3::x(), Vec3::y(), Vec3::z()));
    }

    #[test]
    fn a_flat_sheet_lies_across_the_picture_and_is_seen_almost_face_on() {
        let lying =
            Camera::automatic(&sheet(Vec3::new(0.1, 0.0, 0.0), Vec3::new(0.0, 0.25, 0.0)), Up::Z);
        let [right, _, toward] = rows(&lying);
        assert!((right - Vec3::y()).norm() < 1e-9, "{right}");
        assert!((toward.z - 25f64.to_radians().cos()).abs() < 1e-9);
        let square = Camera::automatic(&sheet(Vec3::x(), Vec3::y()), Up::Y);
        let [right, up, toward] = rows(&square);
        assert!((right - Vec3::x()).norm() < 1e-9 && up.y > 0.9 && toward.z > 0.9);
        let turned = Vec3::new(0.6, 0.8, 0.0);
        let oblique = Camera::automatic(&sheet(turned, Vec3::new(-0.24, 0.18, 0.0)), Up::Z);
        assert!((rows(&oblique)[0] - turned).norm() < 0.02);
    }

    #[test]
    fn every_point_is_inside_the_frame() {
        let mut positions = sheet(Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.3, 0.4));
        positions.push(Vec3::new(f64::NAN, 0.0, 0.0));
        let camera = Camera::fit(&positions[..100], Up::Y, 30.0, 20.0);
        let subject = Subject { positions: &positions, faces: &[] };
        let frame = Frame::new(&camera, &camera.bounds().including(&camera, subject), (200, 100));
        for p in &positions[..441] {
            let [x, y, _] = frame.pixel_from_world(p);
            assert!((1.9..198.1).contains(&x) && (1.9..98.1).contains(&y));
        }
    }
}
