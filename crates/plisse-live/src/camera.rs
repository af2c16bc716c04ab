//! A perspective camera that looks at a model.

use crate::shade::Light;
use crate::{Mat4, Vec3};

/// Vertical opening angle (rad).
const OPENING_RAD: f32 = 0.5;

/// Position and lens of a viewer. Right-handed; the sky is +y, as in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye (m).
    pub eye: Vec3,
    /// The point in the middle of the picture (m).
    pub target: Vec3,
    /// Nearest and farthest depth that is drawn (m).
    pub depth: [f32; 2],
    /// Width of the picture over its height.
    pub aspect: f32,
}

impl Camera {
    /// A camera that holds all of `positions` (those that are finite), seen from `yaw_rad` to the
    /// right of +z and `pitch_rad` above the horizon.
    pub fn fit<'a>(
        positions: impl Iterator<Item = &'a Vec3> + Clone,
        yaw_rad: f32,
        pitch_rad: f32,
        aspect: f32,
    ) -> Self {
        let finite = positions.filter(|p| p.iter().all(|x| x.is_finite()));
        let low = finite.clone().fold(Vec3::repeat(f32::INFINITY), |a, p| a.inf(p));
        let high = finite.clone().fold(Vec3::repeat(f32::NEG_INFINITY), |a, p| a.sup(p));
        let (low, high) =
            if low.x <= high.x { (low, high) } else { (Vec3::repeat(-1.0), Vec3::repeat(1.0)) };
        let pitch_rad = pitch_rad.clamp(-1.5, 1.5);
        let back = Vec3::new(
            yaw_rad.sin() * pitch_rad.cos(),
            pitch_rad.sin(),
            yaw_rad.cos() * pitch_rad.cos(),
        );
        let (right, up) = frame(&back);
        let middle = 0.5 * (low + high);
        let tan = (0.5 * OPENING_RAD).tan();
        // The middle of what is seen, then the distance at which every point is inside the
        // picture's edges.
        let span = |axis: &Vec3| {
            finite
                .clone()
                .map(|p| axis.dot(&(p - middle)))
                .fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
        };
        let centre = |[a, b]: [f32; 2]| if a <= b { 0.5 * (a + b) } else { 0.0 };
        let target = middle + right * centre(span(&right)) + up * centre(span(&up));
        let mut distance = 1e-3 * (high - low).norm().max(1e-6);
        for p in finite {
            let d = p - target;
            let needed = (up.dot(&d).abs() / tan).max(right.dot(&d).abs() / (tan * aspect)) * 1.06;
            distance = distance.max(needed + back.dot(&d));
        }
        let radius = (high - low).norm().max(1e-6);
        let depth = [(distance - radius).max(1e-2 * distance), distance + radius];
        Self { eye: target + back * distance, target, depth, aspect }
    }

    /// A camera that sees everything `factor` times as large.
    pub fn nearer(&self, factor: f32) -> Self {
        let away = self.eye - self.target;
        let depth =
            self.depth.map(|d| (d + away.norm() * (1.0 / factor - 1.0)).max(1e-4 * away.norm()));
        Self { eye: self.target + away / factor, depth, ..*self }
    }

    /// Map from the world to clip space (depth 0 to 1), as wgpu has it.
    pub fn clip_from_world(&self) -> Mat4 {
        let back = (self.eye - self.target).normalize();
        let (right, up) = frame(&back);
        let row = |axis: &Vec3| [axis.x, axis.y, axis.z, -axis.dot(&self.eye)];
        let [r, u, b] = [row(&right), row(&up), row(&back)];
        let view = Mat4::new(
            r[0], r[1], r[2], r[3], //
            u[0], u[1], u[2], u[3], //
            b[0], b[1], b[2], b[3], //
            0.0, 0.0, 0.0, 1.0,
        );
        let tall = 1.0 / (0.5 * OPENING_RAD).tan();
        let [near, far] = self.depth;
        let k = far / (near - far);
        #[rustfmt::skip]
        let lens = Mat4::new(
            tall / self.aspect, 0.0, 0.0, 0.0,
            0.0, tall, 0.0, 0.0,
            0.0, 0.0, k, k * near,
            0.0, 0.0, -1.0, 0.0,
        );
        lens * view
    }

    /// A lamp over the viewer's left shoulder, low enough to graze the surface.
    pub fn light(&self) -> Light {
        let back = (self.eye - self.target).normalize();
        let (right, up) = frame(&back);
        Light { lamp: (back * 0.75 - right * 0.75 + up * 0.65).normalize(), up: Vec3::y() }
    }
}

/// Directions to the right and up of a viewer who looks against `back`.
fn frame(back: &Vec3) -> (Vec3, Vec3) {
    let right = Vec3::y().cross(back).try_normalize(1e-6).unwrap_or_else(Vec3::x);
    (right, back.cross(&right))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_inside_the_picture_and_fills_it() {
        let points: Vec<Vec3> = (0..64)
            .map(|i| Vec3::new((i % 4) as f32, (i / 4 % 4) as f32 * 0.5, (i / 16) as f32 * 2.0))
            .collect();
        for (yaw, pitch, aspect) in [(0.0, 0.0, 1.0), (0.6, 0.3, 1.6), (3.0, -0.4, 0.5)] {
            let camera = Camera::fit(points.iter(), yaw, pitch, aspect);
            let seen = |p: &Vec3| {
                let clip = camera.clip_from_world() * p.push(1.0);
                clip.xyz() / clip.w
            };
            let most = points.iter().map(seen).fold(Vec3::zeros(), |a, p| a.sup(&p.abs()));
            assert!(most.x < 1.0 && most.y < 1.0 && most.x.max(most.y) > 0.8, "{most}");
            assert!(points.iter().map(seen).all(|p| p.z > 0.0 && p.z < 1.0));
        }
        // Up is up, and +x is on the right when looking along -z.
        let camera = Camera::fit(points.iter(), 0.0, 0.0, 1.0);
        let clip = camera.clip_from_world() * Vec3::new(3.0, 1.5, 0.0).push(1.0);
        assert!(clip.x > 0.0 && clip.y > 0.0);
        let _ = Camera::fit([Vec3::repeat(f32::NAN)].iter(), 0.0, 0.0, 1.0);
    }
}
