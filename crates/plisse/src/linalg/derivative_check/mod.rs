//! Derivative checks for tests: against finite differences, of functions and of whole
//! [`Problem`]s.

mod differences;

pub(crate) use differences::{gradient_error, hessian_error};

use super::problem::Problem;
use super::psd_projection::PsdProjection;

/// Checks the derivatives of `problem` at `x` (`[n]`) against differences with steps relative to
/// |xᵢ| + `scale`, and that both evaluations give the same energy.
///
/// # Panics
/// If the gradient is off by more than 10⁻⁷ or the true Hessian, with its remainder, by more than
/// 10⁻⁶ of its largest component.
pub(crate) fn check_problem(problem: &mut dyn Problem, x: &[f64], scale: f64) {
    let n = x.len();
    let mut gradient = vec![0.0; n];
    let energy = problem.value_and_gradient(x, &mut gradient);
    assert!(energy.is_finite() && energy == problem.energy(x), "{energy} {}", problem.energy(x));
    let hessian = dense_hessian(problem, n);
    let e = gradient_error(x, scale, &gradient, |y| problem.energy(y));
    assert!(e < 1e-7, "gradient {e:e}");
    let e = hessian_error(x, scale, &hessian, |y| {
        let mut gradient = vec![0.0; n];
        problem.value_and_gradient(y, &mut gradient);
        gradient
    });
    assert!(e < 1e-6, "Hessian {e:e}");
}

/// `[n][n]` the true Hessian of `problem`, row by row, from its products with unit vectors.
fn dense_hessian(problem: &mut dyn Problem, n: usize) -> Vec<f64> {
    let pattern = problem.pattern();
    let mut values = vec![0.0; pattern.entry_count()];
    problem.hessian(PsdProjection::None, &mut values);
    let (mut hessian, mut unit) = (vec![0.0; n * n], vec![0.0; n]);
    for (i, row) in hessian.chunks_mut(n).enumerate() {
        unit[i] = 1.0;
        pattern.multiply(&values, &unit, row);
        problem.apply_hessian_remainder(&unit, row);
        unit[i] = 0.0;
    }
    hessian
}
