//! The light of stage "Render": one lamp, sky and ground, and a faint sheen. Linear colours, 1
//! being white. CPU reference of `shade` in render.wgsl.

use crate::Vec3;

/// The directions that light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Unit vector towards the lamp.
    pub lamp: Vec3,
    /// Unit vector towards the sky.
    pub up: Vec3,
}

/// Linear colour of a point of colour `albedo` with unit normal `normal`, seen from the unit
/// direction `to_viewer`.
pub fn shade(albedo: Vec3, normal: &Vec3, to_viewer: &Vec3, light: &Light) -> Vec3 {
    let sky = 0.5 + 0.5 * normal.dot(&light.up);
    let ambient = Vec3::new(0.10, 0.09, 0.08).lerp(&Vec3::new(0.28, 0.30, 0.34), sky);
    let lit = normal.dot(&light.lamp).max(0.0);
    let halfway = normal.dot(&(light.lamp + to_viewer).normalize()).max(0.0);
    let sheen = 0.06 * lit * halfway.powi(8);
    albedo.component_mul(&(ambient + Vec3::new(0.92, 0.90, 0.86) * lit)) + Vec3::repeat(sheen)
}

/// The sRGB byte of a linear value in [0, 1] (clamped).
pub fn to_srgb(linear: f32) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let curved = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (255.0 * curved + 0.5) as u8
}

/// The linear value in [0, 1] of an sRGB byte.
pub fn from_srgb(byte: u8) -> f32 {
    let x = f32::from(byte) / 255.0;
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_and_lit_sides_are_brighter() {
        assert!((0..=255).all(|b| to_srgb(from_srgb(b)) == b));
        let light = Light { lamp: Vec3::z(), up: Vec3::y() };
        let towards = shade(Vec3::repeat(0.5), &Vec3::z(), &Vec3::z(), &light);
        let away = shade(Vec3::repeat(0.5), &-Vec3::z(), &Vec3::z(), &light);
        assert!(towards.x > 3.0 * away.x && away.x > 0.05 && towards.x < 1.0);
    }
}
