//! Tests of [`minimise`] on small problems with known minima.

use super::*;
use crate::linalg::sparse::SymmetricPattern;
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
    fn value_and_gradient(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
        let d = x[1] - x[0] * x[0];
        g[0] = -400.0 * x[0] * d - 2.0 * (1.0 - x[0]);
        g[1] = 200.0 * d;
        self.hessian = [-400.0 * d + 800.0 * x[0] * x[0] + 2.0, -400.0 * x[0], 200.0];
        self.energy(x)
    }
    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
        let [a, b, c] = self.hessian;
        let h = crate::linalg::psd_projection::project_to_psd(
            &nalgebra::Matrix2::new(a, b, b, c),
            projection,
        );
        values.copy_from_slice(&[h[(0, 0)], h[(1, 0)], h[(1, 1)]]);
    }
}

#[test]
fn finds_the_minimum_on_the_bound() {
    let options = Options {
        iteration_limit: 200,
        tolerance: 1e-10,
        psd_projection: PsdProjection::Abs,
        ..Options::new("test", 1.0)
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
    has_remainder: bool,
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
    fn value_and_gradient(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
        let all: f64 = x.iter().sum();
        for i in 0..self.n {
            let left = if i > 0 { x[i] - x[i - 1] } else { 0.0 };
            let right = if i + 1 < self.n { x[i] - x[i + 1] } else { 0.0 };
            g[i] = left + right + x[i] + Self::SOFT * all - self.push(i);
        }
        self.energy(x)
    }
    fn apply_hessian_remainder(&self, x: &[f64], out: &mut [f64]) -> bool {
        // The diagonal of the pattern bounds the remainder: SOFT·n on each unknown.
        let all: f64 = x.iter().sum();
        for (out, x) in out.iter_mut().zip(x) {
            *out += Self::SOFT * (all - self.n as f64 * x);
        }
        self.has_remainder
    }
    fn hessian(&mut self, _: PsdProjection, values: &mut [f64]) {
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
fn the_remainder_of_the_hessian_is_accounted_for() {
    let options =
        Options { iteration_limit: 100, tolerance: 1e-11, ridge: 0.0, ..Options::new("test", 1.0) };
    let steps = |has_remainder| {
        minimise(&mut Chain { n: 400, has_remainder }, &[0.0; 400], &options, &Silent).unwrap()
    };
    // The energy is quadratic: a few Newton steps suffice, the later the more exactly solved;
    // without conjugate gradients it takes many.
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
    fn value_and_gradient(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
        self.x = x[0];
        g.copy_from_slice(&[x[0].powi(3) - x[0], x[1] - 1.0]);
        self.energy(x)
    }
    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
        let curvature = 3.0 * self.x * self.x - 1.0;
        values.copy_from_slice(&[
            if projection == PsdProjection::None { curvature } else { curvature.max(1e-3) },
            0.0,
            1.0,
        ]);
    }
}

#[test]
fn saddles_are_escaped_if_that_is_asked_for() {
    let options = |escape_saddles| Options {
        iteration_limit: 100,
        tolerance: 1e-10,
        escape_saddles,
        ..Options::new("test", 1.0)
    };
    let end =
        |escape| minimise(&mut Wells { x: 0.0 }, &[0.0, 5.0], &options(escape), &Silent).unwrap();
    let stuck = end(false).x;
    assert!(stuck[0] == 0.0 && (stuck[1] - 1.0).abs() < 1e-9, "{stuck:?}");
    let escaped = end(true);
    assert_eq!(escaped.ending, Ending::Converged);
    assert!(
        (escaped.x[0].abs() - 1.0).abs() < 1e-9 && (escaped.x[1] - 1.0).abs() < 1e-9,
        "{:?}",
        escaped.x
    );
    // A minimum is not escaped.
    let minimum = minimise(&mut Wells { x: 0.0 }, &[1.0, 1.0], &options(true), &Silent).unwrap();
    assert_eq!((minimum.x, minimum.iterations), (vec![1.0, 1.0], 0));
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
    fn value_and_gradient(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
        g.copy_from_slice(&[1e4 * x[0], x[1] - 100.0]);
        self.energy(x)
    }
    fn max_step_size(&mut self, x: &[f64], _: &[f64]) -> f64 {
        if (x[1] - 100.0).abs() > 1.0 { 0.2 } else { 1.0 }
    }
    fn hessian(&mut self, _: PsdProjection, values: &mut [f64]) {
        values.copy_from_slice(&[1e4, 0.0, 1.0]);
    }
}

#[test]
fn walls_slow_it_down_and_do_not_stop_it() {
    let options = Options { iteration_limit: 200, tolerance: 1e-9, ..Options::new("test", 1.0) };
    let end = minimise(&mut Walled, &[3.0, 0.0], &options, &Silent).unwrap();
    assert_eq!(end.ending, Ending::Converged);
    assert!(
        (end.x[1] - 100.0).abs() < 1e-8 && end.iterations < 100,
        "{:?} in {}",
        end.x,
        end.iterations
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
    fn value_and_gradient(&mut self, x: &[f64], g: &mut [f64]) -> f64 {
        self.x = [x[0], x[1]];
        g.copy_from_slice(&[x[0] - 100.0, 4e-9 * x[1].powi(3)]);
        self.energy(x)
    }
    fn hessian(&mut self, projection: PsdProjection, values: &mut [f64]) {
        let curvature = if projection == PsdProjection::None { self.exact } else { 50.0 };
        values.copy_from_slice(&[curvature, 0.0, 12e-9 * self.x[1] * self.x[1]]);
    }
}

fn stiff(
    exact: f64,
    predicted_decrease_tolerance: f64,
    begin: [f64; 2],
    stay_in_basin: bool,
) -> Outcome {
    let options = Options {
        iteration_limit: 1000,
        tolerance: 1e-15,
        predicted_decrease_tolerance,
        ridge: 1e-20,
        stay_in_basin,
        ..Options::new("test", 1.0)
    };
    minimise(&mut Stiff { x: begin, exact }, &begin, &options, &Silent).unwrap()
}

#[test]
fn steps_are_expanded_where_the_model_is_too_stiff() {
    let end = stiff(-1e3, 0.0, [99.9, 0.0], false);
    assert!((end.x[0] - 100.0).abs() < 1e-5, "{:?}", end.x);
    // A fiftieth of the way with each step takes hundreds of them.
    assert!(end.iterations < 60, "{}", end.iterations);
    // But not where it is to stay in the basin of the start.
    let staying = stiff(-1e3, 0.0, [99.9, 0.0], true);
    assert!(staying.iterations > 3 * end.iterations, "{} {}", staying.iterations, end.iterations);
}

#[test]
fn a_small_predicted_decrease_is_convergence() {
    let [all, enough] = [0.0, 1e-13].map(|predicted_decrease_tolerance| {
        stiff(1.0, predicted_decrease_tolerance, [100.0, 10.0], false)
    });
    assert_eq!([all.ending, enough.ending], [Ending::Converged; 2]);
    assert!(
        enough.iterations + 3 < all.iterations && enough.energy - all.energy < 1e-12,
        "{} {}",
        enough.iterations,
        all.iterations
    );
}
