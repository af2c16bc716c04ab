//! Pairs of triangles of a surface that cross each other, exactly: boxes by parry, signs by
//! [Shewchuk 1997]'s adaptive predicates.
//!
//! Two triangles cross if they have a point in common that is not on a corner or side they share.
//! Triangles that only touch count too. Where all is in one plane, signs in the plane decide.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::Vec3;

/// Faces a thread takes at once.
const CHUNK: usize = 256;

/// All pairs of faces that cross (f < g), in ascending order.
pub fn crossing_pairs(faces: &[[usize; 3]], positions: &[Vec3]) -> Vec<[usize; 2]> {
    let boxes: Vec<Aabb> = faces.iter().map(|face| bounds(face.map(|v| positions[v]))).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let of_face = |f: usize| -> Vec<[usize; 2]> {
        let later = tree.intersect_aabb(&boxes[f]).map(|g| g as usize).filter(|&g| g > f);
        let mut found: Vec<[usize; 2]> =
            later.filter(|&g| cross(faces[f], faces[g], positions)).map(|g| [f, g]).collect();
        found.sort_unstable();
        found
    };
    (0..faces.len()).into_par_iter().with_min_len(CHUNK).flat_map_iter(of_face).collect()
}

fn bounds(corners: [Vec3; 3]) -> Aabb {
    let [a, b, c] = corners.map(|p| Vector::new(p.x, p.y, p.z));
    Aabb::new(a.min(b).min(c), a.max(b).max(c))
}

/// True if two faces have a point in common beside the corners and sides they share.
fn cross(f: [usize; 3], g: [usize; 3], positions: &[Vec3]) -> bool {
    let shared: Vec<usize> = f.into_iter().filter(|v| g.contains(v)).collect();
    let at = |face: [usize; 3]| face.map(|v| positions[v]);
    match shared[..] {
        [] => {
            (0..3).any(|k| pierces([f[k], f[(k + 1) % 3]].map(|v| positions[v]), at(g)))
                || (0..3).any(|k| pierces([g[k], g[(k + 1) % 3]].map(|v| positions[v]), at(f)))
        }
        [v] => {
            let opposite = |face: [usize; 3]| {
                let k = face.iter().position(|&u| u == v).unwrap_or(0);
                [face[(k + 1) % 3], face[(k + 2) % 3]].map(|u| positions[u])
            };
            pierces(opposite(f), at(g)) || pierces(opposite(g), at(f))
        }
        // Along a common side they can only lie on each other.
        [u, v] => {
            let tip = |face: [usize; 3]| face.into_iter().find(|w| *w != u && *w != v).unwrap_or(u);
            let [a, b, p, q] = [u, v, tip(f), tip(g)].map(|w| positions[w]);
            volume(&a, &b, &p, &q) == 0.0 && {
                let axis = flat_axis([a, b, p]);
                side(&a, &b, &p, axis) * side(&a, &b, &q, axis) > 0.0
            }
        }
        _ => true,
    }
}

/// True if a segment and a triangle have a point in common.
fn pierces(segment: [Vec3; 2], triangle: [Vec3; 3]) -> bool {
    let ([p, q], [a, b, c]) = (segment, triangle);
    let (from, to) = (volume(&a, &b, &c, &p), volume(&a, &b, &c, &q));
    if (from > 0.0 && to > 0.0) || (from < 0.0 && to < 0.0) {
        return false;
    }
    if from == 0.0 && to == 0.0 {
        let axis = flat_axis(triangle);
        let inside = |x: &Vec3| {
            let sides = [side(&a, &b, x, axis), side(&b, &c, x, axis), side(&c, &a, x, axis)];
            sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
        };
        return inside(&p)
            || inside(&q)
            || [(a, b), (b, c), (c, a)].iter().any(|(u, v)| segments_meet(&p, &q, u, v, axis));
    }
    let around = [volume(&p, &q, &a, &b), volume(&p, &q, &b, &c), volume(&p, &q, &c, &a)];
    around.iter().all(|&s| s >= 0.0) || around.iter().all(|&s| s <= 0.0)
}

