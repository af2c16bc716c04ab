//! Projected Newton: minimise a smooth energy under lower bounds on some unknowns, with one sparse
//! Cholesky per iteration.
//!
//! Unknowns at their bound whose gradient pushes outward are held (Bertsekas 1982); the others take
//! a Newton step that is projected back onto the bounds along a line search, which goes back where
//! the step is too long and on where the energy falls faster than foreseen. Far from the minimum
//! the element Hessians are made positive semidefinite; near it the true Hessian is tried, which
//! gives quadratic convergence (`descent`). Everything is expected to be without unit and of order
//! one, so that no tolerance mixes units.
//!
//! A problem may leave small, far couplings out of the factorised matrix; conjugate gradients put
//! them right.

use super::descent::{Descent, Wanted};
use super::elimination::Groups;
use super::saddle::downward;
pub use super::small::Convexity;
use super::sparse::SymmetricPattern;
use crate::Result;
use crate::progress::{Observer, Step};

/// Share of the largest diagonal entry that is added after the first short step
/// (Levenberg–Marquardt).
const FIRST_DAMPING: f64 = 1e-8;
/// The same at most, where walls ([`Problem::longest_step`]) and not the energy cut steps short.
const MOST_WALL_DAMPING: f64 = 1e-4;

/// A whole step along which the energy falls by more than this share of its slope (half of it, if
/// the energy bends as the model does) is too short: then multiples of it are tried, up to so many.
const LESS_BENT: f64 = 0.7;
const LONGEST_STEP: f64 = 64.0;

/// Saddles left at most, and the longest first step (largest component) away from one.
const MOST_SADDLES: usize = 5;
const LONGEST_LEAVE: f64 = 0.1;

/// An energy that [`minimise`] can minimise.
pub trait Problem: Send {
    /// Which unknowns its Hessian couples.
    fn pattern(&self) -> SymmetricPattern;
    /// `[n]` lower bound of each unknown; −∞ for none.
    fn lower_bounds(&self) -> Vec<f64>;
    /// The energy at `x`.
    fn energy(&mut self, x: &[f64]) -> f64;
    /// The energy at `x` and its gradient; remembers `x` for [`Problem::hessian`].
    fn linearise(&mut self, x: &[f64], gradient: &mut [f64]) -> f64;
    /// Adds to `out` (`[n]`) what the Hessian does to `x` (`[n]`) beyond its values on
    /// [`Problem::pattern`], if the pattern leaves small, far couplings out; the values must then
    /// bound the whole Hessian from above. Returns whether there is anything.
    fn add_rest_of_hessian(&self, x: &[f64], out: &mut [f64]) -> bool {
        let _ = (x, out);
        false
    }
    /// The longest part (0 to 1) of the step `direction` from `x`, where the problem was last
    /// evaluated, that may be tried, where the energy has walls (contact).
    fn longest_step(&mut self, x: &[f64], direction: &[f64]) -> f64 {
        let _ = (x, direction);
        1.0
    }
    /// The new pattern, if unknowns came to be coupled (contact) that were not before; asked after
    /// [`Problem::linearise`].
    fn changed_pattern(&mut self) -> Option<SymmetricPattern> {
        None
    }
    /// Which unknowns are better eliminated together (the coordinates of a vertex) on the pattern
    /// as it is now; `None` if that is not known.
    fn groups(&self) -> Option<Groups> {
        None
    }
    /// Values on [`Problem::pattern`] of the Hessian where [`Problem::linearise`] was last called.
    fn hessian(&mut self, convexity: Convexity, values: &mut [f64]);
}

/// How [`minimise`] goes about it.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Name of the step, for the observer.
    pub stage: &'static str,
    /// Iterations at most.
    pub iteration_limit: usize,
    /// The step ends when no component of the projected gradient is larger.
    pub tolerance: f64,
    /// The step ends, too, with a Newton step of the true Hessian, positive definite, that was to
    /// lower the energy by less; 0 for never. (By energy and not by gradient, so that what costs
    /// next to nothing, such as phases where there is hardly an amplitude, does not count.)
    pub least_fall: f64,
    /// How element Hessians are treated until the true Hessian is positive definite.
    pub convexity: Convexity,
    /// Share of the largest diagonal entry that is added to each, so that directions without
    /// stiffness do not move.
    pub ridge: f64,
    /// Whether a minimum near to the start is wanted, as where a surface is followed while it
    /// grows, and not any that is low: then no step goes on, and steps are those of the true
    /// Hessian or of the convex one.
    pub nearest: bool,
    /// Whether to ask, where the gradient vanishes, that the energy be least there too, and to go
    /// on along a direction of negative curvature if it is not. For problems without lower bounds.
    pub leave_saddles: bool,
    /// Joules in one unit of energy, for the observer.
    pub energy_unit_joule: f64,
}

