//! Numerical ground floor, without any geometry: symmetric sparse matrices assembled from elements
//! ([`sparse`], `vertex_pattern`), their Cholesky factorisation with a symbolic analysis that is
//! made once ([`cholesky`]), bound-constrained Newton ([`newton`] on a [`problem`]), projection of
//! element Hessians to positive semidefinite ones (`psd_projection`), parallel sums in a fixed
//! order (`ordered_sum`), closest integer vectors ([`lattice`]), and derivative checks for tests
//! (`derivative_check`).
//!
//! Factorisation: `ordering` (over `nested_dissection`, with its `separator`s of a `graph`),
//! `symbolic` analysis, `assembly` of fronts, and `multifrontal` elimination of each
//! `dense_front`. Newton: `newton_direction` (with the `blend_weight` of the Hessian), `damping`,
//! `line_search`, and escape from a `saddle`.

mod assembly;
mod blend_weight;
pub mod cholesky;
mod damping;
mod dense_front;
#[cfg(test)]
pub(crate) mod derivative_check;
mod graph;
pub mod lattice;
mod line_search;
mod multifrontal;
mod nested_dissection;
pub mod newton;
mod newton_direction;
pub(crate) mod ordered_sum;
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
