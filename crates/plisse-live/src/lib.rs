//! Wrinkles on animated meshes in real time, after [Loviscach 2006], *Wrinkling Coarse Meshes on
//! the GPU*.
//!
//! Four stages, each a function of arrays, f32 like their GPU twins: [`skin`] moves the vertices,
//! [`crush`] measures how much and where to the surface is compressed, [`relax`] aligns the phases
//! of neighbouring waves, [`render`] reads height, normal and texture shift at a point of a face
//! ([`gather`] lays out what it reads, [`shade`] lights it). Each stage is here twice: `crush.rs`
//! and `crush.wgsl`; the WGSL texts are in [`wgsl`]. [`live`] runs the first three frame by frame,
//! [`play`] through a clip,
//! [`draw`] makes pictures. Models come from glTF files ([`gltf_in`]) or are made here ([`models`]); [`unify`] joins the vertices that
//! texture seams split.
//! [`bias`] holds wrinkles of the rest pose, [`mod@wavelength`] wavelengths that differ from vertex to vertex.
//! [`field`] converts to and from the library's wrinkle field, [`bake`] makes maps, [`export`] geometry.
//!
//! Units: metre, radian, second. "Rest" is the model's bind pose, "posed" the current frame.

pub mod bake;
pub mod bias;
pub mod camera;
pub mod crush;
pub mod draw;
pub mod export;
pub mod field;
pub mod gather;
mod glb_out;
pub mod gltf_in;
pub mod live;
pub mod model;
pub mod models;
pub mod play;
pub mod profile;
pub mod relax;
pub mod render;
pub mod shade;
pub mod skin;
pub mod texture;
pub mod unify;
pub mod wavelength;
pub mod wgsl;

/// A point or vector in space (m).
pub type Vec3 = nalgebra::Vector3<f32>;
/// Texture coordinates.
pub type Vec2 = nalgebra::Vector2<f32>;
/// An affine map of space.
pub type Mat4 = nalgebra::Matrix4<f32>;

/// Vertices that one thread takes at least: fewer are done sooner than they are handed out.
/// Vertices do not depend on each other within a stage, so any number of threads gives the same
/// bytes.
pub(crate) const CHUNK: usize = 2048;

/// The representative of `angle_rad` in [−π, π).
pub fn wrap(angle_rad: f32) -> f32 {
    use std::f32::consts::TAU;
    angle_rad - TAU * (angle_rad / TAU + 0.5).floor()
}
