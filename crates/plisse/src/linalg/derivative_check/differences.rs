//! Derivatives against finite differences, at several step sizes.

/// Largest difference, over all components, between `gradient` and central differences of `energy`
/// at `x`, relative to the gradient's largest component; the best over several step sizes (relative
/// to each |xᵢ| + `scale`), since small steps suffer from rounding and large ones from curvature.
pub(crate) fn gradient_error(
    x: &[f64],
    scale: f64,
    gradient: &[f64],
    mut energy: impl FnMut(&[f64]) -> f64,
) -> f64 {
    let size = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs())).max(f64::MIN_POSITIVE);
    let mut y = x.to_vec();
    [1e-3, 1e-4, 1e-5, 1e-6]
        .into_iter()
        .map(|relative| {
            let mut worst = 0.0_f64;
            for i in 0..x.len() {
                let step = relative * (x[i].abs() + scale);
                y[i] = x[i] + step;
                let above = energy(&y);
                y[i] = x[i] - step;
                let below = energy(&y);
                y[i] = x[i];
                worst = worst.max(((above - below) / (2.0 * step) - gradient[i]).abs());
            }
            worst / size
        })
        .fold(f64::INFINITY, f64::min)
}

/// The same for a Hessian (`[n][n]`, row by row) against central differences of the gradient.
pub(crate) fn hessian_error(
    x: &[f64],
    scale: f64,
    hessian: &[f64],
    mut gradient: impl FnMut(&[f64]) -> Vec<f64>,
) -> f64 {
    let n = x.len();
    let size = hessian.iter().fold(0.0_f64, |m, h| m.max(h.abs())).max(f64::MIN_POSITIVE);
    let mut y = x.to_vec();
    [1e-3, 1e-4, 1e-5, 1e-6]
        .into_iter()
        .map(|relative| {
            let mut worst = 0.0_f64;
            for i in 0..n {
                let step = relative * (x[i].abs() + scale);
                y[i] = x[i] + step;
                let above = gradient(&y);
                y[i] = x[i] - step;
                let below = gradient(&y);
                y[i] = x[i];
                for j in 0..n {
                    worst = worst
                        .max(((above[j] - below[j]) / (2.0 * step) - hessian[i * n + j]).abs());
                }
            }
            worst / size
        })
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_derivatives_pass_and_wrong_ones_do_not() {
        let energy = |x: &[f64]| x[0].powi(3) * x[1] + x[1].sin();
        let gradient = |x: &[f64]| vec![3.0 * x[0] * x[0] * x[1], x[0].powi(3) + x[1].cos()];
        let x = [0.7_f64, -1.3];
        let hessian = [6.0 * x[0] * x[1], 3.0 * x[0] * x[0], 3.0 * x[0] * x[0], -x[1].sin()];
        assert!(gradient_error(&x, 1.0, &gradient(&x), energy) < 1e-9);
        assert!(hessian_error(&x, 1.0, &hessian, gradient) < 1e-9);
        let mut wrong = gradient(&x);
        wrong[1] *= 1.001;
        assert!(gradient_error(&x, 1.0, &wrong, energy) > 1e-4);
    }
}
