//! Scenes: a TOML file that says what is sewn, held, pushed and solved, and what was published
//! about it.
//!
//! [`schema`] is the file's content, [`read`](mod@read) turns text into it and tells what is wrong in words, [`mod@build`] makes
//! surface, start pose, clamps and loads of it, [`solve_base`] solves its base surface, fine meshes
//! by way of coarse ones,
//! [`measure`](mod@measure) compares a solved field with what was published.
//! [`growth`] does the same for a surface that grows.
//! `docs/scene-format.md` describes every field.

mod base;
mod bodies;
pub mod build;
mod check;
mod closed;
mod garment;
pub mod growth;
mod hold;
mod laid;
mod maps;
pub mod measure;
mod measure_shell;
mod options;
mod panels;
pub mod probe;
pub mod read;
mod reference;
mod resolution;
pub mod schema;
mod value;

pub use base::{base_notes, solve_base};
pub use build::{Built, build};
pub use growth::{BuiltGrowth, build_growth};
pub use laid::BuiltPanel;
pub use measure::{Measured, measure};
pub use measure_shell::measure_shell;
pub use probe::{Probe, Quantity};
pub use read::{parse, read};
pub use resolution::{refined, with_vertices};
pub use schema::Scene;
