//! Folds of a surface that is told to grow: expansion textures ([Combaz & Neyret 2002]).
//!
//! [`expansion`] holds the growth tensor at each vertex and its effect on the rest metric;
//! [`procedural_map`] makes maps from the place on the surface. A [`GrowingSurface`] carries them
//! all. [`load_stepping`] folds it by minimising the energy of a [`film`] on a foundation in load
//! steps; [`reference`](mod@reference) folds it by the forces of the paper. [`fold_angle`] is the
//! mathematics of one large fold. [`adapt`] refines the mesh while it grows; [`sculpt`] follows a
//! brush and solves only its surroundings.

pub mod adapt;
mod equilibrate;
pub mod expansion;
pub mod film;
pub mod fold_angle;
mod imperfection;
pub mod load_stepping;
mod loose;
pub mod maps;
pub mod procedural_map;
pub mod reference;
mod rigid_bands;
pub mod sculpt;
mod surface;

pub use adapt::{AdaptOptions, GrownSurface, follow_adapting};
pub use expansion::Expansion;
pub use load_stepping::{
    GrowthOptions, GrowthReport, LoadSteps, StepReport, follow, follow_each, grow,
};
pub use maps::{GrowthAt, GrowthMaps};
pub use procedural_map::{DirectionField, ProceduralMap};
pub use sculpt::{Dab, Paint, Sculpture};
pub use surface::GrowingSurface;
