//! The body inside a closed mesh: the closest triangle by parry's hierarchy of boxes, the side by
//! pseudo-normals.
//!
//! If the closest point lies on an edge or vertex, no single face tells inside from outside, but
//! the sum of the faces' unit normals there does, weighted by their angles at a vertex: [Bærentzen
//! & Aanæs 2005, *Signed Distance Computation Using the Angle Weighted Pseudonormal*]. A face
//! without area has none; its neighbours stand in for it, so that slivers do no harm.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{Triangle, TrianglePointLocation};

use super::{FARTHEST_M, Nearby, tangent_projection};
use crate::Result;
use crate::error::{MeshError, ObstacleError};
use crate::mesh::{Mat3, Vec3, check};

/// Area of the flattest triangle with a normal of its own, relative to the square of its longest
/// edge.
const LEAST_RELATIVE_AREA: f64 = 1e-12;
/// Smallest volume of a body relative to the cube of its size.
const LEAST_RELATIVE_VOLUME: f64 = 1e-15;
/// Closer to an edge or vertex than this part of the body's size and place, the direction from it
/// is only rounding.
const LEAST_RELATIVE_DISTANCE: f64 = 1e-12;
/// Curvature of the distance to an edge or vertex is at most the inverse of this part of the body's
/// size.
const LEAST_RELATIVE_RADIUS: f64 = 1e-6;

#[derive(Debug)]
pub(super) struct Triangles {
    positions: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    /// Those faces that have an area, as the leaves of `boxes`.
    leaves: Vec<Triangle>,
    /// `[leaf]`
    normals: Vec<Normals>,
    boxes: Bvh,
    /// Distances below are rounding (m).
    least_distance: f64,
    least_radius: f64,
}

/// Outward unit normals of a face and its features.
#[derive(Clone, Copy, Debug)]
struct Normals {
    face: Vec3,
    /// Along the side from corner k to corner k + 1.
    sides: [Vec3; 3],
    corners: [Vec3; 3],
}

/// The closest point of the surface and what it lies on.
struct Closest {
    leaf: usize,
    foot: Vec3,
    location: TrianglePointLocation,
}

impl Triangles {
    pub(super) fn new(positions: &[Vec3], faces: &[[usize; 3]]) -> Result<Self> {
        let mut kept = joined_faces(positions, faces)?;
        check_closed(&kept)?;
        turn_outward(positions, &mut kept)?;
        let faces: Vec<[usize; 3]> = kept.into_iter().map(|(_, face)| face).collect();
        let (positions, faces) = without_loose_vertices(positions, &faces);
        let (lower, upper) =
            positions.iter().fold((positions[0], positions[0]), |(l, u), p| (l.inf(p), u.sup(p)));
        let size = (upper - lower).norm();
        let (mut leaves, mut normals) = (Vec::new(), Vec::new());
        for (face, normals_of_face) in faces.iter().zip(pseudo_normals(&positions, &faces)) {
            if unit_normal(&positions, face).is_some() {
                let [a, b, c] = face.map(|v| to_parry(&positions[v]));
                leaves.push(Triangle::new(a, b, c));
                normals.push(normals_of_face);
            }
        }
        let bounds: Vec<Aabb> = leaves
            .iter()
            .map(|t| Aabb::new(t.a.min(t.b).min(t.c), t.a.max(t.b).max(t.c)))
            .collect();
        let boxes = Bvh::from_leaves(BvhBuildStrategy::Binned, &bounds);
        let least_distance = LEAST_RELATIVE_DISTANCE * (size + lower.amax().max(upper.amax()));
        Ok(Self {
            positions,
            faces,
            leaves,
            normals,
            boxes,
            least_distance,
            least_radius: LEAST_RELATIVE_RADIUS * size,
        })
    }

    /// The closest point of the surface, unless it is `reach` (m) or more away.
    fn closest(&self, p: &Vec3, reach: f64) -> Option<Closest> {
        let p = to_parry(p);
        let box_cost = |node: &BvhNode, _| {
            (node.mins() - p).max(p - node.maxs()).max(Vector::ZERO).length_squared()
        };
        let leaf_cost = |leaf: u32, _| {
            let (projection, location) =
                self.leaves[leaf as usize].project_local_point_and_get_location(p, false);
            Some(((projection.point - p).length_squared(), (projection.point, location)))
        };
        let (leaf, (_, (foot, location))) =
            self.boxes.find_best(reach * reach, box_cost, leaf_cost)?;
        Some(Closest { leaf: leaf as usize, foot: Vec3::new(foot.x, foot.y, foot.z), location })
    }

