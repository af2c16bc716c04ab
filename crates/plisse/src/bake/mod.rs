//! From wrinkles over a surface to pictures of them in its texture space: height (m) and normal of
//! each texel.
//!
//! [`bake`] rasterises the surface's texture coordinates and samples height and gradient at each
//! texel's centre; [`field_sampler`] gives them for a
//! [`WrinkleField`](crate::field::WrinkleField), exactly: amplitude and phase are linear over a
//! face. [`png16`] writes the maps.
//!
//! Conventions: v points up and row 0 is at the top, so texel (x, y) of N × N has its centre at u =
//! (x + ½)/N, v = 1 − (y + ½)/N. Normals are those of glTF and OpenGL: red along u, green along v
//! (up), blue outwards.

mod maps;
mod padding;
pub mod png16;
mod raster;
mod sampler;
mod tangents;

pub use maps::{Baked, Coverage, Options, Sample, Surface};
pub use raster::bake;
pub use sampler::field_sampler;
