//! Scenes: a TOML file with panels, seams, clamps, loads and options of the solves, and with
//! published results to compare with.
//!
//! [`schema`] is the content of the file. [`read`](mod@read) makes it from text and explains
//! errors. [`mod@build`] makes the sheet, its start pose, clamps and loads. [`solve_base`] solves
//! the base surface (of a fine mesh by way of a coarse one), [`solve`](fn@solve) the wrinkle field
//! on it, too. [`measure`](mod@measure) compares the field with published numbers. [`growth`] does
//! the same for a surface that grows. `docs/scene-format.md` describes every field.
//!
//! Order of the files; each uses only those before it: `value` (checks of single values), `schema`,
//! `reference` (names and paths), `placed` (the surface in space), `closed`, `panels` and `garment`
//! (which make it), `hold`, `bodies`, `maps`, `options` and `probe` (which belong to it), `build`,
//! `measure`, `measure_shell`, `resolution`, `base`, `solve`, `growth`, `check`, `read`.

mod base;
mod bodies;
pub mod build;
mod check;
mod closed;
mod garment;
pub mod growth;
mod hold;
mod maps;
pub mod measure;
mod measure_shell;
mod options;
mod panels;
mod placed;
pub mod probe;
pub mod read;
mod reference;
mod resolution;
pub mod schema;
mod solve;
#[cfg(test)]
mod testing;
mod value;

pub use base::{base_notes, solve_base};
pub use build::{BuiltScene, build};
pub use growth::{BuiltGrowth, GrowOptions, GrownScene, build_growth, grow};
pub use measure::{Measured, measure};
pub use measure_shell::{heights_m, measure_shell};
pub use placed::PlacedPanel;
pub use probe::{Probe, Quantity};
pub use read::{parse, read};
pub use resolution::{refined, with_vertices};
pub use schema::Scene;
pub use solve::{SolveOptions, SolvedScene, build_with, solve, solve_built, solve_field};
