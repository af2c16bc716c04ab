//! Closest integer vectors: minimise (z − c)ᵀ M (z − c) over integer z for a small positive
//! definite M.
//!
//! Exact by enumeration (Schnorr & Euchner 1994) as long as the search stays under a budget of
//! nodes; beyond it the best vector found so far is returned, and said to be so. Enumeration visits
//! nearest integers first, so the first leaf is Babai's plane rounding, and the result is never
//! worse than that.

/// Least pivot, relative to the diagonal entry, that is clear of rounding.
const MIN_PIVOT: f64 = 1e-14;

/// A vector of integers near a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Closest {
    /// `[n]` the integers.
    pub integers: Vec<i64>,
    /// (z − c)ᵀ M (z − c).
    pub distance_squared: f64,
    /// True if the search was complete, so that no other vector is nearer.
    pub exact: bool,
}

/// The integers nearest to `target` (`[n]`) in the metric `m` (`[n][n]`, row by row, symmetric
/// positive definite; a pivot that is not positive counts as a direction without weight and is
/// rounded on its own).
pub fn closest_integers(m: &[f64], target: &[f64], node_budget: usize) -> Closest {
    let n = target.len();
    // M = Rᵀ R with R upper triangular.
    let mut r = vec![0.0; n * n];
    for i in 0..n {
        let mut pivot = m[i * n + i];
        for k in 0..i {
            pivot -= r[k * n + i] * r[k * n + i];
        }
        let floor = MIN_PIVOT * m[i * n + i].abs().max(f64::MIN_POSITIVE);
        let d = pivot.max(floor).sqrt();
        r[i * n + i] = d;
        for j in i + 1..n {
            let mut s = m[i * n + j];
            for k in 0..i {
                s -= r[k * n + i] * r[k * n + j];
            }
            r[i * n + j] = s / d;
        }
    }
    let mut search = Search {
        r: &r,
        target,
        z: vec![0; n],
        best: Vec::new(),
        best_distance: f64::INFINITY,
        nodes: node_budget,
    };
    search.descend(n, 0.0);
    let exact = search.nodes > 0;
    Closest { integers: search.best, distance_squared: search.best_distance, exact }
}

struct Search<'a> {
    r: &'a [f64],
    target: &'a [f64],
    z: Vec<i64>,
    best: Vec<i64>,
    best_distance: f64,
    nodes: usize,
}

impl Search<'_> {
    fn descend(&mut self, level: usize, distance: f64) {
        if level == 0 {
            if distance < self.best_distance {
                self.best_distance = distance;
                self.best = self.z.clone();
            }
            return;
        }
        let n = self.target.len();
        let i = level - 1;
        let mut shift = 0.0;
        for j in level..n {
            shift += self.r[i * n + j] * (self.z[j] as f64 - self.target[j]);
        }
        let d = self.r[i * n + i];
        let centre = self.target[i] - shift / d;
        let nearest = centre.round();
        // Zigzag outwards: nearest, then the other side, and so on; distances only grow.
        let side = if centre >= nearest { 1.0 } else { -1.0 };
        let mut k = 0_i64;
        loop {
            let offset =
                if k % 2 == 1 { side * ((k + 1) / 2) as f64 } else { -side * (k / 2) as f64 };
            let value = nearest + offset;
            let here = distance + (d * (value - centre)).powi(2);
            if here >= self.best_distance {
                return;
            }
            if self.nodes == 0 && self.best_distance.is_finite() {
                return;
            }
            self.nodes = self.nodes.saturating_sub(1);
            self.z[i] = value as i64;
            self.descend(i, here);
            k += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beats_plain_rounding_on_a_skewed_metric() {
        // Strongly coupled: rounding each number on its own gives (0, 0) + (1, −1)-like errors.
        let m = [1.0, 0.99, 0.99, 1.0];
        let found = closest_integers(&m, &[0.4, 0.45], 10_000);
        assert!(found.exact);
        let cost = |z: [f64; 2]| {
            let d = [z[0] - 0.4, z[1] - 0.45];
            d[0] * d[0] * m[0] + 2.0 * d[0] * d[1] * m[1] + d[1] * d[1] * m[3]
        };
        let mut best = f64::INFINITY;
        for a in -5..=5 {
            for b in -5..=5 {
                best = best.min(cost([a as f64, b as f64]));
            }
        }
        assert!((found.distance_squared - best).abs() < 1e-12);
        assert!(best < cost([0.0, 0.0]));
    }

    #[test]
    fn agrees_with_brute_force_in_four_dimensions() {
        let n = 4;
        for case in 0..20 {
            let value = |k: usize| ((case * 31 + k * 17) as f64 * 0.618).fract() - 0.5;
            let mut m = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..n {
                    m[i * n + j] = (0..n).map(|k| value(i * n + k) * value(j * n + k)).sum::<f64>()
                        + if i == j { 0.02 } else { 0.0 };
                }
            }
            let target: Vec<f64> = (0..n).map(|i| 3.0 * value(100 + i)).collect();
            let found = closest_integers(&m, &target, 1_000_000);
            let mut best = f64::INFINITY;
            for code in 0..13_usize.pow(4) {
                let z: Vec<f64> = (0..n)
                    .map(|i| ((code / 13_usize.pow(i as u32)) % 13) as f64 - 6.0 - target[i])
                    .collect();
                let cost: f64 =
                    (0..n).map(|i| (0..n).map(|j| z[i] * m[i * n + j] * z[j]).sum::<f64>()).sum();
                best = best.min(cost);
            }
            assert!(found.exact && found.distance_squared <= best + 1e-12, "case {case}");
        }
    }
}
