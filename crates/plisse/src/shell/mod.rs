//! Shells on a coarse mesh: the base surface, free of wrinkles, by tension field theory (4.1 and
//! appendix B of [Chen 2021]), and the reference shell, which resolves its wrinkles if the mesh
//! does (appendix A).
//!
//! [`setup`] says what is held, pushed ([`loads`], [`pressure`]) and in the way (contact); [`tension_field`] is the membrane of a face;
//! [`quadratic_bending`] and [`mid_edge_bending`] resist bending; [`base`] and [`reference`](mod@reference) are the solves.

pub mod base;
pub(crate) mod contact;
mod equilibrium;
pub mod loads;
pub mod mid_edge_bending;
pub mod pressure;
pub mod quadratic_bending;
pub mod reference;
pub mod setup;
mod start;
pub mod tension_field;

pub use base::{BaseOptions, BaseReport, solve_base};
pub use loads::Loads;
pub use reference::{ReferenceOptions, ReferenceReport, solve_reference};
pub use setup::{Clamps, Setup};
