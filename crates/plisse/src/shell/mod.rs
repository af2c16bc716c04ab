//! Shells on a coarse mesh: the base surface, free of wrinkles, by tension field theory (4.1 and
//! appendix B of [Chen 2021]), and the reference shell, which resolves its wrinkles if the mesh
//! does (appendix A).
//!
//! [`setup`] gathers the sheet, its clamps, its [`loads`] ([`pressure`] among them) and the bodies
//! in its way (contact). [`tension_field`] is the membrane energy of a face, [`quadratic_bending`]
//! and [`mid_edge_bending`] are bending energies, [`base`] and [`reference`](mod@reference) the
//! solves.

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
