//! One large fold, as the arc θ = θ₀·sin(qs) of a strip that keeps its length: its angle, its
//! height, and the foundation that keeps its wavelength.
//!
//! Grown by g, the strip lies over 1/g of its length: ⟨cos θ⟩ = J₀(θ₀) = 1/g. To first order its
//! offset is 2J₁(θ₀)/q·cos(qs), and per unit of *starting* length it stores g·B/2·θ₀²q²/2 in
//! bending and k/2·(2J₁/q)²/2 in the foundation. With Q = gq, the wave number seen on the starting
//! surface, the sum is least at Q⁴ = k/B·c(g), c = 4J₁²g³/θ₀². Small folds have c = 1; a foundation
//! softened by c keeps the wavelength that is seen, however far the surface grows.

/// Largest growth factor (no unit) for which θ₀ is computed.
const MOST_GROWTH: f64 = 50.0;

/// J₀(x) and J₁(x) for 0 ≤ x ≤ 2.405, by their series.
fn bessel(x: f64) -> [f64; 2] {
    let y = -0.25 * x * x;
    let (mut zero, mut one, mut term) = (0.0, 0.0, 1.0);
    for k in 0..24 {
        zero += term;
        one += term / (k as f64 + 1.0);
        term *= y / ((k as f64 + 1.0) * (k as f64 + 1.0));
    }
    [zero, 0.5 * x * one]
}

/// θ₀ (rad): the steepest slope of folds that take up growth by the factor `growth` (no unit); 0
/// where nothing grows.
pub fn fold_angle(growth: f64) -> f64 {
    let target = 1.0 / growth.clamp(1.0, MOST_GROWTH);
    let (mut low, mut high) = (0.0, 2.405);
    // J₀ = 1 − θ²/4 + … is above its parabola, so this is below the angle.
    let mut angle = 2.0 * (1.0 - target).sqrt();
    for _ in 0..60 {
        let [zero, one] = bessel(angle);
        if zero > target {
            low = angle;
        } else {
            high = angle;
        }
        // Newton's step, J₀' = −J₁, or half of what is left where that leaves it.
        let next = angle + (zero - target) / one;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - angle).abs() <= 1e-15 * angle || (zero - target).abs() <= f64::EPSILON {
            break;
        }
        angle = next;
    }
    angle
}

/// c(g) (no unit): softening of the foundation of a surface grown by the factor `growth`, over that
/// of one that has only begun to fold, with which its folds keep the wavelength that is seen on the
/// starting surface.
pub fn softening(growth: f64) -> f64 {
    let growth = growth.clamp(1.0, MOST_GROWTH);
    let angle = fold_angle(growth);
    if angle < 1e-4 {
        return 1.0;
    }
    let ratio = 2.0 * bessel(angle)[1] / angle;
    ratio * ratio * growth.powi(3)
}

/// Amplitude of the folds' offset over their wavelength on the starting surface, both m:
/// g·2J₁(θ₀)/2π.
pub fn amplitude(growth: f64) -> f64 {
    let growth = growth.clamp(1.0, MOST_GROWTH);
    growth * bessel(fold_angle(growth))[1] / std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_folds_take_up_a_quarter_of_their_squared_slope() {
        // a²q²/4 = ε for small ε.
        for strain in [1e-6, 1e-4, 1e-2] {
            let slope = fold_angle(1.0 + strain);
            assert!((slope * slope / 4.0 / strain - 1.0).abs() < 2.0 * strain, "{strain}");
            assert!(
                (std::f64::consts::TAU * amplitude(1.0 + strain) / slope - 1.0).abs()
                    < 3.0 * strain
            );
        }
        assert_eq!(
            (fold_angle(0.5), softening(1.0), amplitude(1.0)),
            (fold_angle(1.0), 1.0, 0.0_f64.max(amplitude(1.0)))
        );
    }

    #[test]
    fn a_large_fold_lies_over_its_share_of_its_length() {
        for growth in [1.2, 1.5, 2.0, 3.0] {
            let angle = fold_angle(growth);
            let n = 20_000;
            let cosines: f64 = (0..n)
                .map(|k| (angle * (std::f64::consts::TAU * k as f64 / n as f64).sin()).cos())
                .sum();
            assert!((cosines / n as f64 * growth - 1.0).abs() < 1e-9);
        }
        // J₀(1.5211) = ½; J₁ there is 0.5611.
        assert!((fold_angle(2.0) - 1.5211).abs() < 1e-3);
        assert!((softening(2.0) - 8.0 * (2.0 * 0.5611_f64 / 1.5211).powi(2)).abs() < 5e-3);
        assert!([1.0, 1.1, 1.5, 2.0, 4.0].windows(2).all(|g| softening(g[0]) < softening(g[1])));
    }
}