/// True if two segments of one plane have a point in common, seen along `axis`.
fn segments_meet(p: &Vec3, q: &Vec3, a: &Vec3, b: &Vec3, axis: usize) -> bool {
    let opposite = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    opposite(side(p, q, a, axis), side(p, q, b, axis))
        && opposite(side(a, b, p, axis), side(a, b, q, axis))
}

/// Sign of the volume of a tetrahedron; its size is only near.
fn volume(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    orient3d(a, b, c, d)
}

/// Sign of the area of a triangle seen along `axis`.
fn side(a: &Vec3, b: &Vec3, c: &Vec3, axis: usize) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] });
    orient2d(a, b, c)
}

/// The axis along which a triangle is seen best.
fn flat_axis([a, b, c]: [Vec3; 3]) -> usize {
    (b - a).cross(&(c - a)).iamax()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const TWO: [[usize; 3]; 2] = [[0, 1, 2], [3, 4, 5]];

    fn places(list: &[[f64; 3]]) -> Vec<Vec3> {
        list.iter().map(|&[x, y, z]| Vec3::new(x, y, z)).collect()
    }

    #[test]
    fn crossing_touching_and_clear_triangles_are_told_apart() {
        let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let with =
            |other: [[f64; 3]; 3]| crossing_pairs(&TWO, &places(&[flat, other].concat())).len();
        assert_eq!(with([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [0.3, 0.9, 1.0]]), 1);
        // One corner exactly on the face, and an ulp above it.
        assert_eq!(with([[0.25, 0.25, 0.0], [0.2, 0.2, 1.0], [0.3, 0.9, 1.0]]), 1);
        assert_eq!(with([[0.25, 0.25, 1e-200], [0.2, 0.2, 1.0], [0.3, 0.9, 1.0]]), 0);
        // In one plane: overlapping, one in the other, apart.
        assert_eq!(with([[0.2, 0.2, 0.0], [2.0, 0.2, 0.0], [0.2, 2.0, 0.0]]), 1);
        assert_eq!(with([[0.2, 0.2, 0.0], [0.3, 0.2, 0.0], [0.2, 0.3, 0.0]]), 1);
        assert_eq!(with([[1.2, 0.2, 0.0], [2.0, 0.2, 0.0], [1.2, 2.0, 0.0]]), 0);
    }

    #[test]
    fn neighbours_cross_only_where_they_lie_on_each_other() {
        let fold = |tip: [f64; 3]| {
            let positions = places(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 1.0, 0.0], tip]);
            crossing_pairs(&[[0, 1, 2], [1, 0, 3]], &positions).len()
        };
        assert_eq!(fold([0.5, -1.0, 0.0]), 0);
        assert_eq!(fold([0.5, 1.0, 1e-200]), 0);
        assert_eq!(fold([0.5, 1.0, 0.0]), 1);
        // Two that share a corner.
        let fan = |tip: [f64; 3]| {
            let positions =
                places(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], tip, [0.3, 0.3, -1.0]]);
            crossing_pairs(&[[0, 1, 2], [0, 3, 4]], &positions).len()
        };
        assert_eq!(fan([0.3, 0.3, 1.0]), 1);
        assert_eq!(fan([-0.3, -0.6, 1.0]), 0);
    }

    /// Against what every pair says on its own, and whatever the numbering.
    #[test]
    fn the_boxes_lose_no_pair() {
        let mut random = Random(3);
        let mut number = || random.unit();
        let (mut faces, mut positions) = (Vec::new(), Vec::new());
        for f in 0..120 {
            let centre = Vec3::new(number(), number(), number());
            positions
                .extend((0..3).map(|_| centre + 0.4 * Vec3::new(number(), number(), number())));
            faces.push([3 * f, 3 * f + 1, 3 * f + 2]);
        }
        let found = crossing_pairs(&faces, &positions);
        let all: Vec<[usize; 2]> = (0..faces.len())
            .flat_map(|f| (f + 1..faces.len()).map(move |g| [f, g]))
            .filter(|&[f, g]| cross(faces[f], faces[g], &positions))
            .collect();
        assert_eq!(found, all);
        assert!(found.len() > 20, "{}", found.len());
        let turned: Vec<[usize; 3]> = faces.iter().map(|&[a, b, c]| [c, b, a]).collect();
        assert_eq!(found, crossing_pairs(&turned, &positions));
    }
}
