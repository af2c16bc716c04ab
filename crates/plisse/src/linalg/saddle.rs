//! Where the gradient vanishes without the energy being least: a direction of negative curvature to
//! leave by.
//!
//! A convex bound P of the Hessian H (the factorised one of [`super::newton`]) has no such
//! direction; but P⁻¹H has eigenvalues at most 1, and those of I − P⁻¹H above 1 belong to
//! directions along which H bends downwards. Powers of that matrix find the steepest of them.

use super::descent::Descent;
use super::newton::{Convexity, Problem};

/// Powers taken at most.
const POWERS: usize = 200;
/// Powers between two looks at the curvature.
const LOOK: usize = 20;
/// Curvature, over that of P, that counts as rounding.
const ROUNDING: f64 = 1e-7;

/// A direction (largest component 1) along which the Hessian of `problem`, linearised where its
/// gradient vanishes, is negative; `None` if there is none to be found. `ridge` is the share of the
/// largest diagonal entry that is added.
pub(super) fn downward(
    problem: &mut dyn Problem,
    descent: &mut Descent,
    convexity: Convexity,
    ridge: f64,
) -> Option<Vec<f64>> {
    let Descent { cholesky, diagonal, values, .. } = descent;
    let stiffen = |values: &mut [f64]| {
        let largest = diagonal.iter().map(|&slot| values[slot].abs()).fold(0.0, f64::max);
        diagonal.iter().for_each(|&slot| values[slot] += ridge.max(1e-12) * largest);
    };
    problem.hessian(Convexity::Exact, values);
    let exact = values.to_vec();
    stiffen(values);
    if cholesky.factorise(values) {
        return None;
    }
    problem.hessian(convexity, values);
    stiffen(values);
    if !cholesky.factorise(values) {
        return None;
    }
    let n = diagonal.len();
    // Any start will do that has a part of everything; this one is the same for any machine.
    let mut v: Vec<f64> = (0..n).map(|i| (i as f64 * 12.9898 + 1.0).sin()).collect();
    let (mut image, mut bound) = (vec![0.0; n], vec![0.0; n]);
    for power in 1..=POWERS {
        cholesky.pattern().multiply(&exact, &v, &mut image);
        if power % LOOK == 0 {
            cholesky.pattern().multiply(values, &v, &mut bound);
            let dot = |a: &[f64]| a.iter().zip(&v).map(|(a, v)| a * v).sum::<f64>();
            if dot(&image) < -ROUNDING * dot(&bound) && power >= 3 * LOOK {
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
