//! Base surfaces: the coarse shape of a thin shell, free of wrinkles, by tension field theory (4.1 and appendix B of
//! [Chen 2021]).
//!
//! [`tension_field`] is the membrane of a face, [`quadratic_bending`] the bending of the whole mesh, [`base`] the solve.
//! [`mid_edge_bending`] is the bending of a shell that may wrinkle for itself, on a mesh fine enough for it.

pub mod base;
pub mod loads;
pub mod mid_edge_bending;
pub mod quadratic_bending;
pub mod tension_field;

pub use base::{BaseOptions, BaseReport, Clamps, solve_base};
pub use loads::Loads;
