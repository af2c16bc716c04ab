//! Triangles unfolded into the plane by their rest metric.

use crate::mesh::Vec2;
use crate::rest::RestFace;

/// Corners (m) of an unfolded face: the first at the origin, the second on the x axis.
pub(super) fn corners(face: &RestFace) -> [Vec2; 3] {
    let [u, v] = face.edges();
    [Vec2::zeros(), u, v]
}

/// The rest metric of a flat triangle with these corners (m), counter-clockwise.
pub(super) fn metric([a, b, c]: [Vec2; 3]) -> RestFace {
    let (u, v) = (b - a, c - a);
    let length = u.norm();
    from_root(length, u.dot(&v) / length, u.perp(&v) / length)
}

/// The rest metric of a triangle with side lengths (m) 0→1, 0→2 and 1→2; none if they make no
/// triangle.
pub(super) fn metric_of_sides(a: f64, b: f64, c: f64) -> Option<RestFace> {
    // Heron's formula as Kahan orders it: exact to rounding for thin triangles too.
    let mut s = [a, b, c];
    s.sort_unstable_by(|x, y| y.total_cmp(x));
    let [x, y, z] = s;
    let square = (x + (y + z)) * (z - (x - y)) * (z + (x - y)) * (x + (y - z));
    (square > 0.0 && square.is_finite())
        .then(|| from_root(a, ((a * a - c * c) + b * b) / (2.0 * a), square.sqrt() / (2.0 * a)))
}

/// The metric whose edges are (l11, 0) and (l21, l22) (m).
fn from_root(l11: f64, l21: f64, l22: f64) -> RestFace {
    let inverse_root = crate::mesh::Mat2::new(1.0 / l11, 0.0, -l21 / (l11 * l22), 1.0 / l22);
    RestFace { inverse_root, area_m2: 0.5 * l11 * l22 }
}

/// Length (m) of the side from corner `k` to the next.
pub(super) fn side(face: &RestFace, k: usize) -> f64 {
    let p = corners(face);
    (p[(k + 1) % 3] - p[k]).norm()
}

/// A face seen from its side `k`, which lies on the x axis from the origin: the side's length (m),
/// and where the third corner is (m).
pub(super) fn over_side(face: &RestFace, k: usize) -> (f64, Vec2) {
    let p = corners(face);
    let (e, w) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
    let length = e.norm();
    (length, Vec2::new(e.dot(&w) / length, e.perp(&w) / length))
}

/// Angle (rad) at corner `k`.
pub(super) fn angle(face: &RestFace, k: usize) -> f64 {
    let (_, apex) = over_side(face, k);
    apex.y.atan2(apex.x)
}

/// Cotangent of the angle opposite side `k`.
pub(super) fn cotangent_over(face: &RestFace, k: usize) -> f64 {
    let p = corners(face);
    let (a, b) = (p[k] - p[(k + 2) % 3], p[(k + 1) % 3] - p[(k + 2) % 3]);
    a.dot(&b) / a.perp(&b)
}

/// True if two lengths of the same side, from the faces on both sides of it, agree.
pub(super) fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-7 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remesh_lays_triangles_as_they_are() {
        let c = [Vec2::new(0.3, 0.1), Vec2::new(1.4, -0.2), Vec2::new(0.8, 0.9)];
        let face = metric(c);
        let sides = [0, 1, 2].map(|k: usize| (c[(k + 1) % 3] - c[k]).norm());
        for k in 0..3 {
            assert!(
                (side(&face, k) - sides[k]).abs() < 1e-15
                    && (over_side(&face, k).0 - sides[k]).abs() < 1e-15
            );
        }
        assert!(
            ((0..3).map(|k| angle(&face, k)).sum::<f64>() - std::f64::consts::PI).abs() < 1e-14
        );
        assert!((cotangent_over(&face, 1) * angle(&face, 0).tan() - 1.0).abs() < 1e-13);
        let again = metric_of_sides(sides[0], sides[2], sides[1]).unwrap();
        assert!(
            (again.inverse_root - face.inverse_root).norm() < 1e-13
                && (again.area_m2 - face.area_m2).abs() < 1e-15
        );
        assert!(
            metric_of_sides(1.0, 1.0, 2.0).is_none() && metric_of_sides(1.0, 1.0, 3.0).is_none()
        );
    }
}
