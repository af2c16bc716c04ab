//! Stage "Render" (5.1, 6): height, normal and texture shift at a point of a face, from the data of
//! its corners.
//!
//! All that is linear over the face is computed at the corners ([`FaceWaves::new`], the vertex
//! stage) and blended at the points ([`FaceWaves::at`], the pixel stage).

use crate::profile::Profile;
use crate::{Vec2, Vec3};

/// The data of a face's corner, all of it posed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Position x′ (m).
    pub position: Vec3,
    /// Unit normal n′.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Amplitude h (m).
    pub amplitude_m: f32,
    /// Wave vector 2π/W·k′ (rad/m).
    pub wave: Vec3,
    /// Phase φ (rad).
    pub phase: f32,
}

/// A face with its waves, ready to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceWaves {
    /// The corners A, B, C.
    pub corners: [Corner; 3],
    /// `[wave][corner]` argument of each corner's wave at each corner (rad).
    pub arguments: [[f32; 3]; 3],
    /// Gradients of u and v by position (1/m), tangential to the face, eq. 11; zero for faces
    /// without an area.
    pub uv_gradient: [Vec3; 2],
}

/// A point of a wrinkled face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position on the base face (m).
    pub position: Vec3,
    /// Height h over it (m), eq. 5.
    pub height_m: f32,
    /// Gradient of the height by position, eq. 8.
    pub gradient: Vec3,
    /// Interpolated unit normal n′ of the base surface.
    pub base_normal: Vec3,
    /// Unit normal of the wrinkled surface, eq. 7.
    pub normal: Vec3,
    /// Texture coordinates of the base point.
    pub uv: Vec2,
}

impl FaceWaves {
    /// Prepares a face.
    pub fn new(corners: [Corner; 3]) -> Self {
        let argument =
            |wave: &Corner, at: &Corner| wave.wave.dot(&(at.position - wave.position)) + wave.phase;
        let arguments = corners.map(|wave| corners.map(|at| argument(&wave, &at)));
        let [a, b, c] = corners;
        let (side_b, side_c) = (b.position - a.position, c.position - a.position);
        let uv_gradient =
            side_b.cross(&side_c).try_normalize(1e-30).map_or([Vec3::zeros(); 2], |n| {
                let area = n.dot(&side_c.cross(&side_b));
                let (n_c, b_n) = (n.cross(&side_c), side_b.cross(&n));
                [0, 1].map(|k| ((b.uv[k] - a.uv[k]) * n_c + (c.uv[k] - a.uv[k]) * b_n) / area)
            });
        Self { corners, arguments, uv_gradient }
    }

    /// The point with barycentric coordinates `weights` (sum 1).
    pub fn at(&self, weights: [f32; 3], profile: &Profile) -> Point {
        let (mut height_m, mut gradient) = (0.0, Vec3::zeros());
        for (k, corner) in self.corners.iter().enumerate() {
            let argument: f32 = (0..3).map(|c| weights[c] * self.arguments[k][c]).sum();
            let (f, df) = profile.at(argument);
            height_m += weights[k] * corner.amplitude_m * f;
            gradient += corner.wave * (weights[k] * corner.amplitude_m * df);
        }
        let blend = |of: fn(&Corner) -> Vec3| {
            (0..3).fold(Vec3::zeros(), |sum, k| sum + of(&self.corners[k]) * weights[k])
        };
        let base_normal = blend(|c| c.normal).try_normalize(1e-20).unwrap_or_else(Vec3::z);
        let normal = (base_normal - gradient).try_normalize(1e-20).unwrap_or(base_normal);
        let uv = (0..3).fold(Vec2::zeros(), |sum, k| sum + self.corners[k].uv * weights[k]);
        Point { position: blend(|c| c.position), height_m, gradient, base_normal, normal, uv }
    }

    /// Texture coordinates seen at `point` by a viewer in direction `to_viewer` (any length), eqs.
    /// 10 and 11.
    pub fn shifted_uv(&self, point: &Point, to_viewer: &Vec3) -> Vec2 {
        let shift = parallax(&point.base_normal, to_viewer, point.height_m);
        point.uv + Vec2::new(self.uv_gradient[0].dot(&shift), self.uv_gradient[1].dot(&shift))
    }
}

/// Shift Δx′ (m) of the point that is seen through the height field, smoothly cut off at grazing
/// angles, eq. 10.
pub fn parallax(normal: &Vec3, to_viewer: &Vec3, height_m: f32) -> Vec3 {
    let up = to_viewer.dot(normal);
    (to_viewer - normal * up)
        * (up / (up * up + 0.1 * to_viewer.norm_squared()).max(1e-30) * height_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(wave: Vec3, phase: f32) -> FaceWaves {
        let corner = |x: f32, y: f32| Corner {
            position: Vec3::new(x, y, 0.0),
            normal: Vec3::z(),
            uv: Vec2::new(3.0 * x + y, -2.0 * y),
            amplitude_m: 0.1,
            wave,
            phase: phase + wave.dot(&Vec3::new(x, y, 0.0)),
        };
        FaceWaves::new([corner(0.0, 0.0), corner(1.0, 0.2), corner(0.1, 0.9)])
    }

    #[test]
    fn agreeing_waves_give_the_plane_wave_and_its_gradient() {
        let (wave, phase) = (Vec3::new(7.0, -3.0, 0.0), 0.4);
        let face = face(wave, phase);
        for weights in [[0.2, 0.3, 0.5], [1.0, 0.0, 0.0], [0.1, 0.1, 0.8]] {
            let point = face.at(weights, &Profile::sine());
            let argument = wave.dot(&point.position) + phase;
            assert!((point.height_m - 0.1 * argument.cos()).abs() < 1e-3);
            assert!((point.gradient + wave * (0.1 * argument.sin())).norm() < 0.01);
            assert!((point.normal.dot(&point.gradient) < 0.0) || point.gradient.norm() < 1e-3);
        }
        // Shown to fail: another phase is another height.
        assert!(
            (face.at([0.2, 0.3, 0.5], &Profile::sine()).height_m
                - self::face(wave, 2.0).at([0.2, 0.3, 0.5], &Profile::sine()).height_m)
                .abs()
                > 1e-3
        );
    }

    #[test]
    fn the_texture_shift_is_where_the_ray_meets_the_height() {
        let face = face(Vec3::new(7.0, -3.0, 0.0), 0.0);
        assert!((face.uv_gradient[0] - Vec3::new(3.0, 1.0, 0.0)).norm() < 1e-5);
        assert!((face.uv_gradient[1] - Vec3::new(0.0, -2.0, 0.0)).norm() < 1e-5);
        // Seen almost from above, eq. 10 is eq. 9 but for a factor 1/1.1: the ray at height h is
        // off by h·tan(angle).
        let shift = parallax(&Vec3::z(), &Vec3::new(0.01, 0.0, 1.0), 0.1);
        assert!((shift - Vec3::new(0.001 / 1.1, 0.0, 0.0)).norm() < 1e-6, "{shift}");
    }
}