/// How a minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The projected gradient is below the tolerance, or nothing is to be gained by a step
    /// ([`Options::least_fall`]).
    Converged,
    /// No step lowers the energy any more; the projected gradient is as small as rounding lets it
    /// become.
    RoundOff,
    /// The iteration limit was reached first.
    IterationLimit,
    /// The observer asked to stop.
    Cancelled,
}

/// Where a minimisation ended.
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
    /// Why it ended.
    pub ending: Ending,
}

/// The part of a gradient component that a lower bound leaves: zero where it pushes against the
/// bound.
pub fn projected(x: f64, lower: f64, gradient: f64) -> f64 {
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
    let n = start.len();
    let lower = problem.lower_bounds();
    let groups = problem.groups();
    let mut x: Vec<f64> = start.iter().zip(&lower).map(|(&v, &l)| v.max(l)).collect();
    let mut gradient = vec![0.0; n];
    let pattern = problem.pattern();
    let (descent, mut energy) = rayon::join(
        || Descent::new(pattern, groups, options.nearest),
        || problem.linearise(&x, &mut gradient),
    );
    let mut descent = descent?;
    let (mut direction, mut trial, mut trial_gradient) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut held = vec![false; n];
    let mut residual = largest_projected(&x, &lower, &gradient);
    let mut settled = false;
    let mut saddles = 0;
    let mut damping = options.ridge;
    let mut iterations = 0;
    let ending = loop {
        if residual <= options.tolerance {
            if !leave(problem, &mut descent, options, &mut saddles, &x, energy, &mut trial) {
                break Ending::Converged;
            }
            std::mem::swap(&mut x, &mut trial);
            energy = problem.linearise(&x, &mut gradient);
            residual = largest_projected(&x, &lower, &gradient);
            settled = false;
        }
        if iterations >= options.iteration_limit {
            break Ending::IterationLimit;
        }
        if observer.cancelled() {
            break Ending::Cancelled;
        }
        if let Some(pattern) = problem.changed_pattern() {
            descent = descent.again(pattern, problem.groups())?;
        }
        // Bertsekas' ε: unknowns this near to their bound count as at it.
        let near = residual.min(1e-3);
        for i in 0..n {
            held[i] = x[i] <= lower[i] + near && gradient[i] > 0.0;
        }
        let wanted = Wanted {
            convexity: options.convexity,
            settled,
            damping,
            held: &held,
            gradient: &gradient,
        };
        let solved = descent.find(problem, &wanted, &mut direction);
        let exact = solved && settled && damping <= options.ridge && descent.exact();
        let last = exact && fall(&x, &lower, &gradient, &direction) < options.least_fall;
        let mut accepted = false;
        if solved {
            let longest = problem.longest_step(&x, &direction);
            let mut length = longest;
            for _ in 0..40 {
                let mut slope = 0.0;
                for i in 0..n {
                    trial[i] = (x[i] + length * direction[i]).max(lower[i]);
                    slope += gradient[i] * (trial[i] - x[i]);
                }
                // Below this an energy difference is rounding; the gradient decides instead.
                if slope.abs() < 1e-13 * energy.abs() {
                    let trial_energy = problem.linearise(&trial, &mut trial_gradient);
                    let trial_residual = largest_projected(&trial, &lower, &trial_gradient);
                    if trial_residual < 0.9 * residual
                        && trial_energy <= energy + 1e-13 * energy.abs()
                    {
                        accepted = true;
                        energy = trial_energy.min(energy);
                    }
                    break;
                }
                let mut trial_energy = problem.energy(&trial);
                if slope < 0.0 && trial_energy <= energy + 1e-4 * slope {
                    accepted = true;
                    // A short step says that the model reaches too far, e.g. that a slack face
                    // would be pulled taut; or that there is a wall: then some damping keeps the
                    // rest from sliding along it, and more would keep it from moving at all.
                    let more = (damping * 100.0).max(FIRST_DAMPING);
                    if length < 0.3 * longest {
                        damping = more;
                    } else if length < 0.3 {
                        damping = damping.max(more.min(MOST_WALL_DAMPING));
                    } else if length == 1.0 {
                        damping = (damping * 0.1).max(options.ridge);
                    }
                    if length == 1.0
                        && settled
                        && !options.nearest
                        && trial_energy < energy + LESS_BENT * slope
                    {
                        trial_energy = go_on(
                            problem,
                            &x,
                            &direction,
                            &lower,
                            trial_energy,
                            &mut trial,
                            &mut trial_gradient,
                        );
                    }
                    settled = energy - trial_energy < 1e-2 * energy.abs();
                    break;
                }
                length *= 0.5;
            }
        }
        iterations += 1;
        if !accepted {
            // The problem remembers a trial point now.
            problem.linearise(&x, &mut gradient);
            if !leave(problem, &mut descent, options, &mut saddles, &x, energy, &mut trial) {
                break Ending::RoundOff;
            }
            settled = false;
        }
        std::mem::swap(&mut x, &mut trial);
        energy = problem.linearise(&x, &mut gradient);
        residual = largest_projected(&x, &lower, &gradient);
        observer.step(&Step {
            stage: options.stage,
            iteration: iterations,
            limit: options.iteration_limit,
            energy_joule: energy * options.energy_unit_joule,
            residual,
            tolerance: options.tolerance,
        });
        if last {
            break Ending::Converged;
        }
    };
    Ok(Outcome { x, energy, gradient, projected_gradient: residual, iterations, ending })
}

