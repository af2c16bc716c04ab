//! Distance of two primitives of a surface: a vertex and a face, or two edges. The distance is d =
//! |Σ wₖxₖ|, and because it is the smallest one, its derivative is that at fixed weights: ∂d/∂xₖ =
//! wₖn.

use crate::mesh::Vec3;

/// Two primitives of a surface that have no vertex in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum PrimitivePair {
    /// A vertex, and the corners of a face.
    VertexFace([usize; 4]),
    /// The ends of an edge, and the ends of another.
    Edges([usize; 4]),
}

/// Closest points of two primitives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestPoints {
    /// Their distance, in the unit of the places.
    pub(crate) distance: f64,
    /// Weights of the four places in the vector between the closest points.
    pub(crate) weights: [f64; 4],
    /// Unit vector from the second primitive to the first; zero where they touch.
    pub(crate) normal: Vec3,
}

impl PrimitivePair {
    /// The four vertices.
    pub(crate) fn vertices(&self) -> [usize; 4] {
        match *self {
            Self::VertexFace(vertices) | Self::Edges(vertices) => vertices,
        }
    }

    /// Bound on the loss of distance where vertices move as far as `by` (`[V]`).
    pub(crate) fn approach_bound(&self, by: &[f64]) -> f64 {
        match *self {
            Self::VertexFace([v, a, b, c]) => by[v] + by[a].max(by[b]).max(by[c]),
            Self::Edges([a, b, c, d]) => by[a].max(by[b]) + by[c].max(by[d]),
        }
    }

    /// Closest points of the two, with the four vertices at `x`.
    pub(crate) fn closest_points(&self, x: [Vec3; 4]) -> ClosestPoints {
        let weights = match self {
            Self::VertexFace(_) => {
                let [a, b, c] = closest_on_triangle(&x[0], &x[1], &x[2], &x[3]);
                [1.0, -a, -b, -c]
            }
            Self::Edges(_) => {
                let [s, t] = closest_on_segments(&x[0], &x[1], &x[2], &x[3]);
                [1.0 - s, s, t - 1.0, -t]
            }
        };
        // From differences, so that places far from the origin lose nothing.
        let join =
            (x[1] - x[0]) * weights[1] + (x[2] - x[0]) * weights[2] + (x[3] - x[0]) * weights[3];
        let distance = join.norm();
        ClosestPoints { distance, weights, normal: join.try_normalize(0.0).unwrap_or_default() }
    }
}

/// Barycentric coordinates of the point of a triangle nearest to `p`, by the region that `p` lies
/// in.
fn closest_on_triangle(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let beyond_ab = d1 * d4 - d3 * d2;
    if beyond_ab <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let beyond_ac = d5 * d2 - d1 * d6;
    if beyond_ac <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let beyond_bc = d3 * d6 - d5 * d4;
    if beyond_bc <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let sum = beyond_ab + beyond_ac + beyond_bc;
    let (v, w) = (beyond_ac / sum, beyond_ab / sum);
    [1.0 - v - w, v, w]
}

/// Positions of the nearest points along the segments a–b and c–d (0 to 1).
fn closest_on_segments(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> [f64; 2] {
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.norm_squared(), v.norm_squared(), u.dot(&v));
    let (ur, vr) = (u.dot(&r), v.dot(&r));
    let unit = |x: f64| x.clamp(0.0, 1.0);
    if uu == 0.0 {
        return [0.0, if vv == 0.0 { 0.0 } else { unit(vr / vv) }];
    }
    if vv == 0.0 {
        return [unit(-ur / uu), 0.0];
    }
    // The cross product's square, without the cancellation of uu·vv − uv².
    let slant = u.cross(&v).norm_squared();
    let s = if slant > 0.0 { unit((uv * vr - ur * vv) / slant) } else { 0.5 };
    let t = (uv * s + vr) / vv;
    if t < 0.0 {
        [unit(-ur / uu), 0.0]
    } else if t > 1.0 {
        [unit((uv - ur) / uu), 1.0]
    } else {
        [s, t]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::derivative_check::gradient_error;
    use crate::random::Random;

    fn random_places(random: &mut Random) -> [Vec3; 4] {
        std::array::from_fn(|_| Vec3::new(random.unit(), random.unit(), random.unit()))
    }

    /// Against a fine sampling of both parts.
    #[test]
    fn nothing_is_nearer() {
        let mut random = Random(11);
        let steps = 60;
        let part = |n: usize| n as f64 / steps as f64;
        for _ in 0..200 {
            let x = random_places(&mut random);
            let mut least = [f64::INFINITY; 2];
            for m in 0..=steps {
                for n in 0..=steps {
                    let on_first = x[0] + (x[1] - x[0]) * part(m);
                    least[1] = least[1].min((on_first - (x[2] + (x[3] - x[2]) * part(n))).norm());
                    if m + n <= steps {
                        let on_face = x[1] + (x[2] - x[1]) * part(m) + (x[3] - x[1]) * part(n);
                        least[0] = least[0].min((x[0] - on_face).norm());
                    }
                }
            }
            for (pair, least) in
                [PrimitivePair::VertexFace([0, 1, 2, 3]), PrimitivePair::Edges([0, 1, 2, 3])]
                    .into_iter()
                    .zip(least)
            {
                let near = pair.closest_points(x);
                assert!(
                    near.distance <= least + 1e-12 && near.distance > least - 0.03,
                    "{near:?} {least}"
                );
                let join: Vec3 = x.iter().zip(near.weights).map(|(x, w)| x * w).sum();
                assert!((join - near.normal * near.distance).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn the_slope_is_that_at_fixed_weights() {
        let mut random = Random(4);
        for pair in [PrimitivePair::VertexFace([0, 1, 2, 3]), PrimitivePair::Edges([0, 1, 2, 3])] {
            for _ in 0..20 {
                let x = random_places(&mut random);
                let flat: Vec<f64> = x.iter().flat_map(|p| p.iter().copied()).collect();
                let at = |y: &[f64]| {
                    pair.closest_points(std::array::from_fn(|k| {
                        Vec3::new(y[3 * k], y[3 * k + 1], y[3 * k + 2])
                    }))
                    .distance
                };
                let near = pair.closest_points(x);
                let gradient: Vec<f64> =
                    (0..12).map(|i| near.weights[i / 3] * near.normal[i % 3]).collect();
                let e = gradient_error(&flat, 0.01, &gradient, at);
                assert!(e < 1e-5, "{pair:?} {e:e}");
            }
        }
    }

    #[test]
    fn edges_without_length_and_parallel_ones_have_a_distance() {
        let [o, x, y] = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        let edges = PrimitivePair::Edges([0, 1, 2, 3]);
        assert_eq!(edges.closest_points([o, o, x, x]).distance, 1.0);
        assert_eq!(edges.closest_points([o, o, y, y + x]).distance, 1.0);
        assert_eq!(edges.closest_points([y, y + x, o, o]).distance, 1.0);
        assert_eq!(edges.closest_points([o, x, y, y + x]).distance, 1.0);
        assert!(
            (edges.closest_points([o, x, 2.0 * x + y, 3.0 * x + y]).distance - 2.0_f64.sqrt())
                .abs()
                < 1e-15
        );
    }
}
