//! The brush: the point where a ray meets the surface ([`mod@pick`]), distances along the surface
//! from there ([`reach`]), the effect of dabs on the layers ([`painting`]), and the dabs of a
//! moving pointer ([`trail`]).
//!
//! Everything works on welded vertices, so that texture seams do not stop a stroke. Knows no
//! window.

pub mod painting;
pub mod pick;
pub mod reach;
pub mod trail;

pub use painting::{Canvas, Painting};
pub use pick::{Hit, Ray, between, nearest, nearest_among, pick, pick_among};
pub use reach::VertexFaces;
pub use trail::Trail;
