//! Scenes that grow: `[growth]` made ready for [`crate::growth::grow`].
//!
//! `check` says what the table's types cannot, `build` makes the starting surface and its maps,
//! `windows` finds the parts of panels in which [`count`] reads off folds, `adapted` is the scene on
//! the mesh that followed its folds.

mod adapted;
mod build;
pub(super) mod check;
pub mod count;
mod windows;

pub use build::{BuiltGrowth, build_growth};
pub use count::FoldCount;

pub use super::schema::Mode;