/// If it is asked for and the Hessian where the problem was last linearised, at `x`, is not
/// positive definite: `trial` lower down; tells whether there is one.
fn leave(
    problem: &mut dyn Problem,
    descent: &mut Descent,
    options: &Options,
    saddles: &mut usize,
    x: &[f64],
    energy: f64,
    trial: &mut [f64],
) -> bool {
    if !options.leave_saddles || *saddles == MOST_SADDLES {
        return false;
    }
    *saddles += 1;
    let way = downward(problem, descent, options.convexity, options.ridge);
    way.is_some_and(|way| step_down(problem, x, energy, &way, trial))
}

/// Goes from the saddle `x` along `way` (either sign) as far as the energy falls well below
/// `energy`; tells whether it does at all.
fn step_down(
    problem: &mut dyn Problem,
    x: &[f64],
    energy: f64,
    way: &[f64],
    trial: &mut [f64],
) -> bool {
    let direction: Vec<f64> = way.iter().map(|w| w * LONGEST_LEAVE).collect();
    let mut length = problem.longest_step(x, &direction);
    let mut least = (energy - 1e-13 * energy.abs(), 0.0);
    for _ in 0..30 {
        for i in 0..x.len() {
            trial[i] = x[i] + length * direction[i];
        }
        let there = problem.energy(trial);
        if there < least.0 {
            least = (there, length);
        } else if least.1 > 0.0 {
            break;
        }
        length *= 0.5;
    }
    for i in 0..x.len() {
        trial[i] = x[i] + least.1 * direction[i];
    }
    least.1 > 0.0
}

/// From `trial`, the end of the whole step `direction` from `x`, where the energy is `energy`: to
/// twice, four times, … that step, as long as the energy falls and no wall is met. Returns the
/// energy at the new `trial`; `farther` is room for one more.
fn go_on(
    problem: &mut dyn Problem,
    x: &[f64],
    direction: &[f64],
    lower: &[f64],
    mut energy: f64,
    trial: &mut Vec<f64>,
    farther: &mut Vec<f64>,
) -> f64 {
    let way: Vec<f64> = direction.iter().map(|d| d * LONGEST_STEP).collect();
    let longest = 1.0 + LONGEST_STEP * problem.longest_step(trial, &way);
    let mut length = 2.0;
    while length <= longest {
        for i in 0..x.len() {
            farther[i] = (x[i] + length * direction[i]).max(lower[i]);
        }
        let there = problem.energy(farther);
        if there.is_nan() || there >= energy {
            break;
        }
        energy = there;
        std::mem::swap(trial, farther);
        length *= 2.0;
    }
    energy
}

