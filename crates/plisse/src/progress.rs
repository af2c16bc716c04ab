//! How long steps tell what they do and hear that they should stop. The library itself never
//! prints.

/// Where a long step is.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Name of the step, e.g. "field".
    pub stage: &'static str,
    /// Iterations done.
    pub iteration: usize,
    /// Iterations at most.
    pub limit: usize,
    /// Energy now (J), where the step has one.
    pub energy_joule: f64,
    /// Residual now, no unit: the step ends when it is below [`Step::tolerance`].
    pub residual: f64,
    /// Residual at which the step ends.
    pub tolerance: f64,
}

/// Somebody who watches a long step.
pub trait Observer: Sync {
    /// Called after each iteration.
    fn step(&self, step: &Step);
    /// Asked before each iteration; on `true` the step ends early and keeps its best state so far.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Nobody watches.
pub struct Silent;

impl Observer for Silent {
    fn step(&self, _: &Step) {}
}
