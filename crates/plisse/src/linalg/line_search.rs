//! Steps along a line: backtracking to a sufficient decrease, and expansion of a step that was too
//! short.

use super::problem::Problem;

/// Sufficient decrease (Armijo; c₁ of [Nocedal & Wright], eq. 3.4): least share of the decrease
/// that the slope predicts.
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Factor of backtracking from one step size to the next.
const BACKTRACK: f64 = 0.5;
/// Largest number of step sizes that are tried: 2⁻⁴⁰ is next to nothing.
const MAX_BACKTRACKS: usize = 40;
/// Share of the energy below which a difference of energies is rounding.
pub(super) const ENERGY_ROUNDING: f64 = 1e-13;
/// Step expansion: least share of the decrease that the slope predicts, above which a whole step is
/// too short. It is ½ where the energy is as curved as the model.
const EXPANSION_THRESHOLD: f64 = 0.7;
/// Factor of expansion from one step size to the next.
const EXPAND: f64 = 2.0;
/// Largest step size of an expanded step.
const MAX_EXPANDED_STEP: f64 = 64.0;

/// The line x + t·direction, projected onto the lower bounds.
pub(super) struct Line<'a> {
    /// `[n]` where it begins.
    pub(super) x: &'a [f64],
    /// `[n]`.
    pub(super) direction: &'a [f64],
    /// `[n]` lower bounds.
    pub(super) lower: &'a [f64],
    /// `[n]` gradient at `x`.
    pub(super) gradient: &'a [f64],
    /// Energy at `x`.
    pub(super) energy: f64,
}

/// A step that lowers the energy.
pub(super) struct Step {
    /// Its size; 1 for a whole step.
    pub(super) size: f64,
    /// Energy at its end.
    pub(super) energy: f64,
    /// The change of the energy that the gradient predicts.
    slope: f64,
}

/// The outcome of a line search.
pub(super) enum LineSearch {
    /// A step with a sufficient decrease; the trial point is its end.
    Decreased(Step),
    /// At the trial point no decrease can be told from rounding any more.
    BelowRounding,
    /// No step size gave a sufficient decrease.
    Failed,
}

impl Line<'_> {
    /// Sets `out` (`[n]`) to the point at `size`.
    fn point(&self, size: f64, out: &mut [f64]) {
        for i in 0..self.x.len() {
            out[i] = (self.x[i] + size * self.direction[i]).max(self.lower[i]);
        }
    }

    /// The change of the energy that the gradient predicts from `x` to `point`.
    fn slope(&self, point: &[f64]) -> f64 {
        let mut slope = 0.0;
        for i in 0..self.x.len() {
            slope += self.gradient[i] * (point[i] - self.x[i]);
        }
        slope
    }

    /// Decrease of the energy that a quadratic model predicts for its Newton step `direction`: half
    /// the Newton decrement squared.
    pub(super) fn predicted_decrease(&self) -> f64 {
        let slope: f64 = (0..self.x.len())
            .map(|i| {
                let end = (self.x[i] + self.direction[i]).max(self.lower[i]);
                self.gradient[i] * (end - self.x[i])
            })
            .sum();
        -0.5 * slope
    }

    /// Backtracks from the step size `first` until the energy of `problem` decreases sufficiently.
    pub(super) fn backtrack(
        &self,
        problem: &mut dyn Problem,
        first: f64,
        trial: &mut [f64],
    ) -> LineSearch {
        let mut size = first;
        for _ in 0..MAX_BACKTRACKS {
            self.point(size, trial);
            let slope = self.slope(trial);
            if slope.abs() < ENERGY_ROUNDING * self.energy.abs() {
                return LineSearch::BelowRounding;
            }
            let energy = problem.energy(trial);
            if slope < 0.0 && energy <= self.energy + SUFFICIENT_DECREASE * slope {
                return LineSearch::Decreased(Step { size, energy, slope });
            }
            size *= BACKTRACK;
        }
        LineSearch::Failed
    }

    /// True if `step` was a whole one along which the energy fell so steadily that a longer one is
    /// worth a try.
    pub(super) fn is_too_short(&self, step: &Step) -> bool {
        step.size == 1.0 && step.energy < self.energy + EXPANSION_THRESHOLD * step.slope
    }

    /// Expands a whole step, which ended at `trial` with `energy`, to 2, 4, … times its size, as
    /// long as the energy falls and no wall is met. Returns the energy at the new `trial`;
    /// `farther` is memory for one more point.
    pub(super) fn expand(
        &self,
        problem: &mut dyn Problem,
        mut energy: f64,
        trial: &mut Vec<f64>,
        farther: &mut Vec<f64>,
    ) -> f64 {
        let longest: Vec<f64> = self.direction.iter().map(|d| d * MAX_EXPANDED_STEP).collect();
        let max_size = 1.0 + MAX_EXPANDED_STEP * problem.max_step_size(trial, &longest);
        let mut size = EXPAND;
        while size <= max_size {
            self.point(size, farther);
            let there = problem.energy(farther);
            if there.is_nan() || there >= energy {
                break;
            }
            energy = there;
            std::mem::swap(trial, farther);
            size *= EXPAND;
        }
        energy
    }
}
