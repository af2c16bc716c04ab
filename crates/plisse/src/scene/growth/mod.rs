//! Scenes that grow: `[growth]` made ready for [`crate::growth::grow`].
//!
//! `check` holds the checks beyond the table's types, `build` makes the starting surface and its
//! maps, `windows` finds the parts of panels in which [`count`] counts folds, `adapted` is the scene
//! on the mesh that followed its folds.

mod adapted;
mod build;
pub(super) mod check;
pub mod count;
mod windows;

pub use build::{BuiltGrowth, build_growth};
pub use count::FoldCount;

pub use super::schema::Mode;
