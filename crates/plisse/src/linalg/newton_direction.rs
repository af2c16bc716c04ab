//! The direction of a Newton step: the matrix that is factorised, and the solve with it.
//!
//! Close to the minimum the matrix is the true Hessian H, which gives quadratic convergence.
//! Farther away H has directions of negative curvature. The projected Hessian C, with every
//! element's Hessian positive semidefinite, has none, but may be far stiffer than the energy is. So
//! the blended Hessian H + s(C − H) is factorised, with a blend weight s (`blend_weight`) as small
//! as experience allows, from 0 to 1. But for loads like pressure, C − H is positive semidefinite:
//! what can be factorised with one weight can be with any larger one.

use super::blend_weight::BlendWeight;
use super::cholesky::Cholesky;
use super::damping::GROWTH;
use super::problem::Problem;
use super::psd_projection::PsdProjection;
use super::sparse::SymmetricPattern;
use super::symbolic::IndexBlocks;
use crate::Result;

/// Damping above which no positive definite matrix is hoped for any more.
const MAX_DAMPING: f64 = 1e8;
/// Forcing terms (relative residuals at which [`NewtonDirection::conjugate_gradients`] ends;
/// Eisenstat & Walker 1996): the largest, far from the minimum, where a Newton step is rough
/// anyway, and the smallest, close to it.
const MAX_FORCING: f64 = 1e-2;
const MIN_FORCING: f64 = 1e-6;
/// Largest number of conjugate-gradient steps.
const MAX_CG_STEPS: usize = 60;

/// Solver for the directions of successive Newton steps.
pub(super) struct NewtonDirection {
    pub(super) cholesky: Cholesky,
    /// `[n]` slots of the diagonal's entries.
    pub(super) diagonal: Vec<usize>,
    /// `[nnz]` values of the matrix that is factorised.
    pub(super) values: Vec<f64>,
    /// `[nnz]` values of H and C, while both are needed.
    hessian: Vec<f64>,
    projected: Vec<f64>,
    weight: BlendWeight,
}

/// The request for a direction.
pub(super) struct DirectionRequest<'a> {
    /// Projection that makes C.
    pub(super) projection: PsdProjection,
    /// True if steps have become small, so that H may be tried.
    pub(super) near_convergence: bool,
    /// Share of the largest diagonal entry that is added to each.
    pub(super) damping: f64,
    /// `[n]` unknowns at a bound, which step down their own gradient only.
    pub(super) held: &'a [bool],
    /// `[n]`.
    pub(super) gradient: &'a [f64],
}

impl NewtonDirection {
    /// A solver for `pattern`. Without `blends` the weight is 0 or 1.
    pub(super) fn new(
        pattern: SymmetricPattern,
        blocks: Option<IndexBlocks>,
        blends: bool,
    ) -> Result<Self> {
        Ok(Self::with(Cholesky::for_many(pattern, blocks)?, BlendWeight::new(blends)))
    }

    /// Exchanges the pattern; the weight stays.
    pub(super) fn set_pattern(
        &mut self,
        pattern: SymmetricPattern,
        blocks: Option<IndexBlocks>,
    ) -> Result<()> {
        self.cholesky.reanalyse(pattern, blocks)?;
        self.diagonal = diagonal_slots(self.cholesky.pattern());
        self.values = vec![0.0; self.cholesky.pattern().entry_count()];
        (self.hessian, self.projected) = (Vec::new(), Vec::new());
        Ok(())
    }

    fn with(cholesky: Cholesky, weight: BlendWeight) -> Self {
        Self {
            diagonal: diagonal_slots(cholesky.pattern()),
            values: vec![0.0; cholesky.pattern().entry_count()],
            hessian: Vec::new(),
            projected: Vec::new(),
            cholesky,
            weight,
        }
    }

    /// True if the last direction was that of the true Hessian.
    pub(super) fn is_true_hessian(&self) -> bool {
        self.weight.is_zero()
    }

    /// Sets `direction` (`[n]`) to one along which the energy of `problem` falls from the point
    /// where it was last evaluated. Returns true if there is one.
    pub(super) fn compute(
        &mut self,
        problem: &mut dyn Problem,
        request: &DirectionRequest<'_>,
        direction: &mut [f64],
    ) -> bool {
        if request.projection == PsdProjection::None || !request.near_convergence {
            self.weight.skip_step();
        } else if self.compute_blended(problem, request, direction) {
            return true;
        }
        let mut damping = request.damping;
        loop {
            problem.hessian(request.projection, &mut self.values);
            if self.solve(problem, request, damping, direction) {
                return true;
            }
            damping *= GROWTH;
            if damping.is_nan() || damping > MAX_DAMPING {
                return false;
            }
        }
    }

    /// As [`NewtonDirection::compute`], with blend weights below 1.
    fn compute_blended(
        &mut self,
        problem: &mut dyn Problem,
        request: &DirectionRequest<'_>,
        direction: &mut [f64],
    ) -> bool {
        let mut weight = self.weight.first();
        if weight >= 1.0 {
            return false;
        }
        self.hessian.resize(self.values.len(), 0.0);
        problem.hessian(PsdProjection::None, &mut self.hessian);
        let mut has_projected = false;
        while weight < 1.0 {
            self.values.copy_from_slice(&self.hessian);
            if weight > 0.0 {
                if !has_projected {
                    self.projected.resize(self.values.len(), 0.0);
                    problem.hessian(request.projection, &mut self.projected);
                    has_projected = true;
                }
                for (value, projected) in self.values.iter_mut().zip(&self.projected) {
                    *value += weight * (projected - *value);
                }
            }
            if self.solve(problem, request, request.damping, direction) {
                self.weight.succeeded(weight);
                return true;
            }
            weight = self.weight.failed(weight);
        }
        self.weight.set_one();
        false
    }

