//! Wrinkles on animated meshes in real time, after [Loviscach 2006], *Wrinkling Coarse Meshes on
//! the GPU*.
//!
//! Five stages ([`stage::Stage`]) make a frame. [`mod@skin`] moves the vertices. [`mod@crush`]
//! measures strength and direction of the surface's compression. [`mod@relax`] aligns the phases of
//! neighbouring waves. [`mod@gather`] lays out the data of each face's corners. [`render`] reads
//! height, normal and texture shift at a point of a face, and [`mod@shade`] lights it. Each stage
//! is a function of f32 arrays and is here twice: in WGSL for the GPU (`crush.wgsl`; all texts are
//! in [`wgsl`]), and in Rust (`crush.rs`) as its CPU reference, which runs where there is no GPU.
//!
//! Models come from glTF files ([`gltf_in`]) or are made here ([`models`]); [`mod@weld`] welds the
//! vertices that texture seams split. [`live_model::LiveModel`] is a model with the settings of its
//! wrinkles. From there, [`recording`] makes the frames of a clip, and [`play`] the waves at a time
//! of a clip; [`bake`] makes maps of them and [`export`] geometry ([`fine_mesh`]). [`field`]
//! converts to and from the library's wrinkle field. [`bias`] holds wrinkles of the rest pose,
//! [`mod@wavelength`] wavelengths that differ from vertex to vertex.
//!
//! Units: metre, radian, second. "Rest" is the model's bind pose, "posed" the current frame.
//! Shapes: `[V]` draw vertices, `[U]` welded vertices, `[F]` faces, `[N]` nodes, `[P]` palette
//! entries. Numbers in parentheses, such as 5.2 or eq. 6, are those of [Loviscach 2006].
//!
//! [Loviscach 2006]: https://doi.org/10.1111/j.1467-8659.2006.00966.x

pub mod backend;
pub mod bake;
pub mod bias;
pub mod camera;
pub mod crush;
pub mod draw;
pub mod export;
pub mod field;
pub mod film;
pub mod fine_mesh;
pub mod gather;
mod glb_out;
pub mod gltf_in;
pub mod live;
pub mod live_model;
pub mod measures;
pub mod model;
pub mod models;
pub mod play;
pub mod profile;
pub mod recording;
pub mod relax;
pub mod render;
pub mod shade;
pub mod skin;
pub mod stage;
pub mod texture;
pub mod timeline;
pub mod wavelength;
pub mod weld;
pub mod wgsl;

/// A point or vector in space (m).
pub type Vec3 = nalgebra::Vector3<f32>;
/// Texture coordinates.
pub type Vec2 = nalgebra::Vector2<f32>;
/// An affine map of space.
pub type Mat4 = nalgebra::Matrix4<f32>;

/// Least number of vertices that a thread takes: fewer are done sooner than they are handed out.
/// Vertices do not depend on each other within a stage, so any number of threads gives the same
/// bytes.
pub(crate) const CHUNK: usize = 2048;

/// The representative of `angle_rad` in [−π, π).
pub fn wrap(angle_rad: f32) -> f32 {
    use std::f32::consts::TAU;
    angle_rad - TAU * (angle_rad / TAU + 0.5).floor()
}
