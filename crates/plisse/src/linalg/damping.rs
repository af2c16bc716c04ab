//! Levenberg–Marquardt damping: a multiple of the identity on the Hessian, as a share of its
//! largest diagonal entry, that follows the step sizes of the line search.

/// Damping after the first short step.
const FIRST: f64 = 1e-8;
/// Largest damping where walls ([`super::problem::Problem::max_step_size`]), and not the energy,
/// cut steps short.
const MAX_AT_WALLS: f64 = 1e-4;
/// Step size below which a step is short.
const SHORT_STEP: f64 = 0.3;
/// Factor of the damping after a short step.
pub(super) const GROWTH: f64 = 100.0;
/// Factor of the damping after a whole step.
const DECAY: f64 = 0.1;

/// The damping of the next step.
pub(super) struct Damping {
    /// Share of the largest diagonal entry that is added to each.
    pub(super) share: f64,
    /// The least share.
    ridge: f64,
}

impl Damping {
    /// No more damping than `ridge`.
    pub(super) fn new(ridge: f64) -> Self {
        Self { share: ridge, ridge }
    }

    /// True if there is no damping beyond the ridge.
    pub(super) fn is_off(&self) -> bool {
        self.share <= self.ridge
    }

    /// Adapts the damping to a step of `size`, where walls allowed one of `max_size`.
    ///
    /// A short step says that the model reaches too far, e.g. that a slack face would be pulled
    /// taut; or that there is a wall: then some damping keeps the other unknowns from sliding along
    /// it, and more would keep them from moving at all.
    pub(super) fn after(&mut self, size: f64, max_size: f64) {
        let more = (self.share * GROWTH).max(FIRST);
        if size < SHORT_STEP * max_size {
            self.share = more;
        } else if size < SHORT_STEP {
            self.share = self.share.max(more.min(MAX_AT_WALLS));
        } else if size == 1.0 {
            self.share = (self.share * DECAY).max(self.ridge);
        }
    }
}
