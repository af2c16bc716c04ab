//! Projected Newton: minimises a smooth energy under lower bounds on some unknowns, with one sparse
//! Cholesky factorisation per iteration.
//!
//! Unknowns at their bound whose gradient pushes outward are held (Bertsekas 1982). The others take
//! a Newton step that is projected back onto the bounds along a line search (`line_search`), which
//! backtracks where the step is too long and expands it where the energy falls faster than
//! predicted. Far from the minimum the element Hessians are projected to positive semidefinite
//! ones; near it the true Hessian is tried, which gives quadratic convergence (`newton_direction`).
//! A gradient that vanishes at a saddle is left along a direction of negative curvature (`saddle`).
//!
//! A problem may leave small, far couplings out of the factorised matrix; preconditioned conjugate
//! gradients account for them.

use super::damping::Damping;
use super::line_search::{ENERGY_ROUNDING, Line, LineSearch};
use super::newton_direction::{DirectionRequest, NewtonDirection};
use super::problem::Problem;
use super::psd_projection::PsdProjection;
use super::saddle;
use crate::Result;
use crate::progress::{self, Observer};

/// Largest ε of Bertsekas' ε-active set: unknowns this near to their bound count as at it.
const MAX_ACTIVE_BAND: f64 = 1e-3;
/// Share of the energy: the true Hessian is tried after a step that lowers the energy by less.
const NEAR_CONVERGENCE: f64 = 1e-2;
/// Share of its old value to which the projected gradient must fall for a step whose decrease of
/// the energy is below rounding.
const GRADIENT_DECREASE: f64 = 0.9;
/// Largest number of saddles that are escaped.
const MAX_SADDLES: usize = 5;

/// Settings of [`minimise`].
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Name of the stage, for the observer.
    pub stage: &'static str,
    /// Largest number of iterations.
    pub iteration_limit: usize,
    /// Largest component of the projected gradient at which the minimisation has converged.
    pub tolerance: f64,
    /// Predicted decrease of the energy (half the Newton decrement squared) at which the
    /// minimisation has converged, too, if the step is that of the true, positive definite Hessian;
    /// 0 for never. (By energy and not by gradient, so that unknowns that cost next to nothing,
    /// such as phases where there is hardly an amplitude, do not count.)
    pub predicted_decrease_tolerance: f64,
    /// Projection of element Hessians until the true Hessian is positive definite.
    pub psd_projection: PsdProjection,
    /// Ridge: share of the Hessian's largest diagonal entry that is added to each, so that
    /// directions without stiffness do not move.
    pub ridge: f64,
    /// True to stay in the basin of the start, as where a surface is followed while it grows, and
    /// not to look for any low minimum: then no step is expanded, and the Hessian is either the
    /// true or the projected one, never a blend.
    pub stay_in_basin: bool,
    /// True to test, where the gradient vanishes, that the Hessian is positive definite, and to go
    /// on along a direction of negative curvature if it is not. For problems without lower bounds.
    pub escape_saddles: bool,
    /// Joules in one unit of energy, for the observer.
    pub energy_unit_joule: f64,
}

impl Options {
    /// Options with defaults for all but the `stage` and the unit of energy.
    pub fn new(stage: &'static str, energy_unit_joule: f64) -> Self {
        Self {
            stage,
            iteration_limit: 1000,
            tolerance: 1e-10,
            predicted_decrease_tolerance: 0.0,
            psd_projection: PsdProjection::Clamp,
            ridge: 1e-14,
            stay_in_basin: false,
            escape_saddles: false,
            energy_unit_joule,
        }
    }
}

/// The reason why a minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The projected gradient is below the tolerance, or so is the predicted decrease
    /// ([`Options::predicted_decrease_tolerance`]).
    Converged,
    /// No step lowers the energy any more; the projected gradient is as small as rounding lets it
    /// become.
    RoundOff,
    /// The iteration limit was reached first.
    IterationLimit,
    /// The observer asked to stop.
    Cancelled,
}

impl Ending {
    /// A few words for reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::RoundOff => "converged to rounding",
            Self::IterationLimit => "iteration limit reached",
            Self::Cancelled => "interrupted",
        }
    }
}

/// The end of a minimisation.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// `[n]` the unknowns.
    pub x: Vec<f64>,
    /// Energy there.
    pub energy: f64,
    /// `[n]` gradient there.
    pub gradient: Vec<f64>,
    /// Largest component of the projected gradient there.
    pub projected_gradient: f64,
    /// Iterations made.
    pub iterations: usize,
    /// The reason to end.
    pub ending: Ending,
}

