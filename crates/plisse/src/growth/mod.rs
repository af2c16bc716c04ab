//! Folds where the surface is told to grow: expansion textures ([Combaz & Neyret 2002]).
//!
//! [`expansion`] says by how much, and along what, the surface grows, and edits the rest metric; [`procedure`] makes such maps, and
//! maps of single numbers, from the place on the surface; [`equilibrium`] folds the grown surface
//! up by minimising the energy of a
//! [`film`] on a foundation, [`reference`](mod@reference) by the forces of the paper; [`fold_angle`] is the mathematics of one large
//! fold; [`measure`] counts what came out; [`mod@remesh`] makes the mesh fine where it grows,
//! [`adapt`] while it does; [`sculpt`] follows a brush, and solves what lies around it alone.

pub mod adapt;
mod bands;
pub mod equilibrium;
pub mod expansion;
pub mod film;
pub mod fold_angle;
mod growing;
mod imperfection;
mod loose;
mod maps;
pub mod measure;
pub mod procedure;
pub mod reference;
pub mod remesh;
pub mod sculpt;
mod self_contact;
mod settle;

pub use adapt::{AdaptOptions, Surface, grow_adapting};
pub use equilibrium::{GrowthOptions, GrowthReport, StepReport, grow, grow_each};
pub use expansion::Expansion;
pub use growing::Growing;
pub use maps::GrowthMaps;
pub use procedure::{Course, Procedure};
pub use sculpt::{Dab, Paint, Sculpture};
