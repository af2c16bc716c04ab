//! Cuts one polygon in space into triangles, without new vertices: quads along their shorter valid
//! diagonal, convex polygons as a fan from their first corner, all others by clipping ears in the
//! plane of their area vector.
//!
//! Time is quadratic in the number of corners of a polygon that is not convex. Holes are understood
//! only as mesh programs write them: joined to the outline by an edge that is run along twice.

use crate::mesh::{Vec2, Vec3};

/// Smallest usable triangle: its area relative to the square of its sides, or to the area of its
/// quad.
const SLIVER: f64 = 1e-10;

/// Appends the triangles of the polygon with corners `points` (`[n]`, n ≥ 3) to `triangles`: `n -
/// 2` of them, as numbers of corners (from 0), each running around as the polygon does.
///
/// Returns whether the cut is sound: no triangle is turned over or without area. It is not for a
/// polygon that crosses itself, has no area, or is far from flat; the connectivity is that of a
/// disk even then.
pub(super) fn triangulate(points: &[Vec3], triangles: &mut Vec<[usize; 3]>) -> bool {
    let n = points.len();
    if n == 3 {
        triangles.push([0, 1, 2]);
        return true;
    }
    let area = area_vector(points);
    if n == 4 {
        return quad(points, &area, triangles);
    }
    let Some(flat) = project(points, &area) else {
        fan(n, triangles);
        return false;
    };
    let turns_left = |a: usize, b: usize, c: usize| shape(flat[a], flat[b], flat[c]) > SLIVER;
    if (0..n).all(|i| turns_left(i, (i + 1) % n, (i + 2) % n))
        && (1..n - 1).all(|i| turns_left(0, i, i + 1))
    {
        fan(n, triangles);
        return true;
    }
    clip_ears(&flat, triangles)
}

/// Twice the vector area; its direction is the normal of the plane in which the polygon is seen
/// largest.
fn area_vector(points: &[Vec3]) -> Vec3 {
    points.windows(2).skip(1).map(|p| (p[0] - points[0]).cross(&(p[1] - points[0]))).sum()
}

fn fan(n: usize, triangles: &mut Vec<[usize; 3]>) {
    triangles.extend((1..n - 1).map(|i| [0, i, i + 1]));
}

fn quad(p: &[Vec3], area: &Vec3, triangles: &mut Vec<[usize; 3]>) -> bool {
    let faces_up = |[a, b, c]: [usize; 3]| {
        (p[b] - p[a]).cross(&(p[c] - p[a])).dot(area) > SLIVER * area.norm_squared()
    };
    let cuts = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
    let sound = cuts.map(|cut| cut.into_iter().all(faces_up));
    let first_is_shorter = (p[2] - p[0]).norm_squared() <= (p[3] - p[1]).norm_squared();
    let take_first = if sound[0] == sound[1] { first_is_shorter } else { sound[0] };
    triangles.extend(cuts[usize::from(!take_first)]);
    sound[0] || sound[1]
}

/// The corners in a right-handed frame of the plane across `area`, or nothing if the polygon has no
/// area.
fn project(points: &[Vec3], area: &Vec3) -> Option<Vec<Vec2>> {
    let normal = area.try_normalize(0.0).filter(|n| n.iter().all(|x| x.is_finite()))?;
    let mut axis = Vec3::zeros();
    axis[normal.iamin()] = 1.0;
    let u = axis.cross(&normal).normalize();
    let v = normal.cross(&u);
    Some(
        points
            .iter()
            .map(|p| Vec2::new((p - points[0]).dot(&u), (p - points[0]).dot(&v)))
            .collect(),
    )
}

/// Twice the signed area of a triangle over the sum of its squared sides: 0.577 if equilateral, 0
/// if flat, < 0 if turned over.
fn shape(a: Vec2, b: Vec2, c: Vec2) -> f64 {
    let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    if sides > 0.0 { (b - a).perp(&(c - a)) / sides } else { 0.0 }
}

/// Clips the best-shaped ear until a triangle is left. Removing an ear changes only whether its two
/// neighbours are ears.
fn clip_ears(flat: &[Vec2], triangles: &mut Vec<[usize; 3]>) -> bool {
    let mut ring: Vec<usize> = (0..flat.len()).collect();
    let mut ears: Vec<Option<f64>> = (0..ring.len()).map(|i| ear(flat, &ring, i)).collect();
    let mut sound = true;
    while ring.len() > 3 {
        let n = ring.len();
        let mut best: Option<usize> = None;
        for i in 0..n {
            if ears[i].is_some() && best.is_none_or(|b| ears[i] > ears[b]) {
                best = Some(i);
            }
        }
        let i = best.unwrap_or_else(|| {
            sound = false;
            let tip = |i: usize| {
                shape(flat[ring[(i + n - 1) % n]], flat[ring[i]], flat[ring[(i + 1) % n]])
            };
            (1..n).fold(0, |most, i| if tip(i) > tip(most) { i } else { most })
        });
        triangles.push([ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]]);
        ring.remove(i);
        ears.remove(i);
        for k in [(i + n - 2) % (n - 1), i % (n - 1)] {
            ears[k] = ear(flat, &ring, k);
        }
    }
    triangles.push([ring[0], ring[1], ring[2]]);
    sound && shape(flat[ring[0]], flat[ring[1]], flat[ring[2]]) > SLIVER
}