    /// Normal of the feature that `closest` lies on.
    fn normal_at(&self, closest: &Closest) -> &Vec3 {
        let normals = &self.normals[closest.leaf];
        match closest.location {
            TrianglePointLocation::OnVertex(k) => &normals.corners[k as usize],
            TrianglePointLocation::OnEdge(k, _) => &normals.sides[k as usize],
            TrianglePointLocation::OnFace(..) | TrianglePointLocation::OnSolid => &normals.face,
        }
    }

    /// Signed distance of `p`, whose closest point is `closest`.
    fn signed(&self, p: &Vec3, closest: &Closest) -> f64 {
        let offset = p - closest.foot;
        offset.norm().copysign(offset.dot(self.normal_at(closest)))
    }

    pub(super) fn distance_m(&self, p: &Vec3) -> f64 {
        self.closest(p, f64::INFINITY).map_or(f64::NAN, |closest| self.signed(p, &closest))
    }

    pub(super) fn nearby(&self, p: &Vec3, reach_m: f64) -> Option<Nearby> {
        // Outside the box of all, what is out of reach need not be looked for. Inside, there is an
        // answer at any depth.
        let q = to_parry(p);
        let bounds = self.boxes.root_aabb();
        let outside = (bounds.mins - q).max(q - bounds.maxs).max(Vector::ZERO);
        let reach =
            if outside == Vector::ZERO { f64::INFINITY } else { reach_m.max(0.0) * (1.0 + 1e-12) };
        let closest = self.closest(p, reach)?;
        let distance_m = self.signed(p, &closest);
        if distance_m > reach_m {
            return None;
        }
        let normal = *self.normal_at(&closest);
        let side = match closest.location {
            TrianglePointLocation::OnFace(..) | TrianglePointLocation::OnSolid => {
                return Some(Nearby { distance_m, gradient: normal, hessian: Mat3::zeros() });
            }
            TrianglePointLocation::OnEdge(k, _) => Some(k as usize),
            TrianglePointLocation::OnVertex(_) => None,
        };
        let gradient = if distance_m.abs() > self.least_distance {
            ((p - closest.foot) / distance_m).normalize()
        } else {
            normal
        };
        let mut flat = tangent_projection(&gradient);
        if let Some(k) = side {
            // Along the edge nothing bends.
            let triangle = &self.leaves[closest.leaf];
            let corners = [triangle.a, triangle.b, triangle.c];
            let along = corners[(k + 1) % 3] - corners[k];
            let along = flat * Vec3::new(along.x, along.y, along.z).normalize();
            flat -= along * along.transpose() / along.norm_squared().max(f64::MIN_POSITIVE);
        }
        let hessian = flat / distance_m.abs().max(self.least_radius).copysign(distance_m);
        Some(Nearby { distance_m, gradient, hessian })
    }

    pub(super) fn surface(&self) -> (Vec<Vec3>, Vec<[usize; 3]>) {
        (self.positions.clone(), self.faces.clone())
    }
}

fn to_parry(p: &Vec3) -> Vector {
    Vector::new(p.x, p.y, p.z)
}

/// Faces with their number in the input and their vertices: those at the same place along seams, or
/// joined by an edge without length, count as the lowest of them. Faces that name a vertex twice
/// then are left out.
fn joined_faces(positions: &[Vec3], faces: &[[usize; 3]]) -> Result<Vec<(usize, [usize; 3])>> {
    if faces.is_empty() {
        return Err(ObstacleError::NoFaces.into());
    }
    check::check_finite(positions)?;
    if let Some(vertex) = positions.iter().position(|p| p.amax() > FARTHEST_M) {
        return Err(ObstacleError::TooFar { vertex }.into());
    }
    for (f, face) in faces.iter().enumerate() {
        if let Some(&vertex) = face.iter().find(|&&v| v >= positions.len()) {
            let vertex_count = positions.len();
            return Err(MeshError::IndexOutOfRange { face: f, vertex, vertex_count }.into());
        }
    }
    let welded = check::weld(positions, faces);
    let mut lowest_of_welded = vec![usize::MAX; welded.positions.len()];
    for (v, &w) in welded.vertex_of_input.iter().enumerate() {
        lowest_of_welded[w] = lowest_of_welded[w].min(v);
    }
    let mut lowest: Vec<usize> =
        welded.vertex_of_input.iter().map(|&w| lowest_of_welded[w]).collect();
    let find = |lowest: &[usize], mut v: usize| {
        while lowest[v] != v {
            v = lowest[v];
        }
        v
    };
    for face in faces {
        for k in 0..3 {
            let (i, j) = (face[k], face[(k + 1) % 3]);
            if positions[i] == positions[j] {
                let (i, j) = (find(&lowest, i), find(&lowest, j));
                lowest[i.max(j)] = i.min(j);
            }
        }
    }
    let joined = faces.iter().map(|face| face.map(|v| find(&lowest, v)));
    let kept: Vec<_> =
        joined.enumerate().filter(|(_, [a, b, c])| a != b && b != c && c != a).collect();
    if kept.is_empty() { Err(ObstacleError::NoFaces.into()) } else { Ok(kept) }
}

