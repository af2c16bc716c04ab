//! Scenes: a TOML file that says what is sewn, held and solved, and what was published about it.
//!
//! [`schema`] is the file's content, [`read`](mod@read) turns text into it and tells what is wrong in words, [`mod@build`] makes
//! panels, start pose and clamps of it, [`measure`](mod@measure) compares a solved field with what was published.
//! `docs/scene-format.md` describes every field. Limits: panels only (no mesh files), clamps along whole sides, no contact,
//! no pressure and no gravity.

pub mod build;
mod check;
pub mod measure;
pub mod read;
pub mod schema;

pub use build::{Built, BuiltPanel, build};
pub use check::MOST_LEVELS;
pub use measure::{Measured, Probe, Quantity, measure};
pub use read::{parse, read};
pub use schema::Scene;
