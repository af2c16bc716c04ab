//! The brush: where a ray meets the surface ([`mod@pick`]), how far along the surface everything is
//! from there ([`reach`]), what a dab does to the layers ([`painting`]), and how pointer positions
//! become dabs ([`trail`]).
//!
//! Everything works on unified vertices, so that texture seams neither stop a stroke nor show in
//! it. Knows no window.

pub mod painting;
pub mod pick;
pub mod reach;
pub mod trail;

pub use painting::{Canvas, Painting};
pub use pick::{Hit, Ray, between, nearest, nearest_among, pick, pick_among};
pub use reach::VertexFaces;
pub use trail::Trail;