/// Every side of every face as (edge with the lower vertex first, position of the face in the list,
/// corner, whether it runs upward), sorted: equal edges are neighbours.
fn sorted_sides(faces: impl Iterator<Item = [usize; 3]>) -> Vec<([usize; 2], usize, usize, bool)> {
    let sides = faces.enumerate().flat_map(|(f, face)| {
        (0..3).map(move |k| {
            let (i, j) = (face[k], face[(k + 1) % 3]);
            ([i.min(j), i.max(j)], f, k, i < j)
        })
    });
    let mut sides: Vec<_> = sides.collect();
    sides.sort_unstable();
    sides
}

/// Checks that every edge has two faces that agree about outside.
fn check_closed(kept: &[(usize, [usize; 3])]) -> Result<()> {
    let sides = sorted_sides(kept.iter().map(|k| k.1));
    let edges = || sides.chunk_by(|a, b| a.0 == b.0);
    if let Some(same) = edges().find(|same| same.len() > 2) {
        let faces = same.iter().map(|side| kept[side.1].0).collect();
        return Err(ObstacleError::NonManifoldEdge { edge: same[0].0, faces }.into());
    }
    if let Some(edge) = edges().find(|same| same.len() == 1).map(|same| same[0].0) {
        let count = edges().filter(|same| same.len() == 1).count();
        return Err(ObstacleError::Holes { edge, count }.into());
    }
    if let Some(same) = edges().find(|same| same[0].3 == same[1].3) {
        let faces = [kept[same[0].1].0, kept[same[1].1].0];
        return Err(ObstacleError::InconsistentOrientation { faces, edge: same[0].0 }.into());
    }
    Ok(())
}

/// Flips all faces of a mesh that is inside out.
fn turn_outward(positions: &[Vec3], kept: &mut [(usize, [usize; 3])]) -> Result<()> {
    // From a vertex of the body, so that a body far away loses nothing.
    let origin = positions[kept[0].1[0]];
    let (mut volume, mut size) = (0.0, 0.0f64);
    for (_, face) in kept.iter() {
        let [a, b, c] = face.map(|v| positions[v] - origin);
        volume += a.dot(&b.cross(&c)) / 6.0;
        size = size.max(a.norm());
    }
    if volume.abs() <= LEAST_RELATIVE_VOLUME * size.powi(3) {
        return Err(ObstacleError::NoVolume.into());
    }
    if volume < 0.0 {
        for (_, face) in kept.iter_mut() {
            face.swap(1, 2);
        }
    }
    Ok(())
}

/// The vertices that faces use, and the faces over them.
fn without_loose_vertices(
    positions: &[Vec3],
    faces: &[[usize; 3]],
) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let mut number = vec![usize::MAX; positions.len()];
    for &v in faces.iter().flatten() {
        number[v] = 0;
    }
    let mut used = Vec::new();
    for v in 0..positions.len() {
        if number[v] == 0 {
            number[v] = used.len();
            used.push(positions[v]);
        }
    }
    (used, faces.iter().map(|face| face.map(|v| number[v])).collect())
}

