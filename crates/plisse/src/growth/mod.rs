//! Folds where the surface is told to grow: expansion textures ([Combaz & Neyret 2002]).
//!
//! [`expansion`] says by how much, and along what, the surface grows, and edits the rest metric; [`procedural_map`] makes such maps, and
//! maps of single numbers, from the place on the surface; [`load_stepping`] folds the grown surface
//! up by minimising the energy of a
//! [`film`] on a foundation, [`reference`](mod@reference) by the forces of the paper; [`fold_angle`] is the mathematics of one large
//! fold; [`adapt`] makes the mesh fine where it grows, while it does; [`sculpt`] follows a brush, and solves what lies around it alone.

pub mod adapt;
mod equilibrate;
pub mod expansion;
pub mod film;
pub mod fold_angle;
mod imperfection;
pub mod load_stepping;
mod loose;
mod maps;
pub mod procedural_map;
pub mod reference;
mod rigid_bands;
pub mod sculpt;
mod surface;

pub use adapt::{AdaptOptions, Surface, grow_adapting};
pub use expansion::Expansion;
pub use load_stepping::{GrowthOptions, GrowthReport, StepReport, grow, grow_each};
pub use maps::GrowthMaps;
pub use procedural_map::{DirectionField, ProceduralMap};
pub use sculpt::{Dab, Paint, Sculpture};
pub use surface::Growing;
