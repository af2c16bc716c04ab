//! The five stages by name, and values of which each stage has one.

use std::ops::{Index, IndexMut};

/// A stage of a frame, in the order in which they run. [Loviscach 2006] has four of them; Gather,
/// which lays out the data that Render reads, is ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Moves the vertices ([`mod@crate::skin`]).
    Skin,
    /// Measures the compression ([`mod@crate::crush`]).
    Crush,
    /// Aligns the phases ([`mod@crate::relax`]).
    Relax,
    /// Lays out the corners of the faces ([`mod@crate::gather`]).
    Gather,
    /// Draws the picture ([`mod@crate::render`]).
    Render,
}

impl Stage {
    /// All stages in their order.
    pub const ALL: [Self; 5] = [Self::Skin, Self::Crush, Self::Relax, Self::Gather, Self::Render];

    /// The name that the stage's files, entry points and timers have.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Skin => "skin",
            Self::Crush => "crush",
            Self::Relax => "relax",
            Self::Gather => "gather",
            Self::Render => "render",
        }
    }
}

/// One value for each stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PerStage<T> {
    /// In the order of [`Stage::ALL`].
    values: [T; Stage::ALL.len()],
}

/// Milliseconds of each stage in one frame; `None` where it did not run or cannot be timed.
pub type StageTimes = PerStage<Option<f64>>;

impl<T> PerStage<T> {
    /// The values that `value` gives for each stage.
    pub fn from_fn(value: impl FnMut(Stage) -> T) -> Self {
        Self { values: Stage::ALL.map(value) }
    }

    /// The stages with their values, in order.
    pub fn iter(&self) -> impl Iterator<Item = (Stage, &T)> {
        Stage::ALL.into_iter().zip(&self.values)
    }

    /// The values alone, in order.
    pub fn values(&self) -> &[T] {
        &self.values
    }
}

impl<T> Index<Stage> for PerStage<T> {
    type Output = T;

    fn index(&self, stage: Stage) -> &T {
        &self.values[stage as usize]
    }
}

impl<T> IndexMut<Stage> for PerStage<T> {
    fn index_mut(&mut self, stage: Stage) -> &mut T {
        &mut self.values[stage as usize]
    }
}
