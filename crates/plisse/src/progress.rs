//! Progress of long steps, and their cancellation. The library itself never prints.

/// The state of a long step.
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

/// Receiver of the progress of long steps.
pub trait Observer: Sync {
    /// Called after each iteration.
    fn step(&self, step: &Step);
    /// Asked before each iteration; on `true` the step ends early and keeps its best state so far.
    fn cancelled(&self) -> bool {
        false
    }
}

/// An observer that ignores everything and never cancels.
pub struct Silent;

impl Observer for Silent {
    fn step(&self, _: &Step) {}
}
