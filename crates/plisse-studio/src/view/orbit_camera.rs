//! An orbit camera: it turns around a point, and moves nearer and farther; y stays up.

use plisse_live::Vec3;
use plisse_live::camera::Camera;

use crate::document::subject::bounds;

/// Tangent of half the camera's opening angle, from its clip matrix.
fn half_height(camera: &Camera) -> f32 {
    // Clip y of a point one unit above the middle, at the distance 1, is 1/tan.
    1.0 / camera.clip_from_world().fixed_view::<1, 3>(1, 0).norm()
}

/// An orbit camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitCamera {
    /// The point it looks at (m).
    pub target: Vec3,
    /// Angle to the right of +z (rad).
    pub yaw_rad: f32,
    /// Angle above the horizon (rad).
    pub pitch_rad: f32,
    /// Distance from the point (m).
    pub distance_m: f32,
    /// Radius around the target that stays within the depth range (m).
    pub radius_m: f32,
}

impl OrbitCamera {
    /// A camera that sees all of `positions` in a picture of this width over height.
    pub fn fit(positions: &[Vec3], yaw_rad: f32, pitch_rad: f32, aspect: f32) -> Self {
        let camera = Camera::fit(positions.iter(), yaw_rad, pitch_rad, aspect);
        let [low, high] = bounds(positions);
        let radius_m = 0.5 * (high - low).norm().max(1e-6);
        Self {
            target: camera.target,
            yaw_rad,
            pitch_rad: pitch_rad.clamp(-1.5, 1.5),
            distance_m: (camera.eye - camera.target).norm(),
            radius_m,
        }
    }

    /// The camera for a picture of this width over height.
    pub fn camera(&self, aspect: f32) -> Camera {
        let back = self.back();
        let reach = 2.5 * self.radius_m + (self.distance_m * 0.05);
        let near = (self.distance_m - reach).max(5e-3 * self.distance_m);
        Camera {
            eye: self.target + back * self.distance_m,
            target: self.target,
            depth: [near, self.distance_m + reach],
            aspect,
        }
    }

    /// Unit vector from the point to the eye.
    pub fn back(&self) -> Vec3 {
        let (yaw, pitch) = (self.yaw_rad, self.pitch_rad);
        Vec3::new(yaw.sin() * pitch.cos(), pitch.sin(), yaw.cos() * pitch.cos())
    }

    /// Turns by these angles (rad).
    pub fn orbit(&mut self, yaw_rad: f32, pitch_rad: f32) {
        self.yaw_rad = (self.yaw_rad + yaw_rad).rem_euclid(std::f32::consts::TAU);
        self.pitch_rad = (self.pitch_rad + pitch_rad).clamp(-1.5, 1.5);
    }

    /// Moves the picture by shares of its height, to the right and down.
    pub fn pan(&mut self, right: f32, down: f32) {
        let back = self.back();
        let x = Vec3::y().cross(&back).try_normalize(1e-6).unwrap_or_else(Vec3::x);
        let y = back.cross(&x);
        let height_m = 2.0 * self.distance_m * half_height(&self.camera(1.0));
        self.target += (y * down - x * right) * height_m;
    }

    /// Makes everything `factor` times as large.
    pub fn zoom(&mut self, factor: f32) {
        if factor.is_finite() && factor > 0.0 {
            self.distance_m =
                (self.distance_m / factor).clamp(1e-2 * self.radius_m, 1e2 * self.radius_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(camera: &Camera, p: &Vec3) -> Vec3 {
        let clip = camera.clip_from_world() * p.push(1.0);
        clip.xyz() / clip.w
    }

    #[test]
    fn what_fits_stays_in_the_picture_while_it_turns() {
        let points: Vec<Vec3> = (0..27)
            .map(|i| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32))
            .collect();
        let mut orbit = OrbitCamera::fit(&points, 0.5, 0.3, 1.4);
        let inside = |orbit: &OrbitCamera| {
            points
                .iter()
                .map(|p| seen(&orbit.camera(1.4), p))
                .all(|c| c.x.abs() < 1.2 && c.y.abs() < 1.2 && (0.0..1.0).contains(&c.z))
        };
        assert!(inside(&orbit));
        for _ in 0..7 {
            orbit.orbit(0.9, 0.11);
            assert!(inside(&orbit));
        }
    }

    #[test]
    fn panning_by_a_half_moves_the_middle_to_the_rim() {
        let points = [Vec3::zeros(), Vec3::repeat(1.0)];
        let mut orbit = OrbitCamera::fit(&points, 0.7, 0.2, 1.0);
        let middle = orbit.target;
        orbit.pan(0.5, 0.0);
        let at = seen(&orbit.camera(1.0), &middle);
        assert!((at.x - 1.0).abs() < 1e-3 && at.y.abs() < 1e-3, "{at}");
        orbit.pan(-0.5, 0.25);
        let at = seen(&orbit.camera(1.0), &middle);
        assert!(at.x.abs() < 1e-3 && (at.y + 0.5).abs() < 1e-3, "{at}");
        let before = orbit.distance_m;
        orbit.zoom(2.0);
        assert!((orbit.distance_m - 0.5 * before).abs() < 1e-5);
    }
}