    /// Sets `direction` to −A⁻¹·gradient for the matrix A in `values`, damped. Returns false if A
    /// is not positive definite.
    fn solve(
        &mut self,
        problem: &dyn Problem,
        request: &DirectionRequest<'_>,
        damping: f64,
        direction: &mut [f64],
    ) -> bool {
        let values = &mut self.values;
        let largest = self.diagonal.iter().map(|&slot| values[slot].abs()).fold(0.0, f64::max);
        let shift = if largest > 0.0 { damping * largest } else { 1.0 };
        for &slot in &self.diagonal {
            values[slot] += shift;
        }
        self.cholesky.pattern().isolate(values, request.held);
        if !self.cholesky.factorise(values) {
            return false;
        }
        // Held unknowns step down their own gradient, to the bound; the line search projects them.
        for (direction, gradient) in direction.iter_mut().zip(request.gradient) {
            *direction = -gradient;
        }
        self.cholesky.solve(direction);
        // The solve is rough while the gradient (of order one at most) is large, and exact enough
        // that the steps shrink it superlinearly (Eisenstat & Walker 1996).
        let free = request.gradient.iter().zip(request.held).filter(|(_, held)| !**held);
        let largest = free.fold(0.0_f64, |most, (g, _)| most.max(g.abs()));
        self.conjugate_gradients(
            problem,
            request.gradient,
            largest.sqrt().clamp(MIN_FORCING, MAX_FORCING),
            direction,
        );
        dot(direction, request.gradient) < 0.0
    }

    /// Solves H·direction = −gradient, where the factorised matrix P leaves a remainder of the
    /// Hessian out, by conjugate gradients with P as preconditioner. `direction` comes in as
    /// −P⁻¹·gradient. Every iterate is a direction of descent.
    fn conjugate_gradients(
        &mut self,
        problem: &dyn Problem,
        gradient: &[f64],
        forcing: f64,
        direction: &mut [f64],
    ) {
        let n = direction.len();
        let mut image = vec![0.0; n];
        if !problem.apply_hessian_remainder(direction, &mut image) {
            return;
        }
        let mut residual: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut search = direction.to_vec();
        direction.fill(0.0);
        let mut square = dot(&residual, &search);
        let enough = forcing * forcing * square;
        let mut solved = vec![0.0; n];
        for _ in 0..MAX_CG_STEPS {
            self.cholesky.pattern().multiply(&self.values, &search, &mut image);
            problem.apply_hessian_remainder(&search, &mut image);
            let curvature = dot(&search, &image);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let step = square / curvature;
            for i in 0..n {
                direction[i] += step * search[i];
                residual[i] -= step * image[i];
            }
            solved.copy_from_slice(&residual);
            self.cholesky.solve(&mut solved);
            let next = dot(&residual, &solved);
            if next.is_nan() || next <= enough {
                break;
            }
            for i in 0..n {
                search[i] = solved[i] + next / square * search[i];
            }
            square = next;
        }
    }
}

/// `[n]` slots of the diagonal's entries.
fn diagonal_slots(pattern: &SymmetricPattern) -> Vec<usize> {
    (0..pattern.size()).map(|i| pattern.slot(i, i)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One unknown, with H = −1 and C = 50.
    struct Saddle;

    impl Problem for Saddle {
        fn pattern(&self) -> SymmetricPattern {
            SymmetricPattern::from_elements(1, [&[0][..]].into_iter())
        }
        fn lower_bounds(&self) -> Vec<f64> {
            vec![f64::NEG_INFINITY]
        }
        fn energy(&mut self, _: &[f64]) -> f64 {
            0.0
        }
        fn value_and_gradient(&mut self, _: &[f64], _: &mut [f64]) -> f64 {
            0.0
        }
        fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
            values[0] = if projection == PsdProjection::None { -1.0 } else { 50.0 };
        }
    }

    #[test]
    fn the_least_weight_that_makes_the_blend_positive_definite_is_used() {
        let mut newton = NewtonDirection::new(Saddle.pattern(), None, true).unwrap();
        let curvature = |newton: &mut NewtonDirection, near_convergence: bool| {
            let request = DirectionRequest {
                projection: PsdProjection::Clamp,
                near_convergence,
                damping: 0.0,
                held: &[false],
                gradient: &[1.0],
            };
            let mut direction = [0.0];
            assert!(newton.compute(&mut Saddle, &request, &mut direction));
            -1.0 / direction[0]
        };
        assert_eq!(curvature(&mut newton, false), 50.0);
        for expected in [0.25 * 51.0 - 1.0, 0.0625 * 51.0 - 1.0, 0.0625 * 51.0 - 1.0] {
            assert!((curvature(&mut newton, true) - expected).abs() < 1e-12);
            assert!(!newton.is_true_hessian());
        }
    }
}
