//! Numerical ground floor: symmetric sparse matrices assembled from elements ([`sparse`]), their Cholesky factorisation with
//! a symbolic part that is made once ([`cholesky`], over `ordering`, [`dissection`] and `fronts`), bound-constrained Newton ([`newton`]),
//! small dense eigenproblems ([`small`]), closest integer vectors ([`lattice`]), and derivative checks for tests
//! (`derivative_check`).

pub mod cholesky;
#[cfg(test)]
pub mod derivative_check;
pub mod dissection;
mod fronts;
pub mod lattice;
pub mod newton;
mod ordering;
mod saddle;
pub mod small;
pub mod sparse;
