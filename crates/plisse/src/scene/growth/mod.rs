//! Scenes that grow: from `[growth]` to a [`GrownScene`].
//!
//! `check` holds the rules that the table's types cannot, `build` makes the starting surface and
//! its maps, [`solve`] grows it in either mode. `windows` finds the parts of panels in which
//! [`count`] counts folds, `adapted` is the scene on the mesh that followed its folds.

mod adapted;
mod build;
pub(super) mod check;
pub mod count;
pub mod solve;
mod windows;

pub use build::{BuiltGrowth, build_growth};
pub use count::FoldCount;
pub use solve::{GrowOptions, GrownScene, GrowthFields, GrowthMeasures, GrowthStep, grow};

pub use super::schema::Mode;
