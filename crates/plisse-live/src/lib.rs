//! Wrinkles on animated meshes in real time, after [Loviscach 2006], *Wrinkling Coarse Meshes on the GPU*.
//!
//! Four stages, each a function of arrays, f32 like their GPU twins: [`skin`] moves the vertices, [`crush`] measures how much
//! and where to the surface is compressed, [`relax`] aligns the phases of neighbouring waves, [`render`] reads height, normal
//! and texture shift at a point of a face. [`live`] runs the first three frame by frame, [`play`] through a clip. Models come from glTF
//! files
//! ([`gltf_in`]) or are made here ([`models`]); [`unify`] joins the vertices that texture seams split.
//! [`bias`] holds wrinkles of the rest pose, [`mod@wavelength`] wavelengths that differ from vertex to vertex.
//! [`field`] converts to and from the library's wrinkle field, [`bake`] makes maps, [`export`] geometry.
//!
//! Units: metre, radian, second. "Rest" is the model's bind pose, "posed" the current frame.

pub mod bake;
pub mod bias;
pub mod crush;
pub mod export;
pub mod field;
mod glb_out;
pub mod gltf_in;
pub mod live;
pub mod model;
pub mod models;
pub mod play;
pub mod profile;
pub mod relax;
pub mod render;
pub mod skin;
pub mod unify;
pub mod wavelength;

/// A point or vector in space (m).
pub type Vec3 = nalgebra::Vector3<f32>;
/// Texture coordinates.
pub type Vec2 = nalgebra::Vector2<f32>;
/// An affine map of space.
pub type Mat4 = nalgebra::Matrix4<f32>;

/// The representative of `angle_rad` in [−π, π).
pub fn wrap(angle_rad: f32) -> f32 {
    use std::f32::consts::TAU;
    angle_rad - TAU * (angle_rad / TAU + 0.5).floor()
}