/// The projected gradient's component of an unknown `x` with a `lower` bound: zero where the
/// gradient pushes against the bound.
pub fn projected_gradient(x: f64, lower: f64, gradient: f64) -> f64 {
    if x <= lower { gradient.min(0.0) } else { gradient }
}

/// Minimises `problem` from `start` (projected onto the bounds). The energy never rises.
///
/// # Errors
/// Only if the factorisation's memory cannot be had.
pub fn minimise(
    problem: &mut dyn Problem,
    start: &[f64],
    options: &Options,
    observer: &dyn Observer,
) -> Result<Outcome> {
    let mut minimisation = Minimisation::new(problem, start, options)?;
    let ending = minimisation.run(observer)?;
    Ok(Outcome {
        x: minimisation.x,
        energy: minimisation.energy,
        gradient: minimisation.gradient,
        projected_gradient: minimisation.residual,
        iterations: minimisation.iterations,
        ending,
    })
}

/// The state of a minimisation between two iterations.
struct Minimisation<'a> {
    problem: &'a mut dyn Problem,
    options: &'a Options,
    /// `[n]` lower bounds.
    lower: Vec<f64>,
    newton: NewtonDirection,
    damping: Damping,
    /// `[n]` the iterate.
    x: Vec<f64>,
    /// Energy at the iterate.
    energy: f64,
    /// `[n]` gradient at the iterate.
    gradient: Vec<f64>,
    /// Largest component of the projected gradient at the iterate.
    residual: f64,
    /// True if steps have become so small that the true Hessian is tried.
    near_convergence: bool,
    /// Saddles escaped.
    saddles: usize,
    /// Iterations made.
    iterations: usize,
    /// `[n]` unknowns held at their bound in this iteration.
    held: Vec<bool>,
    /// `[n]` direction of this iteration.
    direction: Vec<f64>,
    /// `[n]` the point that is tried next.
    trial: Vec<f64>,
    /// `[n]` memory for the gradient at a trial point, or for one more point.
    spare: Vec<f64>,
}

impl<'a> Minimisation<'a> {
    /// The state before the first iteration from `start`.
    fn new(problem: &'a mut dyn Problem, start: &[f64], options: &'a Options) -> Result<Self> {
        let n = start.len();
        let lower = problem.lower_bounds();
        let blocks = problem.index_blocks();
        let x: Vec<f64> = start.iter().zip(&lower).map(|(&v, &l)| v.max(l)).collect();
        let mut gradient = vec![0.0; n];
        let pattern = problem.pattern();
        let (newton, energy) = rayon::join(
            || NewtonDirection::new(pattern, blocks, !options.stay_in_basin),
            || problem.value_and_gradient(&x, &mut gradient),
        );
        Ok(Self {
            problem,
            options,
            newton: newton?,
            damping: Damping::new(options.ridge),
            residual: largest_projected(&x, &lower, &gradient),
            lower,
            x,
            energy,
            gradient,
            near_convergence: false,
            saddles: 0,
            iterations: 0,
            held: vec![false; n],
            direction: vec![0.0; n],
            trial: vec![0.0; n],
            spare: vec![0.0; n],
        })
    }

    /// Iterates until it ends.
    fn run(&mut self, observer: &dyn Observer) -> Result<Ending> {
        loop {
            if self.residual <= self.options.tolerance {
                if !self.escape_saddle() {
                    return Ok(Ending::Converged);
                }
                self.move_to_trial();
            }
            if self.iterations >= self.options.iteration_limit {
                return Ok(Ending::IterationLimit);
            }
            if observer.cancelled() {
                return Ok(Ending::Cancelled);
            }
            let ending = self.iterate()?;
            if ending == Some(Ending::RoundOff) {
                return Ok(Ending::RoundOff);
            }
            observer.step(&progress::Step {
                stage: self.options.stage,
                iteration: self.iterations,
                limit: self.options.iteration_limit,
                energy_joule: self.energy * self.options.energy_unit_joule,
                residual: self.residual,
                tolerance: self.options.tolerance,
            });
            if let Some(ending) = ending {
                return Ok(ending);
            }
        }
    }