/// Unit normal of a face, if it has an area.
fn unit_normal(positions: &[Vec3], face: &[usize; 3]) -> Option<Vec3> {
    let [a, b, c] = face.map(|v| positions[v]);
    let longest_squared =
        (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
    let twice_area = (b - a).cross(&(c - a));
    (twice_area.norm() > LEAST_RELATIVE_AREA * longest_squared).then(|| twice_area.normalize())
}

/// `[F]` normals of the faces of a closed mesh and of their features.
fn pseudo_normals(positions: &[Vec3], faces: &[[usize; 3]]) -> Vec<Normals> {
    // The face across each side.
    let mut across = vec![[0; 3]; faces.len()];
    for pair in sorted_sides(faces.iter().copied()).chunks_exact(2) {
        let [(_, f, k, _), (_, g, l, _)] = [pair[0], pair[1]];
        across[f][k] = g;
        across[g][l] = f;
    }
    let own: Vec<Option<Vec3>> = faces.iter().map(|face| unit_normal(positions, face)).collect();
    // A face without area lies along its longest side, and is part of the face beyond it.
    let longest_side = |f: usize| {
        let length =
            |k: usize| (positions[faces[f][(k + 1) % 3]] - positions[faces[f][k]]).norm_squared();
        (0..3).fold(0, |best, k| if length(k) > length(best) { k } else { best })
    };
    let mut face_normals: Vec<Vec3> = own.iter().map(|n| n.unwrap_or_default()).collect();
    for f in (0..faces.len()).filter(|&f| own[f].is_none()) {
        let mut beyond = f;
        // Slivers may lie against slivers.
        for _ in 0..16 {
            beyond = across[beyond][longest_side(beyond)];
            if let Some(normal) = own[beyond] {
                face_normals[f] = normal;
                break;
            }
        }
    }
    let mut vertex_normals = vec![Vec3::zeros(); positions.len()];
    for (f, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|i| positions[face[(k + i) % 3]]);
            let angle = (b - a).cross(&(c - a)).norm().atan2((b - a).dot(&(c - a)));
            vertex_normals[face[k]] += face_normals[f] * angle;
        }
    }
    // What a face shows across its side `k`; a sliver across its longest side shows what lies
    // behind it.
    let shown = |f: usize, from: usize| {
        if own[f].is_none() && across[f][longest_side(f)] == from {
            let others =
                (0..3).filter(|&k| k != longest_side(f)).map(|k| face_normals[across[f][k]]);
            return others.sum::<Vec3>().try_normalize(0.0).unwrap_or_default();
        }
        face_normals[f]
    };
    let unit = |sum: Vec3, face: Vec3| sum.try_normalize(1e-12).unwrap_or(face);
    (0..faces.len())
        .map(|f| Normals {
            face: face_normals[f],
            sides: [0, 1, 2]
                .map(|k| unit(face_normals[f] + shown(across[f][k], f), face_normals[f])),
            corners: faces[f].map(|v| unit(vertex_normals[v], face_normals[f])),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::Obstacle;
    use super::super::tessellate::icosphere;
    use super::super::tests::{numbers, points};
    use super::*;
    use crate::{At, Error};

    /// The box with corners ±1, ±2, ±3.
    fn cuboid() -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let corner = |mask: usize| {
            Vec3::from_fn(|k, _| (k as f64 + 1.0) * if mask >> k & 1 == 1 { 1.0 } else { -1.0 })
        };
        let mut faces = Vec::new();
        for k in 0..3 {
            let (u, v) = (1 << ((k + 1) % 3), 1 << ((k + 2) % 3));
            let high = 1 << k;
            faces.extend([[high, high + u, high + u + v], [high, high + u + v, high + v]]);
            faces.extend([[0, u + v, u], [0, v, u + v]]);
        }
        ((0..8).map(corner).collect(), faces)
    }

    fn cuboid_distance(p: &Vec3) -> f64 {
        let q = p.abs() - Vec3::new(1.0, 2.0, 3.0);
        q.sup(&Vec3::zeros()).norm() + q.max().min(0.0)
    }

    fn obstacle((positions, faces): (Vec<Vec3>, Vec<[usize; 3]>)) -> Obstacle {
        Obstacle::mesh("m", &positions, &faces).unwrap()
    }

    #[test]
    fn a_box_has_its_exact_distance() {
        let body = obstacle(cuboid());
        let mut probes = points(1, 4000, 5.0);
        // Close to its edges and corners, too.
        for p in points(2, 4000, 1.0) {
            let size = 10f64.powf(-4.0 - 4.0 * p.x);
            let corner = Vec3::new(1.0, 2.0 * p.y.signum(), 3.0 * p.z.signum());
            probes.push(corner + p * size);
            probes.push(
                Vec3::new(1.0, -2.0, p.z * 2.9) + p.component_mul(&Vec3::new(size, size, 0.0)),
            );
        }
        for p in &probes {
            let expected = cuboid_distance(p);
            let near = body.nearby(p, f64::INFINITY).unwrap();
            assert_eq!(near.distance_m, body.distance_m(p));
            assert!(
                (near.distance_m - expected).abs() < 4e-15,
                "{p} {expected:e} {:e}",
                near.distance_m
            );
            assert!(
                near.distance_m == 0.0
                    || (near.distance_m < 0.0) == (expected < 0.0)
                    || expected.abs() < 1e-15
            );
            assert!(
                (near.gradient.norm() - 1.0).abs() < 1e-14
                    && near.hessian.iter().all(|h| h.is_finite())
            );
        }
        // By region: face, edge, corner, and inside.
        for (p, d, g) in [
            (Vec3::new(1.5, 0.3, 0.2), 0.5, Vec3::x()),
            (Vec3::new(4.0, -6.0, 0.1), 5.0, Vec3::new(0.6, -0.8, 0.0)),
            (Vec3::new(2.0, 4.0, 5.0), 3.0, Vec3::new(1.0, 2.0, 2.0) / 3.0),
            (Vec3::new(-0.8, 0.1, 0.2), -0.2, -Vec3::x()),
        ] {
            let near = body.nearby(&p, 9.0).unwrap();
            assert!((near.distance_m - d).abs() < 1e-15 && (near.gradient - g).norm() < 1e-15);
        }
        // On the surface itself.
        let near = body.nearby(&Vec3::new(1.0, 2.0, 3.0), 0.0).unwrap();
        assert!((near.gradient - Vec3::repeat(1.0 / 3f64.sqrt())).norm() < 1e-15);
    }

    #[test]
    fn derivatives_follow_the_closest_feature() {
        let body = obstacle(cuboid());
        let (step, mut kinds) = (1e-6, [0; 4]);
        for p in points(5, 3000, 5.0) {
            let near = body.nearby(&p, f64::INFINITY).unwrap();
            let sides = [Vec3::x(), Vec3::y(), Vec3::z()]
                .map(|e| [p - e * step, p + e * step].map(|q| body.nearby(&q, 99.0).unwrap()));
            if sides.iter().flatten().any(|s| {
                (s.gradient - near.gradient).norm() > 1e-2
                    || (s.hessian - near.hessian).norm() > 1e-2
            }) {
                continue;
            }
            let gradient =
                Vec3::from(sides.map(|[l, r]| (r.distance_m - l.distance_m) / (2.0 * step)));
            let hessian =
                Mat3::from_columns(&sides.map(|[l, r]| (r.gradient - l.gradient) / (2.0 * step)));
            assert!(
                (gradient - near.gradient).norm() < 1e-8 && (hessian - near.hessian).norm() < 1e-7,
                "{p}"
            );
            let curved =
                near.hessian.symmetric_eigenvalues().iter().filter(|h| h.abs() > 1e-9).count();
            kinds[curved] += 1;
        }
        assert!(kinds[0] > 100 && kinds[1] > 100 && kinds[2] > 100, "{kinds:?}");
    }

    #[test]
    fn reach_and_mesh_search_agree() {
        let body = obstacle(cuboid());
        for p in points(6, 2000, 5.0) {
            let distance = body.distance_m(&p);
            for reach in [0.0, 0.5, 2.0, f64::INFINITY] {
                assert_eq!(body.nearby(&p, reach).is_some(), distance <= reach);
            }
        }
        assert!(body.distance_m(&Vec3::repeat(f64::NAN)).is_nan());
    }

    #[test]
    fn a_fine_sphere_is_a_sphere_within_its_sagitta() {
        let (positions, faces) = icosphere(4);
        let sagitta = faces
            .iter()
            .map(|f| 1.0 - (positions[f[0]] + positions[f[1]] + positions[f[2]]).norm() / 3.0)
            .fold(0.0, f64::max);
        let body = obstacle((positions, faces));
        let mut next = numbers(9);
        for p in points(8, 5000, 1.0) {
            let p = if next() > 0.0 { p * 2.0 } else { p.normalize() * (1.0 + 0.02 * next()) };
            let (near, exact) = (body.nearby(&p, f64::INFINITY).unwrap(), p.norm() - 1.0);
            assert!(
                near.distance_m >= exact - 1e-14 && near.distance_m <= exact + 1.05 * sagitta,
                "{p} {exact}"
            );
            assert!(near.distance_m < 0.0 || exact > -1.05 * sagitta);
            assert!(p.norm() < 0.3 || near.gradient.dot(&p.normalize()) > 0.9);
        }
    }

    /// A star: every second vertex pulled in, so that there are sharp ridges, valleys and saddles.
    fn star() -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let (mut positions, faces) = icosphere(1);
        positions.iter_mut().take(12).for_each(|p| *p *= 3.0);
        positions.iter_mut().skip(12).for_each(|p| *p *= 0.5);
        (positions, faces)
    }

    /// A needle along z with most of its sides crowded together: at its tip, a plain mean of
    /// normals points away from the others.
    fn needle() -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let mut angles: Vec<f64> = (0..12).map(|k| 0.03 * k as f64).collect();
        angles.extend([2.0, 4.2]);
        let n = angles.len();
        let mut positions: Vec<Vec3> =
            angles.iter().map(|a| Vec3::new(0.3 * a.cos(), 0.3 * a.sin(), -1.5)).collect();
        positions.extend([Vec3::new(0.0, 0.0, 1.5), Vec3::new(0.0, 0.0, -1.5)]);
        let faces = (0..n).flat_map(|k| [[k, (k + 1) % n, n], [(k + 1) % n, k, n + 1]]).collect();
        (positions, faces)
    }

    /// A tetrahedron whose ridge along x is sharp.
    fn blade() -> (Vec<Vec3>, Vec<[usize; 3]>) {
        let positions = [[-1.5, 0.0, 1.0], [1.5, 0.0, 1.0], [0.2, -0.2, -1.5], [-0.1, 0.2, -1.5]]
            .map(Vec3::from);
        (positions.to_vec(), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    }

    #[test]
    fn the_sign_is_that_of_the_winding_number_on_sharp_bodies() {
        for (positions, faces) in [star(), needle(), blade()] {
            let body = obstacle((positions.clone(), faces.clone()));
            let mut inside_count = 0;
            for p in points(11, 5000, 2.0).into_iter().chain(points(12, 5000, 0.7)) {
                // Solid angle of all faces: 4π inside, 0 outside.
                let solid_angle = |face: &[usize; 3]| {
                    let [a, b, c] = face.map(|v| positions[v] - p);
                    let (l, m, n) = (a.norm(), b.norm(), c.norm());
                    2.0 * a
                        .dot(&b.cross(&c))
                        .atan2(l * m * n + a.dot(&b) * n + b.dot(&c) * l + c.dot(&a) * m)
                };
                let inside =
                    faces.iter().map(solid_angle).sum::<f64>().abs() > std::f64::consts::TAU;
                assert_eq!(body.distance_m(&p) < 0.0, inside, "{p} {}", body.distance_m(&p));
                inside_count += usize::from(inside);
            }
            assert!((100..9000).contains(&inside_count), "{inside_count}");
        }
    }

    #[test]
    fn the_surface_is_the_mesh() {
        let (mut positions, faces) = cuboid();
        positions.push(Vec3::repeat(77.0));
        let body = obstacle((positions.clone(), faces.clone()));
        assert_eq!(body.surface(&Vec3::zeros(), &Vec3::zeros()), (positions[..8].to_vec(), faces));
    }

    #[test]
    fn meshes_that_can_be_fixed_are_fixed() {
        let (positions, faces) = cuboid();
        let inside_out: Vec<_> = faces.iter().map(|f| [f[0], f[2], f[1]]).collect();
        // As texture seams leave it: each face with its own vertices.
        let split: Vec<Vec3> = faces.iter().flatten().map(|&v| positions[v]).collect();
        let split_faces: Vec<_> = (0..12).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        // A face that names a vertex twice, and an edge cut at its middle with a face without area
        // beside it, on the long edge between the faces on x = 1 and y = −2.
        let (mut more, mut sliver) = (positions.clone(), faces.clone());
        sliver.push([2, 2, 5]);
        more.push((positions[1] + positions[5]) / 2.0);
        let f =
            sliver.iter().position(|f| (0..3).any(|k| f[k] == 1 && f[(k + 1) % 3] == 5)).unwrap();
        let apex = sliver[f].iter().copied().find(|v| ![1, 5].contains(v)).unwrap();
        sliver[f] = [1, 8, apex];
        sliver.extend([[8, 5, apex], [1, 5, 8]]);
        // A corner twice, with a face without area between its two copies.
        let (mut doubled, mut needle) = (positions.clone(), faces.clone());
        doubled.push(positions[7]);
        let f = needle.iter().position(|f| f.contains(&7)).unwrap();
        let k = needle[f].iter().position(|&v| v == 7).unwrap();
        let (before, after) = (needle[f][(k + 2) % 3], needle[f][(k + 1) % 3]);
        needle[f][k] = 8;
        needle.extend([[7, 8, before], [8, 7, after]]);
        let bodies =
            [(positions, inside_out), (split, split_faces), (more, sliver), (doubled, needle)];
        for (k, body) in bodies.into_iter().enumerate() {
            let body = obstacle(body);
            let mut probes = points(1, 3000, 5.0);
            probes.extend(
                points(3, 1000, 1.0)
                    .into_iter()
                    .map(|p| Vec3::new(1.0 + 0.1 * p.x, -2.0 + 0.1 * p.y, 3.0 * p.z)),
            );
            for p in probes {
                assert!(
                    (body.distance_m(&p) - cuboid_distance(&p)).abs() < 1e-14,
                    "{k} {p} {}",
                    body.distance_m(&p)
                );
            }
        }
    }

    #[test]
    fn bad_meshes_are_named() {
        let (positions, faces) = cuboid();
        let message = |positions: &[Vec3], faces: &[[usize; 3]]| {
            let error = Obstacle::mesh("m", positions, faces).at("m.obj").unwrap_err();
            assert!(matches!(error, Error::Mesh { .. }));
            error.to_string()
        };
        assert_eq!(
            message(&[], &[]),
            "m.obj: the obstacle has no faces with an area; give a closed triangle mesh"
        );
        assert!(message(&positions, &[[1, 1, 2]]).contains("no faces with an area"));
        assert_eq!(
            message(&positions, &faces[1..]),
            "m.obj: the obstacle has holes: 3 open edges, first between vertices 1 and 3; close \
             the mesh"
        );
        let mut bad = faces.clone();
        bad[4][1] = 8;
        assert!(
            message(&positions, &bad)
                .contains("face 4 names vertex 8, but there are only 8 vertices")
        );
        let mut bad = faces.clone();
        bad[4].swap(0, 1);
        let text = message(&positions, &bad);
        assert!(
            text.contains("disagree about which side is outside")
                && (text.contains("faces 4 and") || text.contains("and 4 of")),
            "{text}"
        );
        let mut bad = faces.clone();
        bad.push([0, 1, 7]);
        assert!(message(&positions, &bad).contains("of the obstacle is shared by 3 faces"));
        for (value, words) in [
            (f64::NAN, "which is no point"),
            (f64::INFINITY, "which is no point"),
            (1e300, "is the mesh in metres?"),
        ] {
            let mut bad = positions.clone();
            bad[3].y = value;
            assert!(
                message(&bad, &faces).contains("vertex 3 is")
                    && message(&bad, &faces).contains(words)
            );
        }
        let pressed: Vec<Vec3> =
            positions.iter().map(|p| Vec3::new(p.x, p.y, p.z * 1e-20)).collect();
        assert!(message(&pressed, &faces).contains("the obstacle encloses no volume"));
        let dot = vec![Vec3::repeat(1.0); 8];
        assert!(message(&dot, &faces).contains("no faces with an area"));
    }

    #[test]
    fn small_and_far_bodies_keep_their_sign() {
        let (positions, faces) = star();
        let body = obstacle((positions.clone(), faces.clone()));
        for (scale, at) in
            [(1e-6, Vec3::zeros()), (1e4, Vec3::zeros()), (1.0, Vec3::new(1e5, -1e5, 3e4))]
        {
            let moved =
                obstacle((positions.iter().map(|p| p * scale + at).collect(), faces.clone()));
            for p in points(13, 1000, 2.0) {
                let (d, e) = (body.distance_m(&p), moved.distance_m(&(p * scale + at)) / scale);
                assert!((d - e).abs() < 1e-14 + 1e-15 * at.norm() / scale, "{scale} {d} {e}");
            }
        }
    }
}