/// How much a quadratic energy falls by its Newton step `direction` from `x`.
fn fall(x: &[f64], lower: &[f64], gradient: &[f64], direction: &[f64]) -> f64 {
    let slope: f64 =
        (0..x.len()).map(|i| gradient[i] * ((x[i] + direction[i]).max(lower[i]) - x[i])).sum();
    -0.5 * slope
}

fn largest_projected(x: &[f64], lower: &[f64], gradient: &[f64]) -> f64 {
    let mut largest = 0.0_f64;
    for i in 0..x.len() {
        largest = largest.max(projected(x[i], lower[i], gradient[i]).abs());
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    /// Rosenbrock's valley in pairs, with x₀ ≥ 1.5: the minimum lies on the bound.
    struct Valley {
        hessian: [f64; 3],
    }

    impl Problem for Valley {
        fn pattern(&self) -> SymmetricPattern {
            SymmetricPattern::from_elements(2, [&[0, 1][..]].into_iter())
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![1.5, f64::NEG_INFINITY]
        }
        fn energy(&mut self, x: &[f64]) -> f64 {
            100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2)
        }
        fn linearise(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
            let d = x[1] - x[0] * x[0];
            g[0] = -400.0 * x[0] * d - 2.0 * (1.0 - x[0]);
            g[1] = 200.0 * d;
            self.hessian = [-400.0 * d + 800.0 * x[0] * x[0] + 2.0, -400.0 * x[0], 200.0];
            self.energy(x)
        }
        fn hessian(&mut self, convexity: Convexity, values: &mut [f64]) {
            let [a, b, c] = self.hessian;
            let h = crate::linalg::small::convexify(&nalgebra::Matrix2::new(a, b, b, c), convexity);
            values.copy_from_slice(&[h[(0, 0)], h[(1, 0)], h[(1, 1)]]);
        }
    }

    #[test]
    fn finds_the_minimum_on_the_bound() {
        let options = Options {
            stage: "test",
            iteration_limit: 200,
            tolerance: 1e-10,
            least_fall: 0.0,
            convexity: Convexity::Mirrored,
            ridge: 1e-14,
            nearest: false,
            leave_saddles: false,
            energy_unit_joule: 1.0,
        };
        let outcome =
            minimise(&mut Valley { hessian: [0.0; 3] }, &[4.0, -3.0], &options, &Silent).unwrap();
        assert_eq!(outcome.ending, Ending::Converged);
        assert_eq!(outcome.x[0], 1.5);
        assert!((outcome.x[1] - 2.25).abs() < 1e-12, "{:?}", outcome.x);
    }

    /// A stiff chain on a soft foundation that couples everything with everything; only the chain
    /// is in the pattern.
    struct Chain {
        n: usize,
        left_out: bool,
    }

    impl Chain {
        const SOFT: f64 = 1e-3;

        fn push(&self, i: usize) -> f64 {
            (i as f64 * 0.9).sin()
        }
    }

    impl Problem for Chain {
        fn pattern(&self) -> SymmetricPattern {
            let chain: Vec<[usize; 2]> = (0..self.n - 1).map(|i| [i, i + 1]).collect();
            SymmetricPattern::from_elements(self.n, chain.iter().map(|e| &e[..]))
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![f64::NEG_INFINITY; self.n]
        }
        fn energy(&mut self, x: &[f64]) -> f64 {
            let chain: f64 = x.windows(2).map(|p| (p[1] - p[0]).powi(2)).sum();
            let all: f64 = x.iter().sum();
            let ground: f64 = x.iter().map(|x| x * x).sum();
            let push: f64 = x.iter().enumerate().map(|(i, x)| x * self.push(i)).sum();
            1.0 + 0.5 * (chain + ground + Self::SOFT * all * all) - push
        }
        fn linearise(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
            let all: f64 = x.iter().sum();
            for i in 0..self.n {
                let left = if i > 0 { x[i] - x[i - 1] } else { 0.0 };
                let right = if i + 1 < self.n { x[i] - x[i + 1] } else { 0.0 };
                g[i] = left + right + x[i] + Self::SOFT * all - self.push(i);
            }
            self.energy(x)
        }
        fn add_rest_of_hessian(&self, x: &[f64], out: &mut [f64]) -> bool {
            // The diagonal of the pattern bounds what is left out: SOFT·n on each unknown.
            let all: f64 = x.iter().sum();
            for (out, x) in out.iter_mut().zip(x) {
                *out += Self::SOFT * (all - self.n as f64 * x);
            }
            self.left_out
        }
        fn hessian(&mut self, _: Convexity, values: &mut [f64]) {
            let pattern = self.pattern();
            values.fill(0.0);
            for i in 0..self.n {
                values[pattern.slot(i, i)] += 1.0 + Self::SOFT * self.n as f64;
                if i + 1 < self.n {
                    values[pattern.slot(i, i)] += 1.0;
                    values[pattern.slot(i + 1, i + 1)] += 1.0;
                    values[pattern.slot(i, i + 1)] -= 1.0;
                }
            }
        }
    }

    #[test]
    fn what_the_pattern_leaves_out_is_put_right() {
        let options = Options {
            stage: "test",
            iteration_limit: 100,
            tolerance: 1e-11,
            least_fall: 0.0,
            convexity: Convexity::Clamped,
            ridge: 0.0,
            nearest: false,
            leave_saddles: false,
            energy_unit_joule: 1.0,
        };
        let steps = |left_out| {
            minimise(&mut Chain { n: 400, left_out }, &[0.0; 400], &options, &Silent).unwrap()
        };
        // The energy is quadratic: a few Newton steps, the later the more exactly solved; without
        // the inner solve many.
        let (whole, bound) = (steps(true), steps(false));
        assert!(
            whole.iterations <= 6 && bound.iterations > 2 * whole.iterations,
            "{} {}",
            whole.iterations,
            bound.iterations
        );
        assert!(whole.x.iter().zip(&bound.x).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    /// Two wells with a ridge between: x⁴/4 − x²/2 + (y − 1)²/2.
    struct Wells {
        x: f64,
    }

    impl Problem for Wells {
        fn pattern(&self) -> SymmetricPattern {
            SymmetricPattern::from_elements(2, [&[0, 1][..]].into_iter())
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![f64::NEG_INFINITY; 2]
        }
        fn energy(&mut self, x: &[f64]) -> f64 {
            x[0].powi(4) / 4.0 - x[0] * x[0] / 2.0 + (x[1] - 1.0).powi(2) / 2.0
        }
        fn linearise(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
            self.x = x[0];
            g.copy_from_slice(&[x[0].powi(3) - x[0], x[1] - 1.0]);
            self.energy(x)
        }
        fn hessian(&mut self, convexity: Convexity, values: &mut [f64]) {
            let bend = 3.0 * self.x * self.x - 1.0;
            values.copy_from_slice(&[
                if convexity == Convexity::Exact { bend } else { bend.max(1e-3) },
                0.0,
                1.0,
            ]);
        }
    }

    #[test]
    fn saddles_are_left_if_that_is_asked_for() {
        let options = |leave_saddles| Options {
            stage: "test",
            iteration_limit: 100,
            tolerance: 1e-10,
            least_fall: 0.0,
            convexity: Convexity::Clamped,
            ridge: 1e-14,
            nearest: false,
            leave_saddles,
            energy_unit_joule: 1.0,
        };
        let found =
            |leave| minimise(&mut Wells { x: 0.0 }, &[0.0, 5.0], &options(leave), &Silent).unwrap();
        let stuck = found(false).x;
        assert!(stuck[0] == 0.0 && (stuck[1] - 1.0).abs() < 1e-9, "{stuck:?}");
        let left = found(true);
        assert_eq!(left.ending, Ending::Converged);
        assert!(
            (left.x[0].abs() - 1.0).abs() < 1e-9 && (left.x[1] - 1.0).abs() < 1e-9,
            "{:?}",
            left.x
        );
        // A minimum is not left.
        let stays = minimise(&mut Wells { x: 0.0 }, &[1.0, 1.0], &options(true), &Silent).unwrap();
        assert_eq!((stays.x, stays.iterations), (vec![1.0, 1.0], 0));
    }

    /// x₀² and (x₁ − 100)², the first much stiffer, with a wall that cuts every step far from the
    /// minimum short.
    struct Walled;

    impl Problem for Walled {
        fn pattern(&self) -> SymmetricPattern {
            SymmetricPattern::from_elements(2, [&[0, 1][..]].into_iter())
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![f64::NEG_INFINITY; 2]
        }
        fn energy(&mut self, x: &[f64]) -> f64 {
            5e3 * x[0] * x[0] + 0.5 * (x[1] - 100.0).powi(2)
        }
        fn linearise(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
            g.copy_from_slice(&[1e4 * x[0], x[1] - 100.0]);
            self.energy(x)
        }
        fn longest_step(&mut self, x: &[f64], _: &[f64]) -> f64 {
            if (x[1] - 100.0).abs() > 1.0 { 0.2 } else { 1.0 }
        }
        fn hessian(&mut self, _: Convexity, values: &mut [f64]) {
            values.copy_from_slice(&[1e4, 0.0, 1.0]);
        }
    }

    #[test]
    fn walls_slow_it_down_and_do_not_stop_it() {
        let options = Options {
            stage: "test",
            iteration_limit: 200,
            tolerance: 1e-9,
            least_fall: 0.0,
            convexity: Convexity::Clamped,
            ridge: 1e-14,
            nearest: false,
            leave_saddles: false,
            energy_unit_joule: 1.0,
        };
        let found = minimise(&mut Walled, &[3.0, 0.0], &options, &Silent).unwrap();
        assert_eq!(found.ending, Ending::Converged);
        assert!(
            (found.x[1] - 100.0).abs() < 1e-8 && found.iterations < 100,
            "{:?} in {}",
            found.x,
            found.iterations
        );
    }

    /// 1 + (x₀ − 100)²/2 + 10⁻⁹ x₁⁴, with a convex bound that is far too stiff along x₀ and a true
    /// Hessian that is of no use there.
    struct Stiff {
        x: [f64; 2],
        exact: f64,
    }

    impl Problem for Stiff {
        fn pattern(&self) -> SymmetricPattern {
            SymmetricPattern::from_elements(2, [&[0, 1][..]].into_iter())
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![f64::NEG_INFINITY; 2]
        }
        fn energy(&mut self, x: &[f64]) -> f64 {
            1.0 + 0.5 * (x[0] - 100.0).powi(2) + 1e-9 * x[1].powi(4)
        }
        fn linearise(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
            self.x = [x[0], x[1]];
            g.copy_from_slice(&[x[0] - 100.0, 4e-9 * x[1].powi(3)]);
            self.energy(x)
        }
        fn hessian(&mut self, convexity: Convexity, values: &mut [f64]) {
            let bend = if convexity == Convexity::Exact { self.exact } else { 50.0 };
            values.copy_from_slice(&[bend, 0.0, 12e-9 * self.x[1] * self.x[1]]);
        }
    }

    fn stiff(exact: f64, least_fall: f64, begin: [f64; 2], nearest: bool) -> Outcome {
        let options = Options {
            stage: "test",
            iteration_limit: 1000,
            tolerance: 1e-15,
            least_fall,
            convexity: Convexity::Clamped,
            ridge: 1e-20,
            nearest,
            leave_saddles: false,
            energy_unit_joule: 1.0,
        };
        minimise(&mut Stiff { x: begin, exact }, &begin, &options, &Silent).unwrap()
    }

    #[test]
    fn steps_go_on_where_the_model_is_too_stiff() {
        let found = stiff(-1e3, 0.0, [99.9, 0.0], false);
        assert!((found.x[0] - 100.0).abs() < 1e-5, "{:?}", found.x);
        // A fiftieth of the way with each step takes hundreds of them.
        assert!(found.iterations < 60, "{}", found.iterations);
        // But not where the nearest minimum is wanted.
        let followed = stiff(-1e3, 0.0, [99.9, 0.0], true);
        assert!(
            followed.iterations > 3 * found.iterations,
            "{} {}",
            followed.iterations,
            found.iterations
        );
    }

    #[test]
    fn it_ends_where_nothing_is_to_be_gained() {
        let [all, enough] =
            [0.0, 1e-13].map(|least_fall| stiff(1.0, least_fall, [100.0, 10.0], false));
        assert_eq!([all.ending, enough.ending], [Ending::Converged; 2]);
        assert!(
            enough.iterations + 3 < all.iterations && enough.energy - all.energy < 1e-12,
            "{} {}",
            enough.iterations,
            all.iterations
        );
    }
}