    /// One iteration: a direction, a line search along it, and the step. Returns the reason to end
    /// with it, if there is one.
    fn iterate(&mut self) -> Result<Option<Ending>> {
        if let Some(pattern) = self.problem.new_sparsity() {
            self.newton.set_pattern(pattern, self.problem.index_blocks())?;
        }
        self.hold_active_bounds();
        let request = DirectionRequest {
            projection: self.options.psd_projection,
            near_convergence: self.near_convergence,
            damping: self.damping.share,
            held: &self.held,
            gradient: &self.gradient,
        };
        let found = self.newton.compute(self.problem, &request, &mut self.direction);
        let is_newton = found
            && self.near_convergence
            && self.damping.is_off()
            && self.newton.is_true_hessian();
        let last = is_newton
            && self.line().predicted_decrease() < self.options.predicted_decrease_tolerance;
        let accepted = found && self.search();
        self.iterations += 1;
        if !accepted {
            // The problem remembers a trial point now.
            self.problem.value_and_gradient(&self.x, &mut self.gradient);
            if !self.escape_saddle() {
                return Ok(Some(Ending::RoundOff));
            }
        }
        self.move_to_trial();
        Ok(last.then_some(Ending::Converged))
    }

    /// Marks the unknowns that are held: those at their bound, or nearly so, whose gradient pushes
    /// outward.
    fn hold_active_bounds(&mut self) {
        let band = self.residual.min(MAX_ACTIVE_BAND);
        for i in 0..self.x.len() {
            self.held[i] = self.x[i] <= self.lower[i] + band && self.gradient[i] > 0.0;
        }
    }

    /// The line from the iterate along the direction.
    fn line(&self) -> Line<'_> {
        Line {
            x: &self.x,
            direction: &self.direction,
            lower: &self.lower,
            gradient: &self.gradient,
            energy: self.energy,
        }
    }

    /// Searches along the direction; returns true if the trial point is to be the next iterate.
    fn search(&mut self) -> bool {
        let max_size = self.problem.max_step_size(&self.x, &self.direction);
        let Self { problem, x, direction, lower, gradient, energy, trial, spare, .. } = self;
        let line = Line { x, direction, lower, gradient, energy: *energy };
        match line.backtrack(&mut **problem, max_size, trial) {
            LineSearch::Decreased(step) => {
                self.damping.after(step.size, max_size);
                let mut end = step.energy;
                if self.near_convergence && !self.options.stay_in_basin && line.is_too_short(&step)
                {
                    end = line.expand(&mut **problem, end, trial, spare);
                }
                self.near_convergence = self.energy - end < NEAR_CONVERGENCE * self.energy.abs();
                true
            }
            LineSearch::BelowRounding => self.gradient_decreases(),
            LineSearch::Failed => false,
        }
    }

    /// True if the gradient is smaller at the trial point, and the energy there not larger than
    /// rounding explains.
    fn gradient_decreases(&mut self) -> bool {
        let energy = self.problem.value_and_gradient(&self.trial, &mut self.spare);
        let residual = largest_projected(&self.trial, &self.lower, &self.spare);
        residual < GRADIENT_DECREASE * self.residual
            && energy <= self.energy + ENERGY_ROUNDING * self.energy.abs()
    }

    /// Makes the trial point the iterate.
    fn move_to_trial(&mut self) {
        std::mem::swap(&mut self.x, &mut self.trial);
        self.energy = self.problem.value_and_gradient(&self.x, &mut self.gradient);
        self.residual = largest_projected(&self.x, &self.lower, &self.gradient);
    }

    /// If that is asked for and the Hessian at the iterate, where the problem was last evaluated,
    /// is not positive definite: sets the trial point to one with less energy. Returns true if
    /// there is one.
    fn escape_saddle(&mut self) -> bool {
        if !self.options.escape_saddles || self.saddles == MAX_SADDLES {
            return false;
        }
        self.saddles += 1;
        let Options { psd_projection, ridge, .. } = *self.options;
        let direction = saddle::negative_curvature_direction(
            self.problem,
            &mut self.newton,
            psd_projection,
            ridge,
        );
        let escaped = direction.is_some_and(|direction| {
            saddle::escape(self.problem, &self.x, self.energy, &direction, &mut self.trial)
        });
        if escaped {
            self.near_convergence = false;
        }
        escaped
    }
}

fn largest_projected(x: &[f64], lower: &[f64], gradient: &[f64]) -> f64 {
    let mut largest = 0.0_f64;
    for i in 0..x.len() {
        largest = largest.max(projected_gradient(x[i], lower[i], gradient[i]).abs());
    }
    largest
}

#[cfg(test)]
mod tests;
