//! Triangle meshes: connectivity ([`Topology`]), flat panels ([`panel`], [`grid`]) and [`closed`]
//! surfaces, charts of panels side by side ([`islands`]), sewing ([`sew`]), welding and checks
//! ([`check`]), normals ([`normals`]), Loop subdivision ([`subdivide`], by [`masks`]).

mod chart;
pub mod check;
pub mod closed;
pub mod crossing;
pub mod grid;
pub mod islands;
pub mod masks;
pub mod normals;
pub mod panel;
pub mod reach;
pub(crate) mod scatter;
pub mod sew;
pub mod subdivide;
mod topology;
mod up;

pub use crate::adjacency::NONE;
pub use chart::{Chart, RestShape};
pub use topology::Topology;
pub use up::Up;

/// A point or vector in space (m).
pub type Vec3 = nalgebra::Vector3<f64>;
/// A point or vector in a flat panel (m).
pub type Vec2 = nalgebra::Vector2<f64>;
/// A symmetric form or linear map on a face's plane.
pub type Mat2 = nalgebra::Matrix2<f64>;
/// A linear map of space.
pub type Mat3 = nalgebra::Matrix3<f64>;
/// The differential of a face's embedding: columns are the images of the face's two frame vectors.
pub type Mat3x2 = nalgebra::Matrix3x2<f64>;
