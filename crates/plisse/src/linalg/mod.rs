//! Numerical ground floor: symmetric sparse matrices assembled from elements ([`sparse`],
//! `by_vertex`), their Cholesky factorisation with a symbolic part that is made once ([`cholesky`],
//! over `ordering`, [`dissection`], `elimination` and `fronts`), bound-constrained Newton
//! ([`newton`], its directions by `descent`), small dense eigenproblems ([`small`]), closest
//! integer vectors ([`lattice`]), and derivative checks for tests (`derivative_check`).

pub(crate) mod by_vertex;
pub mod cholesky;
#[cfg(test)]
pub mod derivative_check;
mod descent;
pub mod dissection;
pub mod elimination;
mod fronts;
pub mod lattice;
pub mod newton;
mod ordering;
mod saddle;
pub mod small;
pub mod sparse;
