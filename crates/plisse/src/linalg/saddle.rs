//! Escape from saddles, where the gradient vanishes but the energy is not least: along a direction
//! of negative curvature.
//!
//! The projected Hessian P (the factorised one of [`super::newton`]) bounds the Hessian H from
//! above and has no such direction. So P⁻¹H has eigenvalues at most 1, and the eigenvalues of
//! I − P⁻¹H above 1 belong to directions of negative curvature of H. Power iteration with that
//! matrix finds the steepest of them.

use super::line_search::ENERGY_ROUNDING;
use super::newton_direction::NewtonDirection;
use super::problem::Problem;
use super::psd_projection::PsdProjection;

/// Largest number of power iterations.
const MAX_POWERS: usize = 200;
/// Number of power iterations from one test of the curvature to the next.
const POWERS_PER_TEST: usize = 20;
/// Number of power iterations before a direction is accepted, so that it is among the steepest.
const MIN_POWERS: usize = 3 * POWERS_PER_TEST;
/// Curvature, relative to that of P, that counts as rounding.
const CURVATURE_ROUNDING: f64 = 1e-7;
/// Least ridge, as a share of the largest diagonal entry.
const MIN_RIDGE: f64 = 1e-12;
/// Angle (rad) between the components of the start, with which sin fills all directions.
const START_ANGLE: f64 = 12.9898;

/// Largest component of the first step away from a saddle.
const FIRST_STEP: f64 = 0.1;
/// Factor from one step size to the next.
const BACKTRACK: f64 = 0.5;
/// Largest number of step sizes that are tried.
const MAX_BACKTRACKS: usize = 30;

/// A direction (largest component 1) of negative curvature of `problem`, evaluated last where its
/// gradient vanishes; `None` if there is none to be found. `ridge` is the share of the largest
/// diagonal entry that is added to each.
pub(super) fn negative_curvature_direction(
    problem: &mut dyn Problem,
    newton: &mut NewtonDirection,
    projection: PsdProjection,
    ridge: f64,
) -> Option<Vec<f64>> {
    let NewtonDirection { cholesky, diagonal, values, .. } = newton;
    let add_ridge = |values: &mut [f64]| {
        let largest = diagonal.iter().map(|&slot| values[slot].abs()).fold(0.0, f64::max);
        diagonal.iter().for_each(|&slot| values[slot] += ridge.max(MIN_RIDGE) * largest);
    };
    problem.hessian(PsdProjection::None, values);
    let hessian = values.to_vec();
    add_ridge(values);
    if cholesky.factorise(values) {
        return None;
    }
    problem.hessian(projection, values);
    add_ridge(values);
    if !cholesky.factorise(values) {
        return None;
    }
    let n = diagonal.len();
    // Any start with a part of every direction will do; this one is the same on any machine.
    let mut v: Vec<f64> = (0..n).map(|i| (i as f64 * START_ANGLE + 1.0).sin()).collect();
    let (mut image, mut bound) = (vec![0.0; n], vec![0.0; n]);
    for power in 1..=MAX_POWERS {
        cholesky.pattern().multiply(&hessian, &v, &mut image);
        if power % POWERS_PER_TEST == 0 {
            cholesky.pattern().multiply(values, &v, &mut bound);
            let dot = |a: &[f64]| a.iter().zip(&v).map(|(a, v)| a * v).sum::<f64>();
            if dot(&image) < -CURVATURE_ROUNDING * dot(&bound) && power >= MIN_POWERS {
                return Some(v);
            }
        }
        cholesky.solve(&mut image);
        let mut largest = 0.0_f64;
        for (v, step) in v.iter_mut().zip(&image) {
            *v -= step;
            largest = largest.max(v.abs());
        }
        if largest == 0.0 || !largest.is_finite() {
            return None;
        }
        v.iter_mut().for_each(|v| *v /= largest);
    }
    None
}

/// Sets `trial` to the point of least energy among a few along `direction` (either sign) from the
/// saddle `x`, whose energy is `energy`. Returns false if none is lower by more than rounding.
pub(super) fn escape(
    problem: &mut dyn Problem,
    x: &[f64],
    energy: f64,
    direction: &[f64],
    trial: &mut [f64],
) -> bool {
    let step: Vec<f64> = direction.iter().map(|d| d * FIRST_STEP).collect();
    let mut size = problem.max_step_size(x, &step);
    let (mut least_energy, mut best_size) = (energy - ENERGY_ROUNDING * energy.abs(), 0.0);
    for _ in 0..MAX_BACKTRACKS {
        for i in 0..x.len() {
            trial[i] = x[i] + size * step[i];
        }
        let there = problem.energy(trial);
        if there < least_energy {
            (least_energy, best_size) = (there, size);
        } else if best_size > 0.0 {
            break;
        }
        size *= BACKTRACK;
    }
    for i in 0..x.len() {
        trial[i] = x[i] + best_size * step[i];
    }
    best_size > 0.0
}
