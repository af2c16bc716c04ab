//! Numerical ground floor: symmetric sparse matrices assembled from elements ([`sparse`],
//! `vertex_pattern`), their Cholesky factorisation with a symbolic part that is made once
//! ([`cholesky`], over `ordering`, `nested_dissection`, `symbolic` and `multifrontal`),
//! bound-constrained Newton ([`newton`] on a [`problem`], its directions by `newton_direction`),
//! projection of element Hessians (`psd_projection`), closest integer vectors ([`lattice`]), and
//! derivative checks for tests (`derivative_check`).

mod blend_weight;
pub mod cholesky;
mod damping;
#[cfg(test)]
pub(crate) mod derivative_check;
mod graph;
pub mod lattice;
mod line_search;
mod multifrontal;
mod nested_dissection;
pub mod newton;
mod newton_direction;
mod ordering;
pub mod problem;
pub(crate) mod psd_projection;
mod saddle;
mod separator;
pub mod sparse;
mod symbolic;
pub(crate) mod vertex_pattern;

pub use newton::Ending;
pub use problem::Problem;
pub use psd_projection::PsdProjection;
pub use symbolic::IndexBlocks;