/// The shape of the triangle at corner `i` of `ring`, if it can be clipped: it has area and no
/// other corner in it or on it.
fn ear(flat: &[Vec2], ring: &[usize], i: usize) -> Option<f64> {
    let n = ring.len();
    let corners = [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
    let [a, b, c] = corners.map(|k| flat[k]);
    let shape = shape(a, b, c);
    // A corner that rounding puts just outside blocks too, or the triangles left for it would have
    // no area.
    let least =
        -SLIVER * ((b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared());
    let blocks = |&k: &usize| {
        let p = flat[k];
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(from, to)| (to - from).perp(&(p - from)) >= least);
        inside && p != a && p != b && p != c
    };
    (shape > SLIVER && !ring.iter().any(blocks)).then_some(shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[Vec3], triangles: &[[usize; 3]]) -> f64 {
        triangles
            .iter()
            .map(|t| {
                0.5 * (points[t[1]] - points[t[0]]).cross(&(points[t[2]] - points[t[0]])).norm()
            })
            .sum()
    }

    /// Corners in a slanted plane far from the origin, so that no axis is special.
    fn slanted(corners: &[[f64; 2]]) -> Vec<Vec3> {
        let (u, v) = (Vec3::new(2.0, -1.0, 2.0) / 3.0, Vec3::new(2.0, 2.0, -1.0) / 3.0);
        corners.iter().map(|c| Vec3::new(10.0, -20.0, 5.0) + u * c[0] + v * c[1]).collect()
    }

    /// A sound cut covers exactly the polygon's area (a wrong diagonal or a turned triangle covers
    /// more) and is a disk: every side of the outline once, every diagonal twice in opposite
    /// directions.
    fn check(corners: &[[f64; 2]]) {
        let points = slanted(corners);
        let n = points.len();
        let mut triangles = Vec::new();
        assert!(triangulate(&points, &mut triangles), "{corners:?}");
        assert_eq!(triangles.len(), n - 2);
        let exact = 0.5 * area_vector(&points).norm();
        assert!(
            (area(&points, &triangles) - exact).abs() < 1e-9 * exact,
            "{corners:?} {triangles:?}"
        );
        let mut sides: Vec<[usize; 2]> =
            triangles.iter().flat_map(|t| (0..3).map(|k| [t[k], t[(k + 1) % 3]])).collect();
        sides.sort_unstable();
        sides.dedup();
        assert_eq!(sides.len(), 3 * (n - 2), "a side runs twice in the same direction");
        for side in &sides {
            let outline = (side[0] + 1) % n == side[1];
            assert_ne!(outline, sides.contains(&[side[1], side[0]]), "{side:?}");
        }
    }

    #[test]
    fn quads_take_the_shorter_diagonal_that_lies_inside() {
        let cut = |corners: &[[f64; 2]]| {
            check(corners);
            let mut triangles = Vec::new();
            triangulate(&slanted(corners), &mut triangles);
            triangles
        };
        assert_eq!(cut(&[[0.0, 0.0], [2.0, -1.0], [4.0, 0.0], [2.0, 1.0]]), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(cut(&[[0.0, 0.0], [2.0, -3.0], [4.0, 0.0], [2.0, 3.0]]), [[0, 1, 2], [0, 2, 3]]);
        // An arrow head: its shorter diagonal 1-3 lies outside.
        assert_eq!(
            cut(&[[0.0, 0.0], [-1.0, -1.0], [4.0, 0.0], [-1.0, 1.0]]),
            [[0, 1, 2], [0, 2, 3]]
        );
    }

    #[test]
    fn any_simple_polygon_is_covered_exactly_from_any_first_corner() {
        let shapes: [&[[f64; 2]]; 5] = [
            // a regular hexagon, roughly
            &[[2.0, 0.0], [1.0, 1.7], [-1.0, 1.7], [-2.0, 0.0], [-1.0, -1.7], [1.0, -1.7]],
            // an L, a comb
            &[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]],
            &[
                [0.0, 0.0],
                [5.0, 0.0],
                [5.0, 3.0],
                [4.0, 3.0],
                [4.0, 1.0],
                [3.0, 1.0],
                [3.0, 3.0],
                [2.0, 3.0],
                [2.0, 1.0],
                [0.0, 1.0],
            ],
            // a triangle with corners on its sides: a fan from any of them has triangles without
            // area
            &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [4.0, 0.0], [2.0, 2.0], [0.0, 4.0], [0.0, 2.0]],
            // a spiral: a fan from its first corner is turned over
            &[
                [0.0, 0.0],
                [6.0, 0.0],
                [6.0, 6.0],
                [1.0, 6.0],
                [1.0, 3.0],
                [2.0, 3.0],
                [2.0, 5.0],
                [5.0, 5.0],
                [5.0, 1.0],
                [0.0, 1.0],
            ],
        ];
        for shape in shapes {
            for first in 0..shape.len() {
                check(&[&shape[first..], &shape[..first]].concat());
            }
        }
    }

    #[test]
    fn unsound_polygons_are_told() {
        let told = |corners: &[[f64; 2]]| {
            let mut triangles = Vec::new();
            let sound = triangulate(&slanted(corners), &mut triangles);
            assert_eq!(triangles.len(), corners.len() - 2);
            !sound
        };
        assert!(told(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), "a bow tie");
        assert!(told(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [1.5, 0.0]]), "a line");
        assert!(told(&[[1.0, 1.0]; 5]), "a point");
        let star: Vec<[f64; 2]> =
            (0..5).map(|i| (f64::from(i) * 0.8 * std::f64::consts::PI).sin_cos().into()).collect();
        assert!(told(&star), "a five-pointed star turns left everywhere, but twice around");
    }
}
